# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds that Cycles draws for Éclat, in a Blender of its own, which runs without a window."""

from __future__ import annotations

import hashlib
import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from eclat.scene import DirectionalLight

from .world import DrawnWorld

SIZE = (1024, 512)
"""Width and height of a drawn world in pixels. Suns are drawn apart."""

SECONDS = 300
"""Time after which drawing is given up."""

_drawn: dict[str, DrawnWorld] = {}


def draw_world(world: Any) -> DrawnWorld | None:
    """Draw a world with Cycles; None if that fails. The same world is drawn once in a session."""
    original = world.original
    key = f"{original.name_full}-{_mark(original)}"
    if key not in _drawn:
        with tempfile.TemporaryDirectory() as folder:
            library, target = Path(folder) / "world.blend", Path(folder) / "world.npz"
            bpy.data.libraries.write(str(library), {original}, path_remap="ABSOLUTE", fake_user=True)
            command = [*_blender(), "--", str(library), str(target), *map(str, SIZE)]
            try:
                done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
            except subprocess.TimeoutExpired:
                return None
            if not target.exists():
                print("Éclat: Cycles could not draw the world:", done.stderr[-500:])
                return None
            with np.load(target) as arrays:
                _drawn[key] = _read(arrays)
    return _drawn[key]


def _read(arrays: Any) -> DrawnWorld:
    sky = np.ascontiguousarray(arrays["sky"], np.float32)
    if "irradiance" not in arrays:
        return DrawnWorld(sky)
    direction, irradiance = (tuple(float(x) for x in arrays[name]) for name in ("direction", "irradiance"))
    backwards: Any = tuple(-x for x in direction)
    power: Any = irradiance
    return DrawnWorld(sky, DirectionalLight(backwards, power, math.degrees(float(arrays["angle"])) / 2))


def _blender() -> list[str]:
    script = str(Path(__file__).with_name("panorama.py"))
    if bpy.app.binary_path and not bpy.app.module:
        return [bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    return [sys.executable, script]


def _mark(world: Any) -> str:
    """A digest of the nodes of a world and of their links."""
    parts = []
    for node in world.node_tree.nodes:
        parts.append(node.bl_idname)
        parts += [f"{p.identifier}={getattr(node, p.identifier)!r}" for p in node.bl_rna.properties if _plain(p)]
        parts += [f"{s.identifier}={_value(s)}" for s in node.inputs]
        image = getattr(node, "image", None)
        parts.append("" if image is None else f"{image.name_full} {image.filepath} {image.size[:]}")
    parts += [
        f"{link.from_node.name}.{link.from_socket.identifier}>{link.to_node.name}.{link.to_socket.identifier}"
        for link in world.node_tree.links
    ]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _plain(prop: Any) -> bool:
    unseen = ("select", "location", "location_absolute", "width", "height", "dimensions")
    return prop.identifier not in unseen and prop.type in ("FLOAT", "INT", "BOOLEAN", "ENUM", "STRING")


def _value(socket: Any) -> str:
    value = getattr(socket, "default_value", "")
    return repr(tuple(value)) if hasattr(value, "__len__") and not isinstance(value, str) else repr(value)
