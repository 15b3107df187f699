# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat solve`, which computes the solution of a method for a scene and writes it to a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.farm_options import farm_options, on_farm
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
    "eclat solve room.glb": "Compute the records for the view of the scene's first camera, and write room.npz:",
    "eclat solve room.glb -o fine.npz --max-error 0.005": "Compute more accurate records:",
    "eclat solve room.glb --method radiance-cache": "Compute records for glossy surfaces too:",
    "eclat solve room.glb --method radiosity": "Compute the radiosity of all surfaces, which serves all views:",
    "eclat render room.glb --cache fine.npz --samples 64": "Render with these records; the scene must be the same:",
    "eclat solve room.glb --cache room.npz --refine --max-error 0.003": (
        "Refine existing records until their estimated error is below --max-error:"
    ),
    "eclat solve room.glb --view-independent": "Compute records on all surfaces, which serve all views:",
    "eclat solve room.glb --points desks.csv": "Compute records for points with normals, as `eclat irradiance` reads them:",
}


@click.command(
    "solve",
    cls=Command,
    short_help="Compute the records, photons or patches of a scene, and keep them in a file.",
    examples=EXAMPLES,
    notes=lambda: method_notes(that_solve=True),
    help="""Compute the records that a view of SCENE needs, and keep them in a file.

    With --points or --view-independent, records are computed for points or for all surfaces instead. With --method
    photon-map or radiosity, the file holds the photons or patches of the whole scene. The file is a NumPy .npz archive, which
    `eclat render`, `eclat irradiance` and `eclat bake` read with --cache, and Python reads with `eclat.load_solved`. It
    can be used only with the scene that it was computed for, unchanged.""",
)
@scene_argument
@output_option("The .npz file to write [SCENE.npz].")
@keep_partial_option("If you press Ctrl-C, write the records of the finished passes, marked as incomplete.")
@option(
    "--view-independent",
    is_flag=True,
    section="Input",
    help="Place records on all surfaces, instead of only where one view needs them.",
)
@option(
    "--points",
    metavar="FILE",
    section="Input",
    help="Compute records for the points in this file: x y z nx ny nz per point, as text, .csv or .npy.",
)
@max_error_option("Wanted relative error of the indirect light")
@max_depth_option()
@no_check_option()
@refine_option("Refine the records until their estimated error is below --max-error.")
@option(
    "--cache",
    metavar="FILE",
    section="Input",
    help="File of records, written by `eclat solve`, that --refine refines.",
)
@method_option
@set_option
@camera_options
@light_options
@material_option
@work_options
@farm_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Solve the scene and write the solution."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter, on_farm(flags):
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
"""Flags that are passed to `eclat.solve` and `eclat.refine` unchanged, as arguments of the same names."""


def _check_cache(flags: dict[str, Any], context: click.Context) -> None:
    """Raise EclatError if `--cache` is given without `--refine`, or with an option whose value the file determines."""
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
        raise EclatError("--refine cannot be combined with --no-check: refining stops at an estimated error")
    if method.for_whole_scene:
        for name in ("points", "view_independent", "camera", "size", "cache", "refine", "keep_partial"):
            if flags[name]:
                flag = name.replace("_", "-")
                raise EclatError(
                    f"--{flag}: expected a method with records, got {method.name}, which is solved for the whole scene"
                )
    if flags["points"] and flags["view_independent"]:
        raise EclatError("--points cannot be combined with --view-independent: give one of them")
    if (flags["points"] or flags["view_independent"]) and (flags["camera"] is not None or flags["size"] is not None):
        raise EclatError(
            "--camera and --size cannot be combined with --points or --view-independent: these records serve no "
            "particular view"
        )
