# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat irradiance`: how much light falls on points."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click
import numpy as np

import eclat
from eclat.cli.command import Command, option
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
from eclat.measure.photometry import LUMENS_PER_WATT, illuminance

EXAMPLES = {
    "echo 0 0.8 0 0 0 1 | eclat irradiance cornell-box": "One point, from standard input:",
    "eclat irradiance room.glb --points desks.csv -o desks-lux.csv": "All desks:",
    "eclat irradiance room.glb --points desks.csv --cache room.npz": "From records that `eclat solve` wrote:",
    "eclat irradiance room.glb --points grid.npy --component indirect -o grid.npy": "Points and results as NumPy arrays:",
}


@click.command(
    "irradiance",
    cls=Command,
    short_help="Compute the light that falls on points, in W/m² and lux.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Irradiance at points of SCENE, on the side that their normals face, in W/m² (lux in a photometric scene).

    Points come one a line, x y z nx ny nz, with spaces or commas between (as for Radiance's rtrace), or as a NumPy
    array of six columns. A heading and lines that begin with # are skipped. Results come in the same order: RGB
    irradiance and illuminance in lux. Points need not lie on a surface.""",
)
@scene_argument
@option("--points", metavar="FILE", default="-", section="Input", help="Text, .csv or .npy [- is standard input].")
@output_option("A .csv or .npy file [standard output].", default="-")
@option(
    "--component",
    type=Name("NAME", "total", "direct", "indirect"),
    default="total",
    section="Quality",
    help="total, direct or indirect light [total].",
)
@samples_option("Of the lights, and paths of `path`, per point", default=1024)
@max_error_option("Of a cached method: relative error of indirect light")
@max_depth_option()
@cache_option()
@method_option
@set_option
@light_options
@material_option
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Read, ask, write."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"]
        _check_output(output, flags["as_json"])
        check_cache_alone(flags, context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT)
        what: Any = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        if not flags["settings"] and context.get_parameter_source("method") is click.core.ParameterSource.DEFAULT:
            what = None  # records or, for few points, paths
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
    """The source of the points' light (records or paths), and the meaning of lux in this scene, as text."""
    parts = []
    if "served" in statistics:
        parts.append(f"{statistics['served']:,.0f} served by records, {statistics['gathered']:,.0f} gathered")
    if "paths" in statistics:
        parts.append(f"each by {statistics['paths']:,.0f} paths, which take fewer rays than records would")
    if statistics.get("direct_error", 0) > 0:
        parts.append(f"light straight from lamps within {100 * statistics['direct_error']:.2g} %")
    if "estimated_error" in statistics:
        parts.append(f"all light within {100 * statistics['estimated_error']:.2g} %")
    parts.append("RGB in lux" if photometric else f"RGB in W/m², lux by {LUMENS_PER_WATT:g} lm/W")
    return ", ".join(parts)


def _check_output(output: str, as_json: bool) -> None:
    if output == "-":
        if as_json:
            raise EclatError("--json requires a file by -o: standard output then holds events only")
        return
    if Path(output).suffix.lower() not in (".csv", ".npy"):
        raise EclatError(f"{output}: expected a name that ends in .csv or .npy")
    check_writable(output)
