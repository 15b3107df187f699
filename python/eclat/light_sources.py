# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The lights of a scene that are not surfaces, as plain data; `eclat.scene` has them all."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat.intensity_profile import IntensityProfile

FloatArray = NDArray[np.floating]


@dataclass(frozen=True)
class PointLight:
    """A point that emits equally in all directions; `intensity` is in W·sr⁻¹ (candela in a photometric scene)."""

    position: tuple[float, float, float]
    intensity: tuple[float, float, float]
    name: str = ""


@dataclass(frozen=True)
class SpotLight:
    """A point that emits within a cone. `intensity` on the axis is in W·sr⁻¹; angles are in degrees from the axis.

    With the `falloff` "linear", the intensity is constant up to `inner_angle` and decreases linearly with the angle to
    0 at `outer_angle`, as in Mitsuba. With "smooth", it is the square of a clamped linear ramp of the cosine, as in
    glTF.
    """

    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    intensity: tuple[float, float, float]
    inner_angle: float
    outer_angle: float
    falloff: Literal["linear", "smooth"] = "smooth"
    name: str = ""


def _aimed_down() -> FloatArray:
    return np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class ProfileLight:
    """A point that emits as a luminaire was measured to. `scale` multiplies the candela of the `profile`: it is the colour of
    the light and, in a radiometric scene, also converts candela to W·sr⁻¹.

    `to_world` is a 3×3 rotation. Without it, the luminaire aims down, along −y of the world; its own frame, in which it aims
    along −z, is that of `eclat.intensity_profile`.
    """

    position: tuple[float, float, float]
    profile: IntensityProfile
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    to_world: FloatArray = field(default_factory=_aimed_down)
    name: str = ""

    def __repr__(self) -> str:
        return f"<ProfileLight {self.name!r}: {self.profile!r}>"


@dataclass(frozen=True)
class DirectionalLight:
    """Light from infinity that travels along `direction`; `irradiance` in W·m⁻² is that on a surface that faces the
    light.

    `angular_radius` is in degrees: 0 is a delta light; 0.2665 is the sun as seen from Earth, which is visible as a
    disc.
    """

    direction: tuple[float, float, float]
    irradiance: tuple[float, float, float]
    angular_radius: float = 0.0
    name: str = ""


Light = PointLight | SpotLight | ProfileLight | DirectionalLight
"""A light that is not a surface."""


@dataclass(frozen=True, eq=False)
class Environment:
    """Light from infinity, given by an equirectangular float32 image (H, W, 3) of its radiance. An image of one pixel
    means a constant radiance.

    Row 0 is at the direction +y of the environment's frame; the centre column is at −z, and u increases towards +x: u =
    0.5 + atan2(x, −z) / 2π. `to_world` is a 3×3 rotation that maps the environment's frame to the world.
    """

    image: NDArray[np.float32]
    to_world: FloatArray = field(default_factory=lambda: np.eye(3))
    name: str = ""

    def __repr__(self) -> str:
        return f"<Environment: {'×'.join(map(str, np.shape(self.image)[1::-1]))}>"
