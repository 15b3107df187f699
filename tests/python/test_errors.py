# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that help: nearest words, and warnings that point at whoever asked."""

from __future__ import annotations

import warnings

import pytest

from eclat.errors import EclatError, EclatWarning, did_you_mean, warn


def test_the_nearest_word_is_proposed_and_only_a_near_one() -> None:
    known = ["max_error", "weight", "spacing"]
    assert did_you_mean("max_eror", known) == "; did you mean 'max_error'?"
    assert did_you_mean("colour", known) == ""
    assert did_you_mean("x", []) == ""


def test_a_warning_points_at_the_line_that_called_the_loader() -> None:
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
