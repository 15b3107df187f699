# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What two processes must have in common: every difference is named, and the remedy for instruction sets."""

from __future__ import annotations

import pytest

import eclat
from eclat.farm.identity import INSTRUCTION_SET, identity, refusal


def test_a_process_may_compute_for_one_like_itself() -> None:
    assert refusal(identity()) == ""


@pytest.mark.parametrize("name", list(identity()))
def test_every_difference_is_a_reason(name: str) -> None:
    assert f"{name} {identity()[name]} instead of another" in refusal(identity() | {name: "another"})


def test_the_remedy_for_another_instruction_set_is_to_pin_one() -> None:
    assert "--isa or ECLAT_ISA" in refusal(identity() | {INSTRUCTION_SET: "x86-64-v1"})
    assert "--isa" not in refusal(identity() | {"Python": "2.7"})


def test_the_version_is_the_one_that_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    before = identity()
    monkeypatch.setattr(eclat, "__version__", "8.0")
    assert refusal(before) == f"Éclat 8.0 instead of {before['Éclat']}"
