# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What all tests share: where the real scenes are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def scenes() -> Path:
    """The folder of real scenes, or a skip that says how to get it."""
    folder = Path(os.environ.get("ECLAT_SCENES", ROOT.parent / "shared" / "scenes"))
    if not folder.is_dir():
        pytest.skip(
            f"real scenes not found in {folder}: set ECLAT_SCENES to their folder (CONTRIBUTING.md, 'Real scenes')"
        )
    return folder
