# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat irradiance`, which computes how much light falls on given points."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click
import numpy as np

import eclat
from eclat.cli.command import Command, option
from eclat.cli.farm_options import farm_options, on_farm
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import Name
from eclat.cli.point_files import encode_irradiance, read_points
from eclat.cli.quality_options import (
    cache_option,
    check_cache_alone,
    max_depth_option,
    max_error_option,
    output_option,
    samples_option,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import light_options, load_scene, material_option, scene_argument, work_options
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable, write_file
from eclat.measure.error_estimate import chance_text
from eclat.measure.photometry import LUMENS_PER_WATT, illuminance

EXAMPLES = {
    "echo 0 0.8 0 0 0 1 | eclat irradiance cornell-box": "Compute the irradiance of one point from standard input:",
    "eclat irradiance room.glb --points desks.csv -o desks-lux.csv": "Compute the irradiance of all points of a file:",
    "eclat irradiance room.glb --points desks.csv --cache room.npz": "Use records that `eclat solve` wrote:",
    "eclat irradiance room.glb --points grid.npy --component indirect -o grid.npy": (
        "Read points and write results as NumPy arrays:"
    ),
}


@click.command(
    "irradiance",
    cls=Command,
    short_help="Compute the light that falls on points, in W/m² and lux.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Compute the irradiance at points of SCENE, in W/m² (lux in a photometric scene).

    A point is given by its position and normal, and receives the light from the side that the normal points to. It need
    not lie on a surface. The points are read from a text with one point x y z nx ny nz per line, separated by spaces or
    commas (as for Radiance's rtrace), or from a NumPy array with six columns. A heading and lines that begin with # are
    skipped. The results are RGB irradiance and illuminance in lux, in the order of the points.""",
)
@scene_argument
@option(
    "--points",
    metavar="FILE",
    default="-",
    section="Input",
    help="Points to read: a text, .csv or .npy file [-, standard input].",
)
@output_option("The .csv or .npy file to write [-, standard output].", default="-")
@option(
    "--component",
    type=Name("NAME", "total", "direct", "indirect"),
    default="total",
    section="Quality",
    help="Light to compute: total, direct or indirect [total].",
)
@samples_option("Samples per point: of the lights, and paths with --method path", default=1024)
@max_error_option("Relative error of the indirect light, for methods with records")
@max_depth_option()
@cache_option()
@method_option
@set_option
@light_options
@material_option
@work_options
@farm_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Read the points, compute their irradiance, and write the results."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter, on_farm(flags):
        output = flags["output"]
        _check_output(output, flags["as_json"])
        check_cache_alone(flags, context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT)
        what: Any = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        if not flags["settings"] and context.get_parameter_source("method") is click.core.ParameterSource.DEFAULT:
            what = None  # `eclat.irradiance` then uses records or, for few points, paths
        points, normals = read_points(flags["points"])
        scene = load_scene(flags)
        if flags["cache"]:
            what = eclat.load_solved(flags["cache"], scene)
        statistics: dict[str, float] = {}
        keywords = {name: flags[name] for name in ("component", "max_error", "samples", "max_depth", "seed", "threads")}
        irradiance = eclat.irradiance(
            scene, points, normals, what, progress=reporter.progress, statistics=statistics, **keywords
        )
        table = np.column_stack([irradiance, illuminance(irradiance, scene.photometric)]).astype(np.float32)
        data = encode_irradiance(table, Path(output).suffix.lower())
        how = _how(statistics, scene.photometric)
        if output == "-":
            reporter.end_progress()
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
            reporter.note(f"{len(table):,} points, {how}")
            return
        write_file(output, data)
        mean = float(table[:, 3].mean())
        text = f"{output}: {len(table):,} points, {mean:.4g} lux on average, {how}"
        unit = "lux" if scene.photometric else "W/m2"
        reporter.result(text, file=output, points=len(table), mean_lux=mean, unit=unit, statistics=statistics)


def _how(statistics: dict[str, float], photometric: bool) -> str:
    """Describe how the irradiance was computed, from records or paths, and in which units it is."""
    parts = []
    if "served" in statistics:
        parts.append(f"{statistics['served']:,.0f} read from records, {statistics['gathered']:,.0f} gathered")
    if "paths" in statistics:
        parts.append(f"{statistics['paths']:,.0f} paths per point, which take fewer rays than records would")
    if statistics.get("direct_error", 0) > 0:
        parts.append(f"light straight from lamps within {100 * statistics['direct_error']:.2g} %")
    if "estimated_error" in statistics:
        error, chance = f"{100 * statistics['estimated_error']:.2g} %", chance_text(statistics)
        parts.append(f"error of all light {error} or more ({chance})" if chance else f"all light within {error}")
    parts.append("RGB in lux" if photometric else f"RGB in W/m², lux by {LUMENS_PER_WATT:g} lm/W")
    return ", ".join(parts)


def _check_output(output: str, as_json: bool) -> None:
    if output == "-":
        if as_json:
            raise EclatError("--json requires -o FILE: with --json, standard output holds only events")
        return
    if Path(output).suffix.lower() not in (".csv", ".npy"):
        raise EclatError(f"{output}: expected a name that ends in .csv or .npy")
    check_writable(output)
