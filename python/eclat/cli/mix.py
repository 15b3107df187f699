# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat mix`, which changes the light of a finished picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from eclat.cli.command import Command
from eclat.cli.quality_options import exposure_option, output_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.errors import EclatError
from eclat.images.image import Image, check_output
from eclat.images.mixing import groups_of, mix

EXAMPLES = {
    "eclat mix room.exr": "List the groups of a picture:",
    "eclat mix room.exr sky=0 lamp=2 -o evening.png": "Put out the sky, and make the lamp twice as bright:",
    "eclat mix room.exr lamp=0.3,#ffcc88 -o warm.exr": "Dim the lamp and make it warmer:",
}


@click.command(
    "mix",
    cls=Command,
    short_help="Change the light of a finished picture.",
    examples=EXAMPLES,
    help="""Change the strength and colour of the lamps in PICTURE, an .exr file of `eclat render --light-groups`.

    Each GROUP=WEIGHT multiplies the light of a group of lamps by a factor, by an sRGB colour, or by both, as in
    0.3,#ffcc88. Groups that are not named keep their light. Without any, the groups are listed. A denoised picture stays
    denoised, because each group was denoised on its own.""",
)
@click.argument("picture", metavar="PICTURE")
@click.argument("weights", metavar="[GROUP=WEIGHT]...", nargs=-1)
@output_option("File to write: .exr, .hdr, .png, .pfm or .npy; repeatable [PICTURE_mixed.exr].", multiple=True)
@exposure_option("Exposure of a .png in stops, or auto [0].", 0.0, auto=True)
@reporting_options
def command(**flags: Any) -> None:
    """Load the picture, mix its groups, and write the result."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        path = Path(flags["picture"])
        weights = _weights(flags["weights"])
        if not weights and not flags["output"]:
            names = list(groups_of(Image.load(path)))
            reporter.result("\n".join(names) or f"{path}: no groups of lamps", groups=names)
            return
        outputs = list(flags["output"]) or [str(path.with_name(f"{path.stem}_mixed.exr"))]
        for output in outputs:
            check_output(output)
        image = mix(Image.load(path), weights)
        for output in outputs:
            image.save(output, exposure=flags["exposure"])
        reporter.result(f"{', '.join(outputs)}: {image.width}x{image.height}", files=outputs, mix=image.metadata["mix"])


def _weights(texts: Sequence[str]) -> dict[str, str]:
    weights: dict[str, str] = {}
    for text in texts:
        # A name may contain the sign, but a weight does not.
        name, _, weight = text.rpartition("=")
        if not name or not weight:
            raise EclatError(f"GROUP=WEIGHT: expected a group and its weight, such as lamp=0.3,#ffcc88, got {text!r}")
        if name in weights:
            raise EclatError(f"GROUP=WEIGHT: {name} is given twice, expected it once")
        weights[name] = weight
    return weights
