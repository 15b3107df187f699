# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat render`: a picture of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import eclat
from eclat.cli.command import Command, option, together
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import CROP, REPLAY, Name
from eclat.cli.partial import keep_partial_option, keeping_partial
from eclat.cli.quality_options import (
    QUALITY,
    cache_option,
    check_cache_alone,
    exposure_option,
    max_depth_option,
    max_error_option,
    no_check_option,
    output_option,
    refine_option,
    samples_option,
    time_option,
)
from eclat.cli.replay import (
    REPEATED,
    chosen_by_clock,
    replayed_flags,
    say_replay_of_bad_samples,
    say_replayed_sample,
    settings_of,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    CAMERA,
    camera_index,
    camera_options,
    light_options,
    load_scene_to_show,
    material_option,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.errors import EclatError
from eclat.measure.error_estimate import error_text

if TYPE_CHECKING:
    from eclat.images.image import Image
    from eclat.methods import Method

REACHING_RENDER = (
    "samples",
    "max_error",
    "time",
    "adaptive",
    "size",
    "crop",
    "max_depth",
    "seed",
    "threads",
    "keep_partial",
    "check",
    "refine",
)
"""Flags that are arguments of `eclat.render` as they are."""

EXAMPLES = {
    "eclat render cornell-box": "A built-in scene, as cornell-box.png in this folder:",
    "eclat render room.glb -o room.exr -o room.png": "Your own scene, for compositing and for the screen:",
    "eclat render hall.obj --sun 135,60 --camera-from -8,2,0 --camera-to 0,3,0": "A model without light or camera:",
    "eclat render room.glb --time 30": "The best that fits into half a minute:",
    "eclat render room.glb --method path --samples 1024 -o truth.exr": "The unbiased reference:",
    "eclat render room.glb --cache room.npz --camera 1": "Another view from the records of `eclat solve`:",
}


_output_options = together(
    output_option(
        "A file ending in .png, .exr (layers, metadata), .pfm or .npy; repeatable [SCENE.png].", multiple=True
    ),
    exposure_option(
        "Exposure of a .png in stops (1 doubles the light), or auto: mid grey on average "
        "[auto where only --sun or a default gives light, else 0].",
        default=None,
        auto=True,
    ),
    option(
        "--tone-mapping",
        type=Name("NAME", "none", "filmic"),
        default="none",
        section="Output",
        help="Tone mapping of a .png: none clips at white, filmic rolls off [none].",
    ),
    keep_partial_option("On Ctrl-C, write the picture of the samples taken so far."),
    option(
        "--show-records", is_flag=True, section="Output", help="Draw the positions of the records into the picture."
    ),
)

_quality_options = together(
    cache_option(),
    max_error_option("Relative error at which to stop"),
    samples_option("Take this many paths per pixel instead"),
    time_option("Stop after about this many seconds instead."),
    option(
        "--adaptive/--no-adaptive",
        default=None,
        section=QUALITY,
        help="More samples where pixels are noisy, --samples on average [with records, without --crop].",
    ),
    option("--crop", type=CROP, section=CAMERA, help="Render only these pixels; the rest stays black."),
    max_depth_option(),
    no_check_option(),
    refine_option("Refine the records until their estimated error meets --max-error."),
    option(
        "--replay-settings",
        metavar="FILE",
        section=QUALITY,
        help="Repeat the run that made this .exr or .png bit for bit.",
    ),
    option(
        "--replay", type=REPLAY, section=QUALITY, help="Render only this pixel, up to this sample, and print its value."
    ),
)


@click.command(
    "render",
    cls=Command,
    short_help="Render a picture of a scene.",
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
@material_option
@work_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Collect, render, write."""
    from eclat.images.tone import stops_of

    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        if flags["replay_settings"]:
            flags.update(replayed_flags(flags["replay_settings"], context))
        outputs = _outputs(flags)
        options = _options(flags, context)
        scene, exposure = load_scene_to_show(flags)
        index = camera_index(scene, flags["camera"])
        _check_pixels(flags, scene.cameras[index].size)
        common = {name: flags[name] for name in REACHING_RENDER} | {"camera": index, "progress": reporter.progress}
        what = eclat.load_solved(flags["cache"], scene) if options is None else options

        def keep(image: Image) -> None:
            stops = stops_of(exposure, image.pixels)
            chosen = stops if exposure == "auto" and any(o.lower().endswith(".png") for o in outputs) else None
            if chosen is not None:
                image.metadata["exposure"] = chosen
            image = _finished(image, flags, stops)
            for output in outputs:
                image.save(output, exposure=stops, tone_mapping=flags["tone_mapping"])
            if flags["replay"]:
                say_replayed_sample(reporter, image, flags["replay"])
            else:
                _say_result(reporter, image, outputs, chosen_by_clock(flags, image.metadata), chosen)
                say_replay_of_bad_samples(reporter, image, flags["scene"], outputs)

        with keeping_partial(flags["keep_partial"], keep, reporter):
            image = eclat.render(scene, what, **common)
        keep(image)


def _outputs(flags: dict[str, Any]) -> list[str]:
    """The files to write, known to be writable before any work is done."""
    from eclat.images.image import check_output

    default = [] if flags["replay"] else [f"{scene_stem(flags['scene'])}.png"]
    outputs = list(flags["output"]) or default
    for output in outputs:
        check_output(output)
    return outputs


def _options(flags: dict[str, Any], context: click.Context) -> Method | None:
    """The method's options, or None where a solved cache brings its own."""
    if flags["samples"] is not None and flags["time"] is not None:
        raise EclatError("--time cannot be combined with --samples")
    if flags["refine"] and flags["time"] is not None:
        raise EclatError("--time cannot be combined with --refine")
    if flags["refine"] and flags["cache"]:
        raise EclatError(
            "--refine cannot be combined with --cache: `eclat solve --cache FILE --refine` refines a cache"
        )
    if flags["refine"] and not flags["check"]:
        raise EclatError("--refine cannot be combined with --no-check: the estimated error decides when to stop")
    given = context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT
    check_cache_alone(flags, given and not flags["replay_settings"])
    options = None
    if not flags["cache"]:
        options = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        if flags["show_records"] and not options.has_records:
            raise EclatError(f"--show-records: expected a method with records, got {flags['method']}")
    return options


def _check_pixels(flags: dict[str, Any], size: tuple[int, int] | None) -> None:
    """Refuse pixels outside the picture, and make `--replay` a crop of one pixel."""
    if flags["replay"]:
        x, y, sample = flags["replay"]
        flags.update(crop=(x, y, x + 1, y + 1), samples=sample + 1, adaptive=False, time=None)
    if flags["crop"] and size:
        _, _, x1, y1 = flags["crop"]
        if x1 > size[0] or y1 > size[1]:
            flag = "replay" if flags["replay"] else "crop"
            got = ",".join(map(str, flags[flag]))
            raise EclatError(f"--{flag}: expected pixels inside the picture of {size[0]}x{size[1]}, got {got}")


def _finished(image: Image, flags: dict[str, Any], stops: float) -> Image:
    """With what else goes into the files."""
    image.metadata["settings"] = settings_of(flags, image.metadata)
    return image.show_records(stops) if flags["show_records"] else image


def _say_result(
    reporter: Reporter, image: Image, outputs: list[str], chosen: list[str], exposure: float | None
) -> None:
    """One line. `chosen`: options that the clock chose; `exposure`: the stops that were chosen, if any were."""
    statistics = image.metadata.get("statistics", {})
    parts = [f"{image.width}x{image.height}", str(image.metadata.get("method", ""))]
    if "seconds" in statistics:
        parts.append(f"{statistics['seconds']:.1f} s")
    for name in ("samples", "rays", "records"):
        if statistics.get(name):
            parts.append(f"{statistics[name]:,.0f} {name}")
    if "samples_done" in image.metadata:
        parts.append("interrupted")
    parts.append(error_text(statistics))
    if exposure is not None:
        parts.append(f"exposure {exposure:+g} stops")
    if chosen:
        parts.append("records by --set " + " --set ".join(chosen))
    text = f"{', '.join(map(str, outputs))}: {', '.join(filter(None, parts))}"
    reporter.result(text, files=[str(Path(o)) for o in outputs], metadata=image.metadata)


assert set(REPEATED) <= {parameter.name for parameter in command.params}
