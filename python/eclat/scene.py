# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene as plain data: frozen dataclasses that hold NumPy arrays. Loaders create them, and the core reads them.

The conventions, which the core shares, are:

- the world is right-handed, with lengths in metres; colours are scene-linear RGB with Rec. 709 primaries; radiance is in
  W·sr⁻¹·m⁻²;
- directions point away from the surface; the corners of a triangle are counter-clockwise as seen from its front;
- the texture coordinates (0, 0) are the *top-left* corner of the image, and v increases downwards, as in glTF;
- roughness always means the α of GGX, which is the square of glTF's roughness.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.html import facts_table, listed
from eclat.light_sources import DirectionalLight as DirectionalLight
from eclat.light_sources import Environment as Environment
from eclat.light_sources import Light as Light
from eclat.light_sources import PointLight as PointLight
from eclat.light_sources import ProfileLight as ProfileLight
from eclat.light_sources import SpotLight as SpotLight
from eclat.measured_brdf import MeasuredBrdf

FloatArray = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Texture:
    """An image that varies a parameter over a surface.

    `image` is (H, W, C) with C in 1..4, either uint8 (0..255 means 0..1) or float32. With `srgb`, the first three
    channels are decoded with the sRGB transfer function; alpha is never decoded. Row 0 is at v = 0.
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

    A scalar parameter uses `constant[0]`, to which the other two numbers should be equal, and reads the `channel` of
    the texture. A colour uses all three numbers and reads RGB, or one `channel` as grey. `uv_set` is 0 or 1, the set of
    texture coordinates; `uv_transform` is a 2×3 affine map that is applied to (u, v, 1) before the lookup.
    """

    constant: tuple[float, float, float]
    texture: Texture | None = None
    channel: int | None = None
    uv_set: int = 0
    uv_transform: tuple[tuple[float, float, float], tuple[float, float, float]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    invert: bool = False
    """Whether 1 − texel is used instead of texel, for formats that store transparency instead of opacity."""
    square: bool = False
    """Whether constant² · texel² is used, because glTF stores the square root of the GGX α."""

    def __repr__(self) -> str:
        r, g, b = self.constant
        number = f"{r:.4g}" if r == g == b else f"({r:.4g}, {g:.4g}, {b:.4g})"
        return number if self.texture is None else f"{number} × {self.texture!r}"


def grey(value: float) -> Value:
    """Make a scalar, or a neutral colour, that is constant over the surface."""
    return Value((float(value),) * 3)


def rgb(r: float, g: float, b: float) -> Value:
    """Make a colour that is constant over the surface."""
    return Value((float(r), float(g), float(b)))


@dataclass(frozen=True, eq=False)
class NormalMap:
    """A perturbation of the shading normal.

    The kind "normal" is a normal map in tangent space (texel · 2 − 1), whose x and y are multiplied by `scale`. They
    are along the tangents and bitangents of the mesh, or, if it has none, along increasing u and decreasing v (up in
    the image, as in glTF). The kind "bump" is a height map; `scale` is the height of a white texel in metres, and
    gradients are finite differences.
    """

    value: Value
    kind: Literal["normal", "bump"] = "normal"
    scale: float = 1.0


MATERIAL_KINDS: dict[str, tuple[str, ...]] = {
    # Maps each kind to the names of its parameters (`Material.parameters`); missing parameters take DEFAULTS.
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
    "measured": ("scale",),  # factor of what was measured (`Material.measured`)
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
    "scale": grey(1.0),
    "weight": grey(0.5),
}


@dataclass(frozen=True, eq=False)
class Material:
    """The reflection, transmission and emission of a surface.

    `kind` is a key of `MATERIAL_KINDS`; `parameters` are its values, and those that are missing come from `DEFAULTS`.
    An `alpha_u` of 0 is a perfectly smooth interface (a mirror, glass or polish); without `alpha_v` the material is
    isotropic. A conductor with eta = 0 and k = 1 reflects all light, times `specular_reflectance`. `ior` is the index
    of the interior divided by that of the exterior, which is on the side of the normal. `ior`, `eta` and `k` cannot be
    textured. A `plastic` is a dielectric coat of roughness `alpha_u` over a diffuse base. With `thin_walled`, the
    transmission of a metallic_roughness material does not refract.
    """

    kind: str = "diffuse"
    parameters: dict[str, Value] = field(default_factory=dict)
    name: str = ""
    two_sided: bool = True
    """Whether the material reflects on both sides; otherwise its back is black. Dielectrics and transmission always act
    on both sides."""
    back: Material | None = None
    """Another material for the back, with `two_sided`; None means the same material."""
    back_culled: bool = False
    """Without `two_sided`: whether the back is invisible instead of black, so that rays from behind pass through, as
    for single-sided materials of glTF [glTF 2.0 specification, section 3.9.6, Double Sided]. Light passes through a
    culled back exactly where a viewer at the lit point sees through it."""
    hidden_from_camera: bool = False
    """Whether rays that a camera sends pass through, so that a lamp lights the scene without standing in the picture.
    Everything else sees the surface, mirrors included. The field counts on the material of a mesh, not on its `back` or
    on `children`."""
    distribution: Literal["ggx", "beckmann"] = "ggx"
    masking: Literal["separable", "correlated"] = "separable"
    """Whether the facets that shadow light and those that hide it from the viewer are correlated by their height, for
    conductors with the distribution "ggx", as in Blender. In Mitsuba they are independent. Metallic-roughness materials
    always correlate them."""
    nonlinear: bool = False
    """Whether internal scattering shifts the colour of a plastic."""
    ward_variant: Literal["bounded", "duer"] = "bounded"
    """Variant of Ward's model. `duer`, which may reflect more than all light at grazing angles, is replaced by
    `bounded`, with a warning."""
    thin_walled: bool = True
    children: tuple[Material, ...] = ()
    measured: MeasuredBrdf | None = None  # for the kind "measured" (`eclat.load_brdf`)
    opacity: Value = field(default_factory=lambda: grey(1.0))
    """Probability that a ray hits the surface instead of passing straight through it (masks, blended alpha, the `d` of
    MTL files)."""
    alpha_cutoff: float | None = None
    """Threshold below which the opacity is 0, and from which on it is 1 (glTF's alphaMode MASK); None uses the opacity."""
    vertex_colors: bool = False
    """Whether the base colour or reflectance is multiplied by the vertex colours of the mesh, and the opacity by their
    alpha."""
    normal_map: NormalMap | None = None
    emission: Value | None = None
    """Radiance that is emitted on the side of the normal; None means that the surface does not emit."""
    emission_two_sided: bool = False
    """Whether the surface emits on both sides, which only some formats request. In glTF, `doubleSided` requests it,
    because a back face is shaded, including emission, like a front face with the normal reversed [glTF 2.0
    specification, section 3.9.6, Double Sided]."""

    def __repr__(self) -> str:
        parts = [f"{name} {value!r}" for name, value in self.parameters.items()]
        parts += [f"children {', '.join(child.name or child.kind for child in self.children)}"] if self.children else []
        parts += [] if self.emission is None else [f"emission {self.emission!r}"]
        return f"<Material {self.name!r}: {', '.join([self.kind, *parts])}>"


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles in world space with one material.

    `positions` (V, 3) are float64 or float32, in metres; `triangles` (T, 3) are integers; `normals` (V, 3) are unit
    vectors, or None for flat shading; `uvs` and `uvs2` are (V, 2); `colors` (V, 4) are linear float32. `tangents` (V,
    4), whose xyz is a unit vector and whose w is ±1, are used only by normal maps: red is along the tangent, green
    along the bitangent w · normal × tangent (MikkTSpace). Without tangents, both follow the texture coordinates.
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
    lamp: str = ""
    """The name of the lamp of which the triangles are a part if their material emits, for groups of lamps
    (`stage.light_groups`). If it is empty, the mesh's name or its material's is used."""

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r}: {_counted(len(self.triangles), 'triangle')}, {self.material.kind}>"


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole or thin-lens camera in glTF's convention: it looks along its −z axis, with +y up and +x to the right.

    `to_world` is a 4×4 matrix; if it mirrors, the picture is mirrored. `fov` is in degrees along `fov_axis`; with the
    `projection` "orthographic", it is the full extent in metres along that axis. An `aperture_radius` above 0, in
    metres, blurs surfaces that are not at `focus_distance`. `size` is the preferred (width, height) of pictures.
    `shift` moves the principal point, in fractions of the width and height of the picture.
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
        """Compute half the width and half the height of the image plane at distance 1, or in metres if orthographic.

        `aspect` is width / height. Raises EclatError if the field of view is not between 0 and 180 degrees.
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
    """Compute the areas (N,) of triangles in m² from the positions (N, 3, 3) of their corners in metres."""
    a, b, c = np.moveaxis(np.asarray(corners, dtype=np.float64), 1, 0)
    twice: FloatArray = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return twice / 2


def look_at(
    origin: tuple[float, float, float], target: tuple[float, float, float], up: tuple[float, float, float] = (0, 1, 0)
) -> FloatArray:
    """Make the 4×4 matrix `to_world` of a camera at `origin` that looks at `target`. Raises ValueError if they
    coincide."""
    o, t, u = (np.asarray(v, dtype=np.float64) for v in (origin, target, up))
    backward = o - t
    length = float(np.linalg.norm(backward))
    if not np.isfinite(length) or length == 0:
        raise ValueError(f"camera origin {tuple(o)} and target {tuple(t)} must be finite and differ")
    backward /= length
    right = np.cross(u, backward)
    if np.linalg.norm(right) < 1e-9 * max(float(np.linalg.norm(u)), 1e-300):
        # The view is along `up`, so any perpendicular direction is used as the right.
        right = np.cross(np.eye(3)[int(np.argmin(np.abs(backward)))], backward)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(backward, right), backward, o
    return matrix


class Animation(Protocol):
    """The motion of a scene over time. `start` and `end` are the times of its first and last key in seconds; `objects`,
    `lights` and `cameras` are the names of what moves or changes."""

    @property
    def start(self) -> float: ...
    @property
    def end(self) -> float: ...
    @property
    def objects(self) -> tuple[str, ...]: ...
    @property
    def lights(self) -> tuple[str, ...]: ...
    @property
    def cameras(self) -> tuple[str, ...]: ...

    def at(self, scene: Scene, time: float) -> Scene:
        """Return `scene`, which has this animation, as it is at a time in seconds, without animation."""
        ...


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene: meshes, lights, environment and cameras. `eclat.load` makes a scene; `dataclasses.replace` makes a
    changed copy."""

    meshes: tuple[Mesh, ...] = ()
    lights: tuple[Light, ...] = ()
    environment: Environment | None = None
    cameras: tuple[Camera, ...] = ()
    name: str = ""
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    """Upward direction, which only default cameras, suns and skies use."""
    photometric: bool = False
    """Whether lights are in candela, lux and cd·m⁻², so that radiance means luminance and irradiance is in lux."""
    warnings: tuple[str, ...] = ()
    """The warnings of the loader, about what it replaced, ignored or guessed."""
    animation: Animation | None = None
    """What moves over time; None if nothing does. The scene itself is in its rest pose."""

    def at(self, time: float) -> Scene:
        """Return the scene as it is at a time in seconds: a scene of its own, without animation.

        Before its first key everything is as at that key, and after the last as at the last. A scene without animation
        is returned as it is.

        Raises
        ------
        EclatError : the time is not finite, or a value at that time is invalid.
        """
        if not np.isfinite(time):
            raise EclatError(f"at: expected a finite time in seconds, got {time!r}")
        return self if self.animation is None else self.animation.at(self, float(time))

    def _repr_html_(self) -> str:
        """Return what the scene contains as a table, for notebooks."""
        glowing = [mesh.lamp or mesh.name or "unnamed" for mesh in self.meshes if mesh.material.emission is not None]
        lights = [light.name or type(light).__name__ for light in self.lights]
        lamps = [*glowing, *lights, *([] if self.environment is None else [self.environment.name or "sky"])]
        facts: dict[str, object] = {
            "meshes": f"{len(self.meshes):,}, {sum(len(mesh.triangles) for mesh in self.meshes):,} triangles",
            "materials": listed(mesh.material.name or mesh.material.kind for mesh in self.meshes),
            "lamps": listed(lamps),
            "cameras": listed(camera.name or "unnamed" for camera in self.cameras),
            "units": "photometric (cd, lx)" if self.photometric else "radiometric (W)",
        }
        facts |= {f"warning {i}": text for i, text in enumerate(self.warnings, 1)}
        return facts_table(f"Scene {self.name}".rstrip(), facts)

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
        if self.animation is not None:
            parts.append(f"moves until {self.animation.end:g} s")
        return f"<Scene {self.name!r}: {', '.join(parts)}>"


def _counted(count: int, noun: str, plural: str = "") -> str:
    return f"{count:,} {noun if count == 1 else plural or noun + 's'}"
