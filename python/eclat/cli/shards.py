# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The option by which several machines share a work without knowing of each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eclat.cli.command import option
from eclat.cli.parameters import Parsed
from eclat.frames.plan import parse_shard


def shard_option(section: str, text: str) -> Callable[[Any], Any]:
    """Make the option --shard I/N, whose help is `text`."""
    kind = Parsed("I/N", "a share I/N with 1 ≤ I ≤ N, such as 2/3", parse_shard)
    return option("--shard", type=kind, section=section, help=text)
