# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Limit the memory that the geometry of a scene may take in proportion to the size of its files.

Instances, and primitives that share arrays, are copied to world space. Without a limit, a small file could fill the
memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from eclat.loaders.parts import LimitError
from eclat.scene import Mesh

ALLOWANCE = 1 << 29
"""The number of bytes that the geometry of a scene may take in any case (512 MiB)."""

GROWTH = 64
"""The number of further bytes that the geometry may take for each byte of the scene's files. Without instances, a byte of
a mesh file becomes at most 12 bytes, because indices of one byte become four bytes each and are copied twice. A shape in an
XML file takes 50 bytes there and 3 kB in memory."""

OBJECT = 1 << 10
"""The number of bytes that the objects of one mesh take, besides its arrays. A million meshes take 0.5 to 1 GB."""


class Budget:
    """The bytes of geometry that the files of a scene allow, and those that its meshes take."""

    def __init__(self) -> None:
        self.taken = 0
        self._files: dict[Path, int] = {}

    @property
    def allowed(self) -> int:
        return ALLOWANCE + GROWTH * sum(self._files.values())

    def add_file(self, path: Path, size: int) -> None:
        """Count a file of `size` bytes. A file that is read several times counts once."""
        self._files[path] = size


_current: ContextVar[Budget | None] = ContextVar("current", default=None)


@contextmanager
def geometry_budget() -> Iterator[Budget]:
    """Limit the geometry that is loaded in the body of this context."""
    budget = Budget()
    token = _current.set(budget)
    try:
        yield budget
    finally:
        _current.reset(token)


def count_file(path: Path, size: int) -> None:
    """Count a file of the scene that is being loaded, if a scene is."""
    budget = _current.get()
    if budget is not None:
        budget.add_file(path, size)


def spend(size: int, where: str) -> None:
    """Count `size` bytes of geometry, before they are allocated.

    Raises LimitError, with the element `where`, if the scene that is being loaded would then exceed its budget.
    """
    check(size, where)
    budget = _current.get()
    if budget is not None:
        budget.taken += size


def check(size: int, where: str) -> None:
    """Raise LimitError, with the element `where`, if `size` further bytes would exceed the budget."""
    budget = _current.get()
    if budget is not None and budget.taken + size > budget.allowed:
        raise LimitError(
            f"{where}: expected at most {budget.allowed >> 20} MiB of geometry, including instances, in a scene whose "
            f"files have this size, got more with this element"
        )


def size_of(mesh: Mesh) -> int:
    """Return the number of bytes that a transformed copy of `mesh` takes.

    Copies share texture coordinates and colours with the original, but they may have reversed triangles.
    """
    arrays = (mesh.positions, mesh.triangles, mesh.normals, mesh.tangents)
    return OBJECT + sum(array.nbytes for array in arrays if array is not None)
