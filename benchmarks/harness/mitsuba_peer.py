# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3 (`llvm_ad_rgb`) as a peer: a scene of ours as one of theirs, and its path tracer in the race."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from eclat.scene import Camera, DirectionalLight, Mesh, Scene
from harness import mitsuba_materials
from harness.entrant import Picture, timed
from harness.unavailable import UnavailableError

VARIANT = "llvm_ad_rgb"
FLIP_X_AND_Z = np.diag([-1.0, 1.0, -1.0, 1.0])
"""Their cameras look along local +z with +x to the left, ours along −z with +x to the right."""

_NEEDED_LLVM = "LLVM 17 or newer: apt-get install libllvm19"

SAMPLES = (4, 16, 64, 256)
"""A pixel, of the race's levels."""


def start() -> Any:
    """The module `mitsuba`, ready to trace. Raises UnavailableError where it or LLVM is missing."""
    try:
        import mitsuba
    except ImportError as error:
        raise UnavailableError("Mitsuba 3 is not installed: pip install '.[bench]'") from error
    try:
        mitsuba.set_variant(VARIANT)
        import drjit

        drjit.eval(mitsuba.Float(1) + drjit.arange(mitsuba.Float, 2))
        found = drjit.detail.llvm_version()
    except Exception as error:
        raise UnavailableError(f"Mitsuba's {VARIANT} needs {_NEEDED_LLVM} ({error})") from error
    # An older one starts, and then aborts the process over the kernels of larger scenes.
    if found[0] < 17:
        raise UnavailableError(f"Mitsuba's {VARIANT} needs {_NEEDED_LLVM} (found {'.'.join(map(str, found))})")
    return mitsuba


def convert(mitsuba: Any, scene: Scene, size: tuple[int, int]) -> Any:
    """Their scene, of the same triangles. Raises UnavailableError for what has no counterpart (`mitsuba_materials`)."""
    camera = scene.cameras[0]
    described: dict[str, Any] = {"type": "scene", "sensor": _sensor(mitsuba, camera, size)}
    for i, mesh in enumerate(scene.meshes):
        described[f"mesh{i}"] = _mesh(mitsuba, mesh, i)
    for i, light in enumerate(scene.lights):
        if not isinstance(light, DirectionalLight) or light.angular_radius != 0:
            raise UnavailableError(f"{scene.name}: only directional lights without a disc are given to Mitsuba")
        irradiance = {"type": "rgb", "value": list(light.irradiance)}
        described[f"light{i}"] = {"type": "directional", "direction": list(light.direction), "irradiance": irradiance}
    if scene.environment is not None:
        described["environment"] = mitsuba_materials.environment(mitsuba, scene.environment)
    return mitsuba.load_dict(described)


def version(mitsuba: Any) -> str:
    """As results name it."""
    return f"Mitsuba {mitsuba.__version__} {VARIANT}"


def use_threads(threads: int) -> None:
    """From now on, in this process."""
    import drjit

    drjit.set_thread_count(threads)


class Entrant:
    """Times hold the paths; Mitsuba's scene is built before, and its kernels are compiled by the first picture."""

    unbiased: ClassVar[bool] = True

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        self.mitsuba = start()
        use_threads(threads)
        self.scene = convert(self.mitsuba, scene, size)
        self.integrator = self.mitsuba.load_dict({"type": "path", "max_depth": -1})
        self.levels = tuple(f"{samples} samples" for samples in SAMPLES)
        self.version = version(self.mitsuba)

    def render(self, level: int) -> Picture:
        spp = SAMPLES[level]
        return timed(lambda: np.array(self.mitsuba.render(self.scene, integrator=self.integrator, spp=spp, seed=1)))


def _sensor(mitsuba: Any, camera: Camera, size: tuple[int, int]) -> dict[str, Any]:
    if camera.projection != "perspective" or camera.aperture_radius or any(camera.shift):
        raise UnavailableError("only a pinhole camera is given to Mitsuba")
    return {
        "type": "perspective",
        "fov": camera.fov,
        "fov_axis": camera.fov_axis,
        "to_world": mitsuba.ScalarTransform4f(np.asarray(camera.to_world) @ FLIP_X_AND_Z),
        "near_clip": 1e-3,
        "far_clip": 1e4,
        "film": {
            "type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"},
            "pixel_format": "rgb", "component_format": "float32",
        },
        "sampler": {"type": "independent"},
    }  # fmt: skip


def _mesh(mitsuba: Any, mesh: Mesh, index: int) -> Any:
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict(mitsuba_materials.bsdf(mitsuba, mesh.material))
    properties["face_normals"] = mesh.normals is None
    if mesh.material.emission is not None:
        radiance = {"type": "rgb", "value": list(mesh.material.emission.constant)}
        properties["emitter"] = mitsuba.load_dict({"type": "area", "radiance": radiance})
    smooth = mesh.normals is not None
    out = mitsuba.Mesh(
        f"mesh{index}", len(mesh.positions), len(mesh.triangles), has_vertex_normals=smooth,
        has_vertex_texcoords=mesh.uvs is not None, props=properties,
    )  # fmt: skip
    parameters = mitsuba.traverse(out)
    parameters["vertex_positions"] = np.asarray(mesh.positions, np.float32).ravel()
    parameters["faces"] = np.asarray(mesh.triangles, np.uint32).ravel()
    if smooth:
        parameters["vertex_normals"] = np.asarray(mesh.normals, np.float32).ravel()
    if mesh.uvs is not None:
        parameters["vertex_texcoords"] = np.asarray(mesh.uvs, np.float32)[:, :2].ravel()
    parameters.update()
    return out
