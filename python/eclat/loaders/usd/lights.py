# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read lights [UsdLux].

Symbol  name here   meaning
  L     luminance   cd·m⁻²: intensity · 2^exposure · colour · colour of the temperature, and divided by the size if the light
                    is normalised
  A     area        of the emitting surface in world space, in the unit of length of the stage, by which L is divided
  θ     half_angle  half the angular diameter of a distant light
  E     irradiance  lx, L π sin² θ on a surface that faces a distant light

A distant light is divided by π sin² θ, so that a normalised one has its intensity in lux; one without a diameter is always
in lux.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.primitives import Primitive, transform_primitive
from eclat.loaders.mitsuba import primitives
from eclat.loaders.triangles import LARGEST
from eclat.loaders.usd.shaping import Shaping, read_shaping
from eclat.loaders.usd.stages import Stage, pxr
from eclat.loaders.usd.textures import read_linear_image
from eclat.scene import (
    DirectionalLight,
    Environment,
    Light,
    Material,
    Mesh,
    PointLight,
    ProfileLight,
    SpotLight,
    Texture,
    Value,
    grey,
)

Matrix = NDArray[np.float64]
Rgb = NDArray[np.float64]

SEGMENTS = 64
"""The number of segments around round lights. Their areas, and so their powers, are exact."""


@dataclass(frozen=True)
class Made:
    """What a light of the file becomes: one of these."""

    mesh: Mesh | None = None
    light: Light | None = None
    environment: Environment | None = None


@dataclass(frozen=True)
class _Lamp:
    """A light while it is converted; `to_world` is in metres."""

    stage: Stage
    prim: Any
    schema: Any
    to_world: Matrix
    luminance: Rgb
    normalized: bool
    shaping: Shaping

    @property
    def where(self) -> str:
        return self.stage.where(self.prim)

    def length(self, name: str, default: float) -> float:
        value = self.stage.number(getattr(self.schema, f"Get{name}Attr")(), default)
        if not value >= 0:
            raise EclatError(f"{self.where}: expected a {name.lower()} of at least 0, got {value:g}")
        return value

    def direction(self) -> tuple[float, float, float]:
        """Return the unit vector along −z in the world."""
        axis = -self.to_world[:3, 2]
        length = float(np.linalg.norm(axis))
        if not length > 0:
            raise EclatError(
                f"{self.where}: expected a light with a direction, but its transform has the scale 0 along z"
            )
        x, y, z = (axis / length).tolist()
        return x, y, z


def read_light(stage: Stage, prim: Any, to_world: Matrix) -> Made | None:
    """Read a light.

    Parameters
    ----------
    to_world : 4×4, in metres, and with the scale of the unit of length.

    Returns
    -------
    What it becomes, or None for a kind of light that is not supported, with a warning.

    Raises
    ------
    EclatError : a number is invalid.
    """
    lux, kind = pxr("UsdLux"), str(prim.GetTypeName())
    readers = {
        "DistantLight": _distant,
        "DomeLight": _dome,
        "DomeLight_1": _dome,
        "RectLight": _rect,
        "DiskLight": _disk,
        "SphereLight": _sphere,
        "CylinderLight": _cylinder,
    }
    if kind not in readers:
        stage.once(f"light {kind}", f"lights of the kind {kind or 'mesh'!r} are not supported and are ignored")
        return None
    api = lux.LightAPI(prim)
    luminance = _luminance(stage, api, stage.where(prim), 50000.0 if kind == "DistantLight" else 1.0)
    if not luminance.max() > 0:
        return Made()
    for name, attribute in (("diffuse", api.GetDiffuseAttr()), ("specular", api.GetSpecularAttr())):
        if stage.number(attribute, 1.0) != 1:
            stage.once(f"factor {name}", f"the factor {name!r} of a light is not physical and is ignored")
    schema = getattr(lux, kind)(prim)
    normalized = bool(stage.value(api.GetNormalizeAttr(), False))
    return readers[kind](_Lamp(stage, prim, schema, to_world, luminance, normalized, read_shaping(stage, prim)))


def _luminance(stage: Stage, api: Any, where: str, default: float) -> Rgb:
    intensity = stage.number(api.GetIntensityAttr(), default)
    exposure = stage.number(api.GetExposureAttr(), 0.0)
    color = np.array(stage.value(api.GetColorAttr(), (1, 1, 1)), dtype=np.float64)
    if stage.value(api.GetEnableColorTemperatureAttr(), False):
        kelvin = stage.number(api.GetColorTemperatureAttr(), 6500.0)
        color = color * np.array(pxr("UsdLux").BlackbodyTemperatureAsRgb(kelvin))
    with np.errstate(all="ignore"):
        luminance = intensity * np.exp2(exposure) * color
    if not (np.isfinite(luminance).all() and luminance.min() >= 0 and luminance.max() < LARGEST):
        raise EclatError(f"{where}: expected a luminance of at least 0 that is finite, got {luminance.tolist()}")
    return np.asarray(luminance)


def _distant(lamp: _Lamp) -> Made:
    # A diameter of 360 degrees is light from everywhere; lights of more than a half space are cut there.
    half_angle = min(max(lamp.stage.number(lamp.schema.GetAngleAttr(), 0.53), 0.0), 180.0) / 2
    size = math.pi * math.sin(math.radians(half_angle)) ** 2
    irradiance = lamp.luminance * (1.0 if lamp.normalized or size == 0 else size)
    red, green, blue = irradiance.tolist()
    return Made(light=DirectionalLight(lamp.direction(), (red, green, blue), half_angle, lamp.prim.GetName()))


def _dome(lamp: _Lamp) -> Made:
    """Make an environment. An image of latitudes and longitudes has +y at the top and +z in its centre [UsdLuxDomeLight]."""
    u, values, vt = np.linalg.svd(lamp.to_world[:3, :3])
    if not values[-1] > 1e-9 * values[0]:
        raise EclatError(f"{lamp.where}: expected a dome with a direction, but its transform is singular")
    rotation = u @ vt
    if np.linalg.det(rotation) < 0:
        warn(f"{lamp.where}: the transform mirrors the dome, which is not supported; it is not mirrored")
        rotation = -rotation
    if lamp.prim.GetTypeName() == "DomeLight_1":
        pole = str(lamp.stage.value(lamp.schema.GetPoleAxisAttr(), "scene"))
        if pole == "Z" or (pole == "scene" and lamp.stage.z_up):
            rotation = rotation @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    # The centre of an `Environment` is at −z.
    turned = rotation @ np.diag([-1.0, 1.0, -1.0])
    form = str(lamp.stage.value(lamp.schema.GetTextureFormatAttr(), "automatic"))
    if form not in ("automatic", "latlong"):
        warn(f"{lamp.where}: expected a texture of the format latlong, got {form!r}; it is read as latlong")
    image = read_linear_image(lamp.stage, lamp.schema.GetTextureFileAttr(), lamp.where)
    scaled = np.asarray(image * lamp.luminance, dtype=np.float32)
    return Made(environment=Environment(scaled, turned, lamp.prim.GetName()))


def _rect(lamp: _Lamp) -> Made:
    width, height = lamp.length("Width", 1.0), lamp.length("Height", 1.0)
    image = read_linear_image(lamp.stage, lamp.schema.GetTextureFileAttr(), lamp.where)
    texture = None if image.shape[:2] == (1, 1) and (image == 1).all() else _picture(image, lamp.prim.GetName())
    return _area_light(lamp, primitives.rectangle(), (width / 2, height / 2, 1.0), facing=True, texture=texture)


def _picture(image: NDArray[np.float32], name: str) -> Texture:
    return Texture(image, wrap_u="clamp", wrap_v="clamp", name=name)


def _disk(lamp: _Lamp) -> Made:
    radius = lamp.length("Radius", 0.5)
    return _area_light(lamp, primitives.disk(SEGMENTS), (radius, radius, 1.0), facing=True)


def _cylinder(lamp: _Lamp) -> Made:
    """The lateral surface of a cylinder along x; its ends do not shine."""
    radius, length = lamp.length("Radius", 0.5), lamp.length("Length", 1.0)
    if lamp.stage.value(lamp.schema.GetTreatAsLineAttr(), False):
        warn(f"{lamp.where}: treatAsLine is not supported; the light is a cylinder")
    tube = primitives.cylinder(SEGMENTS)
    along = (tube.positions - [0, 0, 0.5]) * [radius, radius, length]
    surface = primitives.Surface(
        along[:, [2, 0, 1]], tube.normals[:, [2, 0, 1]], tube.tangents, tube.uvs, tube.triangles
    )
    return _area_light(lamp, surface, (1.0, 1.0, 1.0), facing=False)


def _sphere(lamp: _Lamp) -> Made:
    """Make a glowing sphere, or a point at its centre if the light is shaped or to be treated as a point."""
    radius = lamp.length("Radius", 0.5)
    as_point = bool(lamp.stage.value(lamp.schema.GetTreatAsPointAttr(), False)) or radius == 0
    if lamp.shaping.is_even and not as_point:
        return _area_light(lamp, primitives.sphere(SEGMENTS), (radius,) * 3, facing=False)
    if not as_point:
        lamp.stage.once(
            "shaped", "spheres with a cone or a focus become spot lights at their centres, with sharp shadows"
        )
    # A sphere has the intensity L π r² everywhere, in metres; L is divided by its area 4 π r² in units.
    scale = abs(float(np.linalg.det(lamp.to_world[:3, :3]))) ** (1 / 3)
    if lamp.normalized or radius == 0:
        intensity = lamp.luminance / 4 * lamp.stage.metres**2
    else:
        intensity = lamp.luminance * math.pi * (radius * scale) ** 2
    x, y, z = lamp.to_world[:3, 3].tolist()
    red, green, blue = intensity.tolist()
    name, shaping = lamp.prim.GetName(), lamp.shaping
    if shaping.is_even:
        return Made(light=PointLight((x, y, z), (red, green, blue), name))
    if shaping.is_hard_cone:
        cone = min(shaping.cutoff, 180.0)
        return Made(light=SpotLight((x, y, z), lamp.direction(), (red, green, blue), cone, cone, "linear", name))
    u, _, vt = np.linalg.svd(lamp.to_world[:3, :3])
    return Made(light=ProfileLight((x, y, z), shaping.profile(name), (red, green, blue), u @ vt, name))


def _area_light(
    lamp: _Lamp,
    surface: primitives.Surface,
    scale: tuple[float, ...],
    *,
    facing: bool,
    texture: Texture | None = None,
) -> Made:
    """Make a glowing mesh of a surface in the light's coordinates, which faces −z with `facing`, and else outwards.

    The `texture` multiplies its light. Seen from the side that shines, with +y above, the image stands upright.
    """
    positions, normals = surface.positions * scale, surface.normals
    if facing:
        # A half turn about y.
        positions, normals = positions * [-1, 1, -1], normals * [-1, 1, -1]
    limit = 90.0 if facing else 180.0
    if lamp.shaping.cutoff < limit or lamp.shaping.focus > 0:
        kind = lamp.prim.GetTypeName()
        lamp.stage.once(
            f"shaping {kind}",
            f"the cone and the focus of a {kind} are not supported; it shines to all sides of its front",
        )
    primitive = Primitive(
        where=lamp.where,
        positions=positions,
        triangles=surface.triangles.astype(np.int32),
        normals=normals.astype(np.float32),
        tangents=None,
        # Row 0 of a texture lies at v = 0, and here at the largest y.
        uvs=None if texture is None else (surface.uvs * [1, -1] + [0, 1]).astype(np.float32),
        uvs2=None,
        colors=None,
    )
    dark = Material("diffuse", {"reflectance": grey(0.0)}, lamp.prim.GetName(), two_sided=False, back_culled=facing)
    mesh = transform_primitive(primitive, lamp.to_world, dark, lamp.prim.GetName())
    a, b, c = np.moveaxis(np.asarray(mesh.positions, np.float64)[mesh.triangles], 1, 0)
    area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2 / lamp.stage.metres**2
    if not area > 0:
        raise EclatError(f"{lamp.where}: expected a light with an area, got one without")
    red, green, blue = (lamp.luminance / (area if lamp.normalized else 1.0)).tolist()
    glowing = Material(
        "diffuse",
        dark.parameters,
        dark.name,
        two_sided=False,
        back_culled=facing,
        emission=Value((red, green, blue), texture),
    )
    return Made(mesh=replace(mesh, material=glowing, lamp=mesh.name))
