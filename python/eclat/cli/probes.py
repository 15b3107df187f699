# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat probes`, which computes the light that arrives at the points of a grid."""

from __future__ import annotations

from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.method_options import METHOD, method_notes, options_of, set_option
from eclat.cli.parameters import BOUNDS, GRID, Name
from eclat.cli.quality_options import (
    cache_option,
    check_cache_alone,
    max_depth_option,
    max_error_option,
    output_option,
    samples_option,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    light_options,
    load_scene,
    material_option,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.files.atomic_file import check_writable

PROBES = "Probes"

EXAMPLES = {
    "eclat probes room.glb": "Write room.probes.json with about 512 probes:",
    "eclat probes room.glb -o probes.json --grid 16,6,12": "Choose the numbers of probes along x, y and z:",
    "eclat probes room.glb --component indirect": "Leave the light straight from lights to the engine:",
    "eclat probes room.glb --window nonnegative": "Let no normal have negative light:",
    "eclat probes house.glb --bounds 0,0,0,6,2.5,8": "Fill a box with probes, here one room of a house:",
    "eclat probes room.glb --cache room.npz -o probes.npz": "End rays in records of `eclat solve`, and write NumPy arrays:",
}


@click.command(
    "probes",
    cls=Command,
    short_help="Compute the light that arrives at a grid of points, for objects that move.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Compute the light that arrives at the points of a grid in SCENE from all sides, as spherical harmonics.

    Light maps light what stands still. Probes light what moves: an engine interpolates the nine coefficients of the
    probes around an object, and from these computes the light on each side of it. The grid divides a box into cells, with
    a probe in the middle of each. Probes inside solids get the light of their neighbours.

    The file holds the coefficients as JSON or, if its name ends in .npz, as NumPy arrays. The guide docs/guides/probes.md
    describes the format, and how three.js, Godot and Unity read it.""",
)
@scene_argument
@output_option("The .json or .npz file to write [SCENE.probes.json].")
@option(
    "--grid",
    type=GRID,
    section=PROBES,
    help="Numbers of probes along x, y and z [about 512 in all, in cells that are about cubes].",
)
@option(
    "--bounds",
    type=BOUNDS,
    section=PROBES,
    help="The box that the grid fills, in metres [that of the scene without stray parts].",
)
@option(
    "--component",
    type=Name("NAME", "total", "direct", "indirect"),
    default="total",
    section=PROBES,
    help="Light to hold: total, direct or indirect [total].",
)
@option(
    "--window",
    type=Name("NAME", "none", "nonnegative", "sloan", "hanning", "lanczos"),
    default="none",
    section=PROBES,
    help="Remedy against negative light on sides that face away from lamps: none; nonnegative, which brings each probe just "
    "so much nearer to its mean that none is left; sloan, the weakest of Sloan's windows that does; hanning or lanczos, "
    "which blur all probes [none].",
)
@samples_option("Rays per probe, and samples of the lights", default=1024)
@max_error_option("Relative error of the indirect light, for methods with records")
@max_depth_option()
@cache_option()
@option(
    "--method",
    metavar="NAME",
    default="path",
    section=METHOD,
    help="Method that computes the light; all methods are listed below [path].",
)
@set_option
@light_options
@material_option
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Load the scene, compute its probes, and write the file."""
    from eclat.probe_grid.grid import check_name

    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or f"{scene_stem(flags['scene'])}.probes.json"
        check_name(output)
        check_writable(output)
        check_cache_alone(flags, context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT)
        what: Any = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        scene = load_scene(flags)
        if flags["cache"]:
            what = eclat.load_solved(flags["cache"], scene)
        names = ("grid", "bounds", "component", "window", "samples", "max_error", "max_depth", "seed", "threads")
        grid = eclat.probes(scene, what, progress=reporter.progress, **{name: flags[name] for name in names})
        grid.save(output)
        reporter.result(_summary(output, grid), file=output, counts=list(grid.counts), statistics=dict(grid.statistics))


def _summary(output: str, grid: eclat.ProbeGrid) -> str:
    """Describe the grid, what was replaced in it, and its errors, in one line."""
    numbers = grid.statistics
    parts = [f"{output}: {' x '.join(map(str, grid.counts))} probes"]
    if numbers["inside"] > 0:
        parts.append(f"{numbers['inside']:,.0f} inside solids, filled from their neighbours")
    if numbers["windowed"] > 0:
        parts.append(f"{numbers['windowed']:,.0f} windowed")
    parts.append(f"{numbers['seconds']:.1f} s")
    named = {"noise_error": "noise", "order_error": "error of the order", "window_error": "error of the window"}
    named["estimated_error"] = "estimated error"
    parts += [f"{text} {100 * numbers[name]:.2g} %" for name, text in named.items() if numbers.get(name, 0) > 0]
    return ", ".join(parts)
