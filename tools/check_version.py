#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The version is a semantic one [semver.org 2.0.0], and the same wherever it stands: python/eclat/__init__.py, where it is
defined, CITATION.cff, the manifest of the Blender extension, the newest heading of CHANGELOG.md, docs/eclat.1 and, if one is
given, a tag such as v1.2.3.

Prints what differs and exits with 1.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SEMANTIC = r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)"
PLACES = {
    "python/eclat/__init__.py": r'^__version__ = "(.*)"$',
    "CITATION.cff": r"^version: (.*)$",
    "blender/eclat_blender/blender_manifest.toml": r'^version = "(.*)"$',
    "CHANGELOG.md": r"^## (\S+)",
    "docs/eclat.1": r'^\.TH ECLAT 1 "" "eclat (\S+)"',
}


def versions() -> dict[str, str]:
    """Maps each place to the version that stands there; the text is empty if none does."""
    found = {}
    for name, pattern in PLACES.items():
        match = re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.M)
        found[name] = match[1] if match else ""
    return found


def main(tags: list[str]) -> int:
    found = versions()
    wanted = found["python/eclat/__init__.py"]
    problems = [f"{name}: expected version {wanted}, got {said!r}" for name, said in found.items() if said != wanted]
    if not re.fullmatch(SEMANTIC, wanted):
        problems.append(f"python/eclat/__init__.py: expected a version such as 1.2.3, got {wanted!r}")
    problems += [f"tag {tag}: expected v{wanted}" for tag in tags if tag.startswith("v") and tag != f"v{wanted}"]
    print("\n".join(problems), end="\n" if problems else "")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
