# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert `<transform>` elements to matrices, and transform points, directions and normals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.mitsuba.elements import Element
from eclat.loaders.mitsuba.node import check_number, parse_number, parse_numbers, parse_vector, snake_case

Matrix = NDArray[np.float64]


def read_transform(element: Element) -> Matrix:
    """Convert a `<transform>` element to a 4×4 matrix. Its children are applied in the order of the file.

    Raises
    ------
    EclatError : a step is unknown, a number is malformed, or the result is not finite.
    """
    matrix = np.eye(4)
    for step in element.children:
        kind = snake_case(step.tag).replace("_", "")
        if kind not in _STEPS:
            raise EclatError(f"{step.where}: expected one of {', '.join(sorted(_STEPS))}, got {step.tag!r}")
        matrix = _STEPS[kind](step) @ matrix
    return check_matrix(matrix, element.where)


def check_matrix(matrix: Matrix, where: str) -> Matrix:
    """Return `matrix`. Raises EclatError if an entry is not finite or the last row is not 0 0 0 1."""
    for entry in matrix.ravel():
        check_number(float(entry), where)
    if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-6):
        raise EclatError(
            f"{where}: expected an affine transform, whose last row is 0 0 0 1, got the last row {matrix[3].tolist()}"
        )
    return matrix


def transform_points(matrix: Matrix, points: NDArray[Any]) -> Matrix:
    """Transform points, shape (N, 3)."""
    return np.asarray(points, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def transform_directions(matrix: Matrix, directions: NDArray[Any]) -> Matrix:
    """Transform directions, shape (N, 3), without normalising them."""
    return np.asarray(directions, dtype=np.float64) @ matrix[:3, :3].T


def transform_normals(matrix: Matrix, normals: NDArray[Any]) -> Matrix:
    """Transform unit normals (N, 3) by the inverse transpose, and normalise them.

    A normal that becomes zero, because a singular matrix maps its surface to a line, is replaced by +z.
    """
    # The cofactor matrix is the inverse transpose times the determinant. It exists for singular matrices too.
    a, b, c = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if is_mirrored(matrix):
        cofactors = -cofactors
    turned = normalize(np.asarray(normals, dtype=np.float64) @ cofactors.T)
    # A surface that a matrix maps to a line has no area and no normal.
    turned[~turned.any(axis=1)] = (0, 0, 1)
    return turned


def normalize(vectors: Matrix) -> Matrix:
    """Normalise the vectors along the last axis. Zero vectors stay zero."""
    scaled = vectors / np.maximum(np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0), 1e-300)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    unit: Matrix = np.divide(scaled, length, out=np.zeros_like(scaled), where=length > 0)
    return unit


def is_mirrored(matrix: Matrix) -> bool:
    """Return whether the matrix contains a reflection, which changes the handedness of the coordinate system."""
    return float(np.linalg.det(matrix[:3, :3])) < 0


def is_singular(matrix: Matrix) -> bool:
    """Return whether the matrix maps space onto a plane, a line or a point."""
    values = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(values[-1] <= 1e-12 * values[0])


def look_at_mitsuba(origin: NDArray[Any], target: NDArray[Any], up: NDArray[Any], where: str) -> Matrix:
    """Return the matrix (4, 4) of a camera at `origin` in Mitsuba's convention: +z to the target, +x to the left, +y
    up.

    Raises EclatError if `origin` and `target` are equal.
    """
    forward = np.asarray(target, dtype=np.float64) - origin
    if not np.any(forward):
        raise EclatError(
            f"{where}: expected different points for origin and target, got {[float(x) for x in origin]} for both"
        )
    forward = normalize(forward)
    left = np.cross(normalize(np.asarray(up, dtype=np.float64)), forward)
    if np.linalg.norm(left) < 1e-9:
        warn(f"{where}: up is parallel to the viewing direction; another up direction is used")
        left = np.cross(np.eye(3)[int(np.argmin(np.abs(forward)))], forward)
    left = normalize(left)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = left, np.cross(forward, left), forward, origin
    return matrix


def _components(step: Element, default: float) -> Matrix:
    """Return the x, y and z of a step.

    They are read from the attribute `value`, which holds three numbers or one for all, or from the attributes x, y, z.
    """
    if "value" in step.attributes:
        return np.array(parse_vector(step.attributes["value"], step.where))
    found = [step.attributes.get(axis) for axis in "xyz"]
    return np.array([default if text is None else parse_number(text, step.where) for text in found])


def _translate(step: Element) -> Matrix:
    matrix = np.eye(4)
    matrix[:3, 3] = _components(step, 0.0)
    return matrix


def _scale(step: Element) -> Matrix:
    return np.diag([*_components(step, 1.0), 1.0])


def _rotate(step: Element) -> Matrix:
    axis = _components(step, 0.0)
    angle = math.radians(parse_number(step.attributes.get("angle", "0"), step.where))
    if not np.any(axis):
        raise EclatError(f"{step.where}: expected a rotation axis (x, y, z), got the zero vector")
    x, y, z = normalize(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)
    return matrix


def _matrix(step: Element) -> Matrix:
    numbers = parse_numbers(step.attributes.get("value", ""), step.where)
    matrix = np.eye(4)
    if len(numbers) == 16:
        matrix[:] = np.reshape(numbers, (4, 4))
    elif len(numbers) == 9:
        matrix[:3, :3] = np.reshape(numbers, (3, 3))
    else:
        raise EclatError(f"{step.where}: expected 16 or 9 numbers, got {len(numbers)}")
    return matrix


def _look_at(step: Element) -> Matrix:
    vectors = {}
    for name, default in (("origin", "0 0 0"), ("target", None), ("up", "0 1 0")):
        text = step.attributes.get(name, default)
        if text is None:
            raise EclatError(f"{step.where}: expected the attribute {name}, got none")
        vectors[name] = np.array(parse_vector(text, step.where))
    return look_at_mitsuba(vectors["origin"], vectors["target"], vectors["up"], step.where)


_STEPS = {"translate": _translate, "scale": _scale, "rotate": _rotate, "matrix": _matrix, "lookat": _look_at}
