# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The race of benchmarks/peers.py: its arithmetic on made-up entrants, and that each peer is given our scene."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
import peers
from eclat.images.image import Image
from eclat.scene import Material, Mesh, Scene, Texture, Value
from harness import benchmark, povray_peer, radiance_peer, references, scenes, standing
from harness.entrant import Picture
from harness.lamps import lamps
from harness.luxcore_peer import scene_properties
from harness.mitsuba_materials import texels
from harness.painted import mean_colour, painted
from harness.race import Course, Judge, Judged, flip_at, race, time_to
from harness.references import Reference
from harness.unavailable import UnavailableError
from harness.worker import Worker, WorkerError

SIZE = (32, 32)


class Scripted:
    """An entrant whose pictures are the truth times a factor; a level of None fails."""

    version = "scripted 1"
    own_truth = False

    def __init__(self, log: list[str], name: str, factors: list[float | None], unbiased: bool = False) -> None:
        self.log, self.name, self.factors, self.unbiased = log, name, factors, unbiased
        self.levels = tuple(f"level {i}" for i in range(len(factors)))

    def render(self, level: int) -> Picture:
        self.log.append(f"{self.name}{level}")
        factor = self.factors[level]
        if factor is None:
            raise WorkerError("broken")
        return Picture(np.full((16, 16, 3), 0.5 * factor, np.float32), 2.0**level)

    def truth(self, samples: int, seed: int) -> Picture:
        raise AssertionError("it has none")

    def close(self) -> None:
        raise AssertionError("the race does not own its runners")


@pytest.fixture
def judge() -> Judge:
    truth = np.full((16, 16, 3), 0.5)
    return Judge(Reference(truth, truth, np.ones((16, 16), bool), 0.0, 64), 0.0)


def test_entrants_draw_in_turn_and_are_judged_by_the_measure(judge: Judge) -> None:
    log: list[str] = []
    runners = {"a": Scripted(log, "a", [1.1, 1.02]), "b": Scripted(log, "b", [0.7])}
    courses = race(runners, judge, 2)
    assert log == ["a0", "b0", "a0", "b0", "a1", "a1"]
    first, second = courses["a"].levels
    assert first.error == pytest.approx(0.1, rel=1e-5) and second.error == pytest.approx(0.02, rel=1e-4)
    assert first.mean_ratio == pytest.approx(1.1) and first.error_away == first.error
    assert (second.seconds, second.rounds) == (2.0, (2.0, 2.0))


def test_a_renderer_that_fails_keeps_its_pictures_and_stops(judge: Judge) -> None:
    log: list[str] = []
    courses = race({"a": Scripted(log, "a", [1.1, None, 1.01])}, judge, 1)
    assert [level.label for level in courses["a"].levels] == ["level 0"]
    assert courses["a"].stopped == "level 1: broken"
    assert log == ["a0", "a1"]


def test_an_unbiased_renderer_with_another_mean_renders_another_scene(judge: Judge) -> None:
    courses = race({"a": Scripted([], "a", [1.02], unbiased=True), "b": Scripted([], "b", [1.009], True)}, judge, 1)
    assert not courses["a"].levels and "not the same scene" in courses["a"].stopped
    assert courses["b"].levels and not courses["b"].stopped


def test_noise_widens_the_tolerance_for_an_unbiased_mean(judge: Judge) -> None:
    rng = np.random.default_rng(1)
    noisy = 0.5 * (1 + rng.standard_normal((16, 16, 3)))
    noisy *= 0.5 * 1.04 / noisy.mean()
    assert judge.mismatch(noisy) == ""
    assert judge.mismatch(np.full((16, 16, 3), 0.52)) != ""


def test_on_a_busy_machine_the_processor_s_time_counts(judge: Judge) -> None:
    picture = Picture(np.full((16, 16, 3), 0.5, np.float32), 9.0, 6.0)
    assert judge("level", [picture]).seconds == 9
    assert Judge(judge.truth, 0.0, processors=2)("level", [picture]).seconds == 3


def test_a_renderer_with_a_reference_of_its_own_is_judged_by_it(judge: Judge) -> None:
    darker = np.full((16, 16, 3), 0.45)
    own_judge = Judge(Reference(darker, darker, np.ones((16, 16), bool), 0.0, 64), 0.0)
    runners = {"a": Scripted([], "a", [0.9]), "b": Scripted([], "b", [0.9])}
    courses = race(runners, judge, 1, own_judges={"b": own_judge})
    assert courses["a"].levels[0].error == pytest.approx(0.1, rel=1e-5)
    assert courses["b"].levels[0].error == pytest.approx(0, abs=1e-6)


def test_a_renderer_whose_own_reference_fails_is_skipped(
    judge: Judge, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Slow(Scripted):
        own_truth = True

        def truth(self, samples: int, seed: int) -> Picture:
            raise WorkerError("no answer")

    monkeypatch.setattr(references, "FOLDER", tmp_path)
    runners: dict[str, Any] = {"a": Scripted([], "a", [1.0]), "b": Slow([], "b", [1.0])}
    skipped: dict[str, str] = {}
    assert peers._own_judges("room", runners, skipped, judge.truth, 64, None) == {}
    assert list(runners) == ["a"] and skipped == {"b": "its own reference: no answer"}


def course(*points: tuple[float, float]) -> Course:
    levels = [Judged(f"{s} s", s, (s,), e, e / 2, None, 1.0) for s, e in points]
    return Course("1", False, levels)


def test_times_are_interpolated_between_levels_and_not_extrapolated() -> None:
    measured = course((1, 0.08), (4, 0.04), (16, 0.02))
    cost, at_once = time_to(measured, 0.02 * 2**0.5)
    assert cost is not None and cost.value == pytest.approx(8) and not at_once
    assert time_to(measured, 0.01) == (None, False)
    assert time_to(measured, 0.1)[1]
    away, _ = time_to(measured, 0.01, "error_away")
    assert away is not None and away.value == pytest.approx(16)
    assert time_to(measured, 0.01, "flip") == (None, False)


def flips(*points: tuple[float, float]) -> Course:
    return Course("1", False, [Judged(f"{s} s", s, (s,), 0.1 / s, 0.1 / s, flip, 1.0) for s, flip in points])


def test_flip_at_a_time_is_between_levels_and_never_before_the_first() -> None:
    measured = flips((1, 0.08), (4, 0.04), (16, 0.05))
    assert flip_at(measured, 0.5) is None
    assert flip_at(measured, 2) == pytest.approx(0.08 * 0.5**0.5)
    assert flip_at(measured, 4) == pytest.approx(0.04) and flip_at(measured, 100) == pytest.approx(0.04)
    assert flip_at(course((1, 0.1)), 2) is None


def test_ratios_are_of_the_fastest_and_bounds_where_a_first_level_is_better() -> None:
    courses = {
        "Éclat": course((2, 0.08), (8, 0.04)), "Éclat paths": course((1, 0.16), (16, 0.04)),
        "slow": course((64, 0.02)), "fast": course((4, 0.05), (32, 0.04)),
    }  # fmt: skip
    ((scene, error, ours, other, ratio, paths, over_paths),) = standing.ratio_rows(
        "room", courses, ["Éclat"], "Éclat paths", [0.04]
    )
    assert (scene, error) == ("room", "4.00 %")
    assert (ours, other, ratio) == ("8 s (Éclat)", "32 s (fast)", "0.25 ×")
    assert (paths, over_paths) == ("16 s (Éclat paths)", "0.50 ×")
    (row,) = standing.ratio_rows("room", courses, ["Éclat"], "Éclat paths", [0.02])
    assert row[2:5] == ["not reached", "≤ 64 s (slow)", ""]
    (row,) = standing.ratio_rows("room", courses, ["Éclat"], "Éclat paths", [0.1])
    assert row[2:5] == ["≤ 2 s (Éclat)", "≤ 4 s (fast)", "about 0.50 ×"]
    assert standing.ratio_rows("room", courses, ["Éclat"], "Éclat paths", [0.001]) == []
    shown = standing.flip_rows(
        "room", {"Éclat": flips((1, 0.08), (4, 0.04)), "late": flips((9, 0.01))}, ["Éclat"], 0.05
    )
    assert shown == [["room", "2 s", "Éclat", "0.0566"], ["room", "2 s", "late", "no picture yet"]]


@pytest.fixture
def result() -> dict[str, Any]:
    courses = {
        "Éclat": course((1, 0.04), (4, 0.008)).as_row(),
        "Radiance": course((3, 0.04), (30, 0.02)).as_row(),
        "Mitsuba 3 + OIDN": replace(course((0.5, 0.03)), stopped="64 samples: broken").as_row(),
    }
    scene = {
        "courses": courses, "skipped": {"POV-Ray": "not installed\nat all"}, "exposure": 1.5,
        "reference": {"samples": 64, "noise": 0.01}, "size": [64, 64],
    }  # fmt: skip
    return {"scenes": {"cornell-box": json.loads(json.dumps(scene))}}


def test_tables_show_unreached_errors_and_missing_renderers(result: dict[str, Any]) -> None:
    text = peers.tables(result)
    assert "| cornell-box | Radiance | ≤ 3 s | ≤ 3 s | 7.8 s | 30 s | not reached |" in text
    assert "| cornell-box | POV-Ray | not installed |" in text
    assert "| cornell-box | Mitsuba 3 + OIDN | 64 samples: broken |" in text
    assert "not measured" in text  # FLIP


def test_warnings_about_losses_depend_on_the_data(result: dict[str, Any]) -> None:
    said = peers.losses(result)
    assert said.splitlines() == [
        "- cornell-box, 10 %: Mitsuba 3 + OIDN takes 0.5 s, Éclat takes 1 s.",
        "- cornell-box, 5 %: Mitsuba 3 + OIDN takes 0.5 s, Éclat takes 1 s.",
        "- cornell-box, 3 %: Mitsuba 3 + OIDN takes 0.5 s, Éclat takes 1.28 s.",
    ]
    assert set(peers.plots(result)) == {"peers-cornell-box"}


def test_a_result_is_resumed_only_by_the_same_run(tmp_path: Path) -> None:
    result = {"settings": {"side": 64}, "machine": {"commit": "a"}, "scenes": {}}
    path = tmp_path / "peers.json"
    assert benchmark._stored(path, result) == {}
    path.write_text(json.dumps({**result, "scenes": {"x": {}}}))
    assert benchmark._stored(path, result) == {"x": {}}
    assert benchmark._stored(path, {**result, "machine": {"commit": "b"}}) == {}
    assert benchmark._stored(path, {**result, "settings": {"side": 32}}) == {}


def test_a_worker_answers_fails_and_dies_alone() -> None:
    scene = eclat.load("cornell-box")
    place = "support.peers:Obedient"
    worker = Worker(place, scene, (4, 2), 1)
    assert worker.levels == ("draw", "raise", "die") and not worker.unbiased
    picture = worker.render(0)
    assert picture.pixels.shape == (2, 4, 3) and picture.seconds == 0.5
    assert picture.processor is not None and picture.processor >= 0
    with pytest.raises(WorkerError, match="ended with code 7"):
        worker.render(2)
    with pytest.raises(UnavailableError, match="no meshes"):
        Worker(place, Scene(), (4, 2), 1)


def test_lamps_of_a_quad_a_box_and_a_disc() -> None:
    (quad,) = lamps(eclat.load("cornell-box").meshes[0])
    assert not quad.circular and quad.area == pytest.approx(0.46 * 0.38)
    assert quad.normal == pytest.approx([0, -1, 0], abs=1e-6) and quad.centre == pytest.approx(
        [0, 0.99, 0.01], abs=1e-6
    )
    corners = quad.corners()
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    assert normal[1] == pytest.approx(-0.46 * 0.38) and np.ptp(corners, axis=0) == pytest.approx(
        [0.46, 0, 0.38], abs=1e-6
    )
    box = lamps(next(mesh for mesh in eclat.load("door-ajar").meshes if mesh.name == "lamp"))
    assert len(box) == 6 and sum(face.area for face in box) == pytest.approx(2 * (0.8 * 3.4 + 0.05 * (0.8 + 3.4)))
    angles = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    rim = np.stack([2 * np.cos(angles), np.full(48, 3), 2 * np.sin(angles)], axis=1)
    fan = np.array([(48, (i + 1) % 48, i) for i in range(48)])
    (disc,) = lamps(Mesh(np.vstack([rim, [(0, 3, 0)]]), fan, Material()))
    assert disc.circular and disc.normal == pytest.approx([0, 1, 0])
    assert np.linalg.norm(disc.across) == pytest.approx(2 * np.sqrt(disc.area / np.pi))
    with pytest.raises(UnavailableError, match="neither"):
        lamps(Mesh(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float), np.array([(0, 1, 2)]), Material()))


def test_texels_hold_factor_channel_and_decoding() -> None:
    image = np.array([[(0, 255, 128, 51), (255, 0, 0, 255)]], np.uint8)
    colours = texels(Value((0.5, 1.0, 1.0), Texture(image, srgb=True)))
    assert colours[0] == pytest.approx(np.array([(0, 1, 0.2158605), (0.5, 0, 0)]), abs=1e-5)
    alpha = texels(Value((1.0, 1.0, 1.0), Texture(image, srgb=True), channel=3, invert=True))
    assert alpha[0, :, 0] == pytest.approx([0.8, 0])


def test_a_given_reference_is_averaged_over_the_pixels_that_ours_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(5)
    a, b = rng.uniform(0, 1, (2, 12, 12, 3)).astype(np.float32)
    (tmp_path / "targets").mkdir()
    np.savez(tmp_path / "targets" / "box-12x12.npz", A=a, B=b)
    monkeypatch.setattr(scenes, "FOLDER", tmp_path)
    place = scenes.BenchmarkScene("cornell-box", (12, 12))
    assert place.given_reference("box", (5, 5)) is None and place.given_reference("other", (4, 4)) is None
    found = place.given_reference("box", (4, 4))
    assert found is not None
    truth = references.given(*found, eclat.load("cornell-box"), None)
    assert truth.a[1, 2] == pytest.approx(a[3:6, 6:9].mean(axis=(0, 1)), rel=1e-6)
    assert truth.b.shape == (4, 4, 3) and truth.away.shape == (4, 4)


def test_an_own_reference_grows_by_parts_and_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(references, "FOLDER", tmp_path)
    like = Reference(np.zeros((2, 3, 3)), np.zeros((2, 3, 3)), np.ones((2, 3), bool), 0.0, 64)
    seeds: list[int] = []

    def draw(samples: int, seed: int) -> np.ndarray:
        seeds.append(seed)
        return np.full((2, 3, 3), float(len(seeds)), np.float32)

    first = references.own("theirs", draw, like, references.CHUNK)
    assert len(set(seeds)) == 2 and first.a.max() == 1 and first.b.max() == 2
    second = references.own("theirs", draw, like, 2 * references.CHUNK)
    assert len(set(seeds)) == 4 and second.samples == 2 * references.CHUNK
    assert second.a.max() == pytest.approx((1 + 3) / 2) and second.b.max() == pytest.approx((2 + 4) / 2)


def test_paint_is_the_mean_of_the_texels_in_linear_light() -> None:
    image = np.array([[(0, 0, 0), (255, 255, 255)]], np.uint8)
    assert mean_colour(Value((0.5, 1.0, 1.0), Texture(image, srgb=True))).constant == pytest.approx((0.25, 0.5, 0.5))
    glossy = painted(eclat.load("glossy-box"))
    assert {mesh.material.kind for mesh in glossy.meshes} == {"diffuse"}
    assert glossy.meshes[1].material.parameters["reflectance"].constant == (0.8, 0.8, 0.8)
    assert glossy.meshes[0].material.emission is not None


def test_features_that_a_peer_cannot_model_are_named() -> None:
    scene = eclat.load("glossy-box")
    for refuse in (
        lambda: radiance_peer.describe(scene),
        lambda: povray_peer.describe(scene, SIZE, povray_peer.LEVELS[0]),
        lambda: scene_properties(scene, SIZE),
    ):
        with pytest.raises(UnavailableError, match="'gloss' is conductor"):
            refuse()


def test_a_sun_in_radiance_gives_its_irradiance() -> None:
    scene = replace(
        eclat.load("cornell-box"), lights=(eclat.scene.DirectionalLight((0.0, -1.0, 0.0), (20.0, 18.0, 15.0)),)
    )
    lines = radiance_peer.describe(scene).splitlines()
    radiance = float(lines[lines.index("void light sun0") + 3].split()[1])
    degrees = float(lines[lines.index("sun0 source disc0") + 3].split()[4])
    assert radiance * np.pi * np.sin(np.radians(degrees / 2)) ** 2 == pytest.approx(20, rel=1e-4)


def drawn(place: str, name: str, size: tuple[int, int] = SIZE, level: int = 0) -> np.ndarray:
    """A peer's picture of a built-in scene; skips where the peer is missing."""
    try:
        worker = Worker(place, eclat.load(name), size, 2)
    except UnavailableError as reason:
        pytest.skip(str(reason))
    try:
        return worker.render(level).pixels
    finally:
        worker.close()


def reference_of(name: str, size: tuple[int, int] = SIZE, **options: Any) -> np.ndarray:
    return eclat.render(eclat.load(name), eclat.Path(), samples=256, size=size, seed=3, **options).pixels


def beside_the_lamp(ours: np.ndarray) -> np.ndarray:
    """Pixels that are lit and two pixels from the lamp, whose rim few rays a pixel do not resolve."""
    brightest = ours.max(axis=-1)
    padded = np.pad(brightest, 2)
    height, width = brightest.shape
    around = [padded[y : y + height, x : x + width] for y in range(5) for x in range(5)]
    return np.asarray((np.max(around, axis=0) < 2) & (brightest > 0.02))


def ratio_beside_the_lamp(theirs: np.ndarray, ours: np.ndarray) -> float:
    counted = beside_the_lamp(ours)
    return float(theirs[counted].mean() / ours[counted].mean())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cornell-box", "glossy-box", "door-ajar"])
def test_mitsuba_draws_our_scene(name: str) -> None:
    """Normals of vertices and rough metal are given to it too."""
    theirs, ours = drawn("harness.mitsuba_peer:Entrant", name, level=2), reference_of(name)
    truth = Reference(ours, ours, np.ones(ours.shape[:2], bool), None, 256)
    assert Judge(truth, 0.0).mismatch(theirs) == ""


@pytest.mark.slow
def test_cycles_draws_our_box_and_tells_where_it_is_missing() -> None:
    """Diffuse surfaces of one colour are the same in Blender."""
    ours = reference_of("cornell-box")
    theirs = drawn("harness.cycles_peer:Entrant", "cornell-box", level=2)
    assert ratio_beside_the_lamp(theirs, ours) == pytest.approx(1, abs=0.03)


@pytest.mark.slow
def test_the_denoiser_keeps_the_mean_and_takes_the_noise() -> None:
    ours = reference_of("cornell-box")
    noisy, theirs = (drawn(f"harness.{peer}_peer:Entrant", "cornell-box", level=1) for peer in ("mitsuba", "denoised"))
    assert ratio_beside_the_lamp(theirs, ours) == pytest.approx(1, abs=0.03)
    counted = beside_the_lamp(ours)
    assert np.abs(theirs - ours)[counted].mean() < 0.7 * np.abs(noisy - ours)[counted].mean()


@pytest.mark.slow
def test_radiance_draws_our_direct_light() -> None:
    theirs = drawn("support.peers:RadianceDirect", "cornell-box")
    assert ratio_beside_the_lamp(theirs, reference_of("cornell-box", max_depth=2)) == pytest.approx(1, abs=0.03)


@pytest.mark.slow
def test_povray_draws_our_direct_light() -> None:
    theirs = drawn("support.peers:POVRayDirect", "cornell-box")
    assert ratio_beside_the_lamp(theirs, reference_of("cornell-box", max_depth=2)) == pytest.approx(1, abs=0.05)


@pytest.mark.slow
def test_luxcore_draws_our_scene() -> None:
    theirs = drawn("support.peers:LuxCorePaths", "cornell-box", level=1)
    ours = reference_of("cornell-box")
    assert ratio_beside_the_lamp(theirs, ours) == pytest.approx(1, abs=0.03)
    assert Image(theirs).pixels.shape == ours.shape
