# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What takes part in the race: a renderer that was given a scene, and its levels of quality."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from eclat.scene import Mesh, Scene
from harness.unavailable import UnavailableError

Pixels = NDArray[np.float32]


@dataclass(frozen=True)
class Picture:
    """(H, W, 3) linear radiance, row 0 at the top, and the seconds it took by the rules of docs/peers.md."""

    pixels: Pixels
    seconds: float
    processor: float | None = None
    """Seconds of all processors together that the process of the renderer took; None where it was not measured."""


class Entrant(Protocol):
    """One renderer. Made from (scene, size, threads) in a process of its own; may raise UnavailableError then.

    `unbiased`: its picture's mean must be the reference's. `levels` are names of settings, the cheapest first.
    """

    unbiased: ClassVar[bool]
    levels: tuple[str, ...]
    version: str

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None: ...

    def render(self, level: int) -> Picture:
        """The picture of a level. The first call of a process may be slow: the race does not count it."""


def timed(draw: Callable[[], Pixels]) -> Picture:
    """A picture made in this process, by the wall clock."""
    before = time.perf_counter()
    pixels = draw()
    return Picture(pixels, time.perf_counter() - before)


def diffuse_reflectance(mesh: Mesh, peer: str) -> tuple[float, float, float]:
    """Of a constant, opaque, diffuse material. Raises UnavailableError, which names what `peer` is not given."""
    material = mesh.material
    where = f"material {material.name or mesh.name!r}"
    if material.kind != "diffuse":
        raise UnavailableError(f"{peer} has no model that is ours: {where} is {material.kind}")
    reflectance = material.parameters["reflectance"]
    if reflectance.texture is not None or material.normal_map is not None or material.vertex_colors:
        raise UnavailableError(f"{peer} is given constant colours only: {where} is textured")
    if material.opacity.constant[0] != 1 or material.opacity.texture is not None or material.back is not None:
        raise UnavailableError(f"{peer} is given opaque materials, the same on both sides: {where} is not")
    return reflectance.constant


def emitted(mesh: Mesh, peer: str) -> tuple[float, float, float] | None:
    """Radiance on the normal's side, or None. Raises UnavailableError for textured and for two-sided emission."""
    emission = mesh.material.emission
    if emission is None:
        return None
    if emission.texture is not None or mesh.material.emission_two_sided:
        raise UnavailableError(f"{peer} is given emitters of one colour that shine on one side: {mesh.name!r}")
    return emission.constant
