# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat view`, which shows a solved scene in the browser."""

from __future__ import annotations

from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import Number
from eclat.cli.quality_options import (
    QUALITY,
    cache_option,
    check_cache_alone,
    exposure_option,
    max_error_option,
    samples_option,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import light_options, load_scene_to_show, material_option, scene_argument, work_options
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable

EXAMPLES = {
    "eclat view cornell-box": "Solve a built-in scene and walk through it in the browser:",
    "eclat view room.glb --cache room.npz": "Show records that `eclat solve --view-independent` wrote:",
    "eclat view room.glb --save room.npz": "Keep what was solved while you walked:",
    "eclat view room.glb --export site": "Write the page and the scene as files for a web server:",
}


@click.command(
    "view",
    cls=Command,
    short_help="Walk through a solved scene in the browser.",
    examples=EXAMPLES,
    notes=lambda: method_notes(that_solve=True),
    help="""Show SCENE in the browser, with the global illumination of its records.

    The graphics card draws each record as a splat over the surfaces that it serves. Records that a view lacks are computed
    while you look at it. The page is served on this machine only, at an address with a secret token, until you press Ctrl-C.
    No request leaves the machine.""",
)
@scene_argument
@option(
    "--export",
    "folder",
    metavar="DIR",
    section="Output",
    help="Write the page and the scene to this folder, for any web server, instead of serving them.",
)
@option(
    "--browser/--no-browser",
    "open_browser",
    default=True,
    section="Output",
    help="Open the page in the default browser, or only print its address [on].",
)
@option(
    "--whole",
    is_flag=True,
    section="Output",
    help="Solve all surfaces while the page is open, what you look at first; otherwise only what views lack is solved.",
)
@option(
    "--save",
    metavar="FILE",
    section="Output",
    help="Write the records that were solved until Ctrl-C to this .npz file, as `eclat solve` does.",
)
@exposure_option("Exposure in stops with which the page begins [0].", None)
@max_error_option("Relative error of the indirect light")
@option(
    "--texel-size",
    type=Number(float, 0, 1e6, above=True, unit="of metres"),
    section=QUALITY,
    help="Size of a texel in metres of the light map for the direct light of glowing surfaces and the sky [chosen to "
    "give about 260,000 texels].",
)
@samples_option("Samples of these lights per texel", default=256)
@cache_option()
@method_option
@set_option
@light_options
@material_option
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Solve what is missing, and serve the page or write it."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        check_cache_alone(flags, context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT)
        what: Any = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        scene, exposure = load_scene_to_show(flags)
        if flags["cache"]:
            what = eclat.load_solved(flags["cache"], scene)
        common = {name: flags[name] for name in ("max_error", "texel_size", "samples", "seed", "threads")}
        common |= {"exposure": 0.0 if exposure == "auto" else exposure, "progress": reporter.progress}
        if flags["save"]:
            if flags["folder"] is not None:
                raise EclatError("--save cannot be combined with --export: `eclat solve` writes the records of a scene")
            check_writable(flags["save"])
        if flags["folder"] is not None:
            files = eclat.export_view(scene, flags["folder"], what, **common)
            size = sum(file.stat().st_size for file in files)
            reporter.result(
                f"{flags['folder']}: {len(files)} files, {size / 1e6:.1f} MB; serve this folder and open index.html",
                folder=flags["folder"],
                files=len(files),
                bytes=size,
            )
            return
        shown = {"open_browser": flags["open_browser"], "whole": flags["whole"]}
        with eclat.view(scene, what, **shown, **common) as viewer:
            reporter.result(f"{viewer.url} (stop with Ctrl-C)", url=viewer.url)
            try:
                viewer.wait()
            except KeyboardInterrupt:
                if flags["save"]:
                    viewer.solution.save(flags["save"])
                    reporter.note(f"{flags['save']}: {viewer.solution.describe()}")
