# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of node trees: links through reroutes and groups, arithmetic, images and their coordinates."""

import numpy as np
import pytest

from eclat_blender.image_nodes import ImageReader
from eclat_blender.links import follow
from eclat_blender.node_values import NodeValues
from eclat_blender.notices import Notices
from support.blender_standins import image_node, link, node, tree

GREY = (0.5, 0.5, 0.5, 1.0)


def values():
    notices = Notices()
    return NodeValues("material 'm'", ImageReader(notices), notices), notices


def end(value=GREY):
    return node("END", {"Color": value, "Number": 0.25})


def test_links_lead_through_reroutes_muted_nodes_and_groups():
    color = node("RGB", {}, {"Color": (0.1, 0.2, 0.3, 1.0)})
    inside_in = node("GROUP_INPUT", {}, {"Given": (0, 0, 0, 1)})
    reroute = node("REROUTE", {"Input": GREY}, {"Output": GREY})
    inside_out = node("GROUP_OUTPUT", {"Result": GREY}, {})
    link(inside_in, "Given", reroute, "Input")
    link(reroute, "Output", inside_out, "Result")
    group = node(
        "GROUP", {"Given": (0.7, 0.8, 0.9, 1.0)}, {"Result": GREY}, node_tree=tree(inside_in, reroute, inside_out)
    )
    target = end()
    link(group, "Result", target, "Color")
    reader, _ = values()
    assert reader.of(target.inputs["Color"]).color == pytest.approx((0.7, 0.8, 0.9))
    link(color, "Color", group, "Given")
    assert follow(target.inputs["Color"]).node is color
    color.mute = True
    assert follow(target.inputs["Color"]).node is None


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        ("MIX", 0.5 * 0.4 + 0.5 * 0.8), ("MULTIPLY", 0.4 + 0.5 * (0.32 - 0.4)), ("ADD", 0.4 + 0.5 * 0.8),
        ("SCREEN", 0.4 + 0.5 * (1 - 0.6 * 0.2 - 0.4)), ("DIVIDE", 0.4 + 0.5 * (0.5 - 0.4)), ("DARKEN", 0.4),
    ],
)  # fmt: skip
def test_colours_are_mixed(mode, expected):
    mix = node(
        "MIX_RGB", {"Fac": 0.5, "Color1": (0.4, 0.4, 0.4, 1.0), "Color2": (0.8, 0.8, 0.8, 1.0)}, blend_type=mode,
        use_clamp=False,
    )  # fmt: skip
    target = end()
    link(mix, "Color", target, "Color")
    assert values()[0].of(target.inputs["Color"]).number == pytest.approx(expected)


def test_an_image_is_multiplied_texel_by_texel_and_decoded_once():
    texels = np.ones((2, 3, 4)) * 0.5
    texels[0, 0, :3] = 1.0  # Top left.
    source = image_node(texels, "sRGB", is_float=False)
    mix = node(
        "MIX_RGB", {"Fac": 1.0, "Color1": GREY, "Color2": (0.5, 1.0, 1.0, 1.0)}, blend_type="MULTIPLY", use_clamp=False
    )
    target = end()
    link(source, "Color", mix, "Color1")
    link(mix, "Color", target, "Color")
    field = values()[0].of(target.inputs["Color"])
    assert field.texels.shape == (2, 3, 4) and field.texels[0, 0, 0] == pytest.approx(0.5)
    assert field.texels[1, 2, 1] == pytest.approx(0.21404, rel=1e-4)  # The sRGB value 0.5.
    assert field.texels[1, 2, 0] == pytest.approx(0.21404 / 2, rel=1e-4)


def test_a_mapping_moves_texels_as_blender_does():
    texels = np.ones((2, 2, 4))
    source = image_node(texels)
    mapping = node(
        "MAPPING",
        {"Vector": (0.0, 0.0, 0.0), "Location": (0.1, 0.3, 0.0), "Rotation": (0.0, 0.0, 0.5), "Scale": (2.0, 3.0, 1.0)},
        {"Vector": (0, 0, 0)}, vector_type="POINT",
    )  # fmt: skip
    place = node("TEX_COORD", {}, {"UV": (0, 0, 0)})
    link(place, "UV", mapping, "Vector")
    link(mapping, "Vector", source, "Vector")
    target = end()
    link(source, "Color", target, "Color")
    field = values()[0].of(target.inputs["Color"])
    u, v = 0.2, 0.7  # Blender's, with v upwards.
    c, s = np.cos(0.5), np.sin(0.5)
    x, y = 2 * u, 3 * v
    theirs = (c * x - s * y + 0.1, s * x + c * y + 0.3)
    ours = np.array(field.placement.transform) @ (u, 1 - v, 1)
    assert np.allclose((ours[0], 1 - ours[1]), theirs)


def test_a_colour_becomes_a_number_by_its_luminance_and_alpha_is_its_own_output():
    texels = np.zeros((1, 1, 4))
    texels[..., 1], texels[..., 3] = 1.0, 0.25
    source, target = image_node(texels), end()
    link(source, "Color", target, "Number")
    assert values()[0].of(target.inputs["Number"]).number == pytest.approx(0.7152)
    other = end()
    link(source, "Alpha", other, "Number")
    assert values()[0].of(other.inputs["Number"]).number == pytest.approx(0.25)


def test_hue_turns_and_saturation_fades():
    shift = node(
        "HUE_SAT", {"Hue": 0.5 + 1 / 3, "Saturation": 1.0, "Value": 0.5, "Fac": 1.0, "Color": (1.0, 0.0, 0.0, 1.0)}
    )
    target = end()
    link(shift, "Color", target, "Color")
    assert values()[0].of(target.inputs["Color"]).color == pytest.approx((0, 0.5, 0), abs=1e-6)
    shift.inputs["Saturation"].default_value = 0.0
    assert values()[0].of(target.inputs["Color"]).color == pytest.approx((0.5, 0.5, 0.5))


def test_what_is_unknown_is_named_once_and_the_written_value_stands():
    noise, target = node("TEX_NOISE", {}, {"Color": GREY}), end((0.3, 0.3, 0.3, 1.0))
    link(noise, "Color", target, "Color")
    reader, notices = values()
    for _ in range(2):
        assert reader.of(target.inputs["Color"]).number == pytest.approx(0.3)
    assert notices.texts == ["material 'm': the node 'TEX_NOISE' (Tex_Noise) is not supported"]


def test_images_of_different_sizes_are_not_combined_silently():
    a, b, target = image_node(np.ones((2, 2, 4))), image_node(np.full((4, 4, 4), 0.5)), end()
    b.image.name_full = "other"
    mix = node("MIX_RGB", {"Fac": 1.0, "Color1": GREY, "Color2": GREY}, blend_type="MULTIPLY", use_clamp=False)
    link(a, "Color", mix, "Color1")
    link(b, "Color", mix, "Color2")
    link(mix, "Color", target, "Color")
    reader, notices = values()
    assert reader.of(target.inputs["Color"]).texels.shape == (4, 4, 4)
    assert "different sizes" in notices.texts[0]
