# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read point, spot and directional lights [KHR_lights_punctual]."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.gltf.element import Element
from eclat.scene import DirectionalLight, Light, PointLight, ProfileLight, SpotLight


def read_light(light: Element, to_world: NDArray[np.float64], name: str) -> Light:
    """Read a light, whose direction is −z of its node.

    The RGB intensity is the colour multiplied by the intensity in candela or, for directional lights, in lux.

    Parameters
    ----------
    light : the element of the light.
    to_world : the 4×4 transform of the node that it belongs to.
    name : the name that the light gets.

    Raises
    ------
    EclatError : the type is unknown, a number is invalid, or the light has no direction.
    """
    if light.data.get("range") is not None:
        warn(
            f"{light.at('range')}: the range of a light is not supported and is ignored; its intensity decreases with the "
            "inverse square of the distance"
        )
    r, g, b = light.color("color", (1, 1, 1))
    power = max(light.number("intensity", 1.0), 0.0)
    color = (r * power, g * power, b * power)
    x, y, z = (float(v) for v in to_world[:3, 3])
    kind = light.text("type")
    if kind == "point":
        return PointLight((x, y, z), color, name)
    if kind == "directional":
        return DirectionalLight(_direction(light, to_world), color, name=name)
    if kind == "spot":
        inner, outer = _cone(light)
        return SpotLight((x, y, z), _direction(light, to_world), color, inner, outer, "smooth", name)
    raise EclatError(f"{light.at('type')}: expected point, spot or directional, got {kind[:20]!r}")


def read_profile_light(
    reference: Element, profile: IntensityProfile, to_world: NDArray[np.float64], name: str
) -> ProfileLight:
    """Read a light with an IES profile, which aims along −z of its node [EXT_lights_ies].

    Parameters
    ----------
    reference : the extension of the node, which holds the multiplier and the colour.
    profile : the profile that it names.
    to_world : the 4×4 transform of the node, whose scale does not matter.
    name : the name that the light gets.

    Raises
    ------
    EclatError : a number is invalid, or the transform of the node flattens the light.
    """
    power = reference.number("multiplier", 1.0)
    if power < 0:
        raise EclatError(f"{reference.at('multiplier')}: expected a number of at least 0, got {power:g}")
    r, g, b = reference.levels("color", (1, 1, 1), 1.0)
    u, values, vt = np.linalg.svd(to_world[:3, :3])
    if not values[-1] > 1e-9 * values[0]:
        raise EclatError(
            f"{reference.where}: expected a light with a direction, but the transform of its node is singular"
        )
    x, y, z = (float(v) for v in to_world[:3, 3])
    return ProfileLight((x, y, z), profile, (r * power, g * power, b * power), u @ vt, name)


def _direction(light: Element, to_world: NDArray[np.float64]) -> tuple[float, float, float]:
    axis = -to_world[:3, 2]
    length = float(np.linalg.norm(axis))
    if not length > 0:
        raise EclatError(
            f"{light.where}: expected a light with a direction, but the transform of its node has the scale 0 along z"
        )
    x, y, z = (float(v) for v in axis / length)
    return x, y, z


def _cone(light: Element) -> tuple[float, float]:
    """Return the inner and the outer angle of a spot light, in degrees from its axis."""
    spot = light.child("spot") or Element({}, light.where)
    outer = spot.clamped("outerConeAngle", math.pi / 4, 0.0, math.pi / 2)
    inner = spot.clamped("innerConeAngle", 0.0, 0.0, outer)
    if outer == 0:
        raise EclatError(f"{spot.where}: expected an outerConeAngle above 0, got 0")
    return math.degrees(inner), math.degrees(outer)
