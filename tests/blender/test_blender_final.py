# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures through the methods of an engine: rows, passes, Esc, regions, transparent films, reports."""

import numpy as np
import pytest

from eclat_blender.final import draw_final
from support.blender_standins import (
    Engine,
    camera_data,
    depsgraph,
    image_node,
    light,
    link,
    material,
    principled,
    solid,
    thing,
)

NOTHING = lambda _: None  # noqa: E731


def drawn(graph, breaks=None):
    engine = Engine(breaks)
    draw_final(engine, graph, NOTHING)
    return engine


def test_a_white_world_over_a_square_is_seen_the_right_way_up():
    # The square is moved up in the picture (towards +y), and the world is white.
    moved = np.eye(4)
    moved[1, 3] = 0.5
    engine = drawn(depsgraph([(solid(), moved)]))
    combined = engine.picture()
    assert combined.shape == (6, 8, 4) and np.isfinite(combined).all()
    assert combined[0, 0, 0] == pytest.approx(1) and combined[2, 4, 0] == pytest.approx(0.8, rel=0.02)
    depth, normal = engine.picture("Depth")[..., 0], engine.picture("Normal")
    assert depth[2, 4] == pytest.approx(5) and depth[5, 0] == pytest.approx(1e10)
    assert normal[2, 4] == pytest.approx((0, 0, 1))
    light_sum = engine.picture("Direct") + engine.picture("Indirect")
    assert np.allclose(light_sum, combined[..., :3], rtol=1e-4)
    assert engine.picture("Albedo")[2, 4] == pytest.approx((0.8,) * 3, rel=1e-3)
    assert engine.reports[-1][0] == "INFO" and "16 samples" in engine.reports[-1][1]


def test_a_transparent_film_has_the_surfaces_alone():
    graph = depsgraph([(solid(), np.eye(4))], film_transparent=True)
    graph.scene.eclat.samples = 256
    engine = drawn(graph)
    combined = engine.picture()
    assert combined[0, 0] == pytest.approx((0, 0, 0, 0), abs=1e-6)
    assert combined[3, 4, 3] == pytest.approx(1) and combined[3, 4, 0] == pytest.approx(0.8, rel=0.03)


def test_depth_is_along_the_axis_of_a_shifted_camera():
    graph = depsgraph([(solid(), np.diag((9.0, 9.0, 1.0, 1.0)))])
    graph.scene.camera.data = camera_data(lens=20.0, shift_x=0.2, shift_y=-0.1)
    assert drawn(graph).picture("Depth") == pytest.approx(5.0, rel=1e-2)


def test_a_region_is_drawn_where_it_lies():
    graph = depsgraph([(solid(), np.eye(4))], use_border=True, border_min_y=0.5, border_max_x=0.5)
    engine = drawn(graph)
    result = engine.results[-1]
    assert (result.x, result.y, result.width, result.height) == (0, 3, 4, 3)
    whole = drawn(depsgraph([(solid(), np.eye(4))])).picture()
    assert np.allclose(engine.picture(), whole[:3, :4])


def test_esc_keeps_the_samples_that_were_taken(monkeypatch):
    from eclat_blender import final

    graph = depsgraph([(solid(), np.eye(4))])
    taken = []

    def render(*given, progress, keep_partial, **more):
        assert keep_partial
        image = real(*given, progress=progress, keep_partial=keep_partial, **more)
        stop = KeyboardInterrupt()
        stop.partial = image
        try:
            progress("samples", 0.5, {})
        except KeyboardInterrupt:
            taken.append(image)
            raise stop from None
        return image

    real = final.eclat.render
    monkeypatch.setattr(final.eclat, "render", render)
    engine = drawn(graph, breaks=0)
    assert taken and np.allclose(engine.picture()[..., :3], taken[0].pixels)
    assert not any(kind == "INFO" for kind, _ in engine.reports)


def test_esc_before_the_first_sample_ends_without_an_error():
    graph = depsgraph([(solid(), np.eye(4))], size=(400, 300))
    graph.scene.eclat.samples = 4096
    engine = drawn(graph, breaks=0)
    assert engine.error == "" and engine.asked >= 1


def test_what_is_not_supported_is_reported():
    shiny = material(principled(Coat_Weight=1.0))
    cloud = thing("VOLUME", None, "cloud")
    spot = thing("LIGHT", light("SPOT", 5.0, shadow_soft_size=0.1), "spot")
    engine = drawn(depsgraph([(solid(materials=(shiny,)), np.eye(4)), (cloud, np.eye(4)), (spot, np.eye(4))]))
    warned = [text for kind, text in engine.reports if kind == "WARNING"]
    assert any("'Coat Weight' is not supported" in text for text in warned)
    assert any("object 'cloud'" in text for text in warned) and any("light 'spot'" in text for text in warned)


def test_images_without_a_uv_map_are_reported():
    shader, source = principled(), image_node(np.ones((2, 2, 4)))
    link(source, "Color", shader, "Base Color")
    bare = solid(materials=(material(shader, source),))
    bare.to_mesh().uv_layers = []
    for square, named in ((bare, 1), (solid(materials=(material(shader, source),)), 0)):
        reports = drawn(depsgraph([(square, np.eye(4))])).reports
        assert sum("it has no UV map, which the images" in text for _, text in reports) == named


def test_a_scene_without_a_camera_is_an_error():
    graph = depsgraph([(solid(), np.eye(4))])
    graph.scene.camera = None
    engine = drawn(graph)
    assert engine.error == "Éclat: the scene has no camera" and engine.reports[0][0] == "ERROR"


def test_a_dark_scene_stays_dark():
    graph = depsgraph([(solid(), np.eye(4))])
    graph.scene.world = None
    assert not drawn(graph).picture()[..., :3].any()
