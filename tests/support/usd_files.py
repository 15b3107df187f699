# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Small USD files, written as text."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import eclat
from eclat.scene import Scene

SQUARE = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    uniform token subdivisionScheme = "none"
"""
"""The inside of a mesh: a square at z = 0 that faces +z."""


def usda(body: str, head: str = 'upAxis = "Y"\n    metersPerUnit = 1') -> str:
    """A file with the prims `body`, whose braces need no lines of their own, and the metadata `head`."""
    body = body.replace("{", "{\n").replace("}", "\n}\n")
    return f"#usda 1.0\n(\n    {head}\n)\n{body}\n"


def save_usda(folder: Path, body: str, head: str = 'upAxis = "Y"\n    metersPerUnit = 1', name: str = "a.usda") -> Path:
    path = folder / name
    path.write_text(usda(body, head), encoding="utf-8")
    return path


def load_usda(folder: Path, body: str, head: str = 'upAxis = "Y"\n    metersPerUnit = 1') -> Scene:
    return eclat.load(save_usda(folder, body, head))


def direct_light(
    scene: Scene, point: tuple[float, float, float], normal: tuple[float, float, float], samples: int = 1 << 16
) -> np.ndarray:
    """The irradiance (3,) that a point gets straight from the lights, in lux."""
    found = eclat.irradiance(scene, np.array([point]), np.array([normal]), "direct", samples=samples, threads=1)
    return np.asarray(found).reshape(-1, 3)[0]
