# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Try the installed Éclat as a new user would, without a compiler and without Embree on the system.

python tools/try_wheel.py [--bits FILE]

Renders small pictures by several methods with every instruction set that the machine has, twice each; checks that the
same instruction set gives the same bits; proves on Linux that Embree and oneTBB come from the wheel; runs `eclat`. With
--bits, the hashes of the pictures are written to a file, to compare machines. It is run by a Python that has `eclat`
installed, in any folder, and imports nothing of the checkout.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ISAS = ("x86-64-v2", "x86-64-v3", "x86-64-v4")

RENDER = """
import hashlib, json, sys
import eclat
said = {}
methods = (eclat.Path(), eclat.IrradianceCache(max_error=0.2), eclat.PhotonMap(photons=20000, caustic_photons=2000))
for scene in ("cornell-box", "glossy-box"):
    for method in methods:
        image = eclat.render(eclat.load(scene), method, samples=4, size=(32, 24), seed=3, denoise=False)
        said[f"{scene} {method.name}"] = hashlib.sha256(image.pixels.tobytes()).hexdigest()[:16]
from eclat import _core
maps = open("/proc/self/maps").read().split() if sys.platform.startswith("linux") else []
libraries = sorted({m for m in maps if "libembree" in m or "libtbb" in m})
print(json.dumps({"bits": said, "isa": _core.instruction_set(), "core": _core.__file__, "libraries": libraries}))
"""


def rendered(isa: str, folder: str) -> dict[str, object]:
    """Render in a process of its own with this instruction set, or with the default where it is empty."""
    environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "ECLAT_ISA")}
    command = [sys.executable, "-c", RENDER]
    done = subprocess.run(command, env={**environment, "ECLAT_ISA": isa}, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{isa or 'default'}: {done.stderr}")
    said: dict[str, object] = json.loads(done.stdout)
    return said


def supported() -> tuple[str, ...]:
    """The instruction sets between which this build can choose."""
    try:
        from eclat.instruction_set import supported
    except ImportError:
        return ()
    try:
        return supported()
    except ImportError:  # There is one core, as on aarch64.
        return ()


def check(truth: bool, what: str) -> None:
    if not truth:
        raise SystemExit(f"tools/try_wheel.py: {what}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bits", metavar="FILE")
    arguments = parser.parse_args()
    import eclat

    site = Path(eclat.__file__).resolve().parent.parent
    print(f"Python {sys.version.split()[0]}, eclat {eclat.__version__} in {site}")
    bits = {}
    with tempfile.TemporaryDirectory() as folder:
        for isa in ("", *supported()):
            first, again = rendered(isa, folder), rendered(isa, folder)
            check(first["bits"] == again["bits"], f"{isa or 'default'}: two runs gave different bits")
            check(isa in ("", first["isa"]), f"{isa}: the core is for {first['isa']}")
            for library in first["libraries"]:  # type: ignore[attr-defined]
                check(Path(library).is_relative_to(site), f"{library} is not part of the wheel")
            bits[isa or "default"] = first["bits"]
            digest = hashlib.sha256(json.dumps(first["bits"]).encode()).hexdigest()[:16]
            print(f"{isa or 'default'}: core for {first['isa']}, bits {digest}, {', '.join(first['libraries'])}")  # type: ignore[arg-type]
        for words in (["--version"], ["render", "cornell-box", "--size", "32x32", "--samples", "1", "-o", "a.png"]):
            command = [sys.executable, "-m", "eclat", *words]
            subprocess.run(command, cwd=folder, check=True)
        check((Path(folder) / "a.png").stat().st_size > 500, "no picture was written")
    if arguments.bits:
        Path(arguments.bits).write_text(json.dumps(bits, indent=1))


if __name__ == "__main__":
    main()
