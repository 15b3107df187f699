# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat bake`, which computes light maps for viewers that do not compute light themselves."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import click

import eclat
from eclat.cli.command import Command, option
from eclat.cli.farm_options import farm_options, on_farm
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import Name, Number
from eclat.cli.quality_options import (
    QUALITY,
    cache_option,
    check_cache_alone,
    exposure_option,
    max_depth_option,
    max_error_option,
    output_option,
    samples_option,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    by_name,
    light_options,
    load_scene,
    material_option,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable
from eclat.measure.error_estimate import chance_text, error_text

MAP = "Map"

EXAMPLES = {
    "eclat bake room.glb": "Write room_lit.glb, room_lit.lightmap.exr and room_lit.lightmap.json:",
    "eclat bake room.glb -o lit.glb --texel-size 0.01": "Use one texel per centimetre:",
    "eclat bake room.glb --dry-run": "Say how large the map will be and about how long it will take:",
    "eclat bake room.glb --texel-size 0.05 --texel-size-of 'statue*=0.01'": "Give the statues finer texels:",
    "eclat bake room.glb --directional godot --ktx2": "Also write directions for Godot, and KTX2:",
    "eclat bake room.glb --method radiosity": "Use another method:",
    "eclat bake room.glb --cache room.npz": "Use a file that `eclat solve --view-independent` wrote:",
    "eclat bake room.glb --flatten": "Write room_flat.glb, which viewers without support for light maps can show:",
    "eclat bake room.glb --method path --samples 64 --denoise": "Bake with few paths, and remove the noise:",
    "eclat bake room.glb --component indirect": "Bake only indirect light, and leave the lights to the viewer:",
}


@click.command(
    "bake",
    cls=Command,
    short_help="Bake the light on all surfaces into light maps, for viewers in the browser.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Compute the irradiance of all surfaces of SCENE and write it as a light map.

    Three files are written. The .glb file holds the scene with a light map of 8 bits per channel on a second set of
    texture coordinates (MOZ_lightmap). The .exr file holds the same irradiance unclipped, in W/m² (lux in a photometric
    scene). The .json file describes the units and the layout of both. Unless --component is indirect, the .glb contains
    no light sources, because the light map holds their light; emissive surfaces stay emissive.""",
)
@scene_argument
@output_option("The .glb file to write [SCENE_lit.glb].")
@option(
    "--flatten",
    is_flag=True,
    section="Output",
    help="Write a .glb for viewers without support for light maps: the colour of its unlit materials includes all "
    "light [SCENE_flat.glb].",
)
@exposure_option("Exposure for --flatten in stops [chosen so that few texels are clipped at white].", None)
@option(
    "--texel-size",
    type=Number(float, 0, 1e6, above=True, unit="of metres"),
    section=MAP,
    help="Size of a texel in metres [chosen to give about 260,000 texels].",
)
@option(
    "--texel-size-of",
    "texel_sizes",
    multiple=True,
    metavar="NAME=METRES",
    section=MAP,
    help="Another size of a texel for the meshes of that name, which may be a pattern such as 'statue*'. Repeatable; the first "
    "that matches counts.",
)
@option(
    "--directional",
    type=Name("LAYOUT", "sh", "godot", "unity"),
    default=None,
    section=MAP,
    help="Also write from where the light comes, for viewers with normal maps: sh writes spherical harmonics of order 1, godot "
    "and unity what these engines read [off].",
)
@option(
    "--ktx2",
    is_flag=True,
    section="Output",
    help="Also write the light map as KTX2, in half precision, which graphics cards take as it is.",
)
@option(
    "--dry-run",
    is_flag=True,
    section="Output",
    help="Bake nothing, and say how large the light map will be and about how long it will take.",
)
@option(
    "--component",
    type=Name("NAME", "total", "direct", "indirect"),
    default="total",
    section=MAP,
    help="Light to bake: total, direct or indirect [total].",
)
@option(
    "--gutter",
    type=Number(int, 2, 64),
    default=2,
    section=MAP,
    help="Width in texels of the border around each chart. 2 to the power of n gives the mip map of --ktx2 n smaller levels [2].",
)
@option(
    "--sides",
    type=Name("NAME", "auto", "front", "both"),
    default="auto",
    section=MAP,
    help="Sides of two-sided surfaces to bake. auto bakes both sides of thin sheets and only the outside of solids; "
    "front bakes the front and shows its light on both sides; both bakes both sides of every two-sided surface [auto].",
)
@option(
    "--max-size",
    type=Number(int, 16, 16384),
    default=4096,
    section=MAP,
    help="Largest width and height of a page of the light map in texels; what does not fit goes on several [4096].",
)
@option(
    "--denoise/--no-denoise",
    default=False,
    section=QUALITY,
    help="Remove the noise with Open Image Denoise's network for light maps, and measure the error that remains [off].",
)
@samples_option("Samples per texel: of the lights, and paths with --method path", default=256)
@max_error_option("Relative error of the indirect light, for methods with records")
@max_depth_option()
@option(
    "--charts-timeout",
    type=Number(float, 0, 1e6),
    default=60.0,
    section=QUALITY,
    help="Seconds that xatlas may take to find charts; after that each flat piece of a surface becomes a chart, which "
    "gives smaller charts [60].",
)
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
    """Load the scene, bake its light maps, and write the files."""
    from eclat.lightmap.lightmap import output_names
    from eclat.lightmap.stages import stage

    with Reporter(flags["quiet"], flags["as_json"], show_after=0.0) as reporter, on_farm(flags):
        flat = flags["flatten"]
        if flags["exposure"] is not None and not flat:
            raise EclatError("--exposure requires --flatten: light maps hold irradiance, to which no exposure applies")
        if flat and (flags["ktx2"] or flags["directional"]):
            raise EclatError("--flatten writes no light map: it cannot be combined with --ktx2 or --directional")
        names = output_names(flags["output"] or f"{scene_stem(flags['scene'])}_{'flat' if flat else 'lit'}.glb")
        if not flags["dry_run"]:
            for name in names[:1] if flat else names:
                check_writable(name)
        check_cache_alone(flags, context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT)
        what: Any = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        texel_sizes = by_name("--texel-size-of", flags["texel_sizes"], _named_size)
        stage(reporter.progress, "load")
        scene = load_scene(flags)
        if flags["cache"]:
            what = eclat.load_solved(flags["cache"], scene)
        keys = (
            "component",
            "texel_size",
            "samples",
            "max_error",
            "max_depth",
            "gutter",
            "sides",
            "max_size",
            "charts_timeout",
        )
        keywords = {name: flags[name] for name in (*keys, "seed", "threads")} | {"texel_sizes": texel_sizes}
        if flags["dry_run"]:
            found = eclat.estimate_bake(scene, what, ktx2=flags["ktx2"], progress=reporter.progress, **keywords)
            _say_estimate(reporter, found, str(names[0]))
            return
        directional = flags["directional"]
        lightmap = eclat.bake(
            scene,
            what,
            denoise=flags["denoise"],
            directional=directional is not None,
            progress=reporter.progress,
            **keywords,
        )
        if flat:
            lightmap.save_flat(names[0], flags["exposure"])
        else:
            lightmap.save(names[0], ktx2=flags["ktx2"], directional=directional)
        _say_result(reporter, lightmap, str(names[0]), flat)


def _named_size(text: str) -> tuple[str, float]:
    """Parse NAME=METRES. Names may contain the character `=`."""
    name, separator, metres = text.rpartition("=")
    try:
        size = float(metres)
    except ValueError:
        size = 0.0
    if not separator or not name or not (0 < size < math.inf):
        raise EclatError(f"expected NAME=METRES with a number above 0, got {text!r}")
    return name, size


def _say_estimate(reporter: Reporter, found: eclat.BakeEstimate, output: str) -> None:
    pages = (
        f"{found.width} x {found.height}"
        if found.pages == 1
        else f"{found.pages} pages of {found.width} x {found.height}"
    )
    minutes, seconds = divmod(math.ceil(found.seconds), 60)
    text = (
        f"{output}: {pages} texels of {found.texel_size:g} m, {found.texels:,} of them in {found.charts:,} charts; at most "
        f"{found.most_bytes / 1e6:,.3g} MB; about {f'{minutes} min ' if minutes else ''}{seconds} s"
    )
    reporter.result(text, file=output, dry_run=True, **asdict(found))


def _say_result(reporter: Reporter, lightmap: eclat.Lightmap, output: str, flat: bool) -> None:
    height, width = lightmap.pages[0].shape[:2]
    statistics = lightmap.statistics
    text = (
        f"{output}: {lightmap.size_text()} texels of {lightmap.texel_size:g} m, {statistics['charts']:,.0f} charts, "
        f"{statistics['seconds']:.1f} s{_errors(statistics)}"
    )
    clipped = 0.0 if flat else lightmap.clipped_share()
    if clipped > 0:
        limit = f"{lightmap.intensity():.4g} {lightmap.unit}"
        text += f"; {clipped:.2%} of the texels are above {limit}, where the embedded map is clipped"
    reporter.result(
        text,
        file=output,
        width=width,
        height=height,
        pages=lightmap.page_count,
        texel_size=lightmap.texel_size,
        clipped_share=clipped,
        statistics=dict(statistics),
    )


def _errors(statistics: dict[str, float]) -> str:
    """Describe the estimated errors of the texels before the fit."""
    if "noise_left" in statistics:
        return f", {error_text(statistics)}{', denoised' if statistics['denoised'] > 0 else ''}"
    names = {"direct_error": "light straight from lamps", "estimated_error": "light of records"}
    stated = [f"{what} within {100 * statistics[n]:.2g} %" for n, what in names.items() if statistics.get(n, 0) > 0]
    if "estimated_error" in statistics and (chance := chance_text(statistics)):
        stated[-1] = f"error of light of records {100 * statistics['estimated_error']:.2g} % or more ({chance})"
    return "".join(f", {text}" for text in stated)
