# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat render`: a picture of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import eclat
from eclat.cli.command import Command, F, option
from eclat.cli.method_options import METHOD, method_notes, method_option, options_of, set_option
from eclat.cli.parameters import CROP, REPLAY, Name, Number
from eclat.cli.replay import REPEATED, replayed_flags, say_replayed_sample, settings_of
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    CAMERA,
    MAX_DEPTH,
    MAX_ERROR,
    SAMPLES,
    camera_index,
    camera_options,
    light_options,
    load_scene,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.errors import EclatError

if TYPE_CHECKING:
    from eclat.image import Image
    from eclat.options import Options
    from eclat.scene import Scene
    from eclat.solution import Solution

OUTPUT, QUALITY = "Output", "Quality"

EXAMPLES = {
    "eclat render cornell-box": "A built-in scene, as cornell-box.png in this folder:",
    "eclat render room.glb -o room.exr -o room.png": "Your own scene, for compositing and for the screen:",
    "eclat render hall.obj --sun 135,60 --camera-from -8,2,0 --camera-to 0,3,0": "A model without light or camera:",
    "eclat render room.glb --time 30": "The best that fits into half a minute:",
    "eclat render room.glb --method path --samples 1024 -o truth.exr": "The unbiased reference:",
    "eclat render room.glb --cache room.npz --camera 1": "Another view of what `eclat solve` solved:",
}


def _output_options(function: F) -> F:
    for decorate in (
        option("--show-records", is_flag=True, section=OUTPUT, help="Mark where the cache's records lie."),
        option("--keep-partial", is_flag=True, section=OUTPUT, help="On Ctrl-C write what there is."),
        option(
            "--tone-mapping",
            type=Name("NAME", "none", "filmic"),
            default="none",
            section=OUTPUT,
            help="Of .png: none clips at white, filmic rolls off [none].",
        ),
        option(
            "--exposure",
            type=Number(float, -64, 64),
            default=0.0,
            section=OUTPUT,
            help="Of .png, in stops (1 = twice).",
        ),
        option(
            "-o",
            "--output",
            multiple=True,
            metavar="FILE",
            section=OUTPUT,
            help="A file ending in .png, .exr (layers, metadata), .pfm or .npy; repeatable [SCENE.png].",
        ),
    ):
        function = decorate(function)
    return function


def _quality_options(function: F) -> F:
    for decorate in (
        option("--replay", type=REPLAY, section=QUALITY, help="Only this pixel, up to this sample; says its value."),
        option(
            "--replay-settings",
            metavar="FILE",
            section=QUALITY,
            help="Repeat the run that made this .exr or .png bit for bit.",
        ),
        option(
            "--max-depth", type=MAX_DEPTH, default=-1, section=QUALITY, help="1 emission, 2 direct, -1 no limit [-1]."
        ),
        option("--crop", type=CROP, section=CAMERA, help="Only these pixels; the rest stays black."),
        option("--time", type=Number(float, 0, 1e7, above=True), section=QUALITY, help="Seconds to spend instead."),
        option("--samples", type=SAMPLES, section=QUALITY, help="Exactly so many paths per pixel instead."),
        option("--max-error", type=MAX_ERROR, default=0.01, section=QUALITY, help="Relative error to reach [0.01]."),
        option("--cache", metavar="FILE", section=METHOD, help="Read the records that `eclat solve` wrote."),
    ):
        function = decorate(function)
    return function


@click.command(
    "render",
    cls=Command,
    short_help="A picture of a scene.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""A picture of SCENE: a .gltf, .glb, .obj, .ply or Mitsuba .xml file, or the name of a built-in scene.

    No flag is needed: without any, light is computed by irradiance caching until the picture is within 1 % of the
    exact one, and written as SCENE.png in the current folder.""",
)
@scene_argument
@_output_options
@_quality_options
@method_option
@set_option
@camera_options
@light_options
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Collect, render, write."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        if flags["replay_settings"]:
            flags.update(replayed_flags(flags["replay_settings"], context))
        outputs = _outputs(flags)
        options = _options(flags, context)
        scene = load_scene(flags)
        index = camera_index(scene, flags["camera"])
        _check_pixels(flags, scene.cameras[index].size)
        try:
            image, what = _render(scene, index, options, flags, reporter)
        except KeyboardInterrupt as stop:
            partial = getattr(stop, "partial", None)
            if flags["keep_partial"] and partial is not None:
                _save(partial, outputs, flags)
            raise
        image.metadata["settings"] = settings_of(flags, image.metadata)
        if flags["show_records"]:
            image = _with_records(image, scene, index, what, flags["exposure"])
        _save(image, outputs, flags)
        if flags["replay"]:
            say_replayed_sample(reporter, image, flags["replay"])
        else:
            _say_result(reporter, image, outputs)


def _outputs(flags: dict[str, Any]) -> list[str]:
    """The files to write, known to be writable before any work is done."""
    from eclat.image import check_output

    default = [] if flags["replay"] else [f"{scene_stem(flags['scene'])}.png"]
    outputs = list(flags["output"]) or default
    for output in outputs:
        check_output(output)
    return outputs


def _options(flags: dict[str, Any], context: click.Context) -> Options | None:
    """The method's options, or None where a solved cache brings its own."""
    if not flags["cache"]:
        return options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
    if flags["settings"] or context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT:
        raise EclatError("--cache: expected no --method and no --set beside it, since the cache brings its own")
    return None


def _check_pixels(flags: dict[str, Any], size: tuple[int, int] | None) -> None:
    """Refuse pixels outside the picture, and make `--replay` a crop of one pixel."""
    if flags["replay"]:
        x, y, sample = flags["replay"]
        flags.update(crop=(x, y, x + 1, y + 1), samples=sample + 1, time=None)
    if flags["crop"] and size:
        _, _, x1, y1 = flags["crop"]
        if x1 > size[0] or y1 > size[1]:
            flag = "replay" if flags["replay"] else "crop"
            got = ",".join(map(str, flags[flag]))
            raise EclatError(f"--{flag}: expected pixels inside the picture of {size[0]}x{size[1]}, got {got}")


def _render(
    scene: Scene, camera: int, options: Options | None, flags: dict[str, Any], reporter: Reporter
) -> tuple[Image, Solution | Options]:
    common = {name: flags[name] for name in ("size", "max_depth", "seed", "threads")}
    common |= {"camera": camera, "progress": reporter.progress}
    what: Any = options if options is not None else eclat.Solution.load(flags["cache"], scene)
    if flags["show_records"] and options is not None:
        from eclat.options import IrradianceCache

        if not isinstance(options, IrradianceCache):
            raise EclatError(f"--show-records: expected a method with records, got {flags['method']}")
        what = eclat.solve(scene, options, **common)
    bounds = {name: flags[name] for name in ("samples", "max_error", "time", "crop")}
    image = eclat.render(scene, what, **bounds, **common)
    if what is not options and options is not None:
        # Solved here, so its time belongs to this picture.
        image.metadata["statistics"]["seconds"] += what.statistics["seconds"]
    return image, what


def _with_records(image: Image, scene: Scene, camera: int, what: Any, exposure: float) -> Image:
    from eclat.record_overlay import mark_records

    return mark_records(image, scene.cameras[camera], what.positions, white=2.0**-exposure)


def _save(image: Image, outputs: list[str], flags: dict[str, Any]) -> None:
    for output in outputs:
        image.save(output, exposure=flags["exposure"], tone_mapping=flags["tone_mapping"])


def _say_result(reporter: Reporter, image: Image, outputs: list[str]) -> None:
    statistics = image.metadata.get("statistics", {})
    parts = [f"{image.width}x{image.height}", str(image.metadata.get("method", ""))]
    if "seconds" in statistics:
        parts.append(f"{statistics['seconds']:.1f} s")
    for name in ("samples", "rays", "records"):
        if statistics.get(name):
            parts.append(f"{statistics[name]:,.0f} {name}")
    text = f"{', '.join(map(str, outputs))}: {', '.join(filter(None, parts))}"
    reporter.result(text, files=[str(Path(o)) for o in outputs], metadata=image.metadata)


assert set(REPEATED) <= {parameter.name for parameter in command.params}
