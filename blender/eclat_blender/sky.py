# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds that Cycles draws for Éclat, in a Blender of its own, which runs without a window."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import numpy as np

SIZE = (1024, 512)
"""Width and height of a drawn world in pixels."""

SUN_SIZE = (4096, 2048)
"""Width and height if the world has a sun, whose disc of 0.545 degrees is then six pixels wide."""

SECONDS = 120
"""Time after which drawing is given up."""

_drawn: dict[str, np.ndarray] = {}


def draw_world(world: Any) -> np.ndarray | None:
    """Draw a world as an equirectangular image (H, W, 3) of its radiance, row 0 on top, centre at +x; None if it fails.

    The same world is drawn once in a session.
    """
    size = SUN_SIZE if _has_sun(world) else SIZE
    with tempfile.TemporaryDirectory() as folder:
        library, picture = Path(folder) / "world.blend", Path(folder) / "world.npy"
        bpy.data.libraries.write(str(library), {world.original}, path_remap="ABSOLUTE", fake_user=True)
        key = f"{world.original.name_full}-{size}-{_mark(world.original)}"
        if key not in _drawn:
            command = [*_blender(), "--", str(library), str(picture), *map(str, size)]
            done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
            if not picture.exists():
                print("Éclat: Cycles could not draw the world:", done.stderr[-500:])
                return None
            _drawn[key] = np.load(picture)
    return _drawn[key]


def _has_sun(world: Any) -> bool:
    return any(node.type == "TEX_SKY" and getattr(node, "sun_disc", False) for node in world.node_tree.nodes)


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
