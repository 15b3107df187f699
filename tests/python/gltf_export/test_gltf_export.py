# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene written as glTF and read back is the same scene, and looks the same."""

from __future__ import annotations

import json
import struct
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning
from eclat.gltf_export import LightmapTexture, Part, encode_glb, scene_parts
from eclat.gltf_export.geometry import with_flat_normals
from eclat.gltf_export.metallic_roughness import as_metallic_roughness
from eclat.gltf_export.textures import texels
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    NormalMap,
    PointLight,
    Scene,
    SpotLight,
    Texture,
    Value,
    grey,
    look_at,
    rgb,
)
from support.planes import CORNERS, TRIANGLES, square

CHECKS = np.array([[[200, 30, 40], [10, 220, 60]], [[5, 90, 250], [128, 128, 128]]], np.uint8)


def read_back(scene: Scene, folder: Path, **keywords: object) -> Scene:
    path = folder / "scene.glb"
    path.write_bytes(encode_glb(scene, **keywords))  # type: ignore[arg-type]
    return eclat.load(path)


def root_of(data: bytes) -> dict:
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length])


def soup(mesh: Mesh) -> np.ndarray:
    return np.asarray(mesh.positions)[np.asarray(mesh.triangles)]


def noon(scene: Scene) -> np.ndarray:
    return eclat.render(scene, eclat.Path(), size=(24, 24), samples=16, seed=3).pixels


@pytest.mark.parametrize(("name", "rounding"), [("cornell-box", 1e-5), ("glossy-box", 0.01), ("atrium", 0.02)])
def test_built_in_scenes_look_the_same(name: str, rounding: float, tmp_path: Path) -> None:
    """The same seed draws the same paths; rounding, of metal and of single precision, turns a few of them."""
    scene = eclat.load(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        again = read_back(scene, tmp_path)
    again = replace(again, environment=scene.environment)
    before, after = noon(scene), noon(again)
    scale = before.mean()
    # Two renders of other seeds differ by 0.14 to 0.23.
    assert np.abs(after - before).mean() / scale < rounding


def test_geometry_comes_back(tmp_path: Path) -> None:
    scene = eclat.load("cornell-box")
    again = read_back(scene, tmp_path)
    assert [m.name for m in again.meshes] == [m.name for m in scene.meshes]
    for a, b in zip(scene.meshes, again.meshes, strict=True):
        np.testing.assert_allclose(soup(a), soup(b), atol=1e-6)
        assert not b.material.two_sided


def test_flat_meshes_get_normals_and_few_vertices() -> None:
    box = next(m for m in eclat.load("cornell-box").meshes if m.name == "small-box")
    flat = with_flat_normals(box)
    assert len(flat.positions) == 24, "four for each face"
    assert flat.normals is not None
    a, b, c = (soup(flat)[:, i] for i in range(3))
    faces = np.cross(b - a, c - a)
    faces /= np.linalg.norm(faces, axis=1, keepdims=True)
    np.testing.assert_allclose(flat.normals[flat.triangles[:, 0]], faces, atol=1e-5)


def test_materials_come_back(tmp_path: Path) -> None:
    texture = Texture(CHECKS, srgb=True, wrap_u="clamp", wrap_v="mirror", filter="nearest")
    rough = Texture(np.full((2, 2, 3), 128, np.uint8))
    turned = ((0.0, 2.0, 0.25), (-3.0, 0.0, 0.5))
    surface = Material(
        "metallic_roughness",
        {
            "base_color": Value((0.5, 0.6, 0.7), texture, uv_transform=turned),
            "metallic": Value((0.3,) * 3, rough, channel=2),
            "roughness": Value((0.8,) * 3, rough, channel=1, square=True),
            "ior": grey(1.7),
            "specular": grey(0.4),
            "specular_color": rgb(0.2, 0.9, 1.5),
        },
        name="all of it",
        two_sided=True,
        emission=rgb(5, 2, 1),
        emission_two_sided=True,
        normal_map=NormalMap(Value((1.0,) * 3, Texture(np.full((4, 4, 3), 128, np.uint8))), scale=0.7),
    )
    again = read_back(Scene((square(surface),)), tmp_path).meshes[0].material
    assert again.name == "all of it" and again.two_sided and again.emission_two_sided
    base = again.parameters["base_color"]
    assert base.texture is not None
    np.testing.assert_array_equal(base.texture.image, CHECKS)
    assert (base.texture.wrap_u, base.texture.wrap_v, base.texture.filter) == ("clamp", "mirror", "nearest")
    np.testing.assert_allclose(base.uv_transform, turned, atol=1e-12)
    assert base.constant == (0.5, 0.6, 0.7)
    for name in ("metallic", "roughness"):
        value, wanted = again.parameters[name], surface.parameters[name]
        assert (value.channel, value.square, value.constant) == (wanted.channel, wanted.square, wanted.constant)
    assert again.parameters["ior"].constant[0] == 1.7
    assert again.parameters["specular"].constant[0] == 0.4
    assert again.parameters["specular_color"].constant == (0.2, 0.9, 1.5)
    assert again.emission is not None and again.emission.constant == pytest.approx((5, 2, 1))
    assert again.normal_map is not None and again.normal_map.scale == 0.7


def test_roughness_without_a_square_is_written_as_its_root(tmp_path: Path) -> None:
    alpha = np.array([[0.04, 0.25], [0.49, 1.0]], np.float32)[..., None]
    value = Value((0.81,) * 3, Texture(alpha), channel=0)
    surface = Material("metallic_roughness", {"roughness": value, "metallic": grey(1)})
    again = read_back(Scene((square(surface),)), tmp_path).meshes[0].material.parameters["roughness"]
    found = texels(again)[..., 0] * again.constant[0] ** 2
    np.testing.assert_allclose(found, 0.81 * alpha[..., 0], atol=0.005)


@pytest.mark.parametrize("cutoff", [None, 0.5])
def test_opacity_beside_colours(tmp_path: Path, cutoff: float | None) -> None:
    """Another image's opacity is joined to the colours."""
    mask = Texture(np.array([[[0], [255]], [[255], [0]]], np.uint8))
    colors = Texture(CHECKS, srgb=True)
    leaf = Material(
        "diffuse",
        {"reflectance": Value((1.0,) * 3, colors)},
        opacity=Value((1.0,) * 3, mask, channel=0),
        alpha_cutoff=cutoff,
    )
    again = read_back(Scene((square(leaf),)), tmp_path).meshes[0].material
    assert again.alpha_cutoff == cutoff
    np.testing.assert_array_equal(texels(again.opacity)[..., 0], [[0, 1], [1, 0]])
    texture = again.parameters["base_color"].texture
    assert texture is not None
    np.testing.assert_array_equal(texture.image[..., :3], CHECKS)


def test_linear_and_bright_textures(tmp_path: Path) -> None:
    """Colours that are linear floats are encoded; emission above 1 becomes a strength."""
    linear = np.array([[[0.0, 0.2, 0.9]], [[4.0, 1.0, 0.5]]], np.float32)
    glow = Material("diffuse", {"reflectance": grey(0)}, emission=Value((2.0, 2.0, 2.0), Texture(linear)))
    again = read_back(Scene((square(glow),)), tmp_path).meshes[0].material.emission
    assert again is not None
    found = texels(again) * again.constant
    np.testing.assert_allclose(found, 2 * linear, atol=0.05)
    assert again.constant == pytest.approx((8, 8, 8))


def test_sides_that_differ_become_two_sheets_and_one_again(tmp_path: Path) -> None:
    """glTF's double-sided materials emit on both sides, ours need not."""
    lamp = Material("diffuse", {"reflectance": grey(0.3)}, two_sided=True, emission=grey(4), name="lamp")
    scene = Scene((square(lamp),))
    data = encode_glb(scene)
    root = root_of(data)
    assert len(root["meshes"]) == 2
    assert not any(m.get("doubleSided") for m in root["materials"])
    assert sorted("emissiveFactor" in m for m in root["materials"]) == [False, True]
    again = read_back(scene, tmp_path)
    assert len(again.meshes) == 1
    assert again.meshes[0].material.two_sided and not again.meshes[0].material.emission_two_sided


def test_the_back_of_a_sheet_is_turned_over() -> None:
    normals = np.tile([0.0, 0.0, 1.0], (4, 1))
    lamp = Material("diffuse", two_sided=True, emission=grey(4))
    front, back = scene_parts(Scene((square(lamp, normals=normals),)))
    assert back.mesh.normals is not None
    np.testing.assert_array_equal(back.mesh.normals, -normals)
    a, b, c = (soup(back.mesh)[:, i] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] < 0).all() and front.mesh.normals is normals


def test_uv_sets_beside_a_light_map(tmp_path: Path) -> None:
    """The scene's own second set moves behind the light map, and comes back as the second."""
    second = np.array([[0.0, 0.5], [0.5, 0.5], [0.5, 0.0], [0.0, 0.0]])
    surface = Material("diffuse", {"reflectance": Value((1.0,) * 3, Texture(CHECKS, srgb=True), uv_set=1)})
    mesh = square(surface, uvs2=second, normals=np.tile([0.0, 0, 1], (4, 1)))
    places = np.array([[0.1, 0.9], [0.9, 0.9], [0.9, 0.1], [0.1, 0.1]])
    png = _png()
    part = Part(mesh, lightmap_uvs=places)
    keywords = {"lightmaps": [LightmapTexture(png, 3.5)], "notes": {"lightmap": "scene.lightmap.json"}}
    root = root_of(encode_glb(Scene((mesh,)), [part], **keywords))
    attributes = root["meshes"][0]["primitives"][0]["attributes"]
    assert {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"} <= set(attributes)
    material = root["materials"][0]
    assert material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] == 2
    moz = material["extensions"]["MOZ_lightmap"]
    assert (moz["texCoord"], moz["intensity"]) == (1, 3.5)
    assert root["images"][root["textures"][moz["index"]]["source"]]["mimeType"] == "image/png"
    assert "MOZ_lightmap" in root["extensionsUsed"] and "extensionsRequired" not in root
    assert root["asset"]["extras"]["eclat"]["lightmap"] == "scene.lightmap.json"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = read_back(Scene((mesh,)), tmp_path, parts=[part], **keywords).meshes[0]
    np.testing.assert_allclose(again.uvs2, second)
    assert again.material.parameters["base_color"].uv_set == 1


def _png() -> bytes:
    import io

    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(file, format="PNG")
    return file.getvalue()


def test_cameras_and_lights_come_back(tmp_path: Path) -> None:
    lights = (
        PointLight((1, 2, 3), (4, 5, 6)),
        SpotLight((0, 3, 0), (0.6, -0.8, 0), (9, 9, 3), 10.0, 30.0),
        DirectionalLight((0, -1, 0), (2, 1, 0.5)),
    )
    cameras = (
        Camera(look_at((1, 2, 5), (0, 0, 0)), fov=40, size=(640, 360), name="wide"),
        Camera(look_at((0, 5, 0), (0, 0, 0), (0, 0, -1)), fov=3, projection="orthographic", size=(360, 720)),
    )
    scene = Scene((square(Material()),), lights, cameras=cameras)
    again = read_back(scene, tmp_path)
    assert not again.photometric, "the numbers are watts still"
    for a, b in zip(lights, again.lights, strict=True):
        for name in a.__dataclass_fields__:
            wanted, found = getattr(a, name), getattr(b, name)
            assert found == (wanted if isinstance(wanted, str) else pytest.approx(wanted, rel=1e-5, abs=1e-9))
    for c, d in zip(cameras, again.cameras, strict=True):
        np.testing.assert_allclose(d.to_world, c.to_world, atol=1e-12)
        assert d.half_extent(1.5) == pytest.approx(c.half_extent(1.5))
    assert not read_back(scene, tmp_path, lights=False).lights


@pytest.mark.parametrize("scale", [1e-3, 1.0, 500.0])
def test_clipping_planes_follow_the_size_of_what_is_seen(scale: float) -> None:
    """From one millimetre to half a kilometre a depth buffer of 24 bits tells apart what is a thousandth of it apart."""
    panel = square(Material())
    panel = replace(panel, positions=scale * np.asarray(panel.positions))
    camera = Camera(look_at((0.3 * scale, 0.2 * scale, 2 * scale), (0, 0, 0)))
    data = encode_glb(Scene((panel,), cameras=(camera,)))
    length = struct.unpack("<I", data[12:16])[0]
    lens = json.loads(data[20 : 20 + length])["cameras"][0]["perspective"]
    depths = -((panel.positions - camera.to_world[:3, 3]) @ camera.to_world[:3, 2])
    assert 0 < lens["znear"] < depths.min() / 100
    assert depths.max() < lens["zfar"]
    assert depths.max() ** 2 / (lens["znear"] * 2**24) < 1e-3 * scale


def test_photometric_scenes_stay_so(tmp_path: Path) -> None:
    assert read_back(Scene((square(Material()),), photometric=True), tmp_path).photometric


@pytest.mark.parametrize(
    "kind", ["phong", "ward", "conductor", "dielectric", "thin_dielectric", "plastic", "diffuse", "blend"]
)
def test_every_kind_becomes_metallic_roughness(kind: str, tmp_path: Path) -> None:
    children = (Material("diffuse", {"reflectance": grey(0.2)}), Material("diffuse", {"reflectance": grey(0.6)}))
    material = Material(kind, children=children if kind == "blend" else (), two_sided=False)
    body = Mesh(np.vstack((np.zeros(3), np.eye(3))), np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]), material)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EclatWarning)
        converted = as_metallic_roughness(material)
        again = read_back(Scene((body,)), tmp_path).meshes[0].material
    assert converted.kind == again.kind == "metallic_roughness"
    if kind == "blend":
        assert converted.parameters["base_color"].constant == pytest.approx((0.4,) * 3)
    if kind == "conductor":
        assert converted.parameters["base_color"].constant == pytest.approx((1.0,) * 3), "the default reflects all"
    assert again.thin_walled == (kind != "dielectric")


def test_a_curtain_is_written_and_read_back(tmp_path: Path) -> None:
    curtain = Material("translucent", {"reflectance": rgb(0.3, 0.2, 0.1), "transmittance": rgb(0.6, 0.4, 0.2)})
    found = read_back(Scene((square(curtain),)), tmp_path).meshes[0].material.parameters
    share = found["diffuse_transmission"].constant[0]
    base, color = (np.array(found[name].constant) for name in ("base_color", "diffuse_transmission_color"))
    np.testing.assert_allclose((1 - share) * base, (0.3, 0.2, 0.1), rtol=1e-5)
    np.testing.assert_allclose(share * color, (0.6, 0.4, 0.2), rtol=1e-5)


def test_features_that_gltf_lacks_cause_warnings() -> None:
    bumpy = Material(normal_map=NormalMap(Value((1.0,) * 3, Texture(CHECKS)), kind="bump"))
    with pytest.warns(EclatWarning, match="bump"):
        encode_glb(Scene((square(bumpy),)))
    with pytest.warns(EclatWarning, match="environment"):
        encode_glb(Scene((square(Material()),), environment=Environment(np.ones((1, 1, 3), np.float32))))
    with pytest.warns(EclatWarning, match="sharp"):
        encode_glb(Scene(lights=(DirectionalLight((0, -1, 0), (1, 1, 1), 0.27),)))


def test_bad_positions_are_refused_and_empty_scenes_written(tmp_path: Path) -> None:
    broken = CORNERS.copy()
    broken[1, 2] = np.nan
    with pytest.raises(EclatError, match="expected positions that are finite"):
        encode_glb(Scene((Mesh(broken, TRIANGLES, Material(), name="wall"),)))
    with pytest.warns(EclatWarning, match="no triangles"):
        assert not read_back(Scene(), tmp_path).meshes
