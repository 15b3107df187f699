# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that help: nearest words, and warnings that point at whoever asked."""

from __future__ import annotations

import threading
import warnings

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning, did_you_mean, heard_warnings, printable, shown, warn


def test_the_nearest_word_is_proposed_and_only_a_near_one() -> None:
    known = ["max_error", "weight", "spacing"]
    assert did_you_mean("max_eror", known) == "; did you mean 'max_error'?"
    assert did_you_mean("colour", known) == ""
    assert did_you_mean("x", []) == ""


def test_a_warning_is_located_at_the_caller_of_the_loader() -> None:
    def loader() -> None:
        warn("texture missing")

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        loader()
    assert [str(w.message) for w in caught] == ["texture missing"]
    assert caught[0].category is EclatWarning
    assert caught[0].filename == __file__


def test_an_error_of_the_user_is_a_value_error() -> None:
    with pytest.raises(ValueError, match="roughness"):
        raise EclatError("roughness must be between 0 and 1")


def test_warnings_of_two_threads_stay_apart() -> None:
    heard: dict[str, list[str]] = {}
    both = threading.Barrier(2)

    def speak(name: str) -> None:
        with heard_warnings() as mine:
            for number in range(5):
                both.wait(10)
                warn(f"{name} {number}")
        heard[name] = mine

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        threads = [threading.Thread(target=speak, args=(name,)) for name in ("a", "b")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(20)
    assert heard == {name: [f"{name} {number}" for number in range(5)] for name in ("a", "b")}


def test_warnings_in_an_inner_block_are_collected_by_the_outer_one() -> None:
    with pytest.warns(EclatWarning), heard_warnings() as outer:
        warn("one")
        with heard_warnings() as inner:
            warn("two")
    assert (outer, inner) == (["one", "two"], ["two"])


def test_control_characters_are_spelled_out() -> None:
    assert printable("a\x1b[31mb\x07\x9b\u202e\udc80é°\n") == r"a\x1b[31mb\x07\x9b\u202e\udc80é°\n"
    assert printable("a\r\nb\t", lines=True) == "a\\r\nb\\t"


def test_values_are_shown_on_one_short_line() -> None:
    assert shown("a\nb") == repr("a\nb") and shown(2.5) == "2.5"
    assert "\n" not in shown(np.eye(5)) and len(shown(np.eye(5))) == 80
