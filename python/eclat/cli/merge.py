# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat merge`, which makes one file of what several jobs computed."""

from __future__ import annotations

from functools import reduce
from pathlib import Path
from typing import Any

import click

import eclat
from eclat.cli.command import Command
from eclat.cli.quality_options import output_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable

EXAMPLES = {
    "eclat merge top.exr bottom.exr -o room.exr": "Join two parts that were rendered with --shard 1/2 and --shard 2/2:",
    "eclat merge a.npz b.npz c.npz -o all.npz": "Join the records that three jobs solved for three views:",
}


@click.command(
    "merge",
    cls=Command,
    short_help="Join caches, or parts of a picture.",
    examples=EXAMPLES,
    help="""Join FILES that several jobs made of one scene into one file.

    .npz files of `eclat solve` must have the same options: the result has the records of all, without duplicates, or the
    photons of all, which must differ in their --seed. .exr files of `eclat render --samples … --shard …`, or of --crop … with
    --continuable, must cover each pixel of the picture once: the result has the bits of a picture that was rendered at once,
    and can be continued.""",
)
@click.argument("files", metavar="FILES...", nargs=-1, required=True)
@output_option("File to write, .npz or .exr as the parts are [merged.npz or merged.exr].")
@reporting_options
def command(**flags: Any) -> None:
    """Read the files, merge them, and write the result."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        files = flags["files"]
        kinds = {Path(name).suffix.lower() for name in files}
        if kinds not in ({".npz"}, {".exr"}):
            raise EclatError(f"expected .npz files or .exr files to merge, got {', '.join(sorted(kinds))}")
        kind = kinds.pop()
        output = flags["output"] or f"merged{kind}"
        if Path(output).suffix.lower() != kind:
            raise EclatError(f"{output}: expected a name that ends in {kind}, as those of the parts do")
        check_writable(output)
        if kind == ".exr":
            image = eclat.merge_pictures(list(files))
            image.save(output)
            reporter.result(f"{output}: {image.width}x{image.height}, from {len(files):,} parts", file=output)
            return
        solved = reduce(eclat.merge, (eclat.load_solved(name) for name in files))
        solved.save(output)
        reporter.result(f"{output}: {solved.describe()}, from {len(files):,} parts", file=output, **solved.facts())
