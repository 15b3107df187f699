# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photometric files in place of a scene's point and spot lights."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from eclat.errors import EclatError, did_you_mean, shown
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.ies import load_ies
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.scene import FloatArray, Light, PointLight, ProfileLight, Scene, SpotLight, look_at


def override_lights(scene: Scene, profiles: Mapping[str, IntensityProfile | str | os.PathLike[str]]) -> Scene:
    """Replace point and spot lights by luminaires that were measured.

    The new light stands where the old one stood and has its colour, but the intensities of the profile. It aims where a spot did,
    and otherwise down.

    Parameters
    ----------
    scene : the scene. If it is radiometric, candela become W·sr⁻¹ by `LUMENS_PER_WATT`.
    profiles : a profile or a photometric file (.ies) by the name of the light.

    Raises
    ------
    EclatError : no point or spot light has a name that is given, or a file cannot be read.
    """
    names = [light.name for light in scene.lights if isinstance(light, PointLight | SpotLight) and light.name]
    loaded: dict[str, IntensityProfile] = {}
    for name, profile in profiles.items():
        if not names:
            raise EclatError(f"light {name!r}: the scene has no point or spot light with a name")
        if name not in names:
            known = ", ".join(dict.fromkeys(names))
            raise EclatError(
                f"light {name!r}: expected the name of a point or spot light ({known}), got another"
                f"{did_you_mean(str(name), names)}"
            )
        if isinstance(profile, str | os.PathLike):
            profile = load_ies(profile)
        if not isinstance(profile, IntensityProfile):
            raise EclatError(f"light {name!r}: expected a profile or the path of a file, got {shown(profile)}")
        loaded[name] = profile
    unit = 1.0 if scene.photometric else 1 / LUMENS_PER_WATT

    def changed(light: Light) -> Light:
        if not isinstance(light, PointLight | SpotLight) or light.name not in loaded:
            return light
        largest = max(light.intensity)
        r, g, b = (unit * (c / largest if largest > 0 else 1.0) for c in light.intensity)
        aim = light.direction if isinstance(light, SpotLight) else tuple(-x for x in scene.up)
        return ProfileLight(light.position, loaded[light.name], (r, g, b), _aimed(aim), light.name)

    return replace(scene, lights=tuple(map(changed, scene.lights)))


def _aimed(direction: tuple[float, ...]) -> FloatArray:
    """Return a rotation (3, 3) that maps −z to the direction."""
    x, y, z = np.asarray(direction, np.float64) / np.linalg.norm(direction)
    rotation: FloatArray = look_at((0.0, 0.0, 0.0), (float(x), float(y), float(z)))[:3, :3]
    return rotation


def parsed_light_override(text: str) -> tuple[str, str]:
    """Parse `LIGHT=FILE` into the name of a light and a file. Raises EclatError if the text has another form."""
    name, _, file = text.partition("=")
    if not name.strip() or not file.strip():
        raise EclatError(f"expected LIGHT=FILE such as lamp=downlight.ies, got {text!r}")
    return name.strip(), file.strip()
