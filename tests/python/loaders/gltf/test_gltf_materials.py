# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""glTF materials and textures."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eclat.errors import EclatWarning
from eclat.loaders.gltf import load_gltf
from eclat.scene import MATERIAL_KINDS, Material, Value
from support.gltf_files import GltfFile, png_bytes

RGBA = np.arange(2 * 3 * 4).reshape(2, 3, 4)
RGB = RGBA[..., :3]
GREY = RGBA[..., :1]


def primitive(file: GltfFile, material: dict[str, Any], *attributes: str) -> dict[str, Any]:
    made = file.primitive(material=file.append("materials", material))
    made["attributes"]["TEXCOORD_0"] = file.accessor([[0, 0], [1, 0], [0, 1]])
    made["attributes"]["TEXCOORD_1"] = file.accessor([[0, 0], [1, 0], [0, 1]])
    for name in attributes:
        made["attributes"][name] = file.accessor([[1, 1, 1, 0.5]] * 3)
    return made


def load(file: GltfFile, folder: Path, material: dict[str, Any], *attributes: str) -> Material:
    file.mesh_node(primitive(file, material, *attributes))
    return load_gltf(file.save(folder)).meshes[0].material


def apply(value: Value, u: float, v: float) -> tuple[float, float]:
    (a, b, c), (d, e, f) = value.uv_transform
    return a * u + b * v + c, d * u + e * v + f


def test_the_default_material_is_white_rough_metal(tmp_path: Path) -> None:
    material = load(GltfFile(), tmp_path, {})
    assert material.parameters["base_color"].constant == (1, 1, 1)
    assert material.parameters["metallic"].constant == (1, 1, 1)
    assert material.parameters["roughness"].constant == (1, 1, 1) and material.parameters["roughness"].square
    assert material.emission is None and material.normal_map is None and material.alpha_cutoff is None
    assert material.opacity.constant == (1, 1, 1) and not material.two_sided


def test_metallic_roughness_with_all_its_textures(tmp_path: Path) -> None:
    file = GltfFile()
    color, data = file.texture(RGB), file.texture(RGBA)
    pbr = {
        "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
        "baseColorTexture": {"index": color},
        "metallicFactor": 0.5,
        "roughnessFactor": 0.6,
        "metallicRoughnessTexture": {"index": data, "texCoord": 1},
    }
    normal = {"index": data, "scale": 0.7}
    emission = {"emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": color}}
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}
    more = {"normalTexture": normal, "occlusionTexture": {"index": data}, "doubleSided": True, "extensions": strength}
    material = load(file, tmp_path, {"pbrMetallicRoughness": pbr, **more, **emission})
    base, metallic = material.parameters["base_color"], material.parameters["metallic"]
    roughness = material.parameters["roughness"]
    assert base.constant == (0.1, 0.2, 0.3) and base.channel is None and base.texture is not None
    assert base.texture.srgb and base.texture.filter == "bilinear"
    np.testing.assert_array_equal(base.texture.image, RGB)
    assert (metallic.constant[0], metallic.channel, metallic.uv_set, metallic.square) == (0.5, 2, 1, False)
    assert (roughness.constant[0], roughness.channel, roughness.square) == (0.6, 1, True)
    assert metallic.texture is roughness.texture and metallic.texture is not None and not metallic.texture.srgb
    assert material.normal_map is not None and material.normal_map.scale == 0.7
    assert material.normal_map.value.texture is metallic.texture
    assert material.emission is not None and material.emission.constant == (8, 4, 0)
    assert material.emission.texture is base.texture
    assert material.two_sided and material.emission_two_sided
    assert set(material.parameters) <= set(MATERIAL_KINDS[material.kind])


def test_alpha_modes(tmp_path: Path) -> None:
    pbr = {"baseColorFactor": [1, 1, 1, 0.25]}
    file = GltfFile()
    opaque = load(file, tmp_path, {"pbrMetallicRoughness": pbr})
    assert (opaque.opacity.constant[0], opaque.alpha_cutoff) == (1.0, None)
    textured = {**pbr, "baseColorTexture": {"index": file.texture(RGBA)}}
    file.json["meshes"], file.json["nodes"] = [], []
    mask = load(file, tmp_path, {"pbrMetallicRoughness": textured, "alphaMode": "MASK"})
    assert (mask.opacity.constant[0], mask.opacity.channel, mask.alpha_cutoff) == (0.25, 3, 0.5)
    assert mask.opacity.texture is mask.parameters["base_color"].texture
    file.json["meshes"], file.json["nodes"] = [], []
    blend = load(file, tmp_path, {"pbrMetallicRoughness": pbr, "alphaMode": "BLEND", "alphaCutoff": 0.3})
    assert (blend.opacity.constant[0], blend.opacity.texture, blend.alpha_cutoff) == (0.25, None, None)


@pytest.mark.parametrize("pixels", [RGB, GREY])
def test_images_without_alpha_are_opaque(tmp_path: Path, pixels: np.ndarray) -> None:
    file = GltfFile()
    pbr = {"baseColorTexture": {"index": file.texture(pixels)}}
    material = load(file, tmp_path, {"pbrMetallicRoughness": pbr, "alphaMode": "BLEND"})
    assert material.opacity.texture is None and material.opacity.constant[0] == 1


def test_vertex_alpha_counts_only_where_alpha_does(tmp_path: Path) -> None:
    file = GltfFile()
    file.mesh_node(primitive(file, {}, "COLOR_0"), primitive(file, {"alphaMode": "BLEND"}, "COLOR_0"))
    opaque, blend = load_gltf(file.save(tmp_path)).meshes
    assert opaque.colors is not None and blend.colors is not None
    assert (opaque.colors[0, 3], blend.colors[0, 3]) == (1, 0.5)


def test_a_grey_image_serves_all_channels(tmp_path: Path) -> None:
    file = GltfFile()
    info = {"index": file.texture(GREY)}
    pbr = {"baseColorTexture": info, "metallicRoughnessTexture": info}
    parameters = load(file, tmp_path, {"pbrMetallicRoughness": pbr}).parameters
    assert [parameters[name].channel for name in ("base_color", "metallic", "roughness")] == [0, 0, 0]


def test_samplers(tmp_path: Path) -> None:
    file = GltfFile()
    pbr = {"baseColorTexture": {"index": file.texture(RGB, wrapS=33071, wrapT=33648, magFilter=9728, minFilter=9987)}}
    texture = load(file, tmp_path, {"pbrMetallicRoughness": pbr}).parameters["base_color"].texture
    assert texture is not None
    assert (texture.wrap_u, texture.wrap_v, texture.filter) == ("clamp", "mirror", "nearest")


def test_texture_transform_is_the_example_of_its_specification(tmp_path: Path) -> None:
    file = GltfFile()
    transform = {"offset": [0, 1], "rotation": math.pi / 2, "scale": [0.5, 0.5], "texCoord": 1}
    info = {"index": file.texture(RGB), "extensions": {"KHR_texture_transform": transform}}
    value = load(file, tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": info}}).parameters["base_color"]
    assert value.uv_set == 1
    # "only the lower left quadrant of the source image, rotated clockwise 90°"; v grows downwards
    corners = [apply(value, u, v) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
    np.testing.assert_allclose(corners, [(0, 1), (0, 0.5), (0.5, 0.5), (0.5, 1)], atol=1e-12)


def test_texture_transform_scales_before_it_turns(tmp_path: Path) -> None:
    file = GltfFile()
    transform = {"rotation": math.pi / 2, "scale": [2, 3]}
    info = {"index": file.texture(RGB), "extensions": {"KHR_texture_transform": transform}}
    value = load(file, tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": info}}).parameters["base_color"]
    np.testing.assert_allclose([apply(value, 1, 0), apply(value, 0, 1)], [(0, -2), (3, 0)], atol=1e-12)


@pytest.mark.parametrize("both", [False, True])
def test_unlit_materials_emit_on_their_visible_sides(both: bool, tmp_path: Path) -> None:
    pbr = {"baseColorFactor": [0.5, 0.6, 0.7, 1]}
    unlit = {"pbrMetallicRoughness": pbr, "extensions": {"KHR_materials_unlit": {}}, "doubleSided": both}
    material = load(GltfFile(), tmp_path, unlit)
    assert material.kind == "diffuse" and material.parameters["reflectance"].constant == (0, 0, 0)
    assert material.emission is not None and material.emission.constant == (0.5, 0.6, 0.7)
    assert material.emission_two_sided == material.two_sided == both and material.back_culled != both


def test_ior_specular_and_transmission(tmp_path: Path) -> None:
    file = GltfFile()
    texture, color = file.texture(RGBA), {"index": file.texture(RGB)}
    specular = {"specularFactor": 0.5, "specularColorFactor": [0.2, 2, 1], "specularColorTexture": color}
    extensions = {
        "KHR_materials_ior": {"ior": 1.33},
        "KHR_materials_specular": {**specular, "specularTexture": {"index": texture}},
        "KHR_materials_transmission": {"transmissionFactor": 0.9, "transmissionTexture": {"index": texture}},
    }
    material = load(file, tmp_path, {"extensions": extensions})
    parameters = material.parameters
    assert parameters["ior"].constant[0] == 1.33 and material.thin_walled
    assert (parameters["specular"].constant[0], parameters["specular"].channel) == (0.5, 3)
    assert parameters["specular_color"].constant == (0.2, 2, 1)
    assert parameters["specular_color"].texture is not None and parameters["specular_color"].texture.srgb
    assert (parameters["transmission"].constant[0], parameters["transmission"].channel) == (0.9, 0)


def test_a_volume_with_thickness_is_solid_glass(tmp_path: Path) -> None:
    volume = {"thicknessFactor": 0.1, "attenuationColor": [1, 0, 0], "attenuationDistance": 0.5}
    glass = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": volume}
    file = GltfFile()
    corners, faces = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
    body = file.primitive(corners, faces, material=file.append("materials", {"extensions": glass}))
    file.mesh_node(body)
    with pytest.warns(EclatWarning, match="attenuation in a volume is not supported and is ignored"):
        (mesh,) = load_gltf(file.save(tmp_path)).meshes
    assert not mesh.material.thin_walled


def test_an_open_sheet_is_a_pane_whatever_its_volume(tmp_path: Path) -> None:
    glass = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": {"thicknessFactor": 0.1}}
    with pytest.warns(EclatWarning, match="requires a closed mesh, .* become thin panes"):
        assert load(GltfFile(), tmp_path, {"extensions": glass}).thin_walled


def test_diffuse_transmission(tmp_path: Path) -> None:
    file = GltfFile()
    paper = {
        "diffuseTransmissionFactor": 0.25,
        "diffuseTransmissionTexture": {"index": file.texture(RGBA)},
        "diffuseTransmissionColorFactor": [0.5, 0.75, 1],
    }
    parameters = load(file, tmp_path, {"extensions": {"KHR_materials_diffuse_transmission": paper}}).parameters
    share = parameters["diffuse_transmission"]
    assert (share.constant[0], share.channel, share.texture is None) == (0.25, 3, False)
    assert parameters["diffuse_transmission_color"].constant == (0.5, 0.75, 1)


def test_specular_glossiness_is_approximated(tmp_path: Path) -> None:
    file = GltfFile()
    glossy = {
        "diffuseFactor": [0.5, 0.4, 0.3, 1],
        "specularFactor": [0.9, 0.8, 0.7],
        "specularGlossinessTexture": {"index": file.texture(RGBA)},
    }
    with pytest.warns(EclatWarning, match="is approximated by a metallic-roughness material"):
        material = load(file, tmp_path, {"extensions": {"KHR_materials_pbrSpecularGlossiness": glossy}})
    parameters = material.parameters
    assert parameters["base_color"].constant == (0.5, 0.4, 0.3) and parameters["metallic"].constant == (0, 0, 0)
    assert parameters["specular_color"].constant == (0.9, 0.8, 0.7)
    assert (parameters["roughness"].channel, parameters["roughness"].invert) == (3, True)


def test_external_and_data_uri_images(tmp_path: Path) -> None:
    (tmp_path / "Wood Grain.PNG").write_bytes(png_bytes(RGB))
    file = GltfFile()
    file.append("images", {"uri": "wood%20grain.png"})
    pbr = {"baseColorTexture": {"index": file.append("textures", {"source": 0})}}
    texture = load(file, tmp_path, {"pbrMetallicRoughness": pbr}).parameters["base_color"].texture
    assert texture is not None
    np.testing.assert_array_equal(texture.image, RGB)


def test_a_missing_image_gets_a_visible_stand_in_and_a_warning(tmp_path: Path) -> None:
    file = GltfFile()
    file.append("images", {"uri": "gone.png"})
    index = file.append("textures", {"source": 0})
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": index}}, "normalTexture": {"index": index}}
    with pytest.warns(
        EclatWarning, match=r"images\[0\]: file not found: .*gone.png; a mauve and grey checkerboard is used instead"
    ):
        loaded = load(file, tmp_path, material)
    texture = loaded.parameters["base_color"].texture
    assert texture is not None and texture.image.min() > 100
    assert loaded.normal_map is not None and loaded.normal_map.value.texture is not None
    np.testing.assert_array_equal(loaded.normal_map.value.texture.image, [[[0.5, 0.5, 1]]])


def test_factors_out_of_range_are_moved_into_it(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=r"roughnessFactor: expected a number in 0..1, got 1.4; 1 is used instead"):
        material = load(GltfFile(), tmp_path, {"pbrMetallicRoughness": {"roughnessFactor": 1.4}})
    assert material.parameters["roughness"].constant[0] == 1


def test_a_texture_without_coordinates_causes_a_warning(tmp_path: Path) -> None:
    file = GltfFile()
    material = file.append("materials", {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": file.texture(RGB)}})
    file.mesh_node(file.primitive(material=material))
    with pytest.warns(EclatWarning, match=r"the material uses TEXCOORD_0, which the primitive does not have"):
        load_gltf(file.save(tmp_path))
