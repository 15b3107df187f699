#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write python/eclat/_core.pyi, the types of the compiled module as nanobind tells them.

tools/make_stub.py          writes the stub, which is committed: its diff is how a change of the bindings is reviewed
tools/make_stub.py --check  writes nothing; exits with 1 if the committed stub is not what the compiled module says

The compiled module is the one in python/eclat/ if there is one, otherwise the one that is installed.
"""

from __future__ import annotations

import difflib
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STUB = ROOT / "python/eclat/_core.pyi"
HEAD = """# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
# Written by tools/make_stub.py from the compiled module: not edited by hand.

"""


def generated() -> str:
    """The stub in the tree's format."""
    built_in_place = any((ROOT / "python/eclat").glob("_core*.so"))
    environment = {**os.environ, **({"PYTHONPATH": str(ROOT / "python")} if built_in_place else {})}
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "_core.pyi"
        command = [sys.executable, "-m", "nanobind.stubgen", "-q", "-m", "eclat._core", "-o", str(raw)]
        if subprocess.run(command, cwd=folder, env=environment).returncode != 0:
            raise SystemExit("the compiled module cannot be imported: build it anew, see tools/check")
        text = HEAD + raw.read_text(encoding="utf-8")
    ruff = Path(sys.executable).with_name("ruff")
    arguments = [str(ruff), "format", "--quiet", "--stdin-filename", str(STUB), "-"]
    return subprocess.run(arguments, cwd=ROOT, input=text, capture_output=True, text=True, check=True).stdout


def main(arguments: list[str]) -> int:
    if arguments not in ([], ["--check"]):
        print(__doc__)
        return 2
    wanted = generated()
    if not arguments:
        STUB.write_text(wanted, encoding="utf-8")
        return 0
    committed = STUB.read_text(encoding="utf-8") if STUB.exists() else ""
    if committed == wanted:
        return 0
    lines = difflib.unified_diff(committed.splitlines(), wanted.splitlines(), "committed", "compiled", lineterm="", n=1)
    print("\n".join(lines))
    print(f"{STUB.relative_to(ROOT)} is not what the compiled module says: run .venv/bin/python tools/make_stub.py")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
