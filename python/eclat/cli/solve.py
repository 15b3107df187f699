# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`eclat solve`: the records of a scene, computed once and kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import eclat
from eclat.atomic_file import check_writable
from eclat.cli.command import Command, option
from eclat.cli.method_options import DEFAULT_METHOD, method_notes, options_of, set_option
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import (
    MAX_DEPTH,
    MAX_ERROR,
    camera_index,
    camera_options,
    light_options,
    load_scene,
    scene_argument,
    scene_stem,
    work_options,
)
from eclat.errors import EclatError

EXAMPLES = {
    "eclat solve room.glb": "Writes room.npz:",
    "eclat solve room.glb -o fine.npz --max-error 0.005": "Finer records:",
    "eclat render room.glb --cache fine.npz --samples 64": "Read them; the scene must be the same:",
}


@click.command(
    "solve",
    cls=Command,
    short_help="Compute the records of a scene and keep them.",
    examples=EXAMPLES,
    notes=lambda: method_notes(DEFAULT_METHOD),
    help="""Compute the irradiance records that a view of SCENE needs, and keep them in a file.

    The file is a NumPy .npz archive with positions, normals, radii, irradiance and its gradients; `eclat render
    --cache` and `eclat.Solution.load` read it. A scene that has changed since is refused.""",
)
@scene_argument
@option("-o", "--output", metavar="FILE", section="Output", help="A file ending in .npz [SCENE.npz].")
@option("--max-error", type=MAX_ERROR, default=0.01, section="Quality", help="Relative error of indirect light [0.01].")
@option("--max-depth", type=MAX_DEPTH, default=-1, section="Quality", help="As for render; -1 no limit [-1].")
@set_option
@camera_options
@light_options
@work_options
@reporting_options
def command(**flags: Any) -> None:
    """Solve and save."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        output = flags["output"] or f"{scene_stem(flags['scene'])}.npz"
        if Path(output).suffix.lower() != ".npz":
            raise EclatError(f"{output}: expected a name that ends in .npz")
        check_writable(output)
        options = options_of(DEFAULT_METHOD, flags["settings"], max_error=flags["max_error"])
        assert isinstance(options, eclat.IrradianceCache)
        scene = load_scene(flags)
        solution = eclat.solve(
            scene,
            options,
            camera=camera_index(scene, flags["camera"]),
            size=flags["size"],
            max_depth=flags["max_depth"],
            seed=flags["seed"],
            threads=flags["threads"],
            progress=reporter.progress,
        )
        solution.save(output)
        seconds = solution.statistics.get("seconds", 0.0)
        text = f"{output}: {len(solution):,} records, {seconds:.1f} s"
        reporter.result(text, file=output, records=len(solution), statistics=dict(solution.statistics))
