# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Reading files of measured BRDFs, and materials that use them; damaged files and what is said of them."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.loaders.brdf_files import MAGIC, parse_brdf
from eclat.measured_brdf import MerlBrdf, RglBrdf
from support.brdf_files import Array, as_spectra, merl_file, rgl_fields, shiny_paint, tensor_file

CELLS = 90 * 90 * 180


@pytest.fixture(scope="module")
def merl() -> bytes:
    return merl_file(shiny_paint())


@pytest.fixture(scope="module")
def fields() -> dict[str, Array]:
    return rgl_fields(shiny_paint(), 0.3)


def test_the_units_of_merl_are_those_of_the_format(merl: bytes) -> None:
    found = parse_brdf(merl, "paint.binary")
    assert isinstance(found, MerlBrdf) and found.values.dtype == np.float32 and found.name == "paint"
    stored = np.frombuffer(merl, "<f8", offset=12).reshape(3, 90, 90, 180)[:, 10, 20, 30]
    np.testing.assert_allclose(found.values[:, 10, 20, 30], stored / 1500 * (1, 1.15, 1.66), rtol=1e-6)


def test_cells_of_merl_without_a_measurement_take_the_one_before(merl: bytes) -> None:
    stored = np.frombuffer(merl, "<f8", offset=12).reshape(3, 90, 90, 180)
    last = int(np.flatnonzero(stored[0, 60, :, 45] >= 0)[-1])
    assert last < 89
    found = parse_brdf(merl, "paint.binary")
    assert isinstance(found, MerlBrdf)
    np.testing.assert_array_equal(
        found.values[:, 60, last:, 45], found.values[:, 60, last : last + 1, 45].repeat(90 - last, 1)
    )


def test_the_same_bytes_are_shared(merl: bytes) -> None:
    first = parse_brdf(merl, "paint.binary")
    assert parse_brdf(bytes(merl), "paint.binary") is first


def test_rgb_and_grey_spectra_are_the_same(fields: dict[str, Array]) -> None:
    grey = fields | {"rgb": fields["rgb"][:, :, :1].repeat(3, 2)}
    spectral = as_spectra(grey, np.array([360.0, 500, 1000]), np.full((3, 3), 1 / 3))
    of_rgb, of_spectra = (parse_brdf(tensor_file(f), "paint.bsdf") for f in (grey, spectral))
    assert isinstance(of_rgb, RglBrdf) and isinstance(of_spectra, RglBrdf)
    np.testing.assert_allclose(of_spectra.channels, of_rgb.channels, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize(
    "data, message",
    [
        (b"", "expected a measured BRDF of MERL or RGL, got 0 bytes"),
        (
            struct.pack("<3i", 90, 90, 360) + bytes(9),
            "begins with the numbers 90, 90 and 180, or of RGL, got one that begins with",
        ),
        (struct.pack("<3i", 90, 90, 180) + bytes(80), "expected 34,992,012 bytes, got 92"),
        (struct.pack("<3i", 90, 90, 180) + struct.pack("<d", -1) * (3 * CELLS), "expected measurements, got none"),
        (MAGIC, "got the end of the file"),
        (MAGIC + bytes([2, 0, 0, 0, 0, 0]), "expected version 1.0 of the format, got 2.0"),
        (MAGIC + bytes([1, 0, 0, 0, 0, 0]), "expected the field 'phi_i', got "),
        (MAGIC + bytes([1, 0]) + struct.pack("<I", 1 << 30), "with 1073741824 fields"),
    ],
)
def test_damaged_files_are_refused(data: bytes, message: str) -> None:
    with pytest.raises(EclatError, match=r"x\.bsdf: ") as refused:
        parse_brdf(data, "x.bsdf")
    assert message in str(refused.value)


def test_numbers_of_merl_that_are_not_finite_count_as_not_measured(merl: bytes) -> None:
    damaged = bytearray(merl)
    damaged[12 + 8 * 200 : 12 + 8 * 201] = struct.pack("<d", np.nan)
    with pytest.warns(EclatWarning, match="1 of 4,374,000 numbers are not finite and count as not measured"):
        found = parse_brdf(bytes(damaged), "paint.binary")
    assert isinstance(found, MerlBrdf)
    np.testing.assert_array_equal(found.values[:, 0, 1, 20], found.values[:, 0, 0, 20])


def test_every_truncation_of_a_file_of_rgl_is_refused(fields: dict[str, Array]) -> None:
    whole = tensor_file(fields)
    for length in [*range(12, 400, 7), len(whole) // 2, len(whole) - 1]:
        with pytest.raises(EclatError):
            parse_brdf(whole[:length], "paint.bsdf")


@pytest.mark.parametrize(
    "name, change, message",
    [
        ("theta_i", lambda a: a[::-1], "expected theta in ascending order"),
        ("theta_i", lambda a: a[:5], "expected visible for (1, 5) directions of the viewer, got (1, 10)"),
        ("ndf", lambda a: a * np.float32(np.nan), "expected finite normals, got 1,024 of 1,024"),
        ("ndf", lambda a: a[None], "ndf: expected 2 dimensions, got the shape (1, 32, 32)"),
        ("vndf", lambda a: a * 0, "expected distributions visible above 0"),
        ("rgb", lambda a: a[:, :, :2], "expected three channels, got 2"),
        ("sigma", lambda a: a[:1], "expected projected of at least 2 x 2 nodes, got (1, 32)"),
        ("rgb", None, "expected the field 'spectra', got description, phi_i"),
        (
            "phi_i",
            lambda a: np.array([0, 1, 2], "<f4"),
            "expected azimuths of a whole, half or quarter circle, got 114.592°",
        ),
    ],
)
def test_files_of_rgl_that_do_not_fit_together_are_refused(
    fields: dict[str, Array], name: str, change: object, message: str
) -> None:
    changed = dict(fields)
    if change is None:
        del changed[name]
    else:
        assert callable(change)
        changed[name] = np.ascontiguousarray(change(fields[name]))
    if name == "phi_i":
        changed |= {field: changed[field].repeat(3, 0) for field in ("vndf", "luminance", "rgb")}
    with pytest.raises(EclatError) as refused:
        parse_brdf(tensor_file(changed), "paint.bsdf")
    assert message in str(refused.value)


@pytest.mark.parametrize("plugin", ["measured", "merl"])
def test_a_mitsuba_scene_names_the_file(plugin: str, merl: bytes, tmp_path: Path) -> None:
    (tmp_path / "paint.binary").write_bytes(merl)
    bsdf = f'<bsdf type="{plugin}"><string name="filename" value="paint.binary"/></bsdf>'
    shapes = f'<shape type="sphere">{bsdf}</shape><shape type="sphere"><bsdf type="twosided">{bsdf}</bsdf></shape>'
    (tmp_path / "scene.xml").write_text(f'<scene version="3.0.0">{shapes}</scene>')
    one, two = (mesh.material for mesh in eclat.load(tmp_path / "scene.xml").meshes)
    assert one.kind == two.kind == "measured" and not one.two_sided and two.two_sided
    assert one.measured is not None and one.measured is two.measured


def test_a_material_is_replaced_by_a_measured_one(merl: bytes, tmp_path: Path) -> None:
    (tmp_path / "paint.binary").write_bytes(merl)
    scene = eclat.override_materials(
        eclat.load("cornell-box"), {"floor": {"type": "measured", "filename": "paint.binary", "scale": 0.5}}, tmp_path
    )
    (floor,) = (mesh.material for mesh in scene.meshes if mesh.name == "floor" or mesh.material.name == "floor")
    assert floor.kind == "measured" and floor.parameters["scale"].constant == (0.5, 0.5, 0.5)


def test_a_file_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match=r"absent\.binary"):
        eclat.load_brdf(tmp_path / "absent.binary")
