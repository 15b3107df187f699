# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Conversion of a scene to the compiled core; the result is kept as long as the scene exists."""

from __future__ import annotations

import hashlib
import weakref
from dataclasses import dataclass

import numpy as np

from eclat import _core
from eclat.bridge.frame import center_of, warn_of_rounding
from eclat.bridge.reach import check_areas, check_length, check_reach
from eclat.errors import EclatError, warn
from eclat.instruction_set import check_variable
from eclat.measured_brdf import MeasuredBrdf, MerlBrdf
from eclat.scene import (
    DEFAULTS,
    MATERIAL_KINDS,
    Camera,
    DirectionalLight,
    FloatArray,
    Light,
    Material,
    PointLight,
    ProfileLight,
    Scene,
    Texture,
    Value,
    grey,
)


@dataclass(frozen=True)
class Compiled:
    """The scene in the compiled core. Its coordinates are relative to `center`, which is subtracted in double
    precision, so that float32 suffices for scenes far from the origin."""

    core: _core.Scene
    center: FloatArray
    name: str
    """The name of the scene, for messages."""

    def to_core(self, points: FloatArray) -> np.ndarray:
        """Convert world positions (N, 3) to the coordinates of the core, float32. Raises EclatError if one is too far
        away."""
        return self._shifted(points, "points", "point")

    def _shifted(self, points: FloatArray, what: str, noun: str) -> np.ndarray:
        local = np.asarray(points, np.float64) - self.center
        check_reach(local, what, noun)
        return np.ascontiguousarray(local, np.float32)

    def camera(self, camera: Camera, size: tuple[int, int]) -> _core.Camera:
        """Make the core's camera for a picture of `size` (width, height) in pixels."""
        width, height = size
        matrix = np.asarray(camera.to_world, np.float64)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise EclatError(f"camera {camera.name!r}: to_world must be a finite 4×4 matrix, got {matrix.tolist()}")
        columns = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
        half_width, half_height = camera.half_extent(width / height)
        axes = tuple(tuple(map(float, columns[:, i])) for i in range(3))
        what = f"{self.name}: camera" + (f" {camera.name!r}" if camera.name else "")
        position = tuple(map(float, self._shifted(matrix[:3, 3], what, "position")))
        check_length(camera.aperture_radius, what, "aperture_radius")
        check_length(camera.focus_distance, what, "focus_distance")
        # For a perspective camera this is the extent at unit distance, and the corners of the picture are directions.
        for reach, axis in zip((half_width, half_height), camera.shift, strict=True):
            check_length(reach * (1 + 2 * abs(axis)), what, "the picture's extent (fov, shift)")
        return _core.Camera(
            axes=axes, position=position, size=size, half_extent=(half_width, half_height), shift=camera.shift,
            lens=(camera.aperture_radius, camera.focus_distance), orthographic=camera.projection == "orthographic",
        )  # fmt: skip


MOST_ALBEDO = 1.02
"""Albedo of a measured BRDF from which on there is a warning. It is computed from 1024 samples, which err by some tenths of a per
cent, and measurements err by more."""

_cache: weakref.WeakKeyDictionary[Scene, Compiled] = weakref.WeakKeyDictionary()


def compiled(scene: Scene) -> Compiled:
    """Return the scene in the compiled core, converting it at the first call. Raises EclatError if the core refuses
    it."""
    found = _cache.get(scene)
    if found is None:
        check_variable()
        try:
            found = _cache[scene] = _Compiler(scene).compile()
        except ValueError as error:
            raise EclatError(f"{scene.name or 'scene'}: {error}") from error
    return found


class _Compiler:
    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.builder = _core.SceneBuilder()
        self.textures: dict[int, int] = {}
        self.materials: dict[int, int] = {}
        self.measured: dict[int, _core.MeasuredBrdf] = {}

    def compile(self) -> Compiled:
        center = center_of(self.scene)
        for number, mesh in enumerate(self.scene.meshes):
            local = np.asarray(mesh.positions, np.float64) - center
            what = f"mesh {number}" + (f" {mesh.name!r}" if mesh.name else "")
            check_reach(local, what)
            check_areas(local, mesh.triangles, what)
            self.builder.add_mesh(
                positions=np.ascontiguousarray(local, np.float32),
                triangles=np.ascontiguousarray(mesh.triangles, np.uint32),
                material=self.material(mesh.material),
                normals=_floats(mesh.normals, 3),
                uvs=_floats(mesh.uvs, 2),
                uvs2=_floats(mesh.uvs2, 2),
                colors=_floats(mesh.colors, 4),
                tangents=_floats(mesh.tangents if _reads_tangents(mesh.material) else None, 4),
            )
        warn_of_rounding(self.scene, center)
        for number, light in enumerate(self.scene.lights):
            if not isinstance(light, DirectionalLight):
                check_reach(np.asarray(light.position, np.float64) - center, f"light {number}")
            self.light(light, center)
        environment = self.scene.environment
        if environment is not None:
            to_world = tuple(float(x) for x in np.asarray(environment.to_world, np.float64).ravel())
            self.builder.set_environment(np.ascontiguousarray(environment.image, np.float32), to_world)
        return Compiled(self.builder.build(), center, self.scene.name or "scene")

    def light(self, light: Light, center: FloatArray) -> None:
        if isinstance(light, DirectionalLight):
            self.builder.add_directional(light.direction, light.irradiance, light.angular_radius)
            return
        position = tuple(float(x) for x in np.asarray(light.position, np.float64) - center)
        if isinstance(light, PointLight):
            self.builder.add_point(position, light.intensity)
        elif isinstance(light, ProfileLight):
            self.profile_light(light, position)
        else:
            self.builder.add_spot(
                position=position, direction=light.direction, intensity=light.intensity, inner_angle=light.inner_angle,
                outer_angle=light.outer_angle, smooth=light.falloff == "smooth",
            )  # fmt: skip

    def profile_light(self, light: ProfileLight, position: tuple[float, ...]) -> None:
        grid = light.profile.grid()
        matrix = np.asarray(light.to_world, np.float64)
        if matrix.shape != (3, 3) or not np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-5):
            raise EclatError(f"light {light.name!r}: to_world must be a 3×3 rotation, got {matrix.tolist()}")
        self.builder.add_profile(
            position=position, axes=(grid.axes @ matrix.T).tolist(), intensity=light.scale, polar=grid.polar.tolist(),
            azimuth=grid.azimuth.tolist(), values=np.ascontiguousarray(grid.values, np.float32),
        )  # fmt: skip

    def texture(self, texture: Texture) -> int:
        index = self.textures.get(id(texture))
        if index is None:
            image = np.asarray(texture.image)
            image = image if image.dtype == np.uint8 else image.astype(np.float32)
            image = np.ascontiguousarray(image if image.ndim == 3 else image[:, :, None])
            index = self.builder.add_texture(
                image, srgb=texture.srgb, wrap_u=_core.Wrap[texture.wrap_u], wrap_v=_core.Wrap[texture.wrap_v],
                nearest=texture.filter == "nearest",
            )  # fmt: skip
            self.textures[id(texture)] = index
        return index

    def value(self, value: Value) -> _core.Value:
        texture = -1 if value.texture is None else self.texture(value.texture)
        channel = -1 if value.channel is None else value.channel
        transform = tuple(float(x) for row in value.uv_transform for x in row)
        return self.builder.value(
            value.constant, texture=texture, channel=channel, uv_set=value.uv_set, uv_transform=transform,
            invert=value.invert, square=value.square,
        )  # fmt: skip

    def table(self, material: Material) -> _core.MeasuredBrdf:
        """Return the table of a measured material, which all materials with the same measurement share."""
        brdf = material.measured
        if brdf is None:
            raise EclatError(f"material {material.name!r}: expected `measured` for the kind 'measured', got None")
        if id(brdf) not in self.measured:
            table = self.measured[id(brdf)] = core_brdf(brdf)
            if table.largest_albedo > MOST_ALBEDO:
                warn(
                    f"material {material.name!r}: the measured BRDF {brdf.name!r} reflects up to "
                    f"{100 * table.largest_albedo:.3g} % of the light, which no surface can; it is used as it was measured"
                )
        return self.measured[id(brdf)]

    def material(self, material: Material) -> int:
        index = self.materials.get(id(material))
        if index is None:
            index = self.materials[id(material)] = self.builder.add_material(self.convert(material))
        return index

    def convert(self, material: Material) -> _core.Material:
        names = MATERIAL_KINDS[material.kind]
        out = _core.Material()
        out.kind = _core.MaterialKind[material.kind]
        given = dict(material.parameters)
        if "alpha_v" in names and "alpha_v" not in given and "alpha_u" in given:
            given["alpha_v"] = given["alpha_u"]
        for name in names:
            out.set(name, self.value(given.get(name, DEFAULTS[name])))
        out.two_sided = material.two_sided
        out.back_culled = material.back_culled
        out.hidden_from_camera = material.hidden_from_camera
        out.back = -1 if material.back is None else self.material(material.back)
        out.children = [self.material(child) for child in material.children] or [-1, -1]
        out.beckmann = material.distribution == "beckmann"
        out.correlated = material.masking == "correlated"
        out.nonlinear = material.nonlinear
        if material.kind == "measured":
            out.table = self.table(material)
        out.thin_walled = material.thin_walled
        out.opacity = self.value(material.opacity)
        out.alpha_cutoff = -1.0 if material.alpha_cutoff is None else material.alpha_cutoff
        out.vertex_colors = material.vertex_colors
        if material.normal_map is not None:
            out.has_normal_map = True
            out.bump = material.normal_map.kind == "bump"
            out.normal_map = self.value(material.normal_map.value)
            out.normal_scale = material.normal_map.scale
        out.emits = material.emission is not None and any(c > 0 for c in material.emission.constant)
        out.emission = self.value(material.emission or grey(0.0))
        # A surface that is invisible from behind does not emit there either.
        out.emission_two_sided = material.emission_two_sided and (material.two_sided or not material.back_culled)
        return out


def core_brdf(brdf: MeasuredBrdf) -> _core.MeasuredBrdf:
    """Make the core's table of a measured BRDF."""
    if isinstance(brdf, MerlBrdf):
        return _core.merl_brdf(brdf.values)
    return _core.rgl_brdf(
        phi=brdf.phi.tolist(), theta=brdf.theta.tolist(), normals=brdf.normals, projected=brdf.projected,
        visible=brdf.visible, luminance=brdf.luminance, channels=brdf.channels, jacobian=brdf.jacobian,
    )  # fmt: skip


def _floats(array: FloatArray | None, width: int) -> np.ndarray:
    return np.zeros((0, width), np.float32) if array is None else np.ascontiguousarray(array, np.float32)


def _reads_tangents(material: Material) -> bool:
    return material.normal_map is not None and material.normal_map.kind == "normal"


_fingerprints: weakref.WeakKeyDictionary[Scene, str] = weakref.WeakKeyDictionary()


def fingerprint(scene: Scene) -> str:
    """Return a hash of everything that affects the light: geometry, materials and lights, but not cameras. It is computed
    at the first call and kept as long as the scene exists."""
    found = _fingerprints.get(scene)
    if found is None:
        found = _fingerprints[scene] = _hashed(scene)
    return found


def _hashed(scene: Scene) -> str:
    digest = hashlib.sha256()

    def feed(x: object) -> None:
        if isinstance(x, np.ndarray):
            digest.update(str((x.dtype, x.shape)).encode())
            digest.update(np.ascontiguousarray(x).tobytes())
        elif hasattr(x, "__dataclass_fields__"):
            for name in x.__dataclass_fields__:
                if name not in ("name", "lamp", "cameras", "warnings", "animation"):
                    digest.update(name.encode())
                    feed(getattr(x, name))
        elif isinstance(x, dict):
            for key in sorted(x):
                digest.update(key.encode())
                feed(x[key])
        elif isinstance(x, tuple | list):
            digest.update(str(len(x)).encode())
            for item in x:
                feed(item)
        else:
            digest.update(repr(x).encode())

    feed(scene)
    return digest.hexdigest()[:32]
