# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of light, which irradiance caching and radiance caching share: options, solving, what is solved."""
