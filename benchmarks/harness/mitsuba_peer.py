# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3 (`llvm_ad_rgb`) as a peer: a scene of ours as one of theirs."""

from __future__ import annotations

from typing import Any

import numpy as np

from eclat.scene import Camera, DirectionalLight, Material, Mesh, Scene
from harness.unavailable import UnavailableError

VARIANT = "llvm_ad_rgb"
FLIP_X_AND_Z = np.diag([-1.0, 1.0, -1.0, 1.0])
"""Their cameras look along local +z with +x to the left, ours along −z with +x to the right."""


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
    except Exception as error:
        needed = "LLVM 17 or newer: apt-get install libllvm19"
        raise UnavailableError(f"Mitsuba's {VARIANT} needs {needed} ({error})") from error
    return mitsuba


def convert(mitsuba: Any, scene: Scene, size: tuple[int, int]) -> Any:
    """Their scene, of the same triangles. Raises UnavailableError for what is not diffuse, constant and simple."""
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
        if scene.environment.image.shape[:2] != (1, 1):
            raise UnavailableError(f"{scene.name}: only a constant environment is given to Mitsuba")
        radiance = {"type": "rgb", "value": [float(x) for x in scene.environment.image[0, 0]]}
        described["environment"] = {"type": "constant", "radiance": radiance}
    return mitsuba.load_dict(described)


def version(mitsuba: Any) -> str:
    """As results name it."""
    return f"Mitsuba {mitsuba.__version__} {VARIANT}"


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
    if mesh.normals is not None:
        raise UnavailableError(f"mesh {mesh.name!r}: only flat shading is given to Mitsuba")
    properties = mitsuba.Properties()
    properties["bsdf"] = mitsuba.load_dict(_bsdf(mesh.material))
    properties["face_normals"] = True
    if mesh.material.emission is not None:
        radiance = {"type": "rgb", "value": list(mesh.material.emission.constant)}
        properties["emitter"] = mitsuba.load_dict({"type": "area", "radiance": radiance})
    out = mitsuba.Mesh(f"mesh{index}", len(mesh.positions), len(mesh.triangles), props=properties)
    parameters = mitsuba.traverse(out)
    parameters["vertex_positions"] = np.asarray(mesh.positions, np.float32).ravel()
    parameters["faces"] = np.asarray(mesh.triangles, np.uint32).ravel()
    parameters.update()
    return out


def _bsdf(material: Material) -> dict[str, Any]:
    value = material.parameters.get("reflectance")
    if material.kind != "diffuse" or value is None or value.texture is not None or material.opacity.constant[0] != 1:
        raise UnavailableError(f"material {material.name!r}: only constant diffuse ones are given to Mitsuba")
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(value.constant)}}
    return {"type": "twosided", "bsdf": diffuse} if material.two_sided else diffuse
