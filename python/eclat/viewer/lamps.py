# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lights and cameras of a scene for the page, and the direct light of glowing surfaces and of the sky as a light map.

The page lights surfaces by points, spots and suns with shadow maps, because their shadows are sharp. Glowing surfaces
have soft shadows, which a light map holds with a small error (docs/guides/view.md); so does the sharp part of the sky, as of
a sun in its image. The smooth part of the sky is in the records, whose gathers collect it.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from eclat import _core
from eclat.bridge.arguments import picture_size
from eclat.errors import warn
from eclat.gltf_export import Part, scene_parts
from eclat.lightmap.directional import AXES, MOMENT
from eclat.lightmap.lightmap import Lightmap
from eclat.measure.photometry import luminance
from eclat.scene import Camera, DirectionalLight, Environment, FloatArray, PointLight, ProfileLight, Scene, SpotLight
from eclat.verbs.bake import bake
from eclat.viewer.even_lights import even_light
from eclat.viewer.messages import encode_message

LARGEST_HALF = 60000.0
"""A little below the largest half float."""


def soft_light_of(scene: Scene, **options: Any) -> Lightmap | None:
    """Bake the direct light of glowing surfaces and of the sharp part of the sky; None if the scene has neither.

    `options` are those of `eclat.bake`.
    """
    sky = sharp_sky(scene.environment)
    if sky is None and all(mesh.material.emission is None for mesh in scene.meshes):
        return None
    lamps = replace(scene, lights=(), environment=sky)
    directional = any(mesh.material.normal_map is not None for mesh in scene.meshes)
    with warnings.catch_warnings():
        # The page applies normal maps to the map's light, of which it knows from where it comes.
        warnings.filterwarnings("ignore", message="bake: the light map ignores normal maps")
        return bake(lamps, component="direct", directional=directional, **options)


def sharp_sky(sky: Environment | None) -> Environment | None:
    """Return the part of an environment that records do not hold (`lights/environment_split.h`); None if there is none."""
    if sky is None:
        return None
    image = np.ascontiguousarray(sky.image, np.float32)
    if (image == image[0, 0]).all():
        return None
    limit = _core.smooth_limit(image)
    bright = luminance(image)[..., None]
    smooth = np.where(bright > limit, image * (limit / np.maximum(bright, np.finfo(np.float32).tiny)), image)
    sharp = np.maximum(0, image - smooth).astype(np.float32)
    return replace(sky, image=sharp) if sharp.any() else None


def parts_of(scene: Scene, lightmap: Lightmap | None) -> list[Part]:
    """Return the meshes that the page draws, with coordinates in the light map if there is one, whose pages are one image."""
    if lightmap is None:
        return scene_parts(scene)
    return [replace(part, lightmap_uvs=uvs) for part, uvs in zip(lightmap.parts, lightmap.stacked_uvs(), strict=True)]


def light_message(lightmap: Lightmap | None) -> bytes:
    """Encode the direct light of glowing surfaces and the sky; without a light map, it is one black texel."""
    values = np.zeros((1, 1, 3), np.float32) if lightmap is None else np.asarray(lightmap.irradiance)
    largest = float(values.max(initial=0))
    scale = LARGEST_HALF / largest if largest > LARGEST_HALF else 1.0
    texels = np.ones((*values.shape[:2], 4), np.float16)
    texels[..., :3] = values * scale
    moments = {} if lightmap is None or lightmap.harmonics is None else _moments(lightmap.harmonics, scale)
    return encode_message("light", {"scale": scale, "moments": bool(moments)}, {"map": texels} | moments)


def _moments(harmonics: np.ndarray, scale: float) -> dict[str, np.ndarray]:
    """Return M = ∫ L ω dω of each channel as half floats (H, W, 4), from the coefficients (H, W, 4, 3) of a directional map."""
    axes = [1 + AXES.index(axis) for axis in range(3)]
    moment = np.clip(harmonics[:, :, axes] * (scale / MOMENT), -LARGEST_HALF, LARGEST_HALF)
    texels = np.zeros((3, *moment.shape[:2], 4), np.float16)
    texels[..., :3] = np.moveaxis(moment, 3, 0)
    return {f"moment_{color}": texels[channel] for channel, color in enumerate("rgb")}


def lights_of(scene: Scene, center: FloatArray) -> list[dict[str, Any]]:
    """Return the point, spot and directional lights, with positions relative to `center`."""
    found: list[dict[str, Any]] = []
    for given in scene.lights:
        if isinstance(given, ProfileLight):
            warn(f"light {given.name!r}: the viewer shows its direct light as that of an even point light")
        light = even_light(given)
        if isinstance(light, DirectionalLight):
            found.append(
                {
                    "kind": "sun",
                    "direction": _unit(light.direction),
                    "irradiance": list(map(float, light.irradiance)),
                    "angular_radius": float(light.angular_radius),
                }
            )
            continue
        position = (np.asarray(light.position, np.float64) - center).tolist()
        entry = {"kind": "point", "position": position, "intensity": list(map(float, light.intensity))}
        if isinstance(light, SpotLight):
            entry |= {
                "kind": "spot",
                "direction": _unit(light.direction),
                "inner_angle": float(light.inner_angle),
                "outer_angle": float(light.outer_angle),
                "smooth": light.falloff == "smooth",
            }
        else:
            assert isinstance(light, PointLight)
        found.append(entry)
    return found


def cameras_of(scene: Scene, center: FloatArray) -> list[dict[str, Any]]:
    """Return the cameras, with row-major matrices `to_world` relative to `center`."""
    return [_camera(camera, number, center) for number, camera in enumerate(scene.cameras)]


def _camera(camera: Camera, number: int, center: FloatArray) -> dict[str, Any]:
    to_world = np.array(camera.to_world, np.float64)
    to_world[:3, :3] /= np.linalg.norm(to_world[:3, :3], axis=0)
    to_world[:3, 3] -= center
    width, height = picture_size(camera, None)
    half_width, half_height = camera.half_extent(width / height)
    return {
        "name": camera.name or f"camera {number}",
        "to_world": to_world.ravel().tolist(),
        "half_extent": [half_width, half_height],
        "fov_axis": camera.fov_axis,
        "fov": float(camera.fov),
        "orthographic": camera.projection == "orthographic",
        "shift": list(map(float, camera.shift)),
        "size": [width, height],
    }


def _unit(direction: tuple[float, float, float]) -> list[float]:
    vector = np.asarray(direction, np.float64)
    unit: list[float] = (vector / np.linalg.norm(vector)).tolist()
    return unit
