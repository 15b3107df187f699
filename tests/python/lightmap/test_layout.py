# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Layouts: texels of other sizes for some meshes, and maps of several pages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.errors import EclatError
from eclat.lightmap.atlas import TYPICAL_TEXELS, Packing, default_texel_size
from eclat.lightmap.flat import encode_flat
from eclat.lightmap.layout import Wishes, lay_out
from eclat.scene import Environment, Material, Mesh, Scene, grey
from eclat.stage.staging import staged
from eclat.viewer.lamps import parts_of
from support.light_maps import read_at_random


def texels_per_metre(part: eclat.gltf_export.Part, shape: tuple[int, ...]) -> np.ndarray:
    """The density along the edges of each triangle that has texels."""
    triangles = np.asarray(part.mesh.triangles)
    uvs = (part.lightmap_uvs * [shape[1], shape[0]])[triangles]
    corners = np.asarray(part.mesh.positions)[triangles]
    a, b = (np.linalg.norm(np.roll(x, -1, axis=1) - x, axis=2) for x in (uvs, corners))
    return (a / b)[a.max(axis=1) > 0].ravel()


def test_meshes_have_the_texels_that_were_asked_for() -> None:
    scene = staged(eclat.load("cornell-box"))
    names = [mesh.name for mesh in scene.meshes]
    assert "floor" in names and any("box" in name for name in names)
    wishes = Wishes(0.1, {"floor": 0.02, "*box*": 0.04})
    layout = lay_out(scene, wishes, 1, None)
    wanted = {name: 0.02 if name == "floor" else 0.04 if "box" in name else 0.1 for name in names}
    for part in layout.parts():
        # xatlas stretches charts to whole texels, at most by one.
        density = texels_per_metre(part, layout.page_shape)
        assert np.median(density) == pytest.approx(1 / wanted[part.mesh.name], rel=0.12), part.mesh.name
    alone = lay_out(scene, Wishes(0.1), 1, None)
    assert len(layout.texels) > 3 * len(alone.texels)


def test_patterns_that_match_nothing_are_told() -> None:
    with pytest.raises(EclatError, match=r"no mesh has a name that matches 'flor'; did you mean 'floor'\?"):
        eclat.bake("cornell-box", texel_size=0.1, texel_sizes={"flor": 0.1})
    with pytest.raises(EclatError, match="above 0 for 'floor'"):
        eclat.bake("cornell-box", texel_size=0.1, texel_sizes={"floor": 0.0})


def test_a_map_of_several_pages_shows_the_light_of_one(tmp_path: Path) -> None:
    options = {"texel_size": 0.1, "samples": 64, "max_error": 0.05}
    one = eclat.bake("cornell-box", **options)
    many = eclat.bake("cornell-box", max_size=48, **options)
    assert one.page_count == 1 < many.page_count == len(many.pages)
    assert max(many.pages[0].shape) <= 48
    assert many.statistics["texels"] == pytest.approx(one.statistics["texels"], rel=0.1)
    a, b = (np.sort(read_at_random(m, 30000).irradiance.mean(axis=1)) for m in (one, many))
    np.testing.assert_allclose(b.mean(), a.mean(), rtol=0.02)
    np.testing.assert_allclose(np.quantile(b, [0.1, 0.5, 0.9]), np.quantile(a, [0.1, 0.5, 0.9]), rtol=0.04)
    files = many.save(tmp_path / "a.glb", ktx2=True)
    names = {file.name for file in files}
    assert {"a.lightmap.exr", "a.lightmap.2.exr", "a.lightmap.ktx2", "a.lightmap.2.ktx2"} <= names
    assert len(eclat.load(tmp_path / "a.glb").meshes) >= len(one.parts) - 2
    # The viewer reads one image of all pages, and unlit files have a texture for each page.
    for part, seen in zip(many.parts, parts_of(many.scene, many), strict=True):
        assert part.lightmap_uvs is not None and seen.lightmap_uvs is not None
        assert (np.floor(seen.lightmap_uvs[:, 1] * many.page_count) == part.lightmap_page).all()
    assert encode_flat(many, None, "none", "test").count(b"\x89PNG") == many.page_count


def test_the_default_size_counts_the_borders_of_charts() -> None:
    """Many small pieces have more texels at their borders than in their areas: the size is that of about 260,000 texels."""
    rng = np.random.default_rng(0)
    places = rng.uniform(-20, 20, (6000, 1, 3))
    corners = (places + rng.uniform(0, 0.4, (6000, 3, 3))).reshape(-1, 3)
    leaves = Mesh(
        corners, np.arange(18000).reshape(-1, 3), Material("diffuse", {"reflectance": grey(0.5)}, two_sided=False)
    )
    scene = staged(Scene((leaves,), environment=Environment(np.ones((1, 1, 3), np.float32))))
    found = lay_out(scene, Wishes(packing=Packing(timeout=0)), 1, None)
    plain = default_texel_size(found.area)
    at_plain = lay_out(scene, Wishes(plain, packing=Packing(timeout=0)), 1, None)
    assert len(at_plain.texels) > 1.5 * TYPICAL_TEXELS
    assert 0.7 * TYPICAL_TEXELS < len(found.texels) <= 1.25 * TYPICAL_TEXELS
