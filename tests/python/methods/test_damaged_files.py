# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Saved solutions that were edited or damaged: an EclatError of one line, for every method."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import eclat
from eclat.scenes import build
from support.mutations import mutated

METHODS: dict[str, Any] = {
    "records": eclat.IrradianceCache(max_error=0.3),
    "radiance": eclat.RadianceCache(max_error=0.3, order=3),
    "photons": eclat.PhotonMap(photons=1000, caustic_photons=1000),
    "radiosity": eclat.Radiosity(patches=100),
}


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """A small file of each kind."""
    found = {}
    scene = build("cornell-box")
    for name, method in METHODS.items():
        path = tmp_path_factory.mktemp("saved") / "a.npz"
        points = {"points": ([[0.0, -1.0, 0.0]], [[0.0, 1.0, 0.0]])} if name == "records" else {}
        if name == "radiance":
            points = {"size": (8, 8)}
        eclat.solve(scene, method, check=False, **points).save(path)
        found[name] = path.read_bytes()
    return found


def edited(data: bytes, change: dict[str, Any]) -> bytes:
    """The file with other fields in its header; None takes one out."""
    with np.load(io.BytesIO(data)) as arrays:
        content = dict(arrays)
    header = json.loads(str(content.pop("header"))) | change
    file = io.BytesIO()
    np.savez(file, header=json.dumps({k: v for k, v in header.items() if v is not None}), **content)
    return file.getvalue()


def refused(path: Path) -> bool:
    try:
        eclat.load_solved(path)
    except eclat.EclatError as error:
        assert "\n" not in str(error) and str(path) in str(error)
        return True
    return False


@pytest.mark.parametrize("kind", METHODS)
@pytest.mark.parametrize(
    "change",
    [
        *({"options": value} for value in ([], 1, {"rows": 2.5}, {"photons": "x"}, {"patches": {}}, {"odd": 1})),
        *({"max_depth": value} for value in (1e300, "x", 2.5, [], None)),
        *({"statistics": value} for value in ([], {"seconds": "x"}, {"seconds": {}}, None)),
        *({"fingerprint": value} for value in (1, None)),
        *({"complete": value} for value in (1, "yes", None)),
        *({"method": value} for value in ("odd", 1, {}, None)),
    ],
)
def test_edited_headers(saved: dict[str, bytes], kind: str, change: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(edited(saved[kind], change))
    assert refused(tmp_path / "a.npz")


@pytest.mark.parametrize("value", [[], 1, [{}], [{"seed": "x", "paths": 1, "caustic_paths": 1}], [{"seed": 0}], None])
def test_edited_emissions(saved: dict[str, bytes], value: object, tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(edited(saved["photons"], {"emissions": value}))
    assert refused(tmp_path / "a.npz")


@pytest.mark.parametrize("kind", METHODS)
def test_files_of_the_current_format_are_read(saved: dict[str, bytes], kind: str, tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(saved[kind])
    assert not refused(tmp_path / "a.npz")


@given(data=st.data())
@settings(
    derandomize=True, max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_mutated_files_are_read_or_refused(saved: dict[str, bytes], data: st.DataObject, tmp_path: Path) -> None:
    kind = data.draw(st.sampled_from(list(METHODS)))
    (tmp_path / "a.npz").write_bytes(data.draw(mutated(saved[kind][:3000] + saved[kind][-3000:])))
    refused(tmp_path / "a.npz")
    (tmp_path / "a.npz").write_bytes(data.draw(mutated(saved[kind])))
    refused(tmp_path / "a.npz")
