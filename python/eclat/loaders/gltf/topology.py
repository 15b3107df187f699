# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Triangles of lists, strips and fans, indexed or not [glTF 2.0, 3.7.2.1]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.element import Element

TRIANGLES, STRIP, FAN = 4, 5, 6
_WITHOUT_AREA = {0: "points", 1: "lines", 2: "a line loop", 3: "a line strip"}


def read_triangles(element: Element, accessors: Accessors, vertices: int) -> NDArray[np.int32] | None:
    """(T, 3) vertex indices, those that use a vertex twice left out; None, with a warning, where none remain.

    Raises EclatError for indices that are not below `vertices`, and unknown modes.
    """
    mode = element.integer("mode", TRIANGLES)
    if mode in _WITHOUT_AREA:
        warn(f"{element.where}: {_WITHOUT_AREA[mode]} cannot be rendered and are skipped")
        return None
    if mode not in (TRIANGLES, STRIP, FAN):
        raise EclatError(f"{element.at('mode')}: expected 0 to 6, got {mode}")
    corners = accessors.integers(element, "indices")
    if corners is None:
        corners = np.arange(vertices, dtype=np.uint32)
    elif len(corners) and int(corners.max()) >= vertices:
        first = int(np.argmax(corners >= vertices))
        raise EclatError(
            f"{element.at('indices')}: expected indices below {vertices}, the number of vertices, "
            f"got {int(corners[first])} at place {first}"
        )
    if mode == TRIANGLES and len(corners) % 3:
        warn(f"{element.where}: {len(corners)} corners make no whole number of triangles; the last are ignored")
    assembled = _assemble(mode, corners.astype(np.int32))
    a, b, c = assembled.T
    triangles: NDArray[np.int32] = assembled[(a != b) & (b != c) & (c != a)]
    if not len(triangles):
        warn(f"{element.where}: has no triangles and is skipped")
        return None
    return triangles


def _assemble(mode: int, corners: NDArray[np.int32]) -> NDArray[np.int32]:
    if mode == TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    i = np.arange(max(len(corners) - 2, 0))
    if mode == STRIP:
        return corners[np.column_stack((i, i + 1 + i % 2, i + 2 - i % 2))]
    return corners[np.column_stack((i + 1, i + 2, np.zeros_like(i)))]
