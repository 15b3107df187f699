# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Packages that only some files need."""

from __future__ import annotations

import math

import pytest

from eclat.errors import EclatError
from eclat.loaders.optional import optional_module


def test_a_module_is_imported() -> None:
    assert optional_module("math", "files", "sums") is math


def test_a_missing_module_is_an_error_that_says_what_to_install() -> None:
    message = (
        r"^pictures of clouds can be read only with an optional package: .* pip install 'eclat\[usd\]' \(got: No module"
    )
    with pytest.raises(EclatError, match=message):
        optional_module("no_such_module_anywhere", "usd", "pictures of clouds")
