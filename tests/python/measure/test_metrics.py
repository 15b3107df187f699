# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The measure of all our figures, against its definition."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.measure import metrics
from eclat.measure.metrics import away_from_edges, flip, relative_rmse, signed_error

RANDOM = np.random.default_rng(11)
TRUTH = RANDOM.uniform(0.1, 2.0, (24, 32, 3))


def test_the_definition_pixel_by_pixel() -> None:
    x, a, b = (TRUTH + RANDOM.normal(0, 0.05, TRUTH.shape) for _ in range(3))
    c, total = 0.01, 0.0
    for pixel in np.ndindex(TRUTH.shape):
        reference = (a[pixel] + b[pixel]) / 2
        total += (x[pixel] - a[pixel]) * (x[pixel] - b[pixel]) / (reference**2 + c)
    assert relative_rmse(x, a, b, c) == pytest.approx(math.sqrt(total / TRUTH.size), rel=1e-12)


def test_noise_of_the_references_does_not_bias_the_error() -> None:
    """x is off by 0.1 %, the references are noisy by 1 %: with one of them the noise hides the error."""
    truth = np.full((400, 400, 3), 0.5)
    a, b = (truth * (1 + RANDOM.normal(0, 0.01, truth.shape)) for _ in range(2))
    x = truth * 1.001
    assert relative_rmse(x, a, b, c=0.0) == pytest.approx(0.001, rel=0.15)
    assert relative_rmse(x, a, a, c=0.0) == pytest.approx(0.01, rel=0.05)


def test_a_negative_mean_counts_as_an_error_of_zero() -> None:
    assert relative_rmse(TRUTH, TRUTH + 0.1, TRUTH - 0.1) == 0.0


def test_exposure_cancels_by_default_and_not_with_a_fixed_c() -> None:
    x = TRUTH * RANDOM.uniform(0.9, 1.1, TRUTH.shape)
    assert relative_rmse(64 * x, 64 * TRUTH, 64 * TRUTH) == pytest.approx(relative_rmse(x, TRUTH, TRUTH))
    assert relative_rmse(64 * x, 64 * TRUTH, 64 * TRUTH, 0.01) != pytest.approx(relative_rmse(x, TRUTH, TRUTH, 0.01))


def test_a_mask_selects_pixels_but_does_not_change_c() -> None:
    x = TRUTH.copy()
    x[:, 16:] *= 2
    left = np.zeros((24, 32), dtype=bool)
    left[:, :16] = True
    assert relative_rmse(x, TRUTH, TRUTH, mask=left) == 0
    reference = relative_rmse(x, TRUTH, TRUTH)
    assert relative_rmse(x, TRUTH, TRUTH, mask=~left) == pytest.approx(reference * math.sqrt(2), rel=0.05)


def test_black_on_black_is_right() -> None:
    black = np.zeros((2, 2, 3))
    assert relative_rmse(black, black, black) == 0
    assert signed_error(black, black).max() == 0


def test_nan_is_not_hidden() -> None:
    x = TRUTH.copy()
    x[3, 4, 1] = np.nan
    assert math.isnan(relative_rmse(x, TRUTH, TRUTH))


def test_shapes_that_differ() -> None:
    with pytest.raises(EclatError) as caught:
        relative_rmse(TRUTH, TRUTH, TRUTH[:3])
    assert str(caught.value) == (
        "metrics: expected pictures of the same shape (height, width, 3), got (24, 32, 3), (24, 32, 3), (3, 32, 3)"
    )
    with pytest.raises(EclatError, match="expected a mask that includes at least one pixel"):
        relative_rmse(TRUTH, TRUTH, TRUTH, mask=np.zeros((24, 32), dtype=bool))


def test_signed_error_has_the_sign_of_brightness() -> None:
    error = signed_error(np.full((1, 1, 3), 1.1), np.ones((1, 1, 3)), c=0.0)
    assert error == pytest.approx(np.array([[0.1]]))
    assert signed_error(np.full((1, 1, 3), 0.9), np.ones((1, 1, 3)), c=0.0)[0, 0] < 0


def flat(height: int = 11, width: int = 11) -> tuple[np.ndarray, np.ndarray]:
    return np.full((height, width), 2.0), np.broadcast_to([0.0, 0.0, 1.0], (height, width, 3)).copy()


def test_a_flat_wall_has_no_edges() -> None:
    assert away_from_edges(*flat()).all()


@pytest.mark.parametrize(("step", "is_edge"), [(0.019, False), (0.021, True)])
def test_a_step_in_depth_takes_two_pixels_on_both_sides(step: float, is_edge: bool) -> None:
    depth, normal = flat()
    depth[:, 5:] *= 1 + step
    away = away_from_edges(depth, normal)
    expected = np.ones((11, 11), dtype=bool)
    if is_edge:
        expected[:, 3:7] = False
    np.testing.assert_array_equal(away, expected)


@pytest.mark.parametrize(("degrees", "is_edge"), [(9.9, False), (10.1, True)])
def test_irradiance_follows_a_rotation_of_the_normal(degrees: float, is_edge: bool) -> None:
    depth, normal = flat()
    angle = math.radians(degrees)
    normal[:5] = (0, 3 * math.sin(angle), 3 * math.cos(angle))
    away = away_from_edges(depth, normal)
    assert away[3:7].any() != is_edge
    assert away[:3].all() and away[7:].all()


@pytest.mark.parametrize("nothing", [np.inf, 0.0])
def test_the_rim_of_a_hole_into_empty_space(nothing: float) -> None:
    depth, normal = flat()
    depth[5, 5] = nothing
    normal[5, 5] = 0
    away = away_from_edges(depth, normal)
    expected = np.ones((11, 11), dtype=bool)
    expected[3:8, 3:8] = False
    np.testing.assert_array_equal(away, expected)


def test_an_empty_picture_has_no_edges() -> None:
    assert away_from_edges(np.full((4, 4), np.inf), np.zeros((4, 4, 3))).all()


def test_edges_need_both_layers_of_one_size() -> None:
    with pytest.raises(EclatError, match=r"expected depth \(H, W\) and normals \(H, W, 3\), got \(4, 4\) and \(4, 4\)"):
        away_from_edges(np.zeros((4, 4)), np.zeros((4, 4)))


def test_flip_of_the_same_and_of_the_opposite() -> None:
    pytest.importorskip("flip_evaluator")
    white, black = np.ones((32, 48, 3)), np.zeros((32, 48, 3))
    error, mean = flip(white, white)
    assert error.shape == (32, 48) and mean == 0
    assert flip(black, white)[1] > 0.5


def test_flip_sees_what_the_exposure_shows() -> None:
    pytest.importorskip("flip_evaluator")
    dark, darker = np.full((32, 32, 3), 0.001), np.full((32, 32, 3), 0.0005)
    assert flip(dark, darker, exposure=8)[1] > 3 * flip(dark, darker)[1]


def test_without_the_package_flip_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    assert not metrics.has_flip()
    with pytest.raises(EclatError) as caught:
        flip(TRUTH, TRUTH)
    assert str(caught.value) == (
        "FLIP needs the package flip-evaluator, which is not installed: pip install flip-evaluator"
    )
