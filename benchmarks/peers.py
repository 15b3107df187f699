# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The race: Éclat's caches against renderers that people use, on the same scenes by the same measure.

Éclat's denoised cache and denoised paths, Mitsuba 3 (path tracing), the same with Open Image Denoise, Blender's Cycles
denoised, with and without path guiding, Radiance (ambient cache), POV-Ray (radiosity) and LuxCore (PhotonGI) get the
same triangles, colours, lights and camera, each in a process of its own, and draw at several levels of quality, in turn.
A renderer that is missing, fails, or has no counterpart of what a scene holds is skipped, with the reason in the table.
Draws docs/benchmarks/peers-SCENE.svg. Also needs: apt-get install povray libllvm19, and for Cycles Python 3.11 with
pip install --no-deps bpy==5.0.1.

living-room and classroom are judged by ECLAT_SCENES/targets/SCENE-640x360.npz at that size and its half (--size 320), at
other sizes by long renders of Path(), which are made first. Cycles is judged by its own long render.

On two cores --size 256 takes about an hour, most of it for the dearest levels of Radiance, POV-Ray and LuxCore. What was
measured is stored after each scene; --resume goes on from there.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from eclat.images.image import Image
from eclat.report.svg_plot import log_log_plot
from eclat.verbs.compare import auto_exposure
from harness import document, standing
from harness.benchmark import Benchmark, Settings, main
from harness.machine import ROOT
from harness.race import Course, Judge, Judged, Runner, race, start, time_to
from harness.references import Reference, given, own, reference
from harness.scenes import BenchmarkScene
from harness.unavailable import UnavailableError
from harness.worker import Worker, WorkerError

ECLAT, GLOSSY, DENOISED = OURS = ("Éclat", "Éclat radiance-cache", "Éclat denoised")
PATHS = "Éclat Path() denoised"
ENTRANTS = {
    "eclat": (ECLAT, "harness.eclat_entrant:Entrant"),
    "glossy": (GLOSSY, "harness.eclat_entrant:Glossy"),
    "cache": (DENOISED, "harness.eclat_entrant:DenoisedCache"),
    "paths": (PATHS, "harness.eclat_entrant:DenoisedPaths"),
    "mitsuba": ("Mitsuba 3 path", "harness.mitsuba_peer:Entrant"),
    "denoised": ("Mitsuba 3 + OIDN", "harness.denoised_peer:Entrant"),
    "cycles": ("Cycles denoised", "harness.cycles_peer:Entrant"),
    "guided": ("Cycles guided, denoised", "harness.cycles_peer:Guided"),
    "radiance": ("Radiance", "harness.radiance_peer:Entrant"),
    "povray": ("POV-Ray", "harness.povray_peer:Entrant"),
    "luxcore": ("LuxCore PhotonGI", "harness.luxcore_peer:Entrant"),
}
"""Name on the command line → name in tables, and where it is."""

WANTED = (0.1, 0.05, 0.03, 0.02, 0.01)
SEEN_AT = 0.03
"""The error at whose time the FLIP of all renderers is compared."""

WANTED_FLIP = (0.05, 0.02, 0.01)
QUICK_LEVELS = 1
PAGE = ROOT / "docs" / "peers.md"


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    scene, size = place.load(), place.size_for(settings.quick, settings.side)
    found = place.given_reference(name, size)
    made = partial(reference, name, scene, size, place.c, settings.reference_samples)
    truth = made() if found is None else given(*found, scene, place.c)
    exposure = auto_exposure(Image(((truth.a + truth.b) / 2).astype(np.float32)))
    makers = {
        ENTRANTS[key][0]: partial(Worker, ENTRANTS[key][1], scene, size, settings.threads) for key in settings.peers
    }
    runners, skipped = start(makers)
    try:
        processors = settings.threads if settings.busy else None
        judge = Judge(truth, exposure, processors)
        own_judges = _own_judges(name, runners, skipped, truth, settings.reference_samples, processors)
        levels = QUICK_LEVELS if settings.quick else None
        courses = race(runners, judge, settings.repeats, levels, own_judges=own_judges)
    finally:
        for runner in runners.values():
            runner.close()
    if not any(course.levels for course in courses.values()):
        raise UnavailableError("; ".join(f"{peer}: {reason}" for peer, reason in skipped.items()) or "nothing finished")
    rows = {peer: course.as_row() for peer, course in courses.items()}
    return {
        "courses": rows, "skipped": skipped, "exposure": exposure, "reference": truth.described(), "size": size,
        "busy": settings.busy,
    }  # fmt: skip


def _own_judges(
    name: str,
    runners: dict[str, Runner],
    skipped: dict[str, str],
    truth: Reference,
    samples: int,
    processors: int | None,
) -> dict[str, Judge]:
    """Judges of the renderers that have references of their own. Renderers of one program share one.

    One whose reference is not finished goes from `runners` to `skipped`.
    """
    judges: dict[str, Judge] = {}
    for peer, runner in list(runners.items()):
        if not runner.own_truth:
            continue
        program = runner.version.split()[0].lower()

        def draw(count: int, seed: int, runner: Runner = runner) -> Any:
            return runner.truth(count, seed).pixels

        try:
            found = own(f"{program}-{name}", draw, truth, samples)
        except WorkerError as reason:
            skipped[peer] = f"its own reference: {reason}"
            del runners[peer]
            print(f"  {peer}: skipped: {skipped[peer]}", flush=True)
            continue
        exposure = auto_exposure(Image(((found.a + found.b) / 2).astype(np.float32)))
        judges[peer] = Judge(found, exposure, processors)
    return judges


def courses_of(scene: dict[str, Any]) -> dict[str, Course]:
    """Of one scene of a result."""
    return {name: Course.from_row(row) for name, row in scene["courses"].items()}


def tables(result: dict[str, Any]) -> str:
    parts = [
        "### Éclat's time over that of others", _ratios(result),
        f"### FLIP when Éclat has reached {100 * SEEN_AT:g} %", _flips(result),
        "### Time to an error, all pixels", _times(result, WANTED, "error"),
        "### Time to an error, away from edges", _times(result, WANTED, "error_away"),
        "### Time to a FLIP", _times(result, WANTED_FLIP, "flip"),
        "### Where another renderer is faster", losses(result),
        "### Error against time",
        "\n".join(f"![{name}: error against time](benchmarks/peers-{name}.svg)" for name in result["scenes"]),
        "### Every level", _levels(result),
        "### What did not take part", _missing(result),
        "### Versions", _versions(result),
    ]  # fmt: skip
    return "\n\n".join(parts)


def _ratios(result: dict[str, Any]) -> str:
    rows = [
        row for name, scene in result["scenes"].items()
        for row in standing.ratio_rows(name, courses_of(scene), OURS, PATHS, WANTED)
    ]  # fmt: skip
    header = ["scene", "error", "Éclat's cache", "best other program", "ratio", "Éclat's paths, denoised", "ratio"]
    return document.table(header, rows)


def _flips(result: dict[str, Any]) -> str:
    rows = [
        row for name, scene in result["scenes"].items()
        for row in standing.flip_rows(name, courses_of(scene), OURS, SEEN_AT)
    ]  # fmt: skip
    return document.table(["scene", "time", "renderer", "FLIP"], rows) if rows else "Éclat reached it in no scene."


def _times(result: dict[str, Any], wanted: tuple[float, ...], measure: str) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        for peer, course in courses_of(scene).items():
            rows.append([name, peer, *(_time(course, value, measure) for value in wanted)])
    heads = [f"{value:g}" if measure == "flip" else f"{100 * value:g} %" for value in wanted]
    return document.table(["scene", "renderer", *heads], rows)


def _time(course: Course, wanted: float, measure: str) -> str:
    if not any(getattr(level, measure) is not None for level in course.levels):
        return "not measured"
    cost, at_once = time_to(course, wanted, measure)
    return "not reached" if cost is None else ("≤ " if at_once else "") + document.seconds(cost.value)


def losses(result: dict[str, Any]) -> str:
    """A sentence for every scene and error at which Éclat is not the fastest, made from the measurements."""
    lines = []
    for name, scene in result["scenes"].items():
        courses = courses_of(scene)
        if ECLAT not in courses or len(courses) < 2:
            continue
        for wanted in WANTED:
            found = {peer: cost.value for peer, c in courses.items() if (cost := time_to(c, wanted)[0]) is not None}
            ours = min((found.pop(name) for name in OURS if name in found), default=None)
            if not found or (ours is not None and ours <= min(found.values())):
                continue
            best = min(found, key=lambda peer: found[peer])
            time = "does not reach it" if ours is None else f"takes {document.seconds(ours)}"
            lines.append(f"- {name}, {100 * wanted:g} %: {best} takes {document.seconds(found[best])}, Éclat {time}.")
    return "\n".join(lines) or "At no error of the table, on no scene of this run."


def _levels(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        for peer, course in courses_of(scene).items():
            rows += [_level(name, peer, level) for level in course.levels]
    header = ["scene", "renderer", "level", "time", "rounds", "error", "away from edges", "FLIP", "mean : reference"]
    return document.table(header, rows)


def _level(scene: str, peer: str, level: Judged) -> list[str]:
    seen = "not measured" if level.flip is None else f"{level.flip:.4f}"
    return [
        scene, peer, level.label, document.seconds(level.seconds), str(len(level.rounds)),
        document.percent(level.error), document.percent(level.error_away), seen, f"{level.mean_ratio:.4f}",
    ]  # fmt: skip


def _missing(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        rows += [[name, peer, reason.splitlines()[0]] for peer, reason in scene["skipped"].items()]
        rows += [[name, peer, c.stopped.splitlines()[0]] for peer, c in courses_of(scene).items() if c.stopped]
    return document.table(["scene", "renderer", "reason"], rows) if rows else "All renderers drew all scenes."


def _versions(result: dict[str, Any]) -> str:
    busy = [
        f"{name}: times are processor time over threads, because the machine did other work"
        for name, scene in result["scenes"].items()
        if scene.get("busy")
    ]
    versions = {peer: row["version"] for scene in result["scenes"].values() for peer, row in scene["courses"].items()}
    named = [f"{peer}: {version}" for peer, version in versions.items()]
    shown = [
        f"{name}: {scene['size'][0]} × {scene['size'][1]}, reference {_samples(scene)} with "
        f"{document.percent(scene['reference']['noise'])} noise, FLIP at {scene['exposure']:+g} stops"
        for name, scene in result["scenes"].items()
    ]
    return "\n".join(f"- {line}" for line in [*named, *shown, *busy])


def _samples(scene: dict[str, Any]) -> str:
    samples = scene["reference"]["samples"]
    return f"{samples} samples a half" if samples else "that came with the scene,"


def plots(result: dict[str, Any]) -> dict[str, str]:
    return {
        f"peers-{name}": log_log_plot(
            {peer: [(v.seconds, v.error) for v in course.levels] for peer, course in courses_of(scene).items()},
            "seconds",
            f"{name}: error",
            lambda error: f"{100 * error:g} %",
        )
        for name, scene in result["scenes"].items()
    }


BENCHMARK = Benchmark(
    "peers", __doc__, ("cornell-box", "glossy-box", "sponza", "door-ajar", "sibenik-painted"), run, tables, plots,
    reference_samples=1024, page=PAGE, peers=tuple(ENTRANTS), side=512,
)  # fmt: skip

if __name__ == "__main__":
    main(BENCHMARK)
