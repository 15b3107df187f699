# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tables by way of arrays: their albedo, the files that keep them, what happens to damaged ones, what is refused."""

from __future__ import annotations

import doctest
import io
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

from eclat import brdf_table as module
from eclat.brdf_table import BrdfTable, brdf_table, cache_folder, split_conductor, split_dielectric
from eclat.errors import EclatError, EclatWarning
from eclat.harmonics import project, quadrature, reconstruct


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "eclat"


def numbers(table: BrdfTable) -> np.ndarray:
    return np.asarray(table.core.coefficients)


def ggx(wi: np.ndarray, wo: np.ndarray, alpha: float, f0: float) -> np.ndarray:
    """Value of a GGX lobe with height-correlated masking and Schlick's reflectance, written anew."""
    h = wi + wo
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    density = alpha**2 / (np.pi * (1 - h[:, 2] ** 2 * (1 - alpha**2)) ** 2)

    def stretch(z: np.ndarray) -> np.ndarray:
        return np.sqrt(alpha**2 + (1 - alpha**2) * z**2)

    visibility = 0.5 / (wo[2] * stretch(wi[:, 2]) + wi[:, 2] * stretch(wo[2]))
    return density * visibility * (f0 + (1 - f0) * (1 - h @ wo) ** 5)


def test_reflected_light_is_a_dot_product() -> None:
    """A Phong lobe under a sky that is brighter towards +x, against the integral itself."""
    w, weights = quadrature(48)
    sky = 1 + 0.8 * w[:, 0]
    wo = np.array([0.5, 0.2, 0.0])
    wo[2] = np.sqrt(1 - wo @ wo)
    alignment = wo[2] * w[:, 2] - wo[0] * w[:, 0] - wo[1] * w[:, 1]
    f_cos = 10 / (2 * np.pi) * np.maximum(alignment, 0) ** 8 * w[:, 2]
    exact = (weights * sky) @ f_cos
    for basis in ("hemispherical", "spherical"):
        found = brdf_table("phong", exponent=8, basis=basis, keep=False).lookup(wo[None])  # type: ignore[arg-type]
        light = project(basis, 10, w, sky, weights)  # type: ignore[arg-type]
        assert found.coefficients[0, 0] @ light == pytest.approx(exact, rel=0.01)
        assert 0 < found.orders[0] <= 10 and found.errors[0] < 0.2


def test_metallic_roughness_serves_all_colours() -> None:
    table = brdf_table("metallic-roughness", keep=False)
    w, weights = quadrature(48)
    sky = project("hemispherical", 10, w, np.ones(len(w)), weights)
    wo = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.6, 0.0, 0.8]])
    found = table.lookup(wo, [0.5, 0.5, 0.05])
    assert found.orders[0] == found.orders[1] > 0 and found.orders[2] == 0
    terms = found.coefficients[0] @ sky
    for f0 in (1.0, 0.5, 0.04):
        exact = weights @ (ggx(w, wo[0], 0.5, f0) * w[:, 2])
        assert terms @ [f0, 1, 0] == pytest.approx(exact, rel=0.01)
    # The lobe looks the same from another azimuth, turned with it.
    there = reconstruct("hemispherical", found.coefficients[0, 0], [[-0.6, 0.0, 0.8]])
    turned = reconstruct("hemispherical", found.coefficients[1, 0], [[0.0, -0.6, 0.8]])
    np.testing.assert_allclose(turned, there, rtol=1e-4)


def test_a_table_is_kept_and_read_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = brdf_table("ward", alpha=0.4, order=4)
    assert [path.suffix for path in folder.iterdir()] == [".npz"]

    def refuse(*arguments: object) -> None:
        raise AssertionError("computed again")

    with monkeypatch.context() as patch:
        patch.setattr(module, "run", refuse)
        again = brdf_table("ward", alpha=0.4, order=4)
    np.testing.assert_array_equal(numbers(again), numbers(first))
    brdf_table("ward", alpha=0.41, order=4)
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("damage", ["cut", "flipped", "text", "empty", "nan", "huge"])
def test_a_damaged_file_is_replaced_with_a_warning(folder: Path, damage: str) -> None:
    first = brdf_table("lambert")
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    middle = len(whole) // 2
    with np.load(path) as arrays:
        kept = dict(arrays)

    def holding(value: float) -> bytes:
        """With checksums that fit: nothing but the number says that it is wrong."""
        file = io.BytesIO()
        np.savez(file, **(kept | {"coefficients": np.full_like(kept["coefficients"], value)}))
        return file.getvalue()

    path.write_bytes(
        {
            "nan": holding(float("nan")),
            "huge": holding(1e30),
            "cut": whole[:middle],
            "flipped": whole[:middle] + bytes([whole[middle] ^ 255]) + whole[middle + 1 :],
            "text": b"not a table",
            "empty": b"",
        }[damage]
    )
    with pytest.warns(EclatWarning, match=r"brdf-.*\.npz: the table cannot be read"):
        again = brdf_table("lambert")
    np.testing.assert_array_equal(numbers(again), numbers(first))
    assert path.read_bytes() == whole


def test_a_folder_that_cannot_be_made_is_a_warning(folder: Path) -> None:
    folder.write_text("in the way")
    with pytest.warns(EclatWarning, match="could not be kept"):
        brdf_table("lambert")


def test_pipes_in_the_way_and_no_home_are_warnings(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    brdf_table("lambert")
    (path,) = folder.iterdir()
    path.unlink()
    os.mkfifo(path)
    with pytest.warns(EclatWarning, match="got a pipe or a device"):
        brdf_table("lambert")

    def homeless() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(Path, "home", homeless)
    with pytest.warns(
        EclatWarning, match="HOME or XDG_CACHE_HOME to be an absolute path, but neither is; the table is not kept"
    ):
        brdf_table("lambert")


@pytest.mark.parametrize("home", ["", "relative", "/proc/none"])
def test_without_a_usable_home_tables_are_not_kept(home: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", home)
    with pytest.warns(EclatWarning, match="not kept|could not be kept") as caught:
        brdf_table("lambert")
    assert len(caught) == 1 and not list(tmp_path.iterdir())


def test_nothing_is_written_with_keep_false(folder: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        brdf_table("lambert", keep=False)
    assert not folder.exists()


def test_the_folder_follows_the_xdg_specification(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/somebody")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache_folder() == Path("/home/somebody/.cache/eclat")
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder() == Path("/home/somebody/.cache/eclat")


def test_fresnel_factors_start_at_normal_incidence() -> None:
    np.testing.assert_allclose(split_dielectric(1.5)[:2], [[0.04] * 3, [1] * 3], rtol=1e-5)
    gold = split_conductor((0.143, 0.375, 1.442), (3.98, 2.39, 1.6))
    assert gold.shape == (3, 3) and gold[0, 0] > 0.9 > gold[0, 2] > 0.3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"kind": "lambertian"}, "did you mean 'lambert'"),
        ({"kind": "ggx"}, "'ggx' needs alpha"),
        ({"kind": "ggx", "alpha": 2.0}, r"in \[0.001, 1\], got 2.0"),
        ({"kind": "ggx", "alpha": float("nan")}, "got nan"),
        ({"kind": "phong", "alpha": 0.2}, "'phong' takes no alpha"),
        ({"kind": "phong", "exponent": -1.0}, "at least 0, got -1"),
        ({"kind": "lambert", "exponent": 3.0}, "'lambert' takes no exponent"),
        ({"kind": "lambert", "order": 13}, r"order must be in \[1, 12\], got 13"),
        ({"kind": "lambert", "max_error": 0.0}, "max_error must be in"),
        ({"kind": "lambert", "basis": "zonal"}, "basis must be one of"),
    ],
)
def test_impossible_values_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(EclatError, match=message):
        brdf_table(**arguments, keep=False)  # type: ignore[arg-type]


def test_lookups_that_do_not_fit_are_refused() -> None:
    table = brdf_table("lambert", keep=False)
    with pytest.raises(EclatError, match=r"shape \(N, 3\)"):
        table.lookup([0.0, 0.0, 1.0])
    with pytest.raises(EclatError, match="tables of 'metallic-roughness' and for no others"):
        table.lookup([[0.0, 0.0, 1.0]], 0.3)
    assert table.lookup([[0.0, 0.0, -1.0]]).orders[0] == 0


def test_examples() -> None:
    assert doctest.testmod(module).failed == 0
