# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat denoise`, which removes the noise of finished pictures and measures the error that remains."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from eclat.cli.command import Command
from eclat.cli.quality_options import exposure_option, output_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.errors import EclatError
from eclat.images.denoiser import require_denoiser
from eclat.images.image import Image, check_output
from eclat.measure.error_estimate import error_text
from eclat.verbs.denoise import denoise

EXAMPLES = {
    "eclat denoise room.exr": "Denoise one picture and write room_denoised.exr:",
    "eclat denoise room.exr -o room.exr -o room.png": "Replace the picture, and write another for the screen:",
    "eclat denoise a.exr b.exr -o room.exr": "Denoise two pictures with different seeds, and measure the remaining error:",
}


@click.command(
    "denoise",
    cls=Command,
    short_help="Remove the noise of finished pictures.",
    examples=EXAMPLES,
    help="""Remove the noise of PICTURE with Open Image Denoise (pip install pyoidn).

    An .exr file that `eclat render` wrote gives the best result: its layers albedo and normal show the denoiser where the
    edges are.

    With OTHER, a second picture of the same scene with the same number of samples and another --seed, the error that
    remains is measured without a reference, and the samples are kept as they are wherever denoising would increase the
    error. An error that both pictures share, such as the error of a cache that both read, is not measured.""",
)
@click.argument("pictures", metavar="PICTURE [OTHER]", nargs=-1, required=True)
@output_option("File to write: .exr, .png, .hdr, .pfm or .npy; repeatable [PICTURE_denoised.exr].", multiple=True)
@exposure_option("Exposure of a .png in stops; each doubles the brightness [0].", 0.0)
@reporting_options
def command(**flags: Any) -> None:
    """Load the pictures, denoise them, and write the result."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        names = flags["pictures"]
        if len(names) > 2:
            raise EclatError(f"PICTURE: expected one or two pictures, got {len(names)}")
        require_denoiser()
        first = Path(names[0])
        outputs = list(flags["output"]) or [str(first.with_name(f"{first.stem}_denoised.exr"))]
        for output in outputs:
            check_output(output)
        image = denoise(*map(Image.load, names))
        for output in outputs:
            image.save(output, exposure=flags["exposure"])
        statistics = image.metadata.get("statistics", {}) if len(names) == 2 else {}
        parts = [f"{image.width}x{image.height}", error_text(statistics), "denoised"]
        reporter.result(f"{', '.join(outputs)}: {', '.join(filter(None, parts))}", files=outputs, statistics=statistics)
