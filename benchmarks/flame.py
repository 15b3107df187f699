# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A flame graph of a whole irradiance-cache picture, solve and render: where does the time go?

    .venv/bin/python benchmarks/flame.py after                 # docs/benchmarks/flame-after.svg, of sponza
    .venv/bin/python benchmarks/flame.py now --scene atrium --folder /tmp

`perf` (Linux) looks 100 times a second at what each thread runs; callers are found by unwinding the stack. Takes about
two minutes, and some gigabytes in the temporary folder meanwhile.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from harness import document, probed_core
from harness.flame_graph import Node, stacks, svg
from harness.scenes import SCENES

RATE = 100  # samples a second and thread
STACK = 65528  # bytes of stack that are kept with each sample: Embree's frames are large, and callers lie beyond them


def picture(name: str, side: int) -> None:
    """What is looked at: records for the camera, then the picture that reads them."""
    probed_core.install()
    import eclat

    scene = SCENES[name].load()
    size = (side, side * SCENES[name].size[1] // SCENES[name].size[0])
    eclat.render(scene, eclat.IrradianceCache(), samples=16, size=size)


def recorded(name: str, side: int) -> Node:
    """All stacks of a picture in a process of its own."""
    root = Node()
    with tempfile.TemporaryDirectory() as folder:
        data = Path(folder) / "perf.data"
        command = ["perf", "record", "--quiet", "-e", "cpu-clock", "-F", str(RATE), "--call-graph", f"dwarf,{STACK}"]
        work = [sys.executable, __file__, "--picture", "--scene", name, "--side", str(side)]
        subprocess.run([*command, "-o", str(data), "--", *work], check=True)
        script = ["perf", "script", "-i", str(data), "--no-inline", "-F", "comm,ip,sym,dso"]
        with subprocess.Popen(script, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
            assert process.stdout is not None
            for stack in stacks(process.stdout):
                if stack != ["Python"]:  # reading the file, importing modules
                    root.add(stack)
    return root


def main() -> None:
    """Run it as the command line says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="?", default="now", help="the file is flame-NAME.svg (default: now)")
    parser.add_argument("--scene", default="sponza", choices=sorted(SCENES))
    parser.add_argument("--side", type=int, default=512, metavar="PIXELS", help="width of the picture (default 512)")
    parser.add_argument("--folder", type=Path, default=document.PLOTS, help="default: docs/benchmarks")
    parser.add_argument("--picture", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.picture:
        picture(given.scene, given.side)
        return
    if shutil.which("perf") is None:
        sys.exit("flame: perf is missing (Linux: apt-get install linux-perf)")
    probed_core.build()
    root = recorded(given.scene, given.side)
    if root.samples == 0:
        sys.exit("flame: perf found no sample in the core")
    title = f"{given.scene}, irradiance cache, {root.samples} samples"
    document.write_plot(f"flame-{given.name}", svg(root, title), given.folder)
    print(f"{title}: {100 * root.share('Embree'):.0f} % inside Embree")


if __name__ == "__main__":
    main()
