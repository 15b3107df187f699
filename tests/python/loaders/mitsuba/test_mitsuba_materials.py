# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Bsdfs and textures of Mitsuba scenes to materials."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.mitsuba import load_dict, load_xml
from eclat.loaders.mitsuba.optics import CONDUCTORS, IOR
from eclat.scene import MATERIAL_KINDS, Material, Value

GREEN = {"type": "rgb", "value": [0.1, 0.6, 0.2]}
DIFFUSE = {"type": "diffuse", "reflectance": GREEN}


def material(bsdf: dict[str, Any], folder: Path | None = None) -> Material:
    scene = load_dict({"type": "scene", "shape": {"type": "rectangle", "bsdf": bsdf}}, folder)
    return scene.meshes[0].material


def from_xml(tmp_path: Path, bsdf: str, version: str = "0.6.0") -> Material:
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="{version}"><shape type="rectangle">{bsdf}</shape></scene>')
    return load_xml(path).meshes[0].material


def texel(value: Value, u: float, v: float) -> np.ndarray:
    """Nearest texel of a texture that repeats."""
    assert value.texture is not None
    x, y = np.array(value.uv_transform) @ (u, v, 1)
    height, width = value.texture.image.shape[:2]
    return value.texture.image[int(np.floor(y * height)) % height, int(np.floor(x * width)) % width]


@pytest.fixture
def image(tmp_path: Path) -> Path:
    pixels = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "image.png")
    return tmp_path


@pytest.mark.parametrize(
    ("bsdf", "kind"),
    [
        ({"type": "diffuse"}, "diffuse"),
        ({"type": "conductor"}, "conductor"),
        ({"type": "roughconductor"}, "conductor"),
        ({"type": "dielectric"}, "dielectric"),
        ({"type": "roughdielectric"}, "dielectric"),
        ({"type": "thindielectric"}, "thin_dielectric"),
        ({"type": "plastic"}, "plastic"),
        ({"type": "roughplastic", "nonlinear": True}, "plastic"),
        ({"type": "phong"}, "phong"),
        ({"type": "ward"}, "ward"),
        ({"type": "principled"}, "metallic_roughness"),
        ({"type": "principledthin"}, "metallic_roughness"),
        ({"type": "mask", "nested": DIFFUSE}, "diffuse"),
        ({"type": "blendbsdf", "weight": 0.3, "a": DIFFUSE, "b": {"type": "conductor"}}, "blend"),
        ({"type": "null"}, "diffuse"),
    ],
)
def test_every_bsdf_becomes_a_kind_with_its_parameters_without_a_word(bsdf: dict[str, Any], kind: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        made = material(bsdf)
    assert made.kind == kind
    assert set(made.parameters) <= set(MATERIAL_KINDS[kind])


def test_reflectors_are_one_sided_unless_wrapped() -> None:
    for kind in ("diffuse", "conductor", "roughconductor", "plastic", "roughplastic", "phong", "ward", "principled"):
        assert not material({"type": kind}).two_sided
        assert material({"type": "twosided", "nested": {"type": kind}}).two_sided
    assert material({"type": "dielectric"}).two_sided
    both = material({"type": "twosided", "front": DIFFUSE, "behind": {"type": "conductor"}})
    assert both.back is not None and both.back.kind == "conductor" and both.kind == "diffuse"


def test_metals_by_name_have_mitsubas_numbers() -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    for name in ("Al", "Ag", "Au", "Cu", "Cr", "W", "Ni_palik", "TiN"):
        ours = material({"type": "roughconductor", "material": name, "alpha": 0.2})
        theirs = mi.traverse(mi.load_dict({"type": "roughconductor", "material": name}))
        assert np.allclose(ours.parameters["eta"].constant, theirs["eta.value"], rtol=1e-3)
        assert np.allclose(ours.parameters["k"].constant, theirs["k.value"], rtol=1e-3)
    mirror = material({"type": "conductor"})
    assert mirror.parameters["eta"].constant == (0, 0, 0) and mirror.parameters["k"].constant == (1, 1, 1)
    with pytest.warns(EclatWarning, match="'Xy' is unknown.*Al"):
        assert material({"type": "conductor", "material": "Xy"}).parameters["eta"].constant == CONDUCTORS["Al"][0]


def test_metals_take_eta_and_k_and_their_outside() -> None:
    made = material({"type": "conductor", "eta": {"type": "rgb", "value": [1, 2, 3]}, "k": 3.0, "ext_eta": 2.0})
    assert made.parameters["eta"].constant == (0.5, 1, 1.5)
    assert made.parameters["k"].constant == (1.5, 1.5, 1.5)
    with pytest.raises(EclatError, match="eta: expected a colour"):
        material({"type": "conductor", "eta": {"type": "checkerboard"}})


def test_named_media_give_the_ratio_of_their_refractive_indices() -> None:
    made = material({"type": "dielectric", "int_ior": "diamond", "ext_ior": "water"})
    assert made.parameters["ior"].constant[0] == pytest.approx(IOR["diamond"] / IOR["water"])
    assert material({"type": "dielectric"}).parameters["ior"].constant[0] == pytest.approx(1.50418, abs=1e-5)
    assert material({"type": "plastic"}).parameters["ior"].constant[0] == pytest.approx(1.48959, abs=1e-5)
    with pytest.raises(EclatError, match="'diamnd'; did you mean 'diamond'"):
        material({"type": "dielectric", "int_ior": "diamnd"})
    with pytest.raises(EclatError, match="int_ior: expected a number above 0, got -1"):
        material({"type": "dielectric", "int_ior": -1.0})


def test_roughness_and_distribution() -> None:
    default = material({"type": "roughconductor"})
    assert default.distribution == "beckmann" and default.parameters["alpha_u"].constant[0] == 0.1
    assert "alpha_v" not in default.parameters
    stretched = material({"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.3})
    assert stretched.distribution == "ggx"
    assert stretched.parameters["alpha_v"].constant[0] == 0.3
    with pytest.warns(EclatWarning, match="expected ggx or beckmann, got 'phong'"):
        material({"type": "roughconductor", "distribution": "phong"})


def test_principled_maps_to_metallic_roughness() -> None:
    made = material({"type": "principled", "base_color": GREEN, "roughness": 0.3, "metallic": 0.7, "specular": 0.5})
    assert made.parameters["roughness"].constant[0] == 0.3 and made.parameters["roughness"].square
    assert made.parameters["ior"].constant[0] == pytest.approx(1.5)
    assert made.parameters["metallic"].constant[0] == 0.7
    glass = material({"type": "principled", "spec_trans": 1.0, "eta": 1.33})
    assert glass.two_sided and not glass.thin_walled
    with pytest.warns(
        EclatWarning, match="properties of principled are not supported and are ignored: sheen, clearcoat$"
    ):
        material({"type": "principled", "clearcoat": 0.5, "sheen": 0.2})


def test_phong_and_ward_do_not_reflect_more_than_arrives() -> None:
    with pytest.warns(EclatWarning, match="at most 1, got 1.6; both are divided"):
        made = material({"type": "phong", "diffuse_reflectance": 0.8, "specular_reflectance": 0.8})
    assert made.parameters["diffuse_reflectance"].constant == pytest.approx((0.5,) * 3)
    board = {"type": "checkerboard", "color0": 0.9, "color1": 0.1}
    with pytest.warns(EclatWarning, match="at most 1, got 1.5"):
        made = material({"type": "ward", "diffuse_reflectance": board, "specular_reflectance": 0.6})
    assert made.parameters["diffuse_reflectance"].constant == pytest.approx((1 / 1.5,) * 3)
    assert material({"type": "ward", "variant": "ward-duer"}).ward_variant == "duer"
    with pytest.warns(EclatWarning, match=r"expected reflectances of at most 1, got .*; clipped to 1"):
        assert material({"type": "diffuse", "reflectance": 1.5}).parameters["reflectance"].constant == (1, 1, 1)


def test_masks_and_null_set_the_opacity(image: Path) -> None:
    assert material({"type": "mask", "opacity": 0.25, "nested": DIFFUSE}).opacity.constant[0] == 0.25
    assert material({"type": "null"}).opacity.constant[0] == 0
    inner = {"type": "mask", "opacity": 0.5, "nested": DIFFUSE}
    assert material({"type": "mask", "opacity": 0.5, "nested": inner}).opacity.constant[0] == 0.25
    bitmap = {"type": "bitmap", "filename": "image.png", "raw": True}
    opacity = material({"type": "mask", "opacity": bitmap, "nested": DIFFUSE}, image).opacity
    assert opacity.channel == 0 and opacity.texture is not None
    assert texel(opacity, 0.75, 0.25)[0] == pytest.approx(0.71516, abs=1e-4)  # green's luminance


def test_bumps_and_normal_maps(image: Path) -> None:
    bitmap = {"type": "bitmap", "filename": "image.png", "raw": True}
    bump = material({"type": "bumpmap", "scale": 2.0, "arbitrary": bitmap, "nested": DIFFUSE}, image).normal_map
    assert bump is not None and bump.kind == "bump" and bump.scale == 2
    scene = load_dict(
        {
            "type": "scene",
            "shape": {"type": "cube", "bsdf": {"type": "normalmap", "normalmap": bitmap, "nested": DIFFUSE}},
        },
        image,
    )
    (mesh,) = scene.meshes
    assert mesh.material.normal_map is not None and mesh.material.normal_map.kind == "normal"
    assert mesh.tangents is not None and mesh.tangents.shape == (24, 4)
    texture = mesh.material.normal_map.value.texture
    assert texture is not None and not texture.srgb
    with pytest.warns(EclatWarning, match="normal map is read as linear data"):
        material({"type": "normalmap", "normalmap": bitmap | {"raw": False}, "nested": DIFFUSE}, image)


def test_old_scaled_bumps(tmp_path: Path, image: Path) -> None:
    bsdf = (
        '<bsdf type="bump"><texture type="scale"><float name="scale" value="3"/><texture type="bitmap">'
        '<string name="filename" value="image.png"/><float name="uvscale" value="2"/><float name="uoffset" value=".5"/>'
        '</texture></texture><bsdf type="diffuse"/></bsdf>'
    )
    normals = from_xml(tmp_path, bsdf).normal_map
    assert normals is not None and normals.scale == 3 and normals.value.constant == (1, 1, 1)
    assert normals.value.uv_transform == ((2, 0, 0.5), (0, 2, 0))


def test_bitmaps_have_the_orientation_of_mitsuba(image: Path) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    to_uv = mi.ScalarTransform4f().translate([0.1, 0.3, 0]).rotate([0, 0, 1], 30).scale([2, 3, 1])
    bitmap = {"type": "bitmap", "filename": str(image / "image.png"), "filter_type": "nearest", "to_uv": to_uv}
    theirs = mi.load_dict(bitmap)
    value = material({"type": "diffuse", "reflectance": bitmap}).parameters["reflectance"]
    assert value.texture is not None and value.texture.filter == "nearest" and value.texture.srgb
    for u, v in np.random.default_rng(5).random((40, 2)):
        interaction = mi.SurfaceInteraction3f()
        interaction.uv = [u, v]
        assert np.allclose(texel(value, u, v) / 255, theirs.eval(interaction), atol=1e-5)


def test_checkerboards_have_the_orientation_of_mitsuba() -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    board = {"type": "checkerboard", "color0": GREEN, "color1": 0.7, "to_uv": mi.ScalarTransform4f().scale([3, 5, 1])}
    theirs = mi.load_dict(board)
    value = material({"type": "diffuse", "reflectance": board}).parameters["reflectance"]
    for u, v in np.random.default_rng(6).random((40, 2)):
        interaction = mi.SurfaceInteraction3f()
        interaction.uv = [u, v]
        assert np.allclose(texel(value, u, v), theirs.eval(interaction), atol=1e-5)


def test_gamma_wrap_and_images_in_memory(tmp_path: Path, image: Path) -> None:
    def bitmap(extra: str) -> Value:
        inner = (
            f'<texture name="reflectance" type="bitmap"><string name="filename" value="image.png"/>{extra}</texture>'
        )
        return from_xml(tmp_path, f'<bsdf type="diffuse">{inner}</bsdf>').parameters["reflectance"]

    linear = bitmap('<float name="gamma" value="1"/><string name="wrapMode" value="mirror"/>').texture
    assert linear is not None and not linear.srgb and (linear.wrap_u, linear.wrap_v) == ("mirror", "mirror")
    powered = bitmap('<float name="gamma" value="2"/>').texture
    assert powered is not None and not powered.srgb and powered.image.dtype == np.float32
    with pytest.warns(EclatWarning, match="wrap_mode: expected repeat, mirror or clamp, got 'zero'"):
        bitmap('<string name="wrapModeU" value="zero"/>')
    data = np.zeros((3, 5, 3), dtype=np.float32)
    memory = material({"type": "diffuse", "reflectance": {"type": "bitmap", "data": data}}).parameters["reflectance"]
    assert memory.texture is not None and memory.texture.image.shape == (3, 5, 3) and not memory.texture.srgb


def test_a_missing_texture_is_named_and_something_visible_stands_in() -> None:
    with pytest.warns(EclatWarning, match=r"dict\['shape'\]\['bsdf'\]\['reflectance'\].*no\.png.*is used instead"):
        made = material({"type": "diffuse", "reflectance": {"type": "bitmap", "filename": "no.png"}})
    assert made.parameters["reflectance"].texture is not None


def test_vertex_colors_multiply_white() -> None:
    made = material({"type": "diffuse", "reflectance": {"type": "mesh_attribute", "name": "vertex_color"}})
    assert made.vertex_colors and made.parameters["reflectance"].constant == (1, 1, 1)


@pytest.mark.parametrize(
    ("bsdf", "kind", "message"),
    [
        (
            {"type": "coating", "int_ior": 1.7, "nested": DIFFUSE},
            "plastic",
            "coating over a diffuse BSDF is replaced by plastic",
        ),
        ({"type": "roughcoating", "alpha": 0.2, "nested": DIFFUSE}, "plastic", "roughcoating over a diffuse BSDF"),
        (
            {"type": "coating", "nested": {"type": "conductor"}},
            "conductor",
            "got conductor, which is used without the coating",
        ),
        ({"type": "roughdiffuse", "alpha": 0.2, "reflectance": GREEN}, "diffuse", "roughness of roughdiffuse"),
        ({"type": "hk"}, "diffuse", "hk"),
        ({"type": "polarizer", "nested": DIFFUSE}, "diffuse", "its first nested BSDF is used instead"),
    ],
)
def test_bsdfs_that_we_do_not_have_become_the_nearest(bsdf: dict[str, Any], kind: str, message: str) -> None:
    with pytest.warns(EclatWarning, match=message):
        made = material(bsdf)
    assert made.kind == kind


def test_a_misspelt_bsdf_of_a_file_is_replaced_and_of_a_dict_refused(tmp_path: Path) -> None:
    with pytest.warns(EclatWarning, match="did you mean 'diffuse'"):
        assert from_xml(tmp_path, '<bsdf type="difuse"/>').kind == "diffuse"
    with pytest.raises(EclatError, match="did you mean 'diffuse'"):
        material({"type": "difuse", "reflectance": GREEN})


def test_mixtures_are_blends_of_blends(tmp_path: Path) -> None:
    inner = '<bsdf type="diffuse"/><bsdf type="conductor"/><bsdf type="plastic"/>'
    made = from_xml(tmp_path, f'<bsdf type="mixturebsdf"><string name="weights" value="0.2, 0.3, 0.1"/>{inner}</bsdf>')
    shares, rest = [], 1.0
    while made.kind == "blend":
        weight = made.parameters["weight"].constant[0]
        shares.append(rest * (1 - weight))
        rest *= weight
        made = made.children[1]
    assert shares == pytest.approx([0.2, 0.3, 0.1]) and rest == pytest.approx(0.4)
    assert made.parameters["reflectance"].constant == (0, 0, 0)


def test_what_a_blend_cannot_keep_of_its_parts_is_named() -> None:
    board = {"type": "checkerboard"}
    bumpy = {"type": "bumpmap", "height": board, "bsdf": DIFFUSE}
    with pytest.warns(EclatWarning, match="normal maps of only one part of a blendbsdf are not supported"):
        assert material({"type": "blendbsdf", "a": DIFFUSE, "b": bumpy}).normal_map is not None
    mask = {"type": "mask", "opacity": 0.5, "bsdf": DIFFUSE}
    with pytest.warns(EclatWarning, match="a mask inside a blendbsdf is not supported beside a texture"):
        blend = material({"type": "blendbsdf", "weight": board, "a": mask, "b": DIFFUSE})
    assert blend.opacity.constant == (1, 1, 1)
    lamp = {"type": "area", "radiance": {"type": "rgb", "value": 1.0}}
    textured = {"type": "rectangle", "bsdf": {"type": "mask", "opacity": board, "bsdf": DIFFUSE}, "emitter": lamp}
    with pytest.warns(EclatWarning, match="shines only where its mask is opaque"):
        load_dict({"type": "scene", "lamp": textured})


@pytest.mark.parametrize(
    ("bsdf", "message"),
    [
        ({"type": "twosided"}, "expected one or two nested BSDFs, got 0"),
        ({"type": "mask"}, "expected one nested BSDF, got none"),
        ({"type": "bumpmap", "nested": DIFFUSE}, "expected a nested texture, got none"),
        ({"type": "blendbsdf", "a": DIFFUSE}, "expected two nested BSDFs, got 1"),
        ({"type": "mixturebsdf", "weights": "1 2", "a": DIFFUSE}, "the same number of non-negative weights, got 1"),
        ({"type": "diffuse", "reflectance": -0.5}, "reflectance: expected non-negative numbers"),
        (
            {"type": "diffuse", "reflectance": {"type": "bitmap"}},
            "expected the property 'filename' with the name of a file, got none",
        ),
        ({"type": "roughconductor", "alpha": "rough"}, "alpha: expected a number, got 'rough'"),
    ],
)
def test_bsdfs_that_cannot_be_are_refused_with_their_place(bsdf: dict[str, Any], message: str) -> None:
    with pytest.raises(EclatError, match=r"dict\['shape'\]\['bsdf'\].*" + re.escape(message)):
        material(bsdf)


def test_stray_properties_are_named_once(tmp_path: Path) -> None:
    bsdf = '<bsdf type="diffuse"><float name="shininess" value="3"/></bsdf>'
    with pytest.warns(EclatWarning, match=r"scene\.xml:1 .*'shininess' of the bsdf type 'diffuse' is not used"):
        from_xml(tmp_path, bsdf)


def test_bsdfs_named_after_materials_replace_those_of_an_obj(tmp_path: Path) -> None:
    (tmp_path / "m.mtl").write_text("newmtl pod\nKd 1 0 0\nnewmtl zid\nKd 0 1 0\n")
    faces = "usemtl pod\nf 1 2 3\nusemtl zid\nf 1 3 2\n"
    (tmp_path / "m.obj").write_text(f"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}")

    def kinds(bsdfs: dict[str, Any]) -> list[tuple[str, tuple[float, float, float]]]:
        scene = load_dict({"type": "scene", "s": {"type": "obj", "filename": "m.obj", **bsdfs}}, tmp_path)
        parameters = [mesh.material.parameters for mesh in scene.meshes]
        colors = [p.get("reflectance") or p.get("diffuse_reflectance") for p in parameters]
        return [(m.material.kind, c.constant) for m, c in zip(scene.meshes, colors, strict=True) if c is not None]

    red, green = (1, 0, 0), (0, 1, 0)
    assert [color for _, color in kinds({})] == [red, green]
    assert kinds({"pod": {"type": "plastic"}})[0] == ("plastic", (0.5, 0.5, 0.5))
    assert kinds({"pod": {"type": "plastic"}})[1][1] == green
    assert kinds({"bsdf": {"type": "plastic"}}) == [("plastic", (0.5, 0.5, 0.5))]
    both = kinds({"bsdf": DIFFUSE, "zid": {"type": "plastic"}})
    assert both == [("diffuse", (0.1, 0.6, 0.2)), ("plastic", (0.5, 0.5, 0.5))]
    with pytest.warns(EclatWarning, match="no material called 'podd'; did you mean 'pod'.*whole shape"):
        assert kinds({"podd": {"type": "plastic"}}) == [("plastic", (0.5, 0.5, 0.5))]
    with pytest.warns(EclatWarning, match="the BSDF 'other' is ignored"):
        assert kinds({"pod": {"type": "plastic"}, "other": DIFFUSE})[0][0] == "plastic"


def test_difftrans_lets_light_through() -> None:
    bsdf = {"type": "difftrans", "transmittance": {"type": "rgb", "value": [0.4, 0.3, 0.2]}}
    sheet = {"type": "rectangle", "bsdf": bsdf}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        material = load_dict({"type": "scene", "sheet": sheet}).meshes[0].material
    assert material.kind == "translucent"
    assert material.parameters["transmittance"].constant == pytest.approx((0.4, 0.3, 0.2))
    assert max(material.parameters["reflectance"].constant) == 0
