# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""UsdPreviewSurface and its textures: what a texel becomes, where it lies, and what is not supported."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import eclat
from eclat.errors import EclatWarning
from eclat.scene import Material, Mesh, Value
from support.usd_files import SQUARE, load_usda

PIXELS = np.array([[[0, 50, 100], [250, 150, 10]], [[30, 60, 200], [128, 128, 255]]], np.uint8)
"""Top row first; the texel of st = (0.25, 0.25), at the bottom left, is (30, 60, 200)."""
ST = 'texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] (interpolation = "faceVarying")'


def body(inputs: str, nodes: str = "", mesh: str = ST) -> str:
    return f"""
    def Material "m" {{
        token outputs:surface.connect = </m/s.outputs:surface>
        def Shader "s" {{
            uniform token info:id = "UsdPreviewSurface"
            {inputs}
            token outputs:surface
        }}
        {nodes}
    }}
    def Mesh "square" (prepend apiSchemas = ["MaterialBindingAPI"]) {{ {SQUARE} {mesh}
        rel material:binding = </m>
    }}"""


def texture(
    inputs: str = "", st: str = "float2 inputs:st.connect = </m/reader.outputs:result>", file: str = "a.png"
) -> str:
    return f"""
    def Shader "tex" {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{file}@
        {st}
        {inputs}
        float3 outputs:rgb
        float outputs:r
        float outputs:a
    }}
    def Shader "reader" {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}"""


COLOR = "color3f inputs:diffuseColor.connect = </m/tex.outputs:rgb>"


def mesh_of(folder: Path, inputs: str, nodes: str = "", mesh: str = ST) -> Mesh:
    Image.fromarray(PIXELS).save(folder / "a.png")
    return load_usda(folder, body(inputs, nodes, mesh)).meshes[0]


def material_of(folder: Path, inputs: str, nodes: str = "") -> Material:
    return mesh_of(folder, inputs, nodes).material


def decoded(byte: float) -> float:
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def texel(value: Value, uv: tuple[float, float]) -> list[float]:
    """What a parameter is at texture coordinates: the nearest texel, decoded, times the constant."""
    assert value.texture is not None
    u, v = np.array(value.uv_transform) @ [*uv, 1]
    image = value.texture.image
    row, column = math.floor(v * image.shape[0]) % image.shape[0], math.floor(u * image.shape[1]) % image.shape[1]
    found = image[row, column].astype(float)
    if image.dtype == np.uint8:
        found = np.array([decoded(x) for x in found]) if value.texture.srgb else found / 255
    if value.channel is not None:
        found = np.repeat(found[value.channel], 3)
    return (found[:3] * value.constant).tolist()


def test_constants(tmp_path: Path) -> None:
    made = material_of(
        tmp_path,
        "color3f inputs:diffuseColor = (0.1, 0.2, 0.3)\nfloat inputs:roughness = 0.6\nfloat inputs:metallic = 0.25\n"
        "float inputs:ior = 1.4\ncolor3f inputs:emissiveColor = (5, 6, 7)\nfloat inputs:opacity = 0.75",
    )
    values = {name: value.constant[0] for name, value in made.parameters.items()}
    assert values == pytest.approx({"base_color": 0.1, "roughness": 0.6, "metallic": 0.25, "ior": 1.4})
    # The roughness is squared on the way to the α of GGX.
    assert made.parameters["roughness"].square and made.opacity.constant[0] == 0.75 and made.alpha_cutoff is None
    assert made.emission is not None and made.emission.constant == pytest.approx((5, 6, 7))


def test_defaults_are_those_of_the_specification(tmp_path: Path) -> None:
    made = material_of(tmp_path, "")
    assert made.parameters["base_color"].constant == (0.18,) * 3
    assert made.parameters["roughness"].constant[0] == 0.5 and made.parameters["metallic"].constant[0] == 0
    assert made.emission is None and made.parameters["ior"].constant[0] == 1.5


def test_the_texel_of_a_point_is_that_of_its_coordinates(tmp_path: Path) -> None:
    """st = (0, 0) is at the bottom left of the image: the corner (−1, −1) of the square gets its lowest row."""
    mesh = mesh_of(tmp_path, COLOR, texture())
    assert mesh.uvs is not None
    value = mesh.material.parameters["base_color"]
    corner = int(np.argmin(np.asarray(mesh.positions)[:, :2].sum(axis=1)))
    np.testing.assert_allclose(np.asarray(mesh.uvs)[corner], [0, 1])
    inside = np.asarray(mesh.uvs)[corner] + [0.25, -0.25]
    assert texel(value, tuple(inside)) == pytest.approx([decoded(30), decoded(60), decoded(200)])


@pytest.mark.parametrize(("space", "srgb"), [("sRGB", True), ("raw", False), ("auto", True), (None, True)])
def test_colour_spaces(tmp_path: Path, space: str | None, srgb: bool) -> None:
    text = "" if space is None else f'token inputs:sourceColorSpace = "{space}"'
    found = material_of(tmp_path, COLOR, texture(text)).parameters["base_color"].texture
    assert found is not None and found.srgb == srgb


def test_wraps(tmp_path: Path) -> None:
    found = material_of(tmp_path, COLOR, texture('token inputs:wrapS = "mirror"\ntoken inputs:wrapT = "clamp"'))
    made = found.parameters["base_color"].texture
    assert made is not None and (made.wrap_u, made.wrap_v) == ("mirror", "clamp")
    with pytest.warns(EclatWarning, match="textures that are 'black' outside of the image are clamped instead"):
        material_of(tmp_path, COLOR, texture('token inputs:wrapS = "black"'))


def test_scale_and_bias(tmp_path: Path) -> None:
    """Decoded texel · scale + bias; the scale alone stays a factor."""
    scale = "float4 inputs:scale = (0.5, 2, 1, 1)"
    uv = (0.25, 0.75)
    plain = material_of(tmp_path, COLOR, texture(scale)).parameters["base_color"]
    assert plain.texture is not None and plain.texture.image.dtype == np.uint8
    expected = np.array([decoded(30), decoded(60), decoded(200)]) * [0.5, 2, 1]
    assert texel(plain, uv) == pytest.approx(expected.tolist())
    moved = material_of(tmp_path, COLOR, texture(scale + "\nfloat4 inputs:bias = (0.1, 0.2, 0.3, 0)"))
    assert texel(moved.parameters["base_color"], uv) == pytest.approx(
        (expected + np.array([0.1, 0.2, 0.3])).tolist(), rel=1e-5
    )


def test_a_transform_scales_then_turns_then_moves(tmp_path: Path) -> None:
    """The coordinates of the package's own definition: R(30°) · (2 s, 3 t) + (0.1, 0.2), with v turned over."""
    nodes = (
        texture(st="float2 inputs:st.connect = </m/move.outputs:result>")
        + """def Shader "move" {
            uniform token info:id = "UsdTransform2d"
            float2 inputs:in.connect = </m/reader.outputs:result>
            float inputs:rotation = 30
            float2 inputs:scale = (2, 3)
            float2 inputs:translation = (0.1, 0.2)
            float2 outputs:result
        }"""
    )
    value = material_of(tmp_path, COLOR, nodes).parameters["base_color"]
    s, t = 0.3, 0.8
    cos, sin = math.cos(math.radians(30)), math.sin(math.radians(30))
    expected = (cos * 2 * s - sin * 3 * t + 0.1, sin * 2 * s + cos * 3 * t + 0.2)
    u, v = np.array(value.uv_transform) @ [s, 1 - t, 1]
    assert (u, 1 - v) == pytest.approx(expected)


def test_single_channels_and_alpha(tmp_path: Path) -> None:
    rough = "float inputs:roughness.connect = </m/tex.outputs:r>"
    nodes = texture('token inputs:sourceColorSpace = "raw"')
    value = material_of(tmp_path, rough, nodes).parameters["roughness"]
    assert value.channel == 0 and value.square
    assert texel(value, (0.25, 0.75))[0] == pytest.approx(30 / 255)
    # The image has no alpha, which is then 1.
    opacity = "float inputs:opacity.connect = </m/tex.outputs:a>\nfloat inputs:opacityThreshold = 0.3"
    made = material_of(tmp_path, opacity, nodes)
    assert made.opacity.texture is None and made.opacity.constant[0] == 1 and made.alpha_cutoff == pytest.approx(0.3)


def test_normal_maps_of_every_convention(tmp_path: Path) -> None:
    """What a `NormalMap` reads, 2 · texel − 1, is scale · texel + bias of the file."""
    inputs = "normal3f inputs:normal.connect = </m/tex.outputs:rgb>"
    raw = 'token inputs:sourceColorSpace = "raw"\n'
    usual = raw + "float4 inputs:scale = (2, 2, 2, 1)\nfloat4 inputs:bias = (-1, -1, -1, 0)"
    made = material_of(tmp_path, inputs, texture(usual)).normal_map
    assert made is not None and made.value.texture is not None
    assert made.value.texture.image.dtype == np.uint8 and not made.value.texture.srgb
    down = raw + "float4 inputs:scale = (2, -2, 2, 1)\nfloat4 inputs:bias = (-1, 1, -1, 0)"
    made = material_of(tmp_path, inputs, texture(down)).normal_map
    assert made is not None
    got = 2 * np.array(texel(made.value, (0.25, 0.75))) - 1
    assert got == pytest.approx([2 * 30 / 255 - 1, 1 - 2 * 60 / 255, 2 * 200 / 255 - 1], abs=1e-5)
    with pytest.warns(EclatWarning, match="a normal map needs scale and bias; 2 and −1 are used"):
        material_of(tmp_path, inputs, texture(raw))


def test_specular_workflow(tmp_path: Path) -> None:
    made = material_of(tmp_path, "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0.5, 0.6, 0.7)")
    assert made.parameters["specular_color"].constant == pytest.approx((0.5, 0.6, 0.7))
    assert made.parameters["metallic"].constant[0] == 0 and made.parameters["ior"].constant[0] == 100


def test_a_second_set_of_coordinates(tmp_path: Path) -> None:
    nodes = texture().replace('"st"\n', '"lightmap"\n') + texture().replace('"tex"', '"tex2"').replace(
        '"reader"', '"reader2"'
    ).replace("/m/reader.", "/m/reader2.")
    rough = "\nfloat inputs:roughness.connect = </m/tex2.outputs:r>"
    second = 'texCoord2f[] primvars:lightmap = [(0, 0), (0.5, 0), (0.5, 0.5), (0, 0.5)] (interpolation = "vertex")'
    mesh = mesh_of(tmp_path, COLOR + rough, nodes, f"{ST}\n{second}")
    assert mesh.material.parameters["base_color"].uv_set == 0 and mesh.material.parameters["roughness"].uv_set == 1
    assert mesh.uvs is not None and mesh.uvs2 is not None
    assert np.ptp(mesh.uvs) == pytest.approx(1) and np.ptp(mesh.uvs2[:, 0]) == pytest.approx(1)
    assert np.asarray(mesh.uvs)[:, 0].max() == pytest.approx(0.5)


def test_vertex_colours_by_a_reader(tmp_path: Path) -> None:
    nodes = """def Shader "c" {
        uniform token info:id = "UsdPrimvarReader_float3"
        string inputs:varname = "paint"
        float3 outputs:result
    }"""
    paint = 'color3f[] primvars:paint = [(0.25, 0.5, 0.75)] (interpolation = "constant")'
    mesh = mesh_of(tmp_path, "color3f inputs:diffuseColor.connect = </m/c.outputs:result>", nodes, paint)
    assert mesh.material.vertex_colors and mesh.colors is not None
    np.testing.assert_allclose(mesh.colors, [[0.25, 0.5, 0.75, 1]] * len(mesh.colors))


def test_inputs_come_through_the_interface_of_the_material(tmp_path: Path) -> None:
    text = body("color3f inputs:diffuseColor.connect = </m.inputs:paint>").replace(
        'def Material "m" {', 'def Material "m" {\ncolor3f inputs:paint = (0.3, 0.2, 0.1)'
    )
    made = load_usda(tmp_path, text).meshes[0].material
    assert made.parameters["base_color"].constant == pytest.approx((0.3, 0.2, 0.1))


def test_what_is_not_supported_is_named(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="the clear coats of UsdPreviewSurface are not supported"):
        material_of(tmp_path, "float inputs:clearcoat = 1")
    with pytest.warns(EclatWarning, match="the displacement of UsdPreviewSurface is not supported"):
        material_of(tmp_path, "float inputs:displacement = 1")
    with pytest.warns(EclatWarning, match=r"/m: expected a UsdPreviewSurface, got none; the display colour"):
        load_usda(tmp_path, body("").replace('"UsdPreviewSurface"', '"ND_standard_surface"'))
    with pytest.warns(EclatWarning, match="expected a roughness in 0..1, got 3; 1 is used instead"):
        material_of(tmp_path, "float inputs:roughness = 3")


def test_a_missing_image_is_a_warning_and_has_the_fallback(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=r"the image 'gone.png' does not exist; a mauve and grey checkerboard"):
        material_of(tmp_path, COLOR, texture(file="gone.png"))
    with pytest.warns(EclatWarning, match="does not exist; the constant"):
        made = material_of(tmp_path, COLOR, texture("float4 inputs:fallback = (0.2, 0.4, 0.6, 1)", file="gone.png"))
    assert texel(made.parameters["base_color"], (0.5, 0.5)) == pytest.approx([0.2, 0.4, 0.6])
    (tmp_path / "bad.png").write_bytes(b"no picture")
    with pytest.warns(EclatWarning, match="the image cannot be decoded"):
        material_of(tmp_path, COLOR, texture(file="bad.png"))


def test_images_outside_of_the_root_folder_are_not_read(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    Image.fromarray(PIXELS).save(tmp_path / "secret.png")
    mesh_of(tmp_path / "inside", COLOR, texture(file="../secret.png"))
    with pytest.warns(EclatWarning, match="expected a file below the root folder"):
        scene = eclat.load(tmp_path / "inside" / "a.usda", root=tmp_path / "inside")
    found = scene.meshes[0].material.parameters["base_color"].texture
    assert found is not None and not np.array_equal(found.image, PIXELS)


def test_inputs_of_wrong_types_are_replaced_with_a_warning(tmp_path: Path) -> None:
    """The file, not the schema, gives the inputs of a shader their types."""
    with pytest.warns(EclatWarning, match="expected 4 finite numbers as bias, got others"):
        material_of(tmp_path, COLOR, texture('string inputs:bias = "much"'))
    with pytest.warns(EclatWarning, match="expected 4 finite numbers as scale, got others"):
        material_of(tmp_path, COLOR, texture("float2 inputs:scale = (1, 2)"))
    with pytest.warns(EclatWarning, match="expected three numbers of at least 0 as emissiveColor, got"):
        material_of(tmp_path, 'string inputs:emissiveColor = "red"')
