# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat render`, which makes a picture of a scene."""

from __future__ import annotations

import time as clock
from typing import TYPE_CHECKING, Any

import click

import eclat
from eclat.cli.command import Command, option, together
from eclat.cli.farm_options import farm_options, on_farm
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import CROP, REPLAY, LightGroups, Name, Parsed, groups_given
from eclat.cli.partial import keep_partial_option, keeping_partial
from eclat.cli.picture_summary import say_result, why_above
from eclat.cli.previews import Previews, wants_previews
from eclat.cli.quality_options import (
    QUALITY,
    adaptive_option,
    cache_option,
    check_cache_alone,
    exposure_option,
    max_depth_option,
    max_error_option,
    no_check_option,
    output_option,
    refine_option,
    samples_option,
    time_left,
    time_option,
)
from eclat.cli.replay import (
    REPEATED,
    chosen_by_clock,
    continued_flags,
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
from eclat.cli.shards import shard_option
from eclat.errors import EclatError

if TYPE_CHECKING:
    from eclat.images.image import Image
    from eclat.methods import Method

REACHING_RENDER = (
    "samples",
    "gathered_samples",
    "max_error",
    "time",
    "adaptive",
    "denoise",
    "halves",
    "continued",
    "continuable",
    "shard",
    "light_groups",
    "size",
    "crop",
    "max_depth",
    "seed",
    "threads",
    "keep_partial",
    "check",
    "refine",
    "display_server",
)
"""Flags that are passed to `eclat.render` unchanged, as arguments of the same names."""

EXAMPLES = {
    "eclat render cornell-box": "Render a built-in scene to cornell-box.png in the current folder:",
    "eclat render room.glb -o room.exr -o room.png": "Render your own scene, for compositing and for the screen:",
    "eclat render hall.obj --sun 135,60 --camera-from -8,2,0 --camera-to 0,3,0": (
        "Render a model that has no light and no camera:"
    ),
    "eclat render room.glb --time 30": "Render the best picture that half a minute allows:",
    "eclat render room.glb --method path --samples 1024 -o truth.exr": "Render an unbiased reference:",
    "eclat render room.glb --max-error 0.01 --continue room.exr": (
        "Improve a picture that was rendered with --continuable:"
    ),
    "eclat render room.glb --cache room.npz --camera 1": "Render another view from a file that `eclat solve` wrote:",
    "eclat render room.glb --samples 64 --shard 2/3 -o part-2.exr": "Render the second third, on one of three machines:",
    "eclat render room.glb --light-groups each -o room.exr": "Render the light of each lamp as a layer, to mix it later:",
}


def _checked_address(text: str) -> str:
    from eclat.tev.display import address_of

    address_of(text)
    return text


_output_options = together(
    output_option(
        "File to write: .png, .exr (with all layers and metadata), .hdr, .pfm or .npy; repeatable [SCENE.png].",
        multiple=True,
    ),
    exposure_option(
        "Exposure of a .png in stops (each doubles the brightness), or auto, which makes the average mid-grey "
        "[auto if light is in candela and lux, or comes from --sun or a default, else 0].",
        default=None,
        auto=True,
    ),
    option(
        "--tone-mapping",
        type=Name("NAME", "none", "filmic"),
        default="none",
        section="Output",
        help="Tone mapping of a .png: none clips highlights at white, filmic compresses them smoothly [none].",
    ),
    keep_partial_option("If you press Ctrl-C, write the picture of the samples taken so far."),
    option(
        "--light-groups",
        type=LightGroups(),
        multiple=True,
        section="Output",
        help="Make a layer of the light of each lamp (each), or of the lamps with these names, in which * stands for any "
        "characters, as in kitchen=lamp*,stove; repeatable. `eclat mix` changes the light of the .exr file afterwards. Each "
        "group is rendered on its own and takes as long as a picture.",
    ),
    option(
        "--display-server",
        type=Parsed("HOST:PORT", "host:port, as in localhost:14158", _checked_address),
        section="Output",
        help="Show the picture while it grows in tev, which listens there, usually at localhost:14158: its tiles and "
        "layers as they come, and the positions of its records.",
    ),
    option("--show-records", is_flag=True, section="Output", help="Mark the positions of the records in the picture."),
)

_quality_options = together(
    cache_option(),
    max_error_option("Stop when the estimated relative error of the picture is below this value", 0.03),
    samples_option("Take this many paths per pixel, instead of as many as --max-error needs"),
    time_option("Finish in about this many seconds, with the scene loaded, instead of when --max-error is reached."),
    adaptive_option(
        "denoised if the picture is denoised without --time, else noise; off with --crop and for methods without records"
    ),
    option(
        "--denoise/--no-denoise",
        default=None,
        section=QUALITY,
        help="Remove the noise with Open Image Denoise and measure the error that remains, which --max-error then bounds "
        "[on if the denoiser is installed, unless --samples or --crop is given].",
    ),
    option(
        "--halves/--no-halves",
        default=None,
        section=QUALITY,
        help="Take the samples in two independent halves, from which the error is measured [on with --denoise].",
    ),
    samples_option(
        "With --samples and --halves, add this many paths per pixel that read the records only after a matte surface, as "
        "--max-error does where the records err too much",
        name="--gathered-samples",
    ),
    option("--crop", type=CROP, section=CAMERA, help="Render only this rectangle of pixels; the rest stays black."),
    shard_option(
        CAMERA,
        "Render only the I-th of N bands of rows, with --samples, to an .exr file; `eclat merge` joins all N, with the bits of a "
        "picture that was rendered at once.",
    ),
    max_depth_option(),
    no_check_option(),
    refine_option("Refine the records until their estimated error is below --max-error."),
    option(
        "--continuable",
        is_flag=True,
        section=QUALITY,
        help="Write what --continue needs to an .exr file, which is then about three times as large.",
    ),
    option(
        "--continue",
        "continued",
        metavar="FILE",
        section=QUALITY,
        help="Add samples to this .exr file, which was written with --continuable; its settings stay, and --max-error, --time, "
        "--denoise, --cache, or --samples for the total number, may differ. Without --output the file itself is replaced.",
    ),
    option(
        "--replay-settings",
        metavar="FILE",
        section=QUALITY,
        help="Repeat the run that made this .exr or .png file, bit for bit.",
    ),
    option(
        "--replay",
        type=REPLAY,
        section=QUALITY,
        help="Render only this pixel, up to and including this sample, and print the value of the sample.",
    ),
)


@click.command(
    "render",
    cls=Command,
    short_help="Render a picture of a scene.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Render a picture of SCENE: a .gltf, .glb, .obj, .ply, .usd or Mitsuba .xml file, or the name of a built-in
    scene.

    All options have defaults. Without any, the light is computed by irradiance caching until the estimated error of
    the picture is below 3 %, and the picture is written to SCENE.png in the current folder. Unless --samples, --time or
    --crop is given, the file holds a rough picture after a few seconds, and better ones until the last.""",
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
@farm_options
@reporting_options
@click.pass_context
def command(context: click.Context, /, **flags: Any) -> None:
    """Read the flags and the scene, render the picture, and write the files."""
    from eclat.images.tone import exposure_stops

    begun = clock.perf_counter()
    with Reporter(flags["quiet"], flags["as_json"]) as reporter, on_farm(flags):
        if flags["replay_settings"]:
            flags.update(replayed_flags(flags["replay_settings"], context))
        if flags["continued"]:
            flags.update(_continued(flags, context))
        outputs = _outputs(flags)
        options = _options(flags, context)
        scene, exposure = load_scene_to_show(flags)
        index = camera_index(scene, flags["camera"])
        _check_pixels(flags, scene.cameras[index].size)
        common = {name: flags[name] for name in REACHING_RENDER} | {"camera": index, "progress": reporter.progress}
        common["light_groups"] = groups_given(flags["light_groups"])
        what = eclat.load_solved(flags["cache"], scene) if options is None else options
        common["time"] = time_left(flags["time"], clock.perf_counter() - begun)

        def keep(image: Image) -> None:
            stops = exposure_stops(exposure, image.pixels)
            chosen = stops if exposure == "auto" and any(o.lower().endswith(".png") for o in outputs) else None
            if chosen is not None:
                image.metadata["exposure"] = chosen
            image = _finished(image, flags, stops)
            for output in outputs:
                image.save(output, exposure=stops, tone_mapping=flags["tone_mapping"])
            if flags["replay"]:
                say_replayed_sample(reporter, image, flags["replay"])
            else:
                say_result(reporter, image, outputs, chosen_by_clock(flags, image.metadata), chosen)
                if why := why_above(flags, image.metadata.get("statistics", {})):
                    reporter.note(why)
                say_replay_of_bad_samples(reporter, image, flags["scene"], outputs)

        previews = Previews(outputs, exposure, flags["tone_mapping"])
        if wants_previews(flags):
            common["preview"] = previews
        with keeping_partial(flags["keep_partial"], keep, reporter):
            try:
                image = eclat.render(scene, what, **common)
            except KeyboardInterrupt:
                if previews.written and not flags["keep_partial"]:
                    reporter.note(f"{', '.join(outputs)}: holds an unfinished picture")
                raise
        keep(image)


def _continued(flags: dict[str, Any], context: click.Context) -> dict[str, Any]:
    """Return the flags of the picture that is continued. Raises EclatError if that cannot be combined with others."""
    for name in ("replay", "replay_settings", "keep_partial"):
        if flags[name]:
            raise EclatError(f"--continue cannot be combined with --{name.replace('_', '-')}: give one of them")
    return continued_flags(flags["continued"], context)


def _outputs(flags: dict[str, Any]) -> list[str]:
    """List the files to write, after checking that each can be written."""
    from eclat.images.image import check_output

    default = [] if flags["replay"] else [flags["continued"] or f"{scene_stem(flags['scene'])}.png"]
    outputs = list(flags["output"]) or default
    needs_sums = "--shard" if flags["shard"] else "--continuable" if flags["continuable"] else None
    if needs_sums and not any(output.lower().endswith(".exr") for output in outputs):
        raise EclatError(f"{needs_sums}: expected an .exr file with --output, got {', '.join(outputs) or 'none'}")
    for output in outputs:
        check_output(output)
    return outputs


def _options(flags: dict[str, Any], context: click.Context) -> Method | None:
    """Return the method with its options, or None if `--cache` names a file that holds them."""
    if flags["samples"] is not None and flags["time"] is not None:
        raise EclatError("--time cannot be combined with --samples: give one of them")
    if flags["gathered_samples"] is not None and flags["samples"] is None:
        raise EclatError("--gathered-samples needs --samples, and --halves or --denoise")
    if flags["refine"] and flags["time"] is not None:
        raise EclatError("--time cannot be combined with --refine: give one of them")
    for name in ("cache", "continuable", "continued", "keep_partial", "replay") if flags["light_groups"] else ():
        if flags[name]:
            flag = {"continued": "continue"}.get(name, name).replace("_", "-")
            raise EclatError(f"--light-groups cannot be combined with --{flag}: give one of them")
    if flags["refine"] and flags["cache"]:
        raise EclatError(
            "--refine cannot be combined with --cache: to refine a cache, run `eclat solve --cache FILE --refine`"
        )
    if flags["refine"] and not flags["check"]:
        raise EclatError("--refine cannot be combined with --no-check: refining stops at an estimated error")
    given = context.get_parameter_source("method") is not click.core.ParameterSource.DEFAULT
    check_cache_alone(flags, given and not (flags["replay_settings"] or flags["continued"]))
    options = None
    if not flags["cache"]:
        options = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        if flags["show_records"] and not options.has_records:
            raise EclatError(f"--show-records: expected a method with records, got {flags['method']}")
    return options


def _check_pixels(flags: dict[str, Any], size: tuple[int, int] | None) -> None:
    """Check that all pixels given lie inside the picture, and turn `--replay` into a crop of one pixel."""
    if flags["replay"]:
        x, y, sample = flags["replay"]
        if flags["halves"]:
            sample |= 1  # Both halves take the same number of samples.
        flags.update(replay=(x, y, sample), crop=(x, y, x + 1, y + 1), samples=sample + 1)
        flags.update(adaptive=False, time=None, denoise=False)
    if flags["crop"] and size:
        _, _, x1, y1 = flags["crop"]
        if x1 > size[0] or y1 > size[1]:
            flag = "replay" if flags["replay"] else "crop"
            got = ",".join(map(str, flags[flag]))
            raise EclatError(f"--{flag}: expected pixels inside the picture of {size[0]}x{size[1]}, got {got}")


def _finished(image: Image, flags: dict[str, Any], stops: float) -> Image:
    """Add the settings of the run to the metadata and, with `--show-records`, marks of the records to the picture."""
    if not (flags["light_groups"] and flags["time"] is not None):
        # With both, the clock gave each group samples and records of its own, which no flags repeat.
        image.metadata["settings"] = settings_of(flags, image.metadata)
    return image.show_records(stops) if flags["show_records"] else image


assert set(REPEATED) <= {parameter.name for parameter in command.params}
