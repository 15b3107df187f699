# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds: colours, images with rotations, and what Cycles draws."""

from types import SimpleNamespace

import numpy as np
import pytest

from eclat.scene import DirectionalLight
from eclat_blender.image_nodes import ImageReader
from eclat_blender.notices import Notices
from eclat_blender.world import DrawnWorld, environment
from support.blender_standins import link, node, picture, world


def made(given, draw=lambda _: None):
    notices = Notices()
    return *environment(given, ImageReader(notices), draw, notices), notices.texts


def test_a_colour_is_one_pixel():
    sky, sun, texts = made(world((0.1, 0.2, 0.3, 1.0), 2.0))
    assert sky.image.shape == (1, 1, 3) and sky.image[0, 0] == pytest.approx((0.2, 0.4, 0.6))
    assert sun is None and texts == []
    assert made(world(strength=0.0))[0] is None


def lit_by_image(turn):
    given = world(strength=2.0)
    shader = given.node_tree.nodes[1]
    texels = np.zeros((4, 8, 4))
    texels[1:3, 3:5, 0] = 1.0  # The centre, which Blender sees along +x.
    source = node("TEX_ENVIRONMENT", {"Vector": (0, 0, 0)}, image=picture("sky", texels), projection="EQUIRECTANGULAR")
    mapping = node(
        "MAPPING", {"Vector": (0, 0, 0), "Location": (0, 0, 0), "Rotation": (0, 0, turn), "Scale": (1, 1, 1)},
        {"Vector": (0, 0, 0)}, vector_type="POINT",
    )  # fmt: skip
    place = node("TEX_COORD", {}, {"Generated": (0, 0, 0)})
    link(place, "Generated", mapping, "Vector")
    link(mapping, "Vector", source, "Vector")
    link(source, "Color", shader, "Color")
    return given


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_the_centre_of_an_image_is_where_the_mapping_looks_it_up(turn):
    sky, _, texts = made(lit_by_image(turn))
    assert texts == [] and sky.image.max() == pytest.approx(2.0)
    centre = np.asarray(sky.to_world) @ (0, 0, -1)
    # The direction d whose image coordinates are turn · d = +x.
    assert np.allclose(centre, (np.cos(turn), -np.sin(turn), 0), atol=1e-9)
    assert np.allclose(np.asarray(sky.to_world) @ (0, 1, 0), (0, 0, 1))
    # u grows to Blender's −y.
    right = np.asarray(sky.to_world) @ (1, 0, 0)
    assert np.allclose(right, (-np.sin(turn), -np.cos(turn), 0), atol=1e-9)


def test_other_nodes_are_drawn_and_named():
    given = world()
    sky_node = node("TEX_SKY", {}, {"Color": (0, 0, 0, 1)})
    link(sky_node, "Color", given.node_tree.nodes[1], "Color")
    sun = DirectionalLight((0, 0, -1), (5, 5, 5), 0.27)
    drawn = DrawnWorld(np.ones((2, 4, 3), np.float32), sun)
    sky, found, texts = made(given, lambda _: drawn)
    assert sky.image is drawn.image and found is sun
    assert texts == [
        "world 'world': Cycles has drawn it as an image of 4 × 2 pixels, and its sun is a light of its own"
    ]
    sky, found, texts = made(given)
    assert sky is None and found is None and "could not be drawn" in texts[0]


def test_a_world_without_nodes_is_its_colour():
    plain = SimpleNamespace(name="world", color=(0.1, 0.2, 0.3), node_tree=None)
    assert made(plain)[0].image[0, 0] == pytest.approx((0.1, 0.2, 0.3))
