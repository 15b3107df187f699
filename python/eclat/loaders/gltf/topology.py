# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read triangles from lists, strips and fans, with or without indices [glTF 2.0, 3.7.2.1]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.element import Element

# The modes of a primitive that consist of triangles.
TRIANGLES, STRIP, FAN = 4, 5, 6
# The modes of a primitive that do not consist of triangles.
_WITHOUT_AREA = {0: "points", 1: "lines", 2: "lines in a loop", 3: "lines in a strip"}


def read_triangles(element: Element, accessors: Accessors, vertices: int) -> NDArray[np.int32] | None:
    """Read the triangles of a primitive, except those that use a vertex twice.

    Parameters
    ----------
    element : the element of the primitive.
    accessors : the accessors of the file.
    vertices : the number of vertices of the primitive.

    Returns
    -------
    (T, 3) vertex indices, or None, with a warning, if there are no triangles.

    Raises
    ------
    EclatError : the mode is unknown, or an index is not below `vertices`.
    """
    mode = element.integer("mode", TRIANGLES)
    if mode in _WITHOUT_AREA:
        warn(f"{element.where}: the primitive consists of {_WITHOUT_AREA[mode]}, which have no area; it is left out")
        return None
    if mode not in (TRIANGLES, STRIP, FAN):
        raise EclatError(f"{element.at('mode')}: expected a mode in 0..6, got {mode}")
    corners = accessors.integers(element, "indices")
    if corners is None:
        corners = np.arange(vertices, dtype=np.uint32)
    elif len(corners) and int(corners.max()) >= vertices:
        first = int(np.argmax(corners >= vertices))
        raise EclatError(
            f"{element.at('indices')}: expected indices below {vertices}, the number of vertices, "
            f"got {int(corners[first])} as number {first}"
        )
    if mode == TRIANGLES and len(corners) % 3:
        warn(
            f"{element.where}: expected a number of indices that is a multiple of 3, got {len(corners)}; the last "
            f"{len(corners) % 3} are ignored"
        )
    assembled = _assemble(mode, corners.astype(np.int32))
    a, b, c = assembled.T
    triangles: NDArray[np.int32] = assembled[(a != b) & (b != c) & (c != a)]
    if not len(triangles):
        warn(f"{element.where}: the primitive has no triangles and is left out")
        return None
    return triangles


def _assemble(mode: int, corners: NDArray[np.int32]) -> NDArray[np.int32]:
    if mode == TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    i = np.arange(max(len(corners) - 2, 0))
    if mode == STRIP:
        return corners[np.column_stack((i, i + 1 + i % 2, i + 2 - i % 2))]
    return corners[np.column_stack((i + 1, i + 2, np.zeros_like(i)))]
