# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Light maps of translated objects."""

import math

import numpy as np
import pytest

from eclat_blender.light_maps import LightMaps
from eclat_blender.notices import Notices
from eclat_blender.translate import translate
from support.blender_standins import depsgraph, solid


def test_a_square_under_a_white_sky_receives_pi_everywhere():
    graph = depsgraph([(solid(), np.eye(4))])
    found = translate(graph, lambda _: None, Notices())
    image = LightMaps(found, graph.scene.eclat).bake("square")
    assert image.shape == (16, 16, 3) and image.min() > 0
    assert image.mean() == pytest.approx(math.pi, rel=0.02)


def test_an_object_without_a_uv_map_is_named():
    thing = solid()
    mesh = thing.to_mesh()
    mesh.uv_layers = []
    graph = depsgraph([(thing, np.eye(4))])
    found = translate(graph, lambda _: None, Notices())
    assert LightMaps(found, graph.scene.eclat).bake("square") is None
    assert "it has no UV map" in found.notices.texts[-1]
