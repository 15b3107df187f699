# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lights as the viewer knows them, which has no profiles of luminaires."""

from __future__ import annotations

import math

from eclat.scene import DirectionalLight, Light, PointLight, ProfileLight, SpotLight


def even_light(light: Light) -> PointLight | SpotLight | DirectionalLight:
    """Return the light, or in place of a profile the point light of the same flux, which shines evenly in all directions."""
    if not isinstance(light, ProfileLight):
        return light
    mean = light.profile.flux / (4 * math.pi)
    r, g, b = (float(c) * mean for c in light.scale)
    return PointLight(light.position, (r, g, b), light.name)
