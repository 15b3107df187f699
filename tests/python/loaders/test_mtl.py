# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""MTL files: statements, and what becomes of them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from PIL import Image

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.obj import load_obj
from eclat.scene import Material, Mesh
from support.mutations import mutated, survives

PANE = "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl m\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"

RICH = b"""newmtl m
Kd 0.5 0.4 0.3 # brown
Ks 0.2
Ns 40
Ke 0 1 0
d 0.5
Tr 0.5
Ni 1.45
illum 2
map_Kd -s 2 2 1 -o 0.5 kd.png
bump -bm 0.5 -clamp on kd.png
Pr 0.3
"""


def mesh_of(folder: Path, mtl: str | bytes, obj: str = PANE + "usemtl m\nf 1/1 2/2 3/3\n") -> Mesh:
    """The mesh of an OBJ file with a material `m` whose statements are `mtl`."""
    text = mtl if isinstance(mtl, bytes) else b"newmtl m\n" + mtl.encode()
    (folder / "test.mtl").write_bytes(text)
    (folder / "test.obj").write_text("mtllib test.mtl\n" + obj)
    (mesh,) = load_obj(folder / "test.obj")
    return mesh


def material_of(folder: Path, mtl: str, obj: str = PANE + "usemtl m\nf 1/1 2/2 3/3\n") -> Material:
    return mesh_of(folder, mtl, obj).material


def image(folder: Path, name: str, mode: str, *pixels: object, size: tuple[int, int] = (2, 1)) -> None:
    picture = Image.new(mode, size)
    picture.putdata(pixels)
    picture.save(folder / name)


def test_illum_without_highlights_is_diffuse(tmp_path: Path) -> None:
    for text in ("Kd 0.1 0.2 0.3\n", "Kd .1 .2 .3\nKs 0 0 0\nNs 10\nillum 2\n", "Kd .1 .2 .3\nKs 1 1 1\nillum 1\n"):
        material = material_of(tmp_path, text)
        assert material.kind == "diffuse" and material.name == "m" and material.two_sided
        assert material.parameters["reflectance"].constant == (0.1, 0.2, 0.3)


def test_phong_for_highlights(tmp_path: Path) -> None:
    material = material_of(tmp_path, "Kd 0.5 0.5 0.5\nKs 0.25\nNs 50\nillum 2\n")
    assert material.kind == "phong"
    assert material.parameters["diffuse_reflectance"].constant == (0.5, 0.5, 0.5)
    assert material.parameters["specular_reflectance"].constant == (0.25, 0.25, 0.25)
    assert material.parameters["exponent"].constant[0] == 50


def test_more_than_all_light_is_scaled_with_a_warning(tmp_path: Path) -> None:
    with pytest.warns(
        EclatWarning, match=r"test\.mtl, material 'm': Kd \+ Ks is 1\.5, expected at most 1; both are divided"
    ):
        material = material_of(tmp_path, "Kd 0.9 0 0\nKs 0.6 0 0\nNs 50\n")
    assert material.parameters["diffuse_reflectance"].constant[0] == pytest.approx(0.6)
    assert material.parameters["specular_reflectance"].constant[0] == pytest.approx(0.4)


@pytest.mark.parametrize("mode", ["illum 5\nNs 10", "illum 3\nNs 1000"])
def test_mirrors(tmp_path: Path, mode: str) -> None:
    material = material_of(tmp_path, f"Kd 0.01 0.01 0.01\nKs 0.95 0.9 0.95\n{mode}\n")
    assert material.kind == "conductor"
    assert material.parameters["specular_reflectance"].constant == (0.95, 0.9, 0.95)
    assert material.parameters["alpha_u"].constant[0] == 0


def test_a_mirror_over_paint_keeps_both_reflectances(tmp_path: Path) -> None:
    material = material_of(tmp_path, "Kd 0.3 0.2 0.1\nKs 0.6\nillum 5\n")
    weight = material.parameters["weight"].constant[0]
    paint, mirror = material.children
    np.testing.assert_allclose(np.array(paint.parameters["reflectance"].constant) * (1 - weight), (0.3, 0.2, 0.1))
    np.testing.assert_allclose(np.array(mirror.parameters["specular_reflectance"].constant) * weight, 0.6)


@pytest.mark.parametrize("illum", [4, 6, 7])
def test_solid_glass_filters_light_once(tmp_path: Path, illum: int) -> None:
    material = material_of(tmp_path, f"Kd 1 0 0\nKs 1 1 1\nd 0.1\nTf 0.25 1 0.5\nNi 1.33\nillum {illum}\n", TETRAHEDRON)
    assert material.kind == "dielectric"
    assert material.parameters["ior"].constant[0] == 1.33
    assert material.parameters["specular_transmittance"].constant == pytest.approx((0.5, 1, math.sqrt(0.5)))
    assert material.opacity.constant[0] == 1


def test_panes(tmp_path: Path) -> None:
    for illum, kind in ((4, "thin_dielectric"), (9, "thin_dielectric"), (7, "thin_dielectric")):
        material = material_of(tmp_path, f"Tf 0.25 1 0.5\nillum {illum}\n")
        assert material.kind == kind
    assert material_of(tmp_path, "Tf 0.25 1 0.5\nillum 9\n", TETRAHEDRON).kind == "thin_dielectric"
    thin = material_of(tmp_path, "Tf 0.25 1 0.5\nillum 4\n")
    assert thin.parameters["specular_transmittance"].constant == (0.25, 1, 0.5)


def test_physically_based_statements(tmp_path: Path) -> None:
    material = material_of(tmp_path, "Kd 1 0.5 0\nPr 0.5\nPm 0.75\nKs 1 1 1\nNi 1.4\n")
    assert material.kind == "metallic_roughness"
    assert material.parameters["base_color"].constant == (1, 0.5, 0)
    assert material.parameters["roughness"].square and material.parameters["roughness"].constant[0] == 0.5
    assert material.parameters["metallic"].constant[0] == 0.75
    assert material.parameters["ior"].constant[0] == 1.4


def test_one_image_for_roughness_and_metalness_is_packed_as_in_gltf(tmp_path: Path) -> None:
    image(tmp_path, "orm.png", "RGB", (255, 128, 0), (255, 64, 255))
    parameters = material_of(tmp_path, "map_Pr orm.png\nmap_Pm orm.png\n").parameters
    assert (parameters["roughness"].channel, parameters["metallic"].channel) == (1, 2)


@pytest.mark.parametrize(
    ("text", "opacity"), [("d 0.25", 0.25), ("Tr 0.25", 0.75), ("d 0.9\nTr 0.9", 0.9), ("d -halo 0.5", 0.5), ("", 1.0)]
)
def test_opacity(tmp_path: Path, text: str, opacity: float) -> None:
    assert material_of(tmp_path, f"Kd 1 1 1\n{text}\n").opacity.constant[0] == opacity


def test_tr_of_one_alone_does_not_make_a_material_invisible(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=r"test\.mtl, line 2, material 'm': Tr is 1 and d is missing"):
        assert material_of(tmp_path, "Tr 1.0\n").opacity.constant[0] == 1


def test_invisible_surfaces_cause_a_warning(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="d is 0, so its surfaces are invisible"):
        assert material_of(tmp_path, "d 0\n").opacity.constant[0] == 0


def test_masks_are_grey_or_the_alpha_of_the_colour_image(tmp_path: Path) -> None:
    image(tmp_path, "leaf.png", "RGBA", (255, 0, 0, 255), (0, 255, 0, 0))
    image(tmp_path, "mask.png", "L", 255, 0)
    shared = material_of(tmp_path, "map_Kd leaf.png\nmap_d leaf.png\n")
    assert shared.opacity.channel == 3
    assert material_of(tmp_path, "map_Kd leaf.png\nmap_d mask.png\n").opacity.channel == 0
    assert material_of(tmp_path, "map_d -imfchan g leaf.png\n").opacity.channel == 1
    assert material_of(tmp_path, "map_Tr mask.png\n").opacity.invert


def test_emission_shines_on_the_normal_s_side_only(tmp_path: Path) -> None:
    material = material_of(tmp_path, "Ke 17 12 4\n")
    assert material.emission.constant == (17, 12, 4) and not material.emission_two_sided
    assert material_of(tmp_path, "Ke 0 0 0\n").emission is None


def test_colour_images_are_srgb_and_data_are_not(tmp_path: Path) -> None:
    image(tmp_path, "a b.png", "RGB", (255, 0, 0), (0, 255, 0))
    material = material_of(tmp_path, "map_Kd a b.png\nKs 0.1\nmap_Ks a b.png\nmap_Ns a b.png\nKd 0.5 0.5 0.5\n")
    diffuse = material.parameters["diffuse_reflectance"]
    assert diffuse.texture.srgb and diffuse.constant == (0.5, 0.5, 0.5)
    assert material.parameters["specular_reflectance"].texture is diffuse.texture
    assert not material.parameters["exponent"].texture.srgb
    assert material.parameters["exponent"].constant[0] == 1000


def test_texture_options_become_a_transform_of_our_uv(tmp_path: Path) -> None:
    image(tmp_path, "a.png", "RGB", (255, 0, 0), (0, 255, 0))
    value = material_of(tmp_path, "map_Kd -s 2 4 1 -o 0.25 0.5 -blendu on -clamp on a.png\n").parameters["reflectance"]
    assert value.texture.wrap_u == value.texture.wrap_v == "clamp"
    u, v = 0.3, 0.8  # in the file's orientation
    ours = np.array(value.uv_transform) @ (u, 1 - v, 1)
    np.testing.assert_allclose(ours, (2 * u + 0.25, 1 - (4 * v + 0.5)))


def test_bump_heights_are_a_hundredth_of_the_texture_s_width(tmp_path: Path) -> None:
    image(tmp_path, "a.png", "L", 0, 255)
    one = material_of(tmp_path, "bump a.png\n").normal_map
    # The mesh is 2 m for one width of the texture, and half of that where it is repeated twice.
    assert one.kind == "bump" and one.scale == pytest.approx(0.02)
    assert material_of(tmp_path, "map_bump -bm 3 -s 2 2 2 a.png\n").normal_map.scale == pytest.approx(0.03)
    assert not one.value.texture.srgb and one.value.channel == 0


def test_normal_maps(tmp_path: Path) -> None:
    image(tmp_path, "n.png", "RGB", (128, 128, 255), (140, 120, 250))
    assert material_of(tmp_path, "norm n.png\n").normal_map.kind == "normal"
    with pytest.warns(EclatWarning, match=r"line 2, material 'm': the bump map 'n\.png' looks like a normal map"):
        found = material_of(tmp_path, "bump n.png\n").normal_map
    assert found.kind == "normal" and found.scale == 1


def test_missing_textures_get_a_stand_in_and_a_warning(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=r"test\.mtl, line 2, material 'm': .*gone\.png"):
        value = material_of(tmp_path, "map_Kd gone.png\n").parameters["reflectance"]
    assert value.texture.image.any()
    with pytest.warns(EclatWarning, match="expected the name of a local file, got the URL"):
        material_of(tmp_path, "map_Kd http://example.org/a.png\n")
    with pytest.warns(EclatWarning, match="expected the name of an image file after map_kd"):
        assert material_of(tmp_path, "map_Kd -s 1 1 1\n").parameters["reflectance"].texture is None
    with pytest.warns(EclatWarning, match="gone"):
        assert material_of(tmp_path, "norm gone.png\n").normal_map is None


def test_textures_on_faces_without_vt_cause_a_warning(tmp_path: Path) -> None:
    image(tmp_path, "a.png", "RGB", (255, 0, 0), (0, 255, 0))
    with pytest.warns(EclatWarning, match="material 'm': the material has textures"):
        material_of(tmp_path, "map_Kd a.png\n", TETRAHEDRON)


def test_unknown_statements_are_named_once_each(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match=r"test\.mtl: .* ignored: 'Pcr' \(line 2\), 'refl' \(line 4\)$") as caught:
        material_of(tmp_path, "Pcr 1\nPcr 2\nrefl a.png\nKa 1 1 1\n")
    assert len(caught) == 1


@pytest.mark.parametrize("kd", ["Kd 0 0 0\n", "Kd 0.2 0.2 0.2\n", ""])
def test_an_image_that_only_map_ka_names_is_a_warning(tmp_path: Path, kd: str) -> None:
    image(tmp_path, "a.png", "RGB", (255, 0, 0), (0, 255, 0))
    with pytest.warns(EclatWarning, match=r"test\.mtl, line \d, material 'm': map_Ka is ignored") as caught:
        assert material_of(tmp_path, f"{kd}map_Ka a.png\n").parameters["reflectance"].texture is None
    assert len(caught) == 1
    assert material_of(tmp_path, "map_Ka a.png\nmap_Kd a.png\n").parameters["reflectance"].texture is not None


@pytest.mark.parametrize("word", ["-1.#IND", "1.#QNAN", "-1.#J", "-nan(ind)", "1.#INF"])
@pytest.mark.parametrize("key", ["Kd", "Ks", "Ke", "Ns", "d"])
def test_statements_with_numbers_that_are_not_finite_are_ignored(tmp_path: Path, key: str, word: str) -> None:
    usual = material_of(tmp_path, "")
    with pytest.warns(
        EclatWarning,
        match=rf"test\.mtl, line 2, material 'm': expected finite numbers .* after {key.lower()}, .*; the statement is ignored",
    ) as caught:
        material = material_of(tmp_path, f"{key} {word}\n")
    assert len(caught) == 1
    assert (material.kind, material.opacity.constant) == (usual.kind, (1, 1, 1))
    assert material.emission is None and repr(material.parameters) == repr(usual.parameters)


def test_libraries_are_found_whatever_they_are_called(tmp_path: Path) -> None:
    (tmp_path / "my colours.mtl").write_text("newmtl m\nKd 1 0 0\n")
    (tmp_path / "Other.MTL").write_text("newmtl n\nKd 0 1 0\n")
    path = tmp_path / "test.obj"
    for statement in ("mtllib my colours.mtl\nmtllib other.mtl", "mtllib my colours.mtl other.mtl"):
        path.write_text(f"{statement}\n{PANE}usemtl m\nf 1 2 3\nusemtl N\nf 1 3 2\n")
        assert [mesh.material.parameters["reflectance"].constant for mesh in load_obj(path)] == [(1, 0, 0), (0, 1, 0)]


def test_absurd_numbers_of_libraries_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "test.obj"
    path.write_text(f"mtllib {' '.join(f'{i}' for i in range(5000))}\n{PANE}f 1 2 3\n")
    with pytest.raises(EclatError, match="line 1: expected at most 256 material files, got 5000"):
        load_obj(path)
    path.write_text("".join(f"mtllib {i}.mtl\n" for i in range(5000)) + f"{PANE}f 1 2 3\n")
    with pytest.raises(EclatError, match="expected at most 256 mtllib statements, got 5000"):
        load_obj(path)


def test_a_missing_library_causes_one_warning(tmp_path: Path) -> None:
    path = tmp_path / "test.obj"
    path.write_text(f"mtllib none.mtl\nmtllib none.mtl\n{PANE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n")
    with pytest.warns(EclatWarning, match=r"test\.obj, line 1: the material file 'none\.mtl' is missing") as caught:
        meshes = load_obj(path)
    assert len(caught) == 1
    assert [mesh.material.name for mesh in meshes] == ["a", "b"]


def test_a_missing_material_suggests_the_nearest(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="material 'florr' is not defined in any MTL file; did you mean 'floor'"):
        mesh_of(tmp_path, b"newmtl floor\nKd 1 1 1\n", PANE + "usemtl florr\nf 1 2 3\n")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("map_Kd " + "x" * 5000, "line 2: expected at most 4096 characters"),
    ],
)
def test_errors_say_file_line_material_and_expectation(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(EclatError, match=message):
        material_of(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "Kd a b c\n",
            r"line 2, material 'm': expected finite numbers of at least 0 after kd, got 'a b c'; the statement",
        ),
        ("Kd -1 0 0\n", "got '-1 0 0'"),
        ("Kd\n", "expected finite numbers of at least 0 after kd, got ''"),
        ("Ke 1e300\n", "expected finite numbers"),
        ("d 2\n", r"expected finite numbers in 0\.\.1 after d, got '2'"),
        ("Ks 0.1\nNs inf\n", "after ns, got 'inf'"),
        ("illum -1\n", "expected finite numbers of at least 0 after illum, got '-1'"),
        ("illum x\n", "after illum, got 'x'"),
    ],
)
def test_one_bad_number_does_not_end_the_load(tmp_path: Path, text: str, message: str) -> None:
    with pytest.warns(EclatWarning, match=message) as caught:
        material = material_of(tmp_path, text)
    assert len(caught) == 1
    assert material.opacity.constant == (1, 1, 1) and material.kind in ("diffuse", "phong")


@settings(
    derandomize=True, max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(mutated(RICH))
def test_damaged_files_never_crash(tmp_path: Path, data: bytes) -> None:
    if not (tmp_path / "kd.png").exists():
        image(tmp_path, "kd.png", "RGB", (255, 0, 0), (0, 255, 0))
    survives(lambda: [mesh_of(tmp_path, data)])


@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
def test_real_materials(scenes: Path) -> None:
    found = {mesh.material.name: mesh.material for mesh in load_obj(scenes / "sibenik" / "sibenik.obj")}
    assert found["staklo_zeleno"].kind == "thin_dielectric"
    assert found["staklo"].opacity.constant[0] == 0.1
    assert 0.001 < found["pod"].normal_map.scale < 0.1
    box = load_obj(scenes / "cornell-box-mcguire" / "CornellBox-Water.obj")
    kinds = {mesh.material.name: mesh.material.kind for mesh in box}
    assert (kinds["leftSphere"], kinds["rightSphere"], kinds["water"]) == ("conductor", "dielectric", "dielectric")
    assert sum(mesh.material.emission is not None for mesh in box) == 1


def png(folder: Path, value: int = 128) -> None:
    Image.fromarray(np.full((2, 2, 3), value, np.uint8)).save(folder / "t.png")


def test_maps_behind_black_constants_are_shown(tmp_path: Path) -> None:
    png(tmp_path)
    with pytest.warns(
        EclatWarning,
        match="line 2, material 'm': Kd is 0, and its product with its map would be 0; the map is used alone",
    ):
        material = material_of(tmp_path, "Kd 0 0 0\nillum 1\nmap_Kd t.png\n")
    value = material.parameters["reflectance"]
    assert value.constant == (1, 1, 1) and value.texture is not None
    with pytest.warns(EclatWarning, match="Ke is 0, and its product with its map would be 0"):
        emission = material_of(tmp_path, "Kd 1 1 1\nKe 0 0 0\nmap_Ke t.png\n").emission
    assert emission is not None and emission.constant == (1, 1, 1) and emission.texture is not None
    for statement, name in (("Pr 0\nmap_Pr t.png\n", "roughness"), ("Pm 0\nmap_Pm t.png\n", "metallic")):
        with pytest.warns(EclatWarning, match=f"{statement[:2]} is 0, and its product with its map would be 0"):
            assert material_of(tmp_path, statement).parameters[name].constant == (1, 1, 1)
    with pytest.warns(EclatWarning, match="d is 0, and its product with its map would be 0"):
        assert material_of(tmp_path, "d 0\nmap_d t.png\n").opacity.constant == (1, 1, 1)


def test_a_black_specular_colour_hides_its_map_with_a_warning(tmp_path: Path) -> None:
    png(tmp_path)
    with pytest.warns(EclatWarning, match="map_Ks is ignored, because Ks is black; the material is diffuse"):
        material = material_of(tmp_path, "Kd 0.8 0.8 0.8\nKs 0 0 0\nmap_Ks t.png\n")
    assert material.kind == "diffuse" and material.parameters["reflectance"].constant == (0.8, 0.8, 0.8)
