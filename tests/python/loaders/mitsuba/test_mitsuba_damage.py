# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Damaged, foreign and hostile Mitsuba scenes: an error that says why, never anything else."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.mitsuba import load_dict, load_xml
from support.luminaires import DOWNLIGHT
from support.mitsuba_files import WHOLE


def test_truncated_and_foreign_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "scene.xml"
    for content, message in (
        (WHOLE[:-20], r"scene\.xml:\d+: expected well-formed XML, got an error: (no element found|unclosed token)"),
        ("", r"scene\.xml:1: expected well-formed XML"),
        ("<html/>", r"scene\.xml:1 <html>: expected the root element <scene>"),
        ('<?xml version="1.0" encoding="klingon"?><scene version="3.0.0"/>', r"scene\.xml"),
        ('<scene version="new"/>', r"expected a version like 3\.0\.0, got 'new'"),
    ):
        path.write_text(content)
        with pytest.raises(EclatError, match=message):
            load_xml(path)
    with pytest.raises(EclatError, match="none"):
        load_xml(tmp_path / "none.xml")
    with pytest.raises(EclatError):
        load_xml(tmp_path)


def test_a_lamp_with_a_faulty_profile_is_left_out_and_nothing_else_is_told_of_it(tmp_path: Path) -> None:
    """The properties that come after its file were told to be unused."""
    (tmp_path / "lamp.ies").write_text(DOWNLIGHT[:-20])
    lamp = '<emitter type="ies"><string name="filename" value="lamp.ies"/><rgb name="intensity" value="1"/></emitter>'
    (tmp_path / "scene.xml").write_text(f'<scene version="3.0.0"><shape type="sphere"/>{lamp}</scene>')
    with pytest.warns(EclatWarning) as told:
        assert not load_xml(tmp_path / "scene.xml").lights
    assert [str(w.message) for w in told if "not used" in str(w.message)] == []
    assert any("lamp.ies" in str(w.message) for w in told)


def test_entities_and_deep_nesting_are_refused_before_they_hurt(tmp_path: Path) -> None:
    path = tmp_path / "bomb.xml"
    entities = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 10))
    path.write_text(f'<?xml version="1.0"?>\n<!DOCTYPE scene [<!ENTITY l0 "lol">{entities}]><scene version="&l9;"/>')
    with pytest.raises(EclatError, match=r"bomb\.xml:2: expected no document type and no entities"):
        load_xml(path)
    path.write_text('<scene version="3.0.0">' + '<bsdf type="twosided">' * 10_000 + "</bsdf>" * 10_000 + "</scene>")
    with pytest.raises(EclatError, match="at most 50 levels of nested"):
        load_xml(path)


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ([], "expected a dict that describes a scene, got list"),
        ({}, "expected 'type': 'scene', got None"),
        ({"type": np.eye(4)}, r"expected 'type': 'scene', got array\(\[\[1.*\)$"),
        ({"type": "scene", "a": {"type": np.eye(4)}}, r"an object whose 'type' is a string, got array.*\)$"),
        (
            {"type": "scene", "a": {"type": "sphere", "radius": np.eye(4)}},
            r"radius: expected a number, got array.*\)$",
        ),
        ({"type": "scene", "a": {"type": 3}}, r"dict\['a'\]: expected an object whose 'type' is a string"),
        ({"type": "scene", "a": {"type": "ref"}}, r"dict\['a'\]: expected a reference whose 'id' is a string"),
        ({"type": "scene", "a": {"type": "sphere", "radius": float("inf")}}, r"\['a'\]\['radius'\].*finite"),
        ({"type": "scene", "a": {"type": "sphere", "radius": 10**400}}, r"\['a'\]\['radius'\].*finite"),
        ({"type": "scene", "a": {"type": "sphere", "center": object()}}, r"\['center'\]: expected numbers"),
        (
            {"type": "scene", "a": {"type": "cube", "to_world": np.eye(5)}},
            r"4×4 matrix, got an array of shape \(5, 5\)",
        ),
        (
            {"type": "scene", "a": {"type": "diffuse", "reflectance": {"type": "rgb", "valeu": 0.5}}},
            r"expected the entry 'value' in a dict of type 'rgb', got \['valeu'\]; did you mean 'value'\?",
        ),
        ({"type": "scene", "a": {"type": "cube", "to_world": np.full((4, 4), np.nan)}}, "finite"),
        (
            {"type": "scene", "a": {"type": "cube", "b": {"type": "ref", "id": "none"}}},
            "expected the id of an object, got 'none'",
        ),
        ({"type": "scene", "a": {"type": "point", "intensity": {"type": "rgb", "value": [1, 2]}}}, r"shape \(2,\)"),
    ],
)
def test_dicts_that_are_no_scene_are_refused(scene: Any, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        load_dict(scene)


def test_dicts_that_hold_themselves_are_refused() -> None:
    inner: dict[str, Any] = {"type": "twosided"}
    inner["nested"] = inner
    with pytest.raises(EclatError, match="at most 50 levels of nested"):
        load_dict({"type": "scene", "s": {"type": "cube", "bsdf": inner}})


MUTATION = settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
FRAGMENTS = [
    "<",
    ">",
    '"',
    "/",
    "&",
    "$",
    "$x",
    "-",
    "1e38",
    "nan",
    "0",
    ":",
    ",",
    "#",
    "\x00",
    "é",
    "<ref id='white'/>",
]


@MUTATION
@given(
    st.lists(
        st.tuples(st.integers(0, len(WHOLE) - 1), st.integers(0, 12), st.sampled_from(FRAGMENTS)),
        min_size=1,
        max_size=4,
    )
)
@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_damaged_files_are_loaded_or_refused_with_a_message(tmp_path: Path, edits: list[tuple[int, int, str]]) -> None:
    text = WHOLE
    for position, length, fragment in edits:
        text = text[:position] + fragment + text[position + length :]
    path = tmp_path / "damaged.xml"
    path.write_text(text, encoding="utf-8")
    try:
        scene = load_xml(path)
    except EclatError as error:
        assert len(str(error)) < 1000
    else:
        assert all(np.isfinite(mesh.positions).all() for mesh in scene.meshes)


VALUES = [
    "0",
    "-1",
    "1e30",
    "-1e-30",
    "x",
    "",
    "1 2 3",
    "1 2",
    "#fff",
    "400:1",
    "true",
    "$angle",
    "nan",
    "  ",
    "9" * 400,
]


@MUTATION
@given(st.integers(0, 200), st.sampled_from(VALUES), st.booleans())
@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_wrong_values_and_elements_are_loaded_or_refused_with_a_message(
    tmp_path: Path, index: int, value: str, swap: bool
) -> None:
    matches = list(re.finditer(r'(?<=value=")[^"]*' if not swap else r'(?<=type=")[^"]*', WHOLE))
    match = matches[index % len(matches)]
    replacement = value if not swap else ["cube", "diffuse", "point", "bitmap", "mask", "instance", "sunsky"][index % 7]
    path = tmp_path / "wrong.xml"
    path.write_text(WHOLE[: match.start()] + replacement + WHOLE[match.end() :])
    try:
        load_xml(path)
    except EclatError as error:
        assert "wrong.xml" in str(error)


PLAIN = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.lists(st.floats(), max_size=4)
)
KEYS = st.sampled_from(["type", "id", "value", "to_world", "radius", "bsdf", "reflectance", "emitter", "filename", "a"])
TYPES = st.sampled_from(
    ["sphere", "diffuse", "twosided", "rgb", "spectrum", "ref", "bitmap", "area", "perspective", "sky"]
)
OBJECTS = st.recursive(
    PLAIN,
    lambda inner: st.builds(lambda kind, rest: {**rest, "type": kind}, TYPES, st.dictionaries(KEYS, inner, max_size=4)),
    max_leaves=12,
)


@MUTATION
@given(st.dictionaries(st.sampled_from("abc"), OBJECTS, max_size=3))
@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_any_dict_is_loaded_or_refused_with_a_message(objects: dict[str, Any]) -> None:
    try:
        load_dict({"type": "scene", **objects})
    except EclatError as error:
        assert len(str(error)) < 1000
