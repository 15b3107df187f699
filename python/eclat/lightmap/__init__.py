# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light maps, images of the irradiance on all surfaces. `atlas` places the charts of all surfaces in one image,
`texels` finds the surface point of each texel, `gathering` computes their light, `gutters` fills the texels between
charts, and `lightmap` holds the result and writes its files."""
