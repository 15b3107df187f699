# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of benchmarks: a wrong ratio would be believed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eclat.images.image import Image
from eclat.measure.metrics import relative_rmse
from eclat.scene import Camera, look_at
from fly_through import along, calm_pixels, flicker, seen_points
from harness import document
from harness.curves import Cost, Point, cost_at
from harness.flame_graph import Node, stacks, svg
from harness.references import Reference
from harness.timing import in_turn


def point(seconds: float, error: float, records: int = 0) -> Point:
    return Point("", seconds, error, None, records, 0, 1)


NOISY = [point(1, 0.08), point(4, 0.04), point(16, 0.02)]


def test_cost_between_points_follows_a_power_law() -> None:
    found = cost_at(NOISY, 0.04 / 2**0.25)
    assert found is not None and not found.extrapolated
    assert found.value == pytest.approx(4 * 2**0.5)


def test_cost_at_a_point_is_that_point_s() -> None:
    assert cost_at(NOISY, 0.04) == Cost(pytest.approx(4), False)  # type: ignore[arg-type]


def test_cost_beyond_the_best_point_is_extrapolated_only_where_a_slope_is_known() -> None:
    assert cost_at(NOISY, 0.01, slope=-2) == Cost(pytest.approx(64), True)  # type: ignore[arg-type]
    assert cost_at(NOISY, 0.01) is None


def test_cost_of_an_error_worse_than_all_is_the_cheapest_point_s() -> None:
    assert cost_at(NOISY, 0.5) == Cost(1, False)


def test_a_point_with_more_cost_and_a_larger_error_is_ignored() -> None:
    assert cost_at([*NOISY[:2], point(9, 0.06), NOISY[2]], 0.03) == cost_at(NOISY, 0.03)
    assert cost_at([point(1, 0.02), point(2, 0.05)], 0.03) == Cost(1, False)


def test_cost_can_be_counted_in_records() -> None:
    points = [point(1, 0.08, records=100), point(2, 0.02, records=400)]
    assert cost_at(points, 0.08 / 4**0.25, "records") == Cost(pytest.approx(100 * 2**0.5), False)  # type: ignore[arg-type]


@pytest.fixture
def truth() -> tuple[np.ndarray, Reference, np.random.Generator]:
    rng = np.random.default_rng(1)
    exact = rng.uniform(0.2, 1, (128, 128, 3))
    a, b = (exact * (1 + 0.02 * rng.standard_normal(exact.shape)) for _ in range(2))
    return exact, Reference(a, b, np.ones((128, 128), bool), 0.01, 1), rng


def picture(pixels: np.ndarray) -> Image:
    return Image(pixels.astype(np.float32))


def test_error_of_a_reference_is_the_measure_of_the_package(truth: tuple) -> None:
    exact, reference, _ = truth
    image = picture(exact * 1.05)
    everywhere, away = reference.error(image)
    assert everywhere == pytest.approx(relative_rmse(image.pixels, reference.a, reference.b, 0.01), rel=1e-6)
    assert away == everywhere


def test_error_of_a_cache_is_free_of_its_pictures_noise(truth: tuple) -> None:
    exact, reference, rng = truth
    biased = exact * 1.03
    pair = [picture(biased * (1 + 0.1 * rng.standard_normal(exact.shape))) for _ in range(2)]
    expected = relative_rmse(biased, exact, exact, 0.01)
    assert reference.cache_error(*pair) == pytest.approx(expected, rel=0.1)
    assert reference.error(pair[0])[0] > 3 * expected  # a single picture's noise counts


def test_an_error_hidden_by_noise_is_quoted_as_its_upper_bound(truth: tuple) -> None:
    _, reference, _ = truth
    everywhere, _ = reference.error(picture((reference.a + reference.b) / 2))  # its mean square comes out below zero
    assert 0 < everywhere < reference.noise / 3


def test_all_renderers_take_turns_and_stop_within_the_budget() -> None:
    calls: list[str] = []
    runs = {"ours": lambda: calls.append("ours"), "theirs": lambda: calls.append("theirs")}
    timed = in_turn(runs, 3, warm_up=False)
    assert calls == ["ours", "theirs"] * 3
    assert len(timed["ours"].rounds) == 3
    assert len(in_turn(runs, 3, warm_up=False, budget=0.0)["ours"].rounds) == 1


def test_a_table_replaces_the_text_between_its_markers(tmp_path: Path) -> None:
    path = tmp_path / "benchmarks.md"
    path.write_text("before\n<!-- x -->\nold\n<!-- end of x -->\nafter\n", encoding="utf-8")
    document.write("x", "| 1 \\g<0> |", path)
    assert path.read_text(encoding="utf-8") == "before\n<!-- x -->\n| 1 \\g<0> |\n<!-- end of x -->\nafter\n"
    with pytest.raises(ValueError, match="markers"):
        document.write("y", "", path)


SCRIPT = """\
python
\t    7f01 eclat::(anonymous namespace)::Tracer::advance(eclat::Ray&, eclat::Hit const&) (/b/_core.cpython-311.so)
\t    7f02 eclat::trace_paths(eclat::World const&, std::span<eclat::PathRay const, 8ul>) (/b/_core.cpython-311.so)
\t    7f03 tbb::detail::d1::start_for<int>::execute(tbb::detail::d1::execution_data&) (/b/_core.cpython-311.so)
\t    7f04 eclat::solve(int) (/b/_core.cpython-311.so)
\t    7f05 main (/usr/bin/python3.11)

python
\t    7f11 [unknown] (/usr/lib/libembree3.so.3)
\t    7f12 [unknown] (/usr/lib/libembree3.so.3)
\t    7f02 eclat::trace_paths(eclat::World const&) (/b/_core.cpython-311.so)
\t    7f13 [unknown] (/usr/lib/libtbb.so.12)

python
\t    7f20 cosf@@GLIBC_2.2.5 (/usr/lib/libm.so.6)
\t    7f04 eclat::solve(int) (/b/_core.cpython-311.so)
\t    7f05 main (/usr/bin/python3.11)

python
\t    7f05 main (/usr/bin/python3.11)
"""


def test_stacks_of_a_profile_start_where_the_task_does() -> None:
    assert list(stacks(SCRIPT.splitlines())) == [
        ["trace_paths", "Tracer::advance"], ["trace_paths", "Embree"], ["solve", "cosf()"], ["Python"],
    ]  # fmt: skip


def test_a_flame_graph_has_each_call_once_as_wide_as_its_share() -> None:
    root = Node()
    for stack in (["trace_paths", "Embree"], ["trace_paths"], ["trace_paths", "Embree"], ["solve", "Embree"]):
        root.add(stack)
    assert root.share("Embree") == 0.75 and root.share("solve") == 0.25
    drawn = svg(root, "a <picture>")
    assert drawn.count("<rect") == 5  # all, trace_paths, solve, and Embree in each
    assert "<title>trace_paths, 75.0 %</title>" in drawn and 'width="899.5"' in drawn
    assert "a &lt;picture&gt;" in drawn


def test_fixed_points_are_reprojected_into_another_view() -> None:
    """A plane whose light changes with the place alone: no change, no flicker, whatever the camera does."""
    base = Camera(look_at((0, 0, 3), (0, 0, 0)), fov=40)

    def frame(camera: Camera, jump: float) -> Image:
        image = Image(np.zeros((60, 80, 3), np.float32), {"depth": np.ones((60, 80)), "normal": np.zeros((60, 80, 3))})
        ahead, _ = seen_points(image, camera)  # at distance 1
        eye = np.asarray(camera.to_world)[:3, 3]
        distance = eye[2] / (eye - ahead)[..., 2]
        place = eye + distance[..., None] * (ahead - eye)
        light = 1 + 0.3 * np.sin(2 * place[..., 0]) + 0.2 * place[..., 1] + jump
        layers = {
            "depth": distance, "normal": np.broadcast_to([0.0, 0, 1], (60, 80, 3)),
            "indirect": np.repeat(light[..., None], 3, axis=2), "gloss_cached": np.ones((60, 80)),
        }  # fmt: skip
        return Image(image.pixels, layers)

    cameras = [along(base, "glossy-box-0.6", t, (80, 60)) for t in (0.3, 0.33, 0.36)]
    frames, everywhere = [frame(camera, 0) for camera in cameras], [np.ones((60, 80), bool)] * 3
    still = flicker(frames, cameras, everywhere)
    assert still["points"] > 0.8
    assert max(still["change"], still["flicker"], still["gloss_flicker"]) < 5e-4
    jumps = flicker([frame(c, j) for c, j in zip(cameras, (0, 0.1, 0), strict=True)], cameras, everywhere)
    assert jumps["change"] == pytest.approx(0.1 / 1.1, rel=0.1)
    assert jumps["flicker"] == pytest.approx(0.2 / 6**0.5 / 1.1, rel=0.1)

    lamp = Image(np.zeros((60, 80, 3), np.float32))
    lamp.pixels[20:30, 40:60] = 5
    calm = calm_pixels(frames[0], lamp)
    assert calm[25, 50] and not calm[25, 59] and not calm[25, 61] and calm[25, 62]
    assert not flicker(frames, cameras, [calm & False] * 3)["points"]
