# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measured BRDFs as values: what is accepted, and their albedo along the normal."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.bridge.compiled import core_brdf
from eclat.errors import EclatError
from eclat.measured_brdf import MERL_SHAPE, MerlBrdf, normal_albedo
from support.brdf_files import merl_file, rgl_fields, shiny_paint, tensor_file


@pytest.mark.parametrize("kind", ["merl", "rgl"])
def test_the_albedo_along_the_normal_is_that_of_the_core(kind: str) -> None:
    from eclat.loaders.brdf_files import parse_brdf

    paint = shiny_paint(share=0.9)
    brdf = parse_brdf(merl_file(paint) if kind == "merl" else tensor_file(rgl_fields(paint, 0.3)), "paint")
    view = np.array([[0.0, 0.0, 1.0]], np.float32)
    np.testing.assert_allclose(normal_albedo(brdf), core_brdf(brdf).albedo(view)[0], rtol=0.03)


def test_an_array_of_another_shape_is_refused() -> None:
    with pytest.raises(EclatError, match=r"paint: expected values of shape \(3, 90, 90, 180\), got \(3, 90, 90, 360\)"):
        MerlBrdf(np.zeros((3, 90, 90, 360), np.float32), "paint")
    with pytest.raises(EclatError, match="MERL BRDF: expected values of 4 dimensions, got the shape"):
        MerlBrdf(np.zeros((90, 90, 180), np.float32))


def test_negative_values_are_refused() -> None:
    with pytest.raises(EclatError, match="expected values of at least 0, got -1"):
        MerlBrdf(np.full(MERL_SHAPE, -1, np.float32))


def test_it_says_what_it_is() -> None:
    assert repr(MerlBrdf(np.zeros(MERL_SHAPE, np.float32), "teflon")) == "<MerlBrdf 'teflon'>"
