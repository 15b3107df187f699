# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat solve`: the records of a scene, computed once and kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.method_options import DEFAULT_METHOD, method_notes, method_option, options_of, set_option
from eclat.cli.partial import keep_partial_option, keeping_partial
from eclat.cli.point_files import read_points
from eclat.cli.quality_options import max_depth_option, max_error_option, no_check_option, output_option, refine_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    camera_index,
    camera_options,
    light_options,
    load_scene,
    material_option,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.error_estimate import error_text
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable

EXAMPLES = {
    "eclat solve room.glb": "Writes room.npz:",
    "eclat solve room.glb -o fine.npz --max-error 0.005": "Finer records:",
    "eclat solve room.glb --method radiance-cache": "Glossy surfaces from records as well:",
    "eclat solve room.glb --method radiosity": "Radiosity of all surfaces, for all views:",
    "eclat render room.glb --cache fine.npz --samples 64": "Read them; the scene must be the same:",
    "eclat solve room.glb --cache room.npz --refine --max-error 0.003": "Go on from there until that is met:",
    "eclat solve room.glb --view-independent": "For views that are not chosen yet:",
    "eclat solve room.glb --points desks.csv": "For points with normals, as `eclat irradiance` takes them:",
}


CACHES = (DEFAULT_METHOD, "radiance-cache")
"""Methods whose records can be kept."""

KEPT = (*CACHES, "radiosity")
"""Methods whose solutions can be kept."""


@click.command(
    "solve",
    cls=Command,
    short_help="Compute the records of a scene and keep them.",
    examples=EXAMPLES,
    notes=lambda: method_notes(*KEPT),
    help="""Compute the irradiance records that a view of SCENE needs (or points, or all surfaces), and keep them.

    The file is a NumPy .npz archive with positions, normals, radii, irradiance and its gradients; `eclat render
    --cache` and `eclat.Solution.load` read it. A scene that has changed since is refused.""",
)
@scene_argument
@output_option("A file ending in .npz [SCENE.npz].")
@keep_partial_option("On Ctrl-C write the records of the passes that are done, if any, marked incomplete.")
@option("--view-independent", is_flag=True, section="Input", help="Records on all surfaces instead of in a view.")
@option("--points", metavar="FILE", section="Input", help="Records for points x y z nx ny nz; text, .csv or .npy.")
@max_error_option("Relative error of indirect light")
@max_depth_option()
@no_check_option()
@refine_option("Go on until the estimated error meets --max-error.")
@option("--cache", metavar="FILE", section="Input", help="Refine these records, which `eclat solve` wrote.")
@method_option
@set_option
@camera_options
@light_options
@material_option
@work_options
@reporting_options
def command(**flags: Any) -> None:
    """Solve and save."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or f"{scene_stem(flags['scene'])}.npz"
        if Path(output).suffix.lower() != ".npz":
            raise EclatError(f"{output}: expected a name that ends in .npz")
        check_writable(output)
        options = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        if isinstance(options, eclat.Radiosity):
            return _solve_radiosity(reporter, options, output, flags)
        if not isinstance(options, eclat.IrradianceCache):
            raise EclatError(f"--method: expected one of {', '.join(KEPT)}, got {flags['method']!r}")
        points = read_points(flags["points"]) if flags["points"] else None
        if points is not None and flags["view_independent"]:
            raise EclatError("--points: expected no --view-independent beside it")
        scene = load_scene(flags)
        where: dict[str, Any] = {"points": points, "view_independent": flags["view_independent"]}
        if points is None and not flags["view_independent"]:
            where |= {"camera": camera_index(scene, flags["camera"]), "size": flags["size"]}
        elif flags["camera"] is not None or flags["size"] is not None:
            raise EclatError("--camera, --size: expected neither beside --points or --view-independent")
        if flags["cache"] and not flags["refine"]:
            raise EclatError("--cache: expected --refine beside it, since records are solved anew without")
        if flags["cache"] and flags["settings"]:
            raise EclatError("--cache: expected no --set beside it, since the cache brings its own")
        common = {name: flags[name] for name in ("max_depth", "seed", "threads", "keep_partial", "check", "refine")}

        def keep(solution: eclat.Solution) -> None:
            solution.save(output)
            _say_result(reporter, solution, output)

        with keeping_partial(flags["keep_partial"], keep, reporter):
            if flags["cache"]:
                start = eclat.Solution.load(flags["cache"], scene)
                where |= {"seed": flags["seed"], "threads": flags["threads"], "progress": reporter.progress}
                solution = eclat.refine(start, scene, flags["max_error"], **where)
            else:
                solution = eclat.solve(scene, options, progress=reporter.progress, **where, **common)
        keep(solution)


def _solve_radiosity(reporter: Reporter, options: eclat.Radiosity, output: str, flags: dict[str, Any]) -> None:
    for name in ("points", "view_independent", "camera", "size", "cache", "refine", "keep_partial"):
        if flags[name]:
            flag = name.replace("_", "-")
            raise EclatError(f"--{flag}: expected a method with records, since radiosity is for the whole scene")
    common = {name: flags[name] for name in ("max_depth", "seed", "threads")}
    solution = eclat.solve(load_scene(flags), options, progress=reporter.progress, **common)
    solution.save(output)
    statistics = solution.statistics
    text = f"{output}: {len(solution):,} patches, {statistics['links']:,.0f} links, {statistics['seconds']:.1f} s"
    reporter.result(text, file=output, patches=len(solution), statistics=dict(statistics))


def _say_result(reporter: Reporter, solution: eclat.Solution, output: str) -> None:
    seconds = solution.statistics.get("seconds", 0.0)
    text = f"{output}: {len(solution):,} records, {seconds:.1f} s{'' if solution.complete else ', incomplete'}"
    statistics = dict(solution.statistics)
    if error := error_text(statistics):
        text += f", {error}"
    reporter.result(text, file=output, records=len(solution), complete=solution.complete, statistics=statistics)
