# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert emitters that are not part of a shape: point, spot and directional lights, environments, sun and sky."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.daylight.sky import SUN_ANGULAR_RADIUS
from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.files import read_bytes, read_texture
from eclat.loaders.ies import parse_ies
from eclat.loaders.mitsuba.daylight import mitsuba_sun_sky
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.node import Node, Vector
from eclat.loaders.mitsuba.sun_position import sun_direction
from eclat.loaders.mitsuba.textures import Textures, image_data
from eclat.loaders.mitsuba.transforms import Matrix, normalize, transform_directions
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.measure.spectrum import srgb_to_linear
from eclat.scene import DirectionalLight, Environment, Light, PointLight, ProfileLight, SpotLight

Emission = tuple[list[Light], Environment | None]

HALF_TURN = np.diag([-1.0, 1.0, -1.0])
"""The rotation from Éclat's environment maps to Mitsuba's. In Mitsuba, the centre of the image is at +z, and +x is to the
left of it. In Éclat, the centre is at −z, and +x is to the right of it."""


def make_emitter(node: Node, textures: Textures) -> Emission:
    """Convert an emitter of the scene to lights and an environment.

    An emitter whose type is unknown or not supported is left out with a warning.

    Raises
    ------
    EclatError : a number is out of range, or a direction is the zero vector.
    """
    if node.type == "area" and node.id:
        return [], None  # it is defined here so that shapes can refer to it
    if node.type not in _MAKERS:
        near = did_you_mean(node.type, PLUGINS["emitter"]) if node.type not in PLUGINS["emitter"] else ""
        reason = "must be part of a shape" if node.type == "area" else f"is not supported{near}"
        warn(f"{node.where}: an emitter of type {node.type!r} {reason}; it is left out")
        return [], None
    lights, environment = _MAKERS[node.type](node, textures)
    if not node.id:
        return lights, environment
    # The sun and the sky of one emitter keep names of their own, so that they can be told apart.
    one = len(lights) + (environment is not None) == 1
    lights = [replace(light, name=node.id if one else f"{node.id} sun") for light in lights]
    if environment is not None:
        environment = replace(environment, name=node.id if one else f"{node.id} sky")
    return lights, environment


def merge_environments(first: Environment | None, second: Environment | None, where: str) -> Environment | None:
    """Return the first environment that is not None. If both are given, a warning says that the second one is ignored."""
    if first is not None and second is not None:
        warn(f"{where}: this second environment is ignored, because a scene can only have one")
    return first if first is not None else second


def _color(node: Node, textures: Textures, name: str) -> Vector:
    value = textures.value(node, name, default=1.0, kind="emission")
    if value.texture is not None:
        warn(f"{node.where}, {name}: textures are not supported here; only the constant factor of the texture is used")
    return value.constant


def _position(node: Node) -> Vector:
    x, y, z = (float(value) for value in node.transform("to_world")[:3, 3])
    return node.vector("position") or (x, y, z)


def _point(node: Node, textures: Textures) -> Emission:
    return [PointLight(_position(node), _color(node, textures, "intensity"))], None


def _spot(node: Node, textures: Textures) -> Emission:
    outer = node.number("cutoff_angle", default=20.0)
    inner = node.number("beam_width", default=outer * 3 / 4)
    if not 0 < outer <= 180 or inner < 0:
        raise EclatError(
            f"{node.where}: expected 0 ≤ beam_width ≤ cutoff_angle ≤ 180 degrees, got beam_width {inner:g} and "
            f"cutoff_angle {outer:g}"
        )
    if node.get("texture") is not None:
        warn(f"{node.where}: textures of spot lights are not supported; the texture is ignored")
    light = SpotLight(
        position=_position(node),
        direction=_axis(node),
        intensity=_color(node, textures, "intensity"),
        inner_angle=min(inner, outer),
        outer_angle=outer,
        falloff="linear",
    )
    return [light], None


def _axis(node: Node) -> Vector:
    """Return the unit direction of the emitter's +z axis in the world."""
    return _unit(transform_directions(node.transform("to_world"), np.array([[0.0, 0.0, 1.0]]))[0], node)


def _unit(direction: NDArray[Any], node: Node) -> Vector:
    x, y, z = (float(value) for value in normalize(np.asarray(direction, dtype=np.float64)))
    if (x, y, z) == (0.0, 0.0, 0.0):
        raise EclatError(f"{node.where}: expected a direction, got the zero vector")
    return x, y, z


def _directional(node: Node, textures: Textures) -> Emission:
    given = node.vector("direction")
    direction = _axis(node) if given is None else _unit(np.array(given), node)
    return [DirectionalLight(direction, _color(node, textures, "irradiance"))], None


def _ies(node: Node, textures: Textures) -> Emission:
    """Convert an emitter with the profile `filename`, which aims along +z as a spot does. This type is an addition of Éclat.

    `intensity` is a colour or a factor. The candela of the file become W·sr⁻¹, because Mitsuba's scenes are radiometric.
    """
    path = node.file("filename")
    factor = node.number("scale", default=1.0) / LUMENS_PER_WATT
    r, g, b = (factor * c for c in _color(node, textures, "intensity"))
    position, rotation = _position(node), _rotation(node) @ np.diag([1.0, -1.0, -1.0])
    # Last, because it may fail, and what was not read by then would be told to be unused.
    profile = parse_ies(read_bytes(path, where=f"{node.where}, filename"), path.name)
    return [ProfileLight(position, profile, (r, g, b), rotation)], None


def _constant(node: Node, textures: Textures) -> Emission:
    radiance = _color(node, textures, "radiance")
    return [], Environment(np.array(radiance, dtype=np.float32).reshape(1, 1, 3))


def _envmap(node: Node, textures: Textures) -> Emission:
    data = image_data(node)
    if data is None:
        where = f"{node.where}, filename"
        texture = read_texture(node.file("filename"), srgb=True, where=where, neutral=(0.5, 0.5, 0.5))
        image, encoded = texture.image, texture.srgb
    else:
        image, encoded = data[0], not data[1]
    image = image.astype(np.float32) / np.float32(255) if image.dtype == np.uint8 else image.astype(np.float32)
    image = image[..., :3] if image.shape[2] >= 3 else np.repeat(image[..., :1], 3, axis=2)
    if encoded:
        image = srgb_to_linear(image)
    image = np.asarray(image * node.number("scale", default=1.0), dtype=np.float32)
    if image.min() < 0:
        warn(f"{node.where}: the environment map has negative radiance, which is set to 0")
        image = np.maximum(image, 0)
    return [], Environment(image, _rotation(node) @ HALF_TURN)


def _rotation(node: Node) -> Matrix:
    """Return the rotation or reflection (3, 3) in `to_world`, without scale."""
    linear = node.transform("to_world")[:3, :3]
    u, values, vt = np.linalg.svd(linear)
    if values[-1] <= 1e-9 * max(values[0], 1e-300):
        raise EclatError(f"{node.where}, to_world: expected a rotation, got a singular matrix")
    if not np.allclose(values, values.mean(), rtol=1e-3):
        warn(
            f"{node.where}, to_world: the unequal scale of an environment's transform is ignored; its rotation is used"
        )
    rotation: Matrix = u @ vt
    return rotation


def _sun_radius(node: Node) -> float:
    """Return the angular radius of the sun in degrees.

    It is read from `sun_aperture` (an angular diameter in degrees, Mitsuba 3) and `sun_radius_scale` (a factor, Mitsuba
    0.6).
    """
    radius = node.number("sun_aperture", default=2 * SUN_ANGULAR_RADIUS) / 2
    radius *= node.number("sun_radius_scale", default=1.0)
    if not 0 <= radius < 90:
        raise EclatError(
            f"{node.where}: expected an angular radius of the sun of at least 0 and below 90 degrees, got {radius:g}"
        )
    return radius


def _sky(node: Node, textures: Textures) -> Emission:
    up = (0.0, 1.0, 0.0) if node.legacy else (0.0, 0.0, 1.0)
    rotation = _rotation(node)
    local = np.array(node.vector("sun_direction") or sun_direction(node))
    if not np.any(local):
        raise EclatError(f"{node.where}, sun_direction: expected a direction, got the zero vector")
    scale = node.number("scale", default=1.0)
    parts: Literal["sun", "sky", "sunsky"] = "sun" if node.type == "sun" else "sky" if node.type == "sky" else "sunsky"
    albedo = textures.value(node, "albedo", default=0.15 if node.legacy else 0.3, kind="reflectance").constant
    try:
        sun, environment = mitsuba_sun_sky(
            tuple((rotation @ local).tolist()),
            turbidity=node.number("turbidity", default=3.0),
            up=tuple((rotation @ np.array(up)).tolist()),
            albedo=sum(albedo) / 3,
            sun_scale=node.number("sun_scale", default=scale),
            sky_scale=node.number("sky_scale", default=scale),
            parts=parts,
            angular_radius=_sun_radius(node),
        )
    except EclatError as error:
        raise EclatError(f"{node.where}: {error}") from None
    return [] if sun is None else [sun], environment


_MAKERS: dict[str, Callable[[Node, Textures], Emission]] = {
    "point": _point,
    "spot": _spot,
    "directional": _directional,
    "ies": _ies,
    "constant": _constant,
    "envmap": _envmap,
    "sun": _sky,
    "sky": _sky,
    "sunsky": _sky,
}
