# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat compare`, which compares all methods on one scene and writes an HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from eclat.cli.command import Command, option
from eclat.cli.parameters import Number
from eclat.cli.quality_options import (
    exposure_option,
    max_depth_option,
    max_error_option,
    output_option,
    samples_option,
    time_option,
)
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
from eclat.files.atomic_file import check_writable, write_file

if TYPE_CHECKING:
    from eclat.verbs.compare import Comparison, Reference

EXAMPLES = {
    "eclat compare cornell-box": "Compare all methods and write cornell-box.html in the current folder:",
    "eclat compare room.glb --methods path,irradiance-cache --time 20": "Compare two methods at equal times up to 20 s:",
    "eclat compare room.glb --reference a.exr --reference b.exr": (
        "Compare with pictures that `eclat render --method path` made:"
    ),
}


@click.command(
    "compare",
    cls=Command,
    short_help="Compare the errors and times of all methods on one scene, on an HTML page.",
    examples=EXAMPLES,
    help="""Render SCENE by several methods and write one self-contained HTML page.

    The page shows pictures, signed error maps and FLIP, and the error, time, rays and records of each method at several
    levels of effort. Each level takes four times the samples (or seconds) of the previous level and aims at half the
    error. The reference is the mean of two independent path-traced pictures.""",
)
@scene_argument
@output_option("The .html file to write [SCENE.html].")
@exposure_option("Exposure of the pictures in stops [computed from the reference].", default=None)
@option("--methods", metavar="A,B,…", section="Method", help="The methods to compare, separated by commas [all].")
@option("--levels", type=Number(int, 1, 10), default=4, section="Quality", help="Number of levels of effort [4].")
@samples_option("Paths per pixel at the last level", default=64)
@max_error_option("Relative error that methods with records aim at on the last level")
@time_option("Give every method this many seconds at the last level, instead of --samples.")
@max_depth_option()
@samples_option(
    "Paths per pixel of each of the two reference pictures",
    default=256,
    name="--reference-samples",
    section="Reference",
)
@option(
    "--reference",
    metavar="FILE",
    multiple=True,
    section="Reference",
    help="Use this .exr as the reference instead; give the option twice to use two independent pictures.",
)
@camera_options
@light_options
@material_option
@work_options
@reporting_options
def command(**flags: Any) -> None:
    """Run the comparison and write its page."""
    from eclat.report.compare_page import compare_page, page_facts, percent

    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or f"{scene_stem(flags['scene'])}.html"
        if Path(output).suffix.lower() not in (".html", ".htm"):
            raise EclatError(f"{output}: expected a name that ends in .html")
        check_writable(output)
        comparison = _compare(flags, reporter)
        write_file(output, compare_page(comparison).encode())
        lines = [output]
        width = max(len(result.method) for result in comparison.results)
        for result in comparison.results:
            last = result.measurements[-1]
            lines.append(f"  {result.method:<{width}}  {percent(last.error):>8} in {last.seconds:.2f} s")
        reporter.result("\n".join(lines), file=output, **page_facts(comparison))


def _compare(flags: dict[str, Any], reporter: Reporter) -> Comparison:
    from eclat.verbs.compare import Effort, compare

    effort = Effort(flags["levels"], flags["samples"], flags["max_error"], flags["time"])
    methods = [name.strip() for name in flags["methods"].split(",")] if flags["methods"] else None
    reference = _reference(flags)
    scene = load_scene(flags)
    return compare(
        scene,
        methods,
        effort=effort,
        reference=reference,
        camera=camera_index(scene, flags["camera"]),
        progress=reporter.progress,
        **{name: flags[name] for name in ("reference_samples", "exposure", "size", "max_depth", "seed", "threads")},
    )


def _reference(flags: dict[str, Any]) -> Reference | None:
    from eclat.images.image import Image
    from eclat.verbs.compare import Reference

    names = flags["reference"]
    if not names:
        return None
    if len(names) > 2:
        raise EclatError(f"--reference: expected one or two files, got {len(names)}")
    images = [Image.load(name) for name in names]
    sizes = {(image.width, image.height) for image in images}
    if len(sizes) > 1 or (flags["size"] and flags["size"] not in sizes):
        got = " and ".join(f"{image.width}x{image.height}" for image in images)
        raise EclatError(f"--reference: expected pictures of the same size, and of --size if that is given, got {got}")
    return Reference(images[0], images[-1])
