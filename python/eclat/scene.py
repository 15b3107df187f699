# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene as plain data: frozen dataclasses that hold NumPy arrays. Loaders create them, and the core reads them.

Conventions (the core's are the same):

- right-handed world, lengths in metres; scene-linear RGB, Rec. 709 primaries; radiance in W·sr⁻¹·m⁻²;
- directions point away from the surface; a triangle's geometric normal follows counter-clockwise order;
- texture coordinates: (0, 0) is the *top-left* corner of the image, v grows downwards, as in glTF;
- roughness means GGX α everywhere here (glTF's roughness squared).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError

FloatArray = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Texture:
    """An image that varies a parameter over a surface.

    `image` is (H, W, C) with C in 1..4, either uint8 (0..255 meaning 0..1) or float32. With `srgb` the first three
    channels are decoded with the sRGB transfer function, alpha never is. Row 0 is v = 0.
    """

    image: NDArray[Any]
    srgb: bool = False
    wrap_u: Literal["repeat", "mirror", "clamp"] = "repeat"
    wrap_v: Literal["repeat", "mirror", "clamp"] = "repeat"
    filter: Literal["bilinear", "nearest"] = "bilinear"
    name: str = ""

    def __repr__(self) -> str:
        size = "×".join(map(str, np.shape(self.image)))
        return f"<Texture {self.name!r}: {size}{', sRGB' if self.srgb else ''}>"


@dataclass(frozen=True, eq=False)
class Value:
    """A material parameter: `constant`, multiplied by the texel if there is a texture.

    A scalar parameter uses `constant[0]` (give all three the same number) and reads the texture's `channel`;
    a colour uses all three and reads RGB (or the one `channel` as grey).
    `uv_transform` is the 2×3 affine map applied to (u, v, 1) before the lookup.
    """

    constant: tuple[float, float, float]
    texture: Texture | None = None
    channel: int | None = None
    uv_set: int = 0
    uv_transform: tuple[tuple[float, float, float], tuple[float, float, float]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    invert: bool = False
    """Use 1 − texel instead of texel (a few formats store transparency instead of opacity)."""
    square: bool = False
    """Use constant² · texel² (glTF stores the square root of the GGX α that we use)."""


def grey(value: float) -> Value:
    """A scalar (or neutral colour) that does not vary."""
    return Value((float(value),) * 3)


def rgb(r: float, g: float, b: float) -> Value:
    """A colour that does not vary."""
    return Value((float(r), float(g), float(b)))


@dataclass(frozen=True, eq=False)
class NormalMap:
    """Perturbation of the shading normal.

    kind "normal": a tangent-space normal map (texel·2 − 1), xy scaled by `scale`; x and y lie along the tangents and
    bitangents of the mesh or, where it has none, along growing u and against growing v (up in the image, as in glTF).
    kind "bump": a height map; `scale` is the height in metres of a white texel, gradients by finite differences.
    """

    value: Value
    kind: Literal["normal", "bump"] = "normal"
    scale: float = 1.0


MATERIAL_KINDS: dict[str, tuple[str, ...]] = {
    # kind: the names of its parameters (`Material.parameters`); missing ones take DEFAULTS
    "diffuse": ("reflectance",),
    "phong": ("diffuse_reflectance", "specular_reflectance", "exponent"),
    "ward": ("diffuse_reflectance", "specular_reflectance", "alpha_u", "alpha_v"),
    "conductor": ("eta", "k", "specular_reflectance", "alpha_u", "alpha_v"),
    "dielectric": ("specular_reflectance", "specular_transmittance", "ior", "alpha_u", "alpha_v"),
    "thin_dielectric": ("specular_reflectance", "specular_transmittance", "ior"),
    "plastic": ("diffuse_reflectance", "specular_reflectance", "ior", "alpha_u"),
    "metallic_roughness": (
        "base_color",
        "metallic",
        "roughness",  # GGX α
        "ior",
        "specular",  # KHR_materials_specular specularFactor, 0..1
        "specular_color",
        "transmission",  # 0..1 of the dielectric part
        "diffuse_transmission",  # 0..1 of the diffuse part, to the other side (KHR_materials_diffuse_transmission)
        "diffuse_transmission_color",
    ),
    "translucent": ("reflectance", "transmittance"),  # diffuse on both sides, and through to the other
    "blend": ("weight",),  # 0 = children[0], 1 = children[1]
}

DEFAULTS: dict[str, Value] = {
    "reflectance": grey(0.5),
    "diffuse_reflectance": grey(0.5),
    "specular_reflectance": grey(1.0),
    "specular_transmittance": grey(1.0),
    "exponent": grey(30.0),
    "alpha_u": grey(0.0),
    "alpha_v": grey(0.0),
    "eta": grey(0.0),
    "k": grey(1.0),
    "ior": grey(1.5),
    "base_color": grey(1.0),
    "metallic": grey(0.0),
    "roughness": grey(0.5),
    "specular": grey(1.0),
    "specular_color": grey(1.0),
    "transmission": grey(0.0),
    "diffuse_transmission": grey(0.0),
    "diffuse_transmission_color": grey(1.0),
    "transmittance": grey(0.5),
    "weight": grey(0.5),
}


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface reflects, transmits and emits.

    `kind` is a key of `MATERIAL_KINDS`, `parameters` are its values (the rest from `DEFAULTS`). An `alpha_u` of 0
    is a perfectly smooth interface (mirror, glass, polish); `alpha_v` missing means isotropic. A conductor with
    eta = 0 and k = 1 reflects everything, times `specular_reflectance`. `ior` is interior over exterior, the exterior
    being on the normal's side. `ior` and `eta`, `k` cannot be textured.
    `plastic`: a dielectric coat of `alpha_u` over a diffuse base.
    `thin_walled` (metallic_roughness): transmission does not refract.
    """

    kind: str = "diffuse"
    parameters: dict[str, Value] = field(default_factory=dict)
    name: str = ""
    two_sided: bool = True
    """Reflects on both sides; else its back is black (dielectrics and transmission always act on both)."""
    back: Material | None = None
    """With `two_sided`, another material for the back."""
    back_culled: bool = False
    """Without `two_sided`, its back is not black but not there: rays that come from behind pass through. So are
    single-sided materials of glTF [glTF 2.0 specification, section 3.9.6, Double Sided]. What one sees is what lights:
    eyes see through a culled back, and light comes to a point through one just where the point sees through it."""
    distribution: Literal["ggx", "beckmann"] = "ggx"
    nonlinear: bool = False
    """plastic: colour shifts by internal scattering."""
    ward_variant: Literal["bounded", "duer"] = "bounded"
    """`duer` (energy may exceed 1 at grazing angles) is mapped to the bounded variant with a warning."""
    thin_walled: bool = True
    children: tuple[Material, ...] = ()
    opacity: Value = field(default_factory=lambda: grey(1.0))
    """Probability that a ray meets the surface; the rest goes straight through (masks, blended alpha, `d`)."""
    alpha_cutoff: float | None = None
    """With a number, opacity below it is 0 and else 1 (glTF alphaMode MASK)."""
    vertex_colors: bool = False
    """Multiply base colour / reflectance (and opacity by their alpha) by the mesh's vertex colours."""
    normal_map: NormalMap | None = None
    emission: Value | None = None
    """Emitted radiance on the normal's side; None = does not emit."""
    emission_two_sided: bool = False
    """Emits on both sides: only where a format says so. glTF's `doubleSided` does, since a back face is shaded as a
    front with its normal reversed, emission included [glTF 2.0 specification, section 3.9.6, Double Sided]."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in world space with one material.

    positions (V, 3) float64 or float32; triangles (T, 3) integer; normals (V, 3) unit or None for flat shading;
    uvs, uvs2 (V, 2); colors (V, 4) float32 linear; tangents (V, 4), xyz unit and w = ±1, only used by normal maps:
    red lies along the tangent, green along the bitangent w · normal × tangent (MikkTSpace). Where they are missing,
    both follow the texture coordinates.
    """

    positions: FloatArray
    triangles: NDArray[np.integer]
    material: Material
    normals: FloatArray | None = None
    uvs: FloatArray | None = None
    uvs2: FloatArray | None = None
    colors: FloatArray | None = None
    tangents: FloatArray | None = None
    name: str = ""

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r}: {_counted(len(self.triangles), 'triangle')}, {self.material.kind}>"


@dataclass(frozen=True)
class PointLight:
    """A point that shines equally in all directions; `intensity` in W·sr⁻¹ (candela in a photometric scene)."""

    position: tuple[float, float, float]
    intensity: tuple[float, float, float]


@dataclass(frozen=True)
class SpotLight:
    """A cone of light. `intensity` on the axis in W·sr⁻¹; angles in degrees from the axis.

    falloff "linear": 1 inside `inner_angle`, linear in angle to 0 at `outer_angle` (Mitsuba);
    "smooth": glTF's squared, clamped ramp in cosine.
    """

    position: tuple[float, float, float]
    direction: tuple[float, float, float]
    intensity: tuple[float, float, float]
    inner_angle: float
    outer_angle: float
    falloff: Literal["linear", "smooth"] = "smooth"


@dataclass(frozen=True)
class DirectionalLight:
    """Light from infinity that travels along `direction`; `irradiance` in W·m⁻² is that on a surface facing it.

    `angular_radius` in degrees: 0 is a delta light, 0.2665 the sun seen from Earth (a visible disc).
    """

    direction: tuple[float, float, float]
    irradiance: tuple[float, float, float]
    angular_radius: float = 0.0


@dataclass(frozen=True, eq=False)
class Environment:
    """Radiance from infinity: an (H, W, 3) float32 equirectangular image (1×1 for a constant one).

    Row 0 is the direction +y of the environment's frame; the image's centre column is −z, u grows towards +x,
    i.e. u = 0.5 + atan2(x, −z) / 2π. `to_world` (3×3 rotation) takes the environment's frame to the world.
    """

    image: NDArray[np.float32]
    to_world: FloatArray = field(default_factory=lambda: np.eye(3))

    def __repr__(self) -> str:
        return f"<Environment: {'×'.join(map(str, np.shape(self.image)[1::-1]))}>"


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole or thin-lens camera in glTF's convention: looks along local −z, +y up, +x right.

    `to_world` is 4×4 (a mirrored one mirrors the picture). `fov` in degrees along `fov_axis`, or, with
    `projection` "orthographic", `fov` is the full height in metres along that axis.
    `aperture_radius` > 0 in metres blurs what is not at `focus_distance`. `size` is the wanted (width, height), a hint.
    `shift` moves the principal point, in fractions of the image's width and height.
    """

    to_world: FloatArray
    fov: float = 45.0
    fov_axis: Literal["x", "y", "smaller", "larger", "diagonal"] = "y"
    projection: Literal["perspective", "orthographic"] = "perspective"
    aperture_radius: float = 0.0
    focus_distance: float = 1.0
    size: tuple[int, int] | None = None
    shift: tuple[float, float] = (0.0, 0.0)
    name: str = ""

    def half_extent(self, aspect: float) -> tuple[float, float]:
        """Half width and height of the image plane at distance 1 (orthographic: in metres); `aspect` is width / height.

        Raises EclatError for a field of view that is not between 0 and 180 degrees.
        """
        if self.projection == "orthographic":
            half = self.fov / 2
        else:
            if not 0 < self.fov < 180:
                raise EclatError(f"camera {self.name!r}: fov must be between 0 and 180 degrees, got {self.fov!r}")
            half = float(np.tan(np.radians(self.fov) / 2))
        axis = self.fov_axis
        if axis == "smaller":
            axis = "y" if aspect >= 1 else "x"
        elif axis == "larger":
            axis = "x" if aspect >= 1 else "y"
        if axis == "diagonal":
            half_height = half / float(np.hypot(aspect, 1))
            return half_height * aspect, half_height
        return (half, half / aspect) if axis == "x" else (half * aspect, half)


def triangle_areas(corners: FloatArray) -> FloatArray:
    """(N,) areas of triangles, m², from (N, 3, 3) positions of their corners in metres."""
    a, b, c = np.moveaxis(np.asarray(corners, dtype=np.float64), 1, 0)
    twice: FloatArray = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return twice / 2


def look_at(
    origin: tuple[float, float, float], target: tuple[float, float, float], up: tuple[float, float, float] = (0, 1, 0)
) -> FloatArray:
    """The 4×4 `to_world` of a camera at `origin` that looks at `target`. Raises ValueError where they coincide."""
    o, t, u = (np.asarray(v, dtype=np.float64) for v in (origin, target, up))
    backward = o - t
    length = float(np.linalg.norm(backward))
    if not np.isfinite(length) or length == 0:
        raise ValueError(f"camera origin {tuple(o)} and target {tuple(t)} must be finite and differ")
    backward /= length
    right = np.cross(u, backward)
    if np.linalg.norm(right) < 1e-9 * max(float(np.linalg.norm(u)), 1e-300):
        # The view is along `up`: any perpendicular will do.
        right = np.cross(np.eye(3)[int(np.argmin(np.abs(backward)))], backward)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(backward, right), backward, o
    return matrix


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything a picture needs. `eclat.load` makes it; `dataclasses.replace` changes it."""

    meshes: tuple[Mesh, ...] = ()
    lights: tuple[PointLight | SpotLight | DirectionalLight, ...] = ()
    environment: Environment | None = None
    cameras: tuple[Camera, ...] = ()
    name: str = ""
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    """Used by defaults (framed view, sun and sky) only."""
    photometric: bool = False
    """Lights are in candela, lux and cd·m⁻², so radiance means luminance and irradiance is in lux."""
    warnings: tuple[str, ...] = ()
    """What the loader replaced, ignored or guessed."""

    def __repr__(self) -> str:
        triangles = sum(len(mesh.triangles) for mesh in self.meshes)
        parts = [
            f"{_counted(len(self.meshes), 'mesh', 'meshes')} of {_counted(triangles, 'triangle')}",
            _counted(sum(mesh.material.emission is not None for mesh in self.meshes), "glowing mesh", "glowing meshes"),
            _counted(len(self.lights), "light"),
            "no environment" if self.environment is None else "an environment",
            _counted(len(self.cameras), "camera"),
            _counted(len(self.warnings), "warning"),
        ]
        return f"<Scene {self.name!r}: {', '.join(parts)}>"


def _counted(count: int, noun: str, plural: str = "") -> str:
    return f"{count:,} {noun if count == 1 else plural or noun + 's'}"
