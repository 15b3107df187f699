# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write cameras and lights as nodes [glTF 2.0, 3.10; KHR_lights_punctual]."""

from __future__ import annotations

import base64
import math

import numpy as np

from eclat.errors import warn
from eclat.gltf_export.document import Document, Json
from eclat.loaders.ies import encode_ies
from eclat.scene import Camera, DirectionalLight, FloatArray, Light, ProfileLight, SpotLight, look_at

NEAR, FAR = 1e-3, 2.0
"""The distances of the near and the far clipping plane, divided by the distance D of the farthest point of the scene.

Cameras in Éclat have no clipping planes, but viewers need them. A depth buffer of n bits cannot distinguish depths that
differ by less than d² / (near · 2ⁿ) at the depth d. With 24 bits and this near plane, this is D / 17,000 at the depth D.
"""


def camera_node(document: Document, camera: Camera, bounds: FloatArray) -> int:
    """Write a camera, and return the index of its node.

    `bounds` (2, 3) are the lowest and the highest corner of the scene. They determine the clipping planes.
    """
    width, height = camera.size or (16, 9)
    aspect = width / height
    half_width, half_height = camera.half_extent(aspect)
    if camera.shift != (0.0, 0.0):
        warn(
            f"camera {camera.name!r}: glTF does not support cameras with a shift; the shift is not written, so the image "
            "section changes"
        )
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
    """Return the distance from `place` (3,) to the farthest corner of the bounds, or 1 if the bounds are infinite."""
    distance = float(np.linalg.norm(np.abs(bounds - place).max(axis=0)))
    return distance if 0 < distance < math.inf else 1.0


def light_node(document: Document, light: Light) -> int:
    """Write a light, and return the index of its node."""
    if isinstance(light, ProfileLight):
        return _profile_node(document, light)
    if isinstance(light, DirectionalLight):
        json: Json = {"type": "directional"} | _colored(light.irradiance)
        matrix = _towards((0.0, 0.0, 0.0), light.direction)
        if light.angular_radius > 0:
            warn(
                "glTF does not support directional lights with an angular radius; it is not written, so that the shadows "
                "of the light are sharp"
            )
    elif isinstance(light, SpotLight):
        outer, inner = math.radians(min(light.outer_angle, 90)), math.radians(light.inner_angle)
        # The specification requires that the inner angle is smaller than the outer one.
        cone = {"innerConeAngle": min(inner, outer * (1 - 1e-6)), "outerConeAngle": outer}
        json = {"type": "spot", "spot": cone} | _colored(light.intensity)
        matrix = _towards(light.position, light.direction)
        if light.falloff != "smooth":
            warn("glTF does not support spot lights with linear falloff; the smooth falloff of glTF is used instead")
    else:
        json = {"type": "point"} | _colored(light.intensity)
        matrix = np.eye(4)
        matrix[:3, 3] = light.position
    named: Json = {"name": light.name} if light.name else {}
    extension = document.use("KHR_lights_punctual")
    known = document.root.setdefault("extensions", {}).setdefault(extension, {"lights": []})["lights"]
    known.append(named | json)
    node = {"extensions": {extension: {"light": len(known) - 1}}, "matrix": matrix.T.ravel().tolist()}
    return document.add("nodes", named | node)


def _profile_node(document: Document, light: ProfileLight) -> int:
    """Write a light with a profile as a data URI [EXT_lights_ies], and return the index of its node."""
    extension = document.use("EXT_lights_ies")
    known = document.root.setdefault("extensions", {}).setdefault(extension, {"lights": []})["lights"]
    mime = "application/x-ies-lm-63"
    data = base64.b64encode(encode_ies(light.profile)).decode("ascii")
    known.append({"uri": f"data:{mime};base64,{data}", "mimeType": mime, "name": light.profile.name})
    largest = max(light.scale)
    color = [c / largest for c in light.scale] if largest > 0 else [1.0, 1.0, 1.0]
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = light.to_world, light.position
    reference = {"light": len(known) - 1, "multiplier": largest, "color": color}
    node = {"name": light.name, "extensions": {extension: reference}, "matrix": matrix.T.ravel().tolist()}
    return document.add("nodes", node)


def _colored(power: tuple[float, float, float]) -> Json:
    """Split an RGB intensity into a colour with components of at most 1 and a scalar intensity."""
    largest = max(power)
    if largest <= 0:
        return {"intensity": 0.0}
    return {"color": [c / largest for c in power], "intensity": largest}


def _towards(position: tuple[float, float, float], direction: tuple[float, float, float]) -> FloatArray:
    """Return a 4×4 matrix that maps the origin to `position` and the direction −z to `direction`."""
    d = np.asarray(direction, np.float64)
    d /= np.linalg.norm(d)
    matrix = look_at((0.0, 0.0, 0.0), (float(d[0]), float(d[1]), float(d[2])))
    matrix[:3, 3] = position
    return matrix
