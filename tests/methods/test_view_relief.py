# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Normal maps and height maps in the page of `eclat view`, beside `eclat render`."""

from __future__ import annotations

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.scene import Camera, DirectionalLight, Material, Mesh, NormalMap, Scene, Texture, Value, grey, look_at, rgb
from support.browser import look_at_page, require_browser, require_node, require_page

SIZE = (48, 48)


@pytest.fixture(autouse=True)
def browser() -> None:
    require_node(), require_browser(), require_page()


def waves(kind: str) -> NormalMap:
    """Waves across a map, higher along one axis than along the other, as heights or as normals of the same slopes."""
    side = 64
    v, u = (np.mgrid[:side, :side] + 0.5) / side
    if kind == "bump":
        heights = 0.5 + 0.3 * np.sin(2 * np.pi * u) + 0.2 * np.cos(2 * np.pi * (u + v))
        return NormalMap(Value((1, 1, 1), Texture(heights[..., None].astype(np.float32), srgb=False)), "bump", 0.1)
    tilts = np.stack([0.3 * np.cos(2 * np.pi * u), 0.2 * np.sin(2 * np.pi * (u + v)), np.ones_like(u)], axis=-1)
    texels = 0.5 + 0.5 * tilts / np.linalg.norm(tilts, axis=-1, keepdims=True)
    return NormalMap(Value((1, 1, 1), Texture(np.rint(255 * texels).astype(np.uint8), srgb=False)), "normal", 0.8)


def wavy_floor(kind: str, tangents: bool, back: bool) -> Scene:
    """A floor with waves under a sun and two lamps of different colours, seen from its front or from its back."""
    corners = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], float)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    floor = Material("diffuse", {"reflectance": grey(0.6)}, "floor", normal_map=waves(kind), two_sided=True)
    uvs = np.array([[0, 1.6], [1.9, 1.3], [2, 0], [0, 0]])
    along = np.tile(np.array([0.6, 0, 0.8, -1.0]), (4, 1)) if tangents else None
    below = -1 if back else 1
    floor_mesh = Mesh(corners, triangles, floor, uvs=uvs, tangents=along, name="floor")
    lamps = []
    for x, radiance in ((-3.0, (8, 2, 1)), (3.0, (1, 2, 8))):
        glow = Material("diffuse", {"reflectance": grey(0)}, "lamp", emission=rgb(*radiance), emission_two_sided=True)
        square = [[x - 0.4, 3 * below, -1], [x + 0.4, 3 * below, -1], [x + 0.4, 3 * below, 1], [x - 0.4, 3 * below, 1]]
        lamps.append(Mesh(np.array(square, float), triangles, glow, name="lamp"))
    sun = DirectionalLight((0.3, -below, 0.5), (0.4, 0.5, 0.3))
    camera = Camera(look_at((0.3, 4 * below, 0.4), (0, 0, 0), up=(0, 0, 1)), fov=22, size=SIZE)
    return Scene((floor_mesh, *lamps), (sun,), cameras=(camera,))


@pytest.mark.parametrize(
    ("kind", "tangents", "back"),
    [
        ("bump", False, True),
        pytest.param("normal", False, False, marks=pytest.mark.full),
        pytest.param("normal", True, True, marks=pytest.mark.full),
    ],
)
def test_relief_is_that_of_render(kind: str, tangents: bool, back: bool) -> None:
    scene = wavy_floor(kind, tangents, back)
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.3), size=SIZE, check=False)
    asked = {"camera": 0, "width": 4 * SIZE[0], "height": 4 * SIZE[1]}
    with eclat.view(scene, solution, texel_size=0.1, samples=256) as viewer:
        page = look_at_page(viewer.url, [asked])
    assert page.message == "" and page.messages == []
    shown = page.pictures[0].reshape(SIZE[1], 4, SIZE[0], 4, 3).mean(axis=(1, 3))
    a, b = (eclat.render(scene, solution, samples=64, seed=seed) for seed in (1, 2))
    # Without the map the floor would be off by far more.
    assert a.pixels[:, :, 0].std() > 0.1 * a.pixels[:, :, 0].mean()
    error = relative_rmse(shown, a.pixels, b.pixels)
    assert error < 0.01, f"{error:.4f}"
