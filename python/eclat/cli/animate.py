# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat animate`, which makes the frames of a scene that moves, and a video of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import eclat
from eclat.cli.command import Command, option, together
from eclat.cli.farm_options import farm_options, on_farm
from eclat.cli.method_options import method_notes, method_option, options_of, set_option
from eclat.cli.parameters import Name, Number, Parsed
from eclat.cli.quality_options import (
    QUALITY,
    adaptive_option,
    exposure_option,
    max_depth_option,
    max_error_option,
    output_option,
    samples_option,
)
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    camera_index,
    camera_options,
    light_options,
    load_scene_to_show,
    material_option,
    moving_scene_argument,
    scene_stem,
    work_options,
)
from eclat.cli.shards import shard_option
from eclat.frames.plan import parse_frames

FRAMES = "Frames"

REACHING_ANIMATE = (
    "frames", "fps", "size", "samples", "max_error", "max_depth", "seed", "threads", "adaptive", "denoise", "shutter",
    "moments", "motion", "shard", "overwrite", "keep_cache", "tone_mapping", "accumulate",
)  # fmt: skip
"""Flags that are passed to `eclat.animate` unchanged, as arguments of the same names."""

EXAMPLES = {
    "eclat animate walk.glb --frames 0:119 -o frames/%04d.exr": "Render five seconds for compositing, with motion vectors:",
    "eclat animate walk.glb --frames 0:119 -o walk.mp4": "Render the same as a video, for which ffmpeg must be installed:",
    "eclat animate room.glb --camera-path walk.json --frames 0:95 -o f/%d.png": "Walk through a scene on a path of your own:",
    "eclat animate walk.glb --frames 0:119 --scheduler tcp://hub:8786 -o f/%d.exr": "Render on all workers of a Dask scheduler:",
    "eclat animate walk.glb --frames 0:119 --shard 2/3 -o frames/%04d.exr": "Render the second third, on one of three machines:",
}

_frame_options = together(
    option(
        "--frames",
        type=Parsed("FIRST:LAST[:STEP]", "frames FIRST:LAST, such as 0:119", parse_frames),
        required=True,
        section=FRAMES,
        help="The frames, both ends included. Frame n shows the scene at n / fps seconds.",
    ),
    option(
        "--fps", type=Number(float, 0, 1e4, above=True), default=24.0, section=FRAMES, help="Frames per second [24]."
    ),
    option(
        "--shutter",
        type=Number(float, 0, 1),
        default=0.0,
        section=FRAMES,
        help="Part of the time between two frames during which the shutter is open; 0.5 is usual for films [0, no blur].",
    ),
    option(
        "--moments",
        type=Number(int, 1, 256),
        default=8,
        section=FRAMES,
        help="Number of pictures at different times within --shutter of which a frame is the mean [8].",
    ),
    option(
        "--motion/--no-motion",
        default=None,
        section=FRAMES,
        help="Add the layers object_id, motion_next and motion_previous for compositors [on for .exr files].",
    ),
    option(
        "--accumulate",
        type=Number(int, 0, 16),
        default=0,
        section=FRAMES,
        help="Let a frame take the samples of N frames before and after it as well, along the motion vectors and before it is "
        "denoised: less noise where the camera moves, but what moves there in the light is blurred [0].",
    ),
    shard_option(
        FRAMES, "Make only each N-th frame, from the I-th on, so that N machines share the work [all frames]."
    ),
    option(
        "--overwrite",
        is_flag=True,
        section=FRAMES,
        help="Render finished frames again, and replace files of other origin.",
    ),
    option(
        "--keep-cache",
        is_flag=True,
        section=FRAMES,
        help="Keep what is solved once for all frames in a file beside them, and read it from there when the animation is "
        "started again, or by other shards.",
    ),
)

_quality_options = together(
    max_error_option("Stop when the estimated relative error of a frame is below this value", 0.03),
    samples_option("Take this many paths per pixel, instead of as many as --max-error needs"),
    adaptive_option("denoised if the frames are denoised, else noise; off for methods without records"),
    option(
        "--denoise/--no-denoise",
        default=None,
        section=QUALITY,
        help="Remove the noise with Open Image Denoise [on if the denoiser is installed, unless --samples is given].",
    ),
    max_depth_option(),
)

_output_options = together(
    output_option("Files to write, .exr or .png with %d or %04d for the number, or an .mp4 [SCENE/%04d.png]."),
    exposure_option(
        "Exposure of .png files in stops, or auto, which makes the average of the middle frame mid-grey in all frames "
        "[auto if light is in candela and lux, or comes from --sun or a default, else 0].",
        default=None,
        auto=True,
    ),
    option(
        "--tone-mapping",
        type=Name("NAME", "none", "filmic"),
        default="none",
        section="Output",
        help="Tone mapping of .png files: none clips highlights at white, filmic compresses them smoothly [none].",
    ),
)


@click.command(
    "animate",
    cls=Command,
    short_help="Render the frames of a scene that moves, or a video.",
    examples=EXAMPLES,
    notes=method_notes,
    help="""Render the frames of SCENE, which moves: by the animations of its file, or by --camera-path.

    Finished frames are kept when the command is started again, and frames do not depend on the order, the number of
    threads or on which machine makes them. If only the camera moves, the records that all frames want are solved once, and
    all frames read them. If anything else moves, records of irradiance-cache stay on their surfaces, are
    gathered again when the light there has changed, and are interpolated between; other methods solve each frame anew.""",
)
@moving_scene_argument
@_frame_options
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
def command(**flags: Any) -> None:
    """Read the flags and the scene, and render the frames."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or str(Path(scene_stem(flags["scene"])) / "%04d.png")
        method = options_of(flags["method"], flags["settings"], max_error=flags["max_error"])
        scene, exposure = load_scene_to_show(flags)
        camera = camera_index(scene, flags["camera"])
        counts = {True: 0, False: 0}

        def finished(path: Path, kept: bool) -> None:
            counts[kept] += 1
            if reporter.events is not None and not flags["quiet"]:
                reporter.events.emit("frame", file=str(path), kept=kept)

        common = {name: flags[name] for name in REACHING_ANIMATE}
        with on_farm(flags):
            files = eclat.animate(
                scene, method, output=output, camera=camera, exposure=exposure, progress=reporter.progress,
                finished=finished, **common,
            )  # fmt: skip
        names = f"{files[0]} to {files[-1]}" if len(files) > 1 else ", ".join(map(str, files)) or "no frames"
        kept = f", {counts[True]:,} of them kept" if counts[True] else ""
        video = output if output.lower().endswith(".mp4") and Path(output).exists() else None
        text = f"{f'{video}, ' if video else ''}{names}: {len(files):,} frames{kept}"
        reporter.result(text, files=[str(file) for file in files], kept=counts[True], video=video)
