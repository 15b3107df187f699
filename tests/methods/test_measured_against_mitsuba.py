# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files of measured BRDFs, made of a BRDF that is known in closed form: what Éclat reads of them against Mitsuba's `measured` and
against the closed form."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.bridge.compiled import core_brdf
from eclat.measure.spectrum import reflectance_weights
from support.brdf_files import Array, as_spectra, directions, merl_file, rgl_fields, shiny_paint, tensor_file

ALPHA = 0.3
WAVELENGTHS = np.linspace(360, 1000, 16)


def pairs_of_directions() -> tuple[Array, Array]:
    """400 directions of the viewer and of light, up to 85° from the normal."""
    rng = np.random.default_rng(5)
    theta, phi = np.arccos(rng.uniform(np.cos(np.radians(85)), 1, (2, 400))), rng.uniform(-np.pi, np.pi, (2, 400))
    wo, wi = directions(theta, phi)
    # Every other one near the mirror direction, where most light is.
    wi[::2] = directions(
        np.clip(theta[0, ::2] + rng.normal(0, 0.15, 200), 0, 1.45), phi[0, ::2] + np.pi + rng.normal(0, 0.2, 200)
    )
    return wo.astype(np.float32), wi.astype(np.float32)


@pytest.fixture(scope="module")
def fields() -> dict[str, Array]:
    return rgl_fields(shiny_paint(ALPHA), ALPHA)


@pytest.fixture
def spectral_mitsuba() -> Iterator[Any]:
    mitsuba = pytest.importorskip("mitsuba")
    before = mitsuba.variant()
    mitsuba.set_variant("scalar_spectral")
    yield mitsuba
    if before is not None:
        mitsuba.set_variant(before)


def test_rgl_files_have_mitsubas_values_and_densities(
    fields: dict[str, Array], spectral_mitsuba: Any, tmp_path: Path
) -> None:
    mi = spectral_mitsuba
    # Smooth spectra that are neither grey nor alike.
    x = (WAVELENGTHS - 360) / 640
    spectral = as_spectra(fields, WAVELENGTHS, np.stack([0.2 + 0.8 * x, 0.5 + 0 * x, np.exp(-2 * x)]))
    path = tmp_path / "paint.bsdf"
    path.write_bytes(tensor_file(spectral))
    wo, wi = pairs_of_directions()
    values, densities = core_brdf(eclat.load_brdf(path)).eval(wo, wi)
    theirs, their_densities = np.zeros((len(wo), len(WAVELENGTHS))), np.zeros(len(wo))
    bsdf, context = mi.load_dict({"type": "measured", "filename": str(path)}), mi.BSDFContext()
    at = mi.SurfaceInteraction3f()
    for i, (view, light) in enumerate(zip(wo, wi, strict=True)):
        at.wi = mi.Vector3f(*map(float, view))
        towards = mi.Vector3f(*map(float, light))
        for first in range(0, len(WAVELENGTHS), 4):
            at.wavelengths = mi.Spectrum([float(nm) for nm in WAVELENGTHS[first : first + 4]])
            theirs[i, first : first + 4] = np.array(bsdf.eval(context, at, towards)) / light[2]
        their_densities[i] = bsdf.pdf(context, at, towards)
    wanted = np.maximum(theirs @ reflectance_weights(WAVELENGTHS).T, 0)
    np.testing.assert_allclose(values, wanted, rtol=2e-3, atol=1e-4)
    np.testing.assert_allclose(densities, their_densities, rtol=3e-3, atol=1e-4)


def test_rgl_files_have_the_values_of_their_model(fields: dict[str, Array], tmp_path: Path) -> None:
    path = tmp_path / "paint.bsdf"
    path.write_bytes(tensor_file(fields))
    wo, wi = pairs_of_directions()
    values, _ = core_brdf(eclat.load_brdf(path)).eval(wo, wi)
    wanted = shiny_paint(ALPHA)(wo, wi)
    # Between nodes of 10° of the viewer, and of 32 × 32 of light.
    error = np.abs(values - wanted) / wanted
    assert np.median(error) < 0.01 and np.quantile(error, 0.95) < 0.1


def test_merl_files_have_the_values_of_their_model_and_are_reciprocal(tmp_path: Path) -> None:
    path = tmp_path / "paint.binary"
    path.write_bytes(merl_file(shiny_paint(ALPHA)))
    wo, wi = pairs_of_directions()
    core = core_brdf(eclat.load_brdf(path))
    values, _ = core.eval(wo, wi)
    # Cells of one degree, and the last one above the horizon stands for those around it.
    error = np.abs(values / shiny_paint(ALPHA)(wo, wi) - 1)
    assert np.quantile(error, 0.99) < 0.01 and error.max() < 0.1
    np.testing.assert_allclose(values, core.eval(wi, wo)[0], rtol=1e-4)


def test_directions_follow_the_density(fields: dict[str, Array], tmp_path: Path) -> None:
    """Chi-square of 200 000 directions in 6 × 12 cells of equal solid angle, for each kind of file and three views."""
    scipy_stats = pytest.importorskip("scipy.stats")
    (tmp_path / "paint.bsdf").write_bytes(tensor_file(fields))
    (tmp_path / "paint.binary").write_bytes(merl_file(shiny_paint(ALPHA)))
    count, heights, azimuths, fine = 200_000, 6, 12, 40
    rng = np.random.default_rng(3)
    z = (np.arange(heights * fine) + 0.5) / (heights * fine)
    phi = (np.arange(azimuths * fine) + 0.5) / (azimuths * fine) * 2 * np.pi
    grid = directions(np.arccos(z)[:, None], phi[None]).reshape(-1, 3).astype(np.float32)
    for name in ("paint.bsdf", "paint.binary"):
        core = core_brdf(eclat.load_brdf(tmp_path / name))
        for angle in (5.0, 40.0, 75.0):
            view = directions(np.radians(angle), np.array(0.6)).astype(np.float32)
            found = core.directions(np.tile(view, (count, 1)), rng.random((count, 2), np.float32))
            up = found[found[:, 2] > 0]
            row = np.minimum((up[:, 2] * heights).astype(int), heights - 1)
            column = ((np.arctan2(up[:, 1], up[:, 0]) / (2 * np.pi)) % 1 * azimuths).astype(int) % azimuths
            observed = np.bincount(row * azimuths + column, minlength=heights * azimuths)
            density = core.eval(np.tile(view, (len(grid), 1)), grid)[1]
            cells = (
                density.reshape(heights, fine, azimuths, fine).mean(axis=(1, 3)).ravel()
                * 2
                * np.pi
                / (heights * azimuths)
            )
            expected = np.append(cells * count, (1 - cells.sum()) * count)
            observed = np.append(observed, count - len(up))
            kept = expected > 5
            statistic = ((observed - expected)[kept] ** 2 / expected[kept]).sum()
            assert scipy_stats.chi2.sf(statistic, kept.sum() - 1) > 1e-6, f"{name} at {angle}°"
