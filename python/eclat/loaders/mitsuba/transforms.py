# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Transforms: makes matrices of `<transform>` elements, and applies matrices to points and normals."""

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
    """The 4×4 matrix of a `<transform>`: its children apply one after the other, the first one first.

    Raises
    ------
    EclatError : unknown steps, malformed numbers, results that are not finite.
    """
    matrix = np.eye(4)
    for step in element.children:
        kind = snake_case(step.tag).replace("_", "")
        if kind not in _STEPS:
            raise EclatError(f"{step.where}: expected one of {', '.join(sorted(_STEPS))}")
        matrix = _STEPS[kind](step) @ matrix
    return check_matrix(matrix, element.where)


def check_matrix(matrix: Matrix, where: str) -> Matrix:
    """Return `matrix`. Raises EclatError if an entry is not finite or the last row is not 0 0 0 1."""
    for entry in matrix.ravel():
        check_number(float(entry), where)
    if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-6):
        raise EclatError(f"{where}: expected an affine transform (last row 0 0 0 1), got {matrix[3].tolist()}")
    return matrix


def transform_points(matrix: Matrix, points: NDArray[Any]) -> Matrix:
    """The transformed points, shape (N, 3)."""
    return np.asarray(points, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def transform_directions(matrix: Matrix, directions: NDArray[Any]) -> Matrix:
    """The transformed directions, shape (N, 3), not normalised."""
    return np.asarray(directions, dtype=np.float64) @ matrix[:3, :3].T


def transform_normals(matrix: Matrix, normals: NDArray[Any]) -> Matrix:
    """Unit normals (N, 3) transformed by the inverse transpose; those of what it squeezes to a line are +z."""
    # The cofactors are the inverse transpose times the determinant; they exist for singular matrices too.
    a, b, c = matrix[:3, 0], matrix[:3, 1], matrix[:3, 2]
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if is_mirrored(matrix):
        cofactors = -cofactors
    turned = normalize(np.asarray(normals, dtype=np.float64) @ cofactors.T)
    # What a matrix squeezes to a line has no area, and no normal.
    turned[~turned.any(axis=1)] = (0, 0, 1)
    return turned


def normalize(vectors: Matrix) -> Matrix:
    """The vectors along the last axis, normalised; zero vectors stay 0."""
    scaled = vectors / np.maximum(np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0), 1e-300)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    unit: Matrix = np.divide(scaled, length, out=np.zeros_like(scaled), where=length > 0)
    return unit


def is_mirrored(matrix: Matrix) -> bool:
    """Whether the matrix contains a reflection, so that it changes handedness."""
    return float(np.linalg.det(matrix[:3, :3])) < 0


def is_singular(matrix: Matrix) -> bool:
    """Whether the matrix flattens space."""
    values = np.linalg.svd(matrix[:3, :3], compute_uv=False)
    return bool(values[-1] <= 1e-12 * values[0])


def look_at_mitsuba(origin: NDArray[Any], target: NDArray[Any], up: NDArray[Any], where: str) -> Matrix:
    """Mitsuba's camera frame at `origin`: +z to the target, +x to the left, +y up. Raises EclatError."""
    forward = np.asarray(target, dtype=np.float64) - origin
    if not np.any(forward):
        raise EclatError(
            f"{where}: expected an origin and a target that differ, got {[float(x) for x in origin]} twice"
        )
    forward = normalize(forward)
    left = np.cross(normalize(np.asarray(up, dtype=np.float64)), forward)
    if np.linalg.norm(left) < 1e-9:
        warn(f"{where}: up is parallel to the view; another one is used")
        left = np.cross(np.eye(3)[int(np.argmin(np.abs(forward)))], forward)
    left = normalize(left)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = left, np.cross(forward, left), forward, origin
    return matrix


def _components(step: Element, default: float) -> Matrix:
    """The x, y and z of a step, from `value` (three numbers, or one for all) or from its attributes x, y, z."""
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
        raise EclatError(f"{step.where}: expected an axis (x, y, z), got the zero vector")
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
            raise EclatError(f"{step.where}: expected the attribute {name}")
        vectors[name] = np.array(parse_vector(text, step.where))
    return look_at_mitsuba(vectors["origin"], vectors["target"], vectors["up"], step.where)


_STEPS = {"translate": _translate, "scale": _scale, "rotate": _rotate, "matrix": _matrix, "lookat": _look_at}
