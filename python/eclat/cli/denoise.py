# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat denoise`: takes the noise out of finished pictures, and measures what error is left."""

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
    "eclat denoise room.exr": "Writes room_denoised.exr; the layers albedo and normal of room.exr guide the denoiser:",
    "eclat denoise room.exr -o room.exr -o room.png": "Replaces the picture, and writes one for the screen:",
    "eclat denoise a.exr b.exr -o room.exr": "Of two pictures with unlike --seed, denoises both and states the error left:",
}


@click.command(
    "denoise",
    cls=Command,
    short_help="Take the noise out of finished pictures.",
    examples=EXAMPLES,
    help="""Take the noise out of PICTURE with Open Image Denoise (pip install pyoidn).

    Pictures as EXR hold the layers that tell the denoiser which edges are real. With two pictures of the same scene, rendered
    with as many samples each and with different values of --seed, each half is judged by the other: the error that is left is
    measured without a reference, and where the denoiser does more harm than good the samples are kept as they are. What
    both pictures share, such as the error of one cache, cannot be measured that way.""",
)
@click.argument("pictures", metavar="PICTURE [OTHER]", nargs=-1, required=True)
@output_option("An .exr, .png, .pfm or .npy file; repeatable [PICTURE_denoised.exr].", multiple=True)
@exposure_option("Stops of exposure of a PNG [0].", 0.0)
@reporting_options
def command(**flags: Any) -> None:
    """Load, denoise, write."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        names = flags["pictures"]
        if len(names) > 2:
            raise EclatError(f"PICTURE: expected one picture or two, got {len(names)}")
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
