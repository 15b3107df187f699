# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Records of light, which irradiance caching and radiance caching share: their options, solving and solutions."""
