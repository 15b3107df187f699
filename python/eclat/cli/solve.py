# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat solve`: the records of a scene, computed once and kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
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
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable

EXAMPLES = {
    "eclat solve room.glb": "Writes room.npz:",
    "eclat solve room.glb -o fine.npz --max-error 0.005": "Finer records:",
    "eclat solve room.glb --method radiance-cache": "Glossy surfaces from records as well:",
    "eclat solve room.glb --method radiosity": "Radiosity of all surfaces, for all views:",
    "eclat render room.glb --cache fine.npz --samples 64": "Render from these records; the scene must be the same:",
    "eclat solve room.glb --cache room.npz --refine --max-error 0.003": "Refine records up to --max-error:",
    "eclat solve room.glb --view-independent": "For every view, including views that you have not chosen yet:",
    "eclat solve room.glb --points desks.csv": "For points with normals, as `eclat irradiance` takes them:",
}


@click.command(
    "solve",
    cls=Command,
    short_help="Compute what a method learns about a scene, and keep it.",
    examples=EXAMPLES,
    notes=lambda: method_notes(that_solve=True),
    help="""Compute the records that a view of SCENE needs (or points, or all surfaces), and keep them.

    With --method photon-map or radiosity: photons, or the light of all patches, for the whole scene. The file is a NumPy
    .npz archive; --cache of `eclat render`, `irradiance` and `bake` and `eclat.load_solved` read it. A scene that has
    changed since is refused.""",
)
@scene_argument
@output_option("A file ending in .npz [SCENE.npz].")
@keep_partial_option("On Ctrl-C, write the records of the finished passes, marked as incomplete.")
@option(
    "--view-independent",
    is_flag=True,
    section="Input",
    help="Place records on all surfaces instead of only those that one view needs.",
)
@option(
    "--points",
    metavar="FILE",
    section="Input",
    help="Compute records for the points in this file (x y z nx ny nz; text, .csv or .npy).",
)
@max_error_option("Relative error of indirect light")
@max_depth_option()
@no_check_option()
@refine_option("Refine until the estimated error meets --max-error.")
@option(
    "--cache",
    metavar="FILE",
    section="Input",
    help="With --refine: the file of records to refine, written by `eclat solve`.",
)
@method_option
@set_option
@camera_options
@light_options
@material_option
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Solve and save."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or f"{scene_stem(flags['scene'])}.npz"
        if Path(output).suffix.lower() != ".npz":
            raise EclatError(f"{output}: expected a name that ends in .npz")
        check_writable(output)
        if flags["cache"]:
            _check_cache(flags, context)
        method = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        _check_purpose(flags, method)
        points = read_points(flags["points"]) if flags["points"] else None
        scene = load_scene(flags)
        common = {name: flags[name] for name in COMMON} | {"progress": reporter.progress}
        if not method.for_whole_scene:
            common |= {"points": points, "view_independent": flags["view_independent"]}
            if points is None and not flags["view_independent"]:
                common |= {"camera": camera_index(scene, flags["camera"]), "size": flags["size"]}

        def keep(solved: eclat.Solved) -> None:
            solved.save(output)
            reporter.result(f"{output}: {solved.describe()}", file=output, **solved.facts())

        with keeping_partial(flags["keep_partial"], keep, reporter):
            if flags["cache"]:
                start = eclat.load_solved(flags["cache"], scene)
                solved = eclat.refine(start, scene, flags["max_error"], **common)
            else:
                solved = eclat.solve(scene, method, max_depth=flags["max_depth"], refine=flags["refine"], **common)
        keep(solved)


COMMON = ("seed", "threads", "keep_partial", "check")
"""Flags that are arguments of `eclat.solve` and `eclat.refine` as they are."""


def _check_cache(flags: dict[str, Any], context: click.Context) -> None:
    """Raise EclatError if `--cache` lacks `--refine`, or is combined with a flag whose value the cache holds."""
    if not flags["refine"]:
        raise EclatError("--cache requires --refine: without --refine, `eclat solve` computes all records anew")
    for name, flag in (("settings", "--set"), ("method", "--method"), ("max_depth", "--max-depth")):
        if context.get_parameter_source(name) is not click.core.ParameterSource.DEFAULT:
            raise EclatError(f"--cache cannot be combined with {flag}: the file holds the value to use")


def _check_purpose(flags: dict[str, Any], method: eclat.Method) -> None:
    """Raise EclatError for flags that the method does not support or that exclude each other."""
    if method.solved is None:
        known = [name for name, cls in eclat.METHODS.items() if cls.solved is not None]
        raise EclatError(f"--method: expected one of {', '.join(known)}, got {flags['method']!r}")
    if flags["refine"] and not flags["check"]:
        raise EclatError("--refine cannot be combined with --no-check: the estimated error decides when to stop")
    if method.for_whole_scene:
        for name in ("points", "view_independent", "camera", "size", "cache", "refine", "keep_partial"):
            if flags[name]:
                flag = name.replace("_", "-")
                raise EclatError(
                    f"--{flag}: expected a method with records, since {method.name} is for the whole scene"
                )
    if flags["points"] and flags["view_independent"]:
        raise EclatError("--points cannot be combined with --view-independent")
    if (flags["points"] or flags["view_independent"]) and (flags["camera"] is not None or flags["size"] is not None):
        raise EclatError("--camera and --size cannot be combined with --points or --view-independent")
