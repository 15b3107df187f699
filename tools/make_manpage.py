#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write docs/eclat.1, the manual page that is installed with Éclat, from the help of the commands.

tools/make_manpage.py          writes the page, which is committed, since building Éclat has no commands to ask
tools/make_manpage.py --check  writes nothing; exits with 1 if the committed page is not what the help says
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/eclat.1"


def main(arguments: list[str]) -> int:
    if arguments not in ([], ["--check"]):
        print(__doc__)
        return 2
    sys.path.insert(0, str(ROOT / "python"))
    from eclat.cli import group
    from eclat.cli.manpage import manpage

    wanted = manpage(group)
    if not arguments:
        PAGE.write_text(wanted, encoding="utf-8")
        return 0
    if PAGE.read_text(encoding="utf-8") == wanted:
        return 0
    print(f"{PAGE.relative_to(ROOT)} is not what the help says: run .venv/bin/python tools/make_manpage.py")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
