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
from eclat.atomic_file import check_writable, write_file
from eclat.cli.command import Command, option
from eclat.cli.method_options import METHOD, method_notes, method_option, options_of, set_option
from eclat.cli.parameters import Name
from eclat.cli.point_files import encode_irradiance, read_points
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    MAX_DEPTH,
    MAX_ERROR,
    SAMPLES,
    light_options,
    load_scene,
    scene_argument,
    work_options,
)
from eclat.errors import EclatError
from eclat.photometry import illuminance

EXAMPLES = {
    "echo 0 0.8 0 0 0 1 | eclat irradiance cornell-box": "One point, by hand:",
    "eclat irradiance room.glb --points desks.csv -o desks-lux.csv": "All desks:",
    "eclat irradiance room.glb --points grid.npy --component indirect -o grid.npy": "NumPy in and out:",
}


@click.command(
    "irradiance",
    cls=Command,
    short_help="How much light falls on points, in W/m² and lux.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Irradiance at points of SCENE, on the side that their normals face, in W/m² (lux in a photometric scene).

    Points come one a line, x y z nx ny nz, with spaces or commas between (as for Radiance's rtrace), or as a NumPy
    array of six columns. A heading and lines that begin with # are skipped. Results come in the same order: RGB
    irradiance and illuminance in lux. Points need not lie on a surface.""",
)
@scene_argument
@option("--points", metavar="FILE", default="-", section="Input", help="Text, .csv or .npy [- is standard input].")
@option("-o", "--output", metavar="FILE", default="-", section="Output", help="A .csv or .npy file [standard output].")
@option(
    "--component",
    type=Name("NAME", "total", "direct", "indirect"),
    default="total",
    section="Quality",
    help="total, direct or indirect light [total].",
)
@option("--samples", type=SAMPLES, section="Quality", help="Paths per point [the method's default].")
@option("--max-error", type=MAX_ERROR, section=METHOD, help="Of a cached method: relative error of indirect light.")
@option("--max-depth", type=MAX_DEPTH, default=-1, section="Quality", help="As for render; -1 no limit [-1].")
@method_option
@set_option
@light_options
@work_options
@reporting_options
def command(**flags: Any) -> None:
    """Read, ask, write."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"]
        _check_output(output, flags["as_json"])
        options = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        points, normals = read_points(flags["points"])
        scene = load_scene(flags)
        keywords = {name: flags[name] for name in ("component", "max_depth", "seed", "threads")}
        if flags["samples"] is not None:
            keywords["samples"] = flags["samples"]
        irradiance = eclat.irradiance(scene, points, normals, options, progress=reporter.progress, **keywords)
        table = np.column_stack([irradiance, illuminance(irradiance, scene.photometric)]).astype(np.float32)
        data = encode_irradiance(table, Path(output).suffix.lower())
        if output == "-":
            reporter.end_progress()
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
            return
        write_file(output, data)
        mean = float(table[:, 3].mean()) if len(table) else 0.0
        text = f"{output}: {len(table):,} points, {mean:.4g} lux on average"
        reporter.result(text, file=output, points=len(table), mean_lux=mean)


def _check_output(output: str, as_json: bool) -> None:
    if output == "-":
        if as_json:
            raise EclatError("--json: expected a file by -o beside it, since standard output then holds events only")
        return
    if Path(output).suffix.lower() not in (".csv", ".npy"):
        raise EclatError(f"{output}: expected a name that ends in .csv or .npy")
    check_writable(output)
