# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Cameras and lights as nodes [glTF 2.0, 3.10; KHR_lights_punctual]."""

from __future__ import annotations

import math

import numpy as np

from eclat.errors import warn
from eclat.gltf_export.document import Document, Json
from eclat.scene import Camera, DirectionalLight, FloatArray, PointLight, SpotLight, look_at

NEAR, FAR = 1e-3, 2.0
"""Clipping planes, which we do not have and viewers need, over the distance of what is farthest. Depths d that differ by less
than d² / (near · 2ⁿ) look the same in a depth buffer of n bits: with 24 a 17,000th of that distance."""


def camera_node(document: Document, camera: Camera, bounds: FloatArray) -> int:
    """The node's index. `bounds` (2, 3): the lowest and the highest corner of all that can be seen."""
    width, height = camera.size or (16, 9)
    aspect = width / height
    half_width, half_height = camera.half_extent(aspect)
    if camera.shift != (0.0, 0.0):
        warn(f"camera {camera.name!r}: glTF has no shifted cameras; its picture moves")
    json: Json = {"name": camera.name, "type": camera.projection}
    farthest = _farthest(np.asarray(camera.to_world, np.float64)[:3, 3], bounds)
    planes = {"znear": NEAR * farthest, "zfar": FAR * farthest}
    if camera.projection == "perspective":
        json["perspective"] = {"yfov": 2 * math.atan(half_height), "aspectRatio": aspect, **planes}
    else:
        json["orthographic"] = {"xmag": half_width, "ymag": half_height, **planes}
    matrix = np.array(camera.to_world, np.float64)
    matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
    index = document.add("cameras", json)
    return document.add("nodes", {"name": camera.name, "camera": index, "matrix": matrix.T.ravel().tolist()})


def _farthest(place: FloatArray, bounds: FloatArray) -> float:
    """The distance to the farthest corner of the bounds, or 1 if there are no bounds."""
    distance = float(np.linalg.norm(np.abs(bounds - place).max(axis=0)))
    return distance if 0 < distance < math.inf else 1.0


def light_node(document: Document, light: PointLight | SpotLight | DirectionalLight) -> int:
    """The node's index."""
    if isinstance(light, DirectionalLight):
        json: Json = {"type": "directional"} | _colored(light.irradiance)
        matrix = _towards((0.0, 0.0, 0.0), light.direction)
        if light.angular_radius > 0:
            warn("glTF has no sun with an angular size: its shadows are sharp in the file")
    elif isinstance(light, SpotLight):
        outer, inner = math.radians(min(light.outer_angle, 90)), math.radians(light.inner_angle)
        # The format wants the inner angle below the outer one.
        cone = {"innerConeAngle": min(inner, outer * (1 - 1e-6)), "outerConeAngle": outer}
        json = {"type": "spot", "spot": cone} | _colored(light.intensity)
        matrix = _towards(light.position, light.direction)
        if light.falloff != "smooth":
            warn("a spot light whose falloff is linear in angle falls off as glTF's do in the file")
    else:
        json = {"type": "point"} | _colored(light.intensity)
        matrix = np.eye(4)
        matrix[:3, 3] = light.position
    extension = document.use("KHR_lights_punctual")
    known = document.root.setdefault("extensions", {}).setdefault(extension, {"lights": []})["lights"]
    known.append(json)
    return document.add(
        "nodes", {"extensions": {extension: {"light": len(known) - 1}}, "matrix": matrix.T.ravel().tolist()}
    )


def _colored(power: tuple[float, float, float]) -> Json:
    """A colour whose components are at most 1, and the factor that scales it."""
    largest = max(power)
    if largest <= 0:
        return {"intensity": 0.0}
    return {"color": [c / largest for c in power], "intensity": largest}


def _towards(position: tuple[float, float, float], direction: tuple[float, float, float]) -> FloatArray:
    """A 4×4 `to_world` matrix whose −z axis is `direction`."""
    d = np.asarray(direction, np.float64)
    d /= np.linalg.norm(d)
    matrix = look_at((0.0, 0.0, 0.0), (float(d[0]), float(d[1]), float(d[2])))
    matrix[:3, 3] = position
    return matrix
