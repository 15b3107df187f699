# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat convert`, which writes a picture or a scene in another format."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click
import numpy as np

import eclat
from eclat.cli.command import Command, completes, option
from eclat.cli.parameters import Name
from eclat.cli.quality_options import exposure_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.errors import EclatError, did_you_mean
from eclat.files.atomic_file import check_writable, write_file
from eclat.images.image import Image, check_output
from eclat.images.image_files import FORMATS
from eclat.images.tone import TONE_MAPPINGS, exposure_stops

EXAMPLES = {
    "eclat convert room.exr room.png --exposure auto --tone-mapping filmic": "Make a picture for the screen:",
    "eclat convert room.exr light.png --layer indirect": "Look at one layer of a picture:",
    "eclat convert sky.exr sky.hdr": "Write a picture for programs that read Radiance pictures:",
    "eclat convert hall.xml hall.glb": "Write a scene as glTF, for viewers and modellers:",
}

SCENE = ".glb"


@click.command(
    "convert",
    cls=Command,
    short_help="Write a picture or a scene in another format.",
    examples=EXAMPLES,
    help=f"""Write the picture or the scene INPUT as OUTPUT, whose suffix tells the format.

    A picture is an .exr, .hdr, .pfm or .npy file and becomes {", ".join(FORMATS)}. Only .exr to .exr keeps layers, and
    .hdr keeps 8 bits of the largest channel. A scene is what `eclat render` reads, and becomes {SCENE}; what glTF cannot
    express is named in a warning.""",
)
@click.argument("source", metavar="INPUT", shell_complete=completes("file"))
@click.argument("target", metavar="OUTPUT", shell_complete=completes("file"))
@exposure_option("Exposure of a .png in stops, or auto; each stop doubles the brightness [0].", None, auto=True)
@option(
    "--tone-mapping",
    type=Name("NAME", *TONE_MAPPINGS),
    section="Output",
    help=f"Tone curve of a .png: {' or '.join(TONE_MAPPINGS)} [none].",
)
@option("--layer", metavar="NAME", section="Output", help="Write this layer of an .exr picture [the picture itself].")
@option(
    "--root",
    metavar="DIR",
    section="Other",
    help="Refuse every file that a scene reads, itself included, if it lies outside this folder [files may lie anywhere].",
)
@reporting_options
def command(**flags: Any) -> None:
    """Read the input and write the output."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        suffix = Path(flags["target"]).suffix.lower()
        if suffix != SCENE and suffix not in FORMATS:
            known = [*FORMATS, SCENE]
            got = f"{suffix!r}{did_you_mean(suffix, known)}" if suffix else "a name without a suffix"
            raise EclatError(f"OUTPUT: {flags['target']}: expected one of the suffixes {', '.join(known)}, got {got}")
        if suffix != ".png":
            _refuse(flags, ("exposure", "tone_mapping"), "only .png files")
        if suffix == SCENE:
            _refuse(flags, ("layer",), "only pictures")
            text = _convert_scene(flags)
        else:
            _refuse(flags, ("root",), "only scenes")
            text = _convert_picture(flags, suffix)
        reporter.result(f"{flags['target']}: {text}", files=[flags["target"]])


def _refuse(flags: Mapping[str, Any], names: tuple[str, ...], who: str) -> None:
    """Raise EclatError for flags that were given and that this conversion does not use."""
    for name in names:
        if flags[name] is not None:
            raise EclatError(f"--{name.replace('_', '-')}: {flags['target']} has none, {who} have it")


def _convert_scene(flags: Mapping[str, Any]) -> str:
    from eclat.gltf_export import encode_glb

    check_writable(flags["target"])
    scene = eclat.load(flags["source"], root=flags["root"])
    data = encode_glb(scene, generator=f"eclat {eclat.__version__}")
    write_file(flags["target"], data)
    triangles = sum(len(mesh.triangles) for mesh in scene.meshes)
    return f"{len(scene.meshes):,} meshes, {triangles:,} triangles, {len(data) / 1e6:.1f} MB"


def _convert_picture(flags: Mapping[str, Any], suffix: str) -> str:
    check_output(flags["target"])
    image = Image.load(flags["source"])
    if flags["layer"] is not None:
        image = _layer(image, flags["layer"], flags["source"])
    if suffix != ".png":
        image.save(flags["target"])
        return f"{image.width}x{image.height}"
    stops = exposure_stops(flags["exposure"] or 0.0, image.pixels)
    image.save(flags["target"], stops, flags["tone_mapping"] or "none")
    return f"{image.width}x{image.height}, exposure {stops:+g} stops"


def _layer(image: Image, name: str, source: str) -> Image:
    """Make a picture of a layer; layers of one channel become grey."""
    if name not in image.layers:
        known = ", ".join(image.layers) or "no layers"
        raise EclatError(f"--layer: {source}: expected one of {known}, got {name!r}{did_you_mean(name, image.layers)}")
    layer = image.layers[name]
    grey = layer[..., None] if layer.ndim == 2 else layer
    return Image(np.repeat(grey, 3, axis=2) if grey.shape[2] == 1 else grey, {}, image.metadata)
