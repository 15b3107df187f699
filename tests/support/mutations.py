# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Valid files, damaged at random: what loaders must survive with an EclatError or a sane result."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

import numpy as np
from hypothesis import strategies as st

from eclat.errors import EclatError, EclatWarning
from eclat.scene import Mesh

_NASTY = (
    *(b"nan", b"-inf", b"1e999", b"0", b"-1", b"99999999999999999999", b"4294967296", b"2147483647", b"1e-320"),
    *(b"\x00", b"\xff\xfe", b"/", b"//", b"\\\n", b"#", b"\n", b"\r", b" ", b"\t", b"-", b"\xe9", b"1_0", b"\x00" * 8),
)


def mutated(original: bytes) -> st.SearchStrategy[bytes]:
    """Copies of `original` with one to four cuts, overwrites, insertions or repetitions."""
    places = st.integers(0, len(original))
    pieces = st.one_of(st.sampled_from(_NASTY), st.binary(min_size=1, max_size=8))
    edits = st.tuples(st.sampled_from(["cut", "delete", "overwrite", "insert", "repeat"]), places, places, pieces)

    def apply(edits: list[tuple[str, int, int, bytes]]) -> bytes:
        data = original
        for kind, a, b, piece in edits:
            low, high = min(a, b), max(a, b)
            if kind == "cut":
                data = data[:high]
            elif kind == "delete":
                data = data[:low] + data[min(high, low + 20) :]
            elif kind == "overwrite":
                data = data[:low] + piece + data[low + len(piece) :]
            elif kind == "insert":
                data = data[:low] + piece + data[low:]
            else:
                data = data[:high] + data[low:]
        return data

    return st.lists(edits, min_size=1, max_size=4).map(apply)


def survives(load: Callable[[], Sequence[Mesh]]) -> None:
    """Assert that `load` either raises EclatError or returns sane meshes, with no warnings but Éclat's."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", EclatWarning)
        try:
            meshes = load()
        except EclatError as error:
            assert len(str(error)) < 1000
            return
    for mesh in meshes:
        check_mesh(mesh)


def check_mesh(mesh: Mesh) -> None:
    """Assert the contract of `Mesh` as far as arrays go."""
    count = len(mesh.positions)
    assert mesh.positions.shape == (count, 3)
    assert np.isfinite(np.asarray(mesh.positions, dtype=np.float32)).all()
    assert mesh.triangles.ndim == 2 and mesh.triangles.shape[1] == 3 and len(mesh.triangles) > 0
    assert mesh.triangles.min() >= 0 and mesh.triangles.max() < count
    if mesh.normals is not None:
        assert mesh.normals.shape == (count, 3)
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)
    if mesh.uvs is not None:
        assert mesh.uvs.shape == (count, 2) and np.isfinite(mesh.uvs).all()
    if mesh.colors is not None:
        assert mesh.colors.shape == (count, 4) and np.isfinite(mesh.colors).all() and mesh.colors.min() >= 0
