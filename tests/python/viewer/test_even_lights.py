# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Luminaires in the viewer."""

from __future__ import annotations

import numpy as np
import pytest

from eclat.errors import EclatWarning
from eclat.scene import PointLight, ProfileLight, Scene
from eclat.viewer.even_lights import even_light
from eclat.viewer.lamps import lights_of
from support.luminaires import cosine_lamp


def test_the_flux_of_a_profile_stays() -> None:
    lamp = ProfileLight((1, 2, 3), cosine_lamp(), (2, 1, 0), name="lamp")
    even = even_light(lamp)
    assert isinstance(even, PointLight) and (even.position, even.name) == ((1, 2, 3), "lamp")
    np.testing.assert_allclose(np.array(even.intensity) * 4 * np.pi, np.array([2, 1, 0]) * 100 * np.pi, rtol=1e-4)
    assert even_light(even) is even
    with pytest.warns(
        EclatWarning, match="light 'lamp': the viewer shows its direct light as that of an even point light"
    ):
        (entry,) = lights_of(Scene(lights=(lamp,)), np.zeros(3))
    assert entry["kind"] == "point" and entry["position"] == [1, 2, 3]
