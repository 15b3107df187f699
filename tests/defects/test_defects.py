# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The defects that irradiance caches are known for, each in a room of its own: the bias of every region is stated.

Pictures and words: docs/defects.md. Bounds are about twice what was measured. Pictures are small, so that a pixel is
2 cm wide and records are read up to 16 cm far: much coarser than in a real picture.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import eclat
from eclat.measure.metrics import relative_rmse
from eclat.scene import Scene
from eclat.scenes.hard_cases import CASES, tessellated
from support.regions import Region, centroids, read, rectangle

SIZE = (112, 84)

scene_of = cache(lambda name: CASES[name]())


@cache
def solved(name: str) -> eclat.Solution:
    """The records of all views of the scene together, so that those of a bright room are there to leak."""
    scene = scene_of(name)
    views = [eclat.solve(scene, size=SIZE, camera=k) for k in range(len(scene.cameras))]
    for other in views[1:]:
        views[0] = eclat.merge(views[0], other)
    return views[0]


def ring(inner: float, outer: float) -> Region:
    """Points of the ceiling of the lampshade's room, on the far half of a ring about the lamp's middle."""
    points = [
        (1.5 + r * np.cos(a), 2.5, 1.5 + r * np.sin(a))
        for r in np.linspace(inner, outer, 3)
        for a in np.linspace(np.pi, 2 * np.pi, 24)
    ]
    return Region(np.array(points), np.tile([0.0, -1, 0], (len(points), 1)))


def floor(x: float, z: float, width: float, depth: float, shape: tuple[int, int]) -> Region:
    return rectangle((x, 0, z), (width, 0, 0), (0, 0, depth), (0, 1, 0), shape)


def back(x: float, y: float, width: float, height: float, shape: tuple[int, int]) -> Region:
    return rectangle((x, y, 0), (width, 0, 0), (0, height, 0), (0, 0, 1), shape)


REGIONS: list[tuple[str, str, Region, float]] = [
    ("thin-wall", "dim floor beside the wall", floor(1.51, 0.3, 0.055, 2.4, (24, 4)), 0.25),
    ("thin-wall", "bright floor beside the wall", floor(1.435, 0.3, 0.055, 2.4, (24, 4)), 0.08),
    ("thin-wall", "dim face", rectangle((1.505, 0.1, 0.3), (0, 1.2, 0), (0, 0, 1.5), (1, 0, 0), (10, 8)), 0.12),
    ("sheet", "dim floor beside the wall", floor(1.505, 0.3, 0.055, 2.4, (24, 4)), 0.25),
    ("sheet", "dim face", rectangle((1.5, 0.1, 0.3), (0, 1.2, 0), (0, 0, 1.5), (1, 0, 0), (10, 8)), 0.12),
    ("gap", "dim floor beside the wall", floor(1.505, 0.3, 0.055, 2.4, (24, 4)), 0.16),
    ("gap", "beside the slit", rectangle((1.5, 0.2, 1.505), (0, 1, 0), (0, 0, 0.06), (1, 0, 0), (4, 16)), 0.06),
    ("gap", "floor before the slit", floor(1.6, 1.2, 0.6, 0.6, (8, 8)), 0.08),
    ("lampshade", "ceiling outside the rim", ring(0.455, 0.5), 0.35),
    ("lampshade", "ceiling behind the lamp", ring(0.3, 0.43), 0.35),
    ("skirting", "floor along the board", floor(0.3, 0.02, 1.3, 0.05, (4, 24)), 0.16),
    ("skirting", "wall above the board", back(0.3, 0.102, 1.3, 0.08, (4, 24)), 0.12),
    ("skirting", "wall under the rail", back(0.3, 0.82, 1.3, 0.078, (4, 24)), 0.27),
    ("sunk", "floor beside the block", floor(0.7, 1.605, 0.55, 0.055, (4, 20)), 0.15),
]


@pytest.mark.parametrize(
    ("name", "where", "region", "bound"), REGIONS, ids=lambda v: v.replace(" ", "-") if isinstance(v, str) else ""
)
def test_the_error_of_each_region_is_no_more_than_stated(name: str, where: str, region: Region, bound: float) -> None:
    found = read(scene_of(name), solved(name), region)
    print(f"{name}, {where}: error {found.error:.3f}, bias {found.bias:.3f}, served {found.served:.2f}")
    assert found.error < bound


def test_no_light_comes_through_a_closed_wall() -> None:
    """The dark of two rooms gets less than a thousandth of the lit one, at any place beside the wall."""
    scene = eclat.load("two-rooms")
    views = [eclat.solve(scene, size=SIZE, camera=k) for k in range(2)]
    both = eclat.merge(*views)
    region = floor(0.006, -1.4, 0.3, 2.8, (24, 6))
    mirrored = Region(region.points * (-1, 1, 1), region.normals)
    dark, lit = (eclat.irradiance(scene, r.points, r.normals, both, component="indirect") for r in (region, mirrored))
    assert dark.max() < 1e-3 * lit.mean()


def test_the_row_of_pixels_behind_the_cornell_lights_edge_is_dark() -> None:
    """Through the gap of a hundredth the camera sees ceiling with a seventieth of the light before the gap: 0.013 beside
    0.21. Records on both sides must keep apart; 0.03 to 0.05 was measured, 0.19 where one side's were not read."""
    scene, size = eclat.load("cornell-box"), (256, 256)
    solution = eclat.solve(scene, size=size, check=False)
    row = eclat.render(scene, solution, samples=32, size=size, crop=(108, 31, 148, 32)).pixels[31, 108:148, 0]
    assert 0.005 < row.mean() < 0.07


def test_the_ceiling_a_hundredth_behind_the_cornell_light_stays_dark() -> None:
    """No camera sees it; points and light maps do. The light's own face, as wide as its records, is next to it."""
    scene = eclat.load("cornell-box")
    for seed in range(2):
        solution = eclat.solve(scene, size=(192, 192), seed=seed)
        region = rectangle((-0.13, 1, -0.06), (0.26, 0, 0), (0, 0, 0.16), (0, -1, 0), (8, 8))  # 12 cm and more inside
        behind = eclat.irradiance(scene, region.points, region.normals, solution, component="indirect")
        assert behind.max() < 0.05  # beside the light it is 0.8


@pytest.mark.parametrize(("mesh", "bound"), [("ball", 0.1), ("vase", 0.06)])
def test_smooth_shaded_coarse_meshes(mesh: str, bound: float) -> None:
    scene = scene_of("coarse-shapes")
    (shape,) = (m for m in scene.meshes if m.name == mesh)
    found = read(scene, solved("coarse-shapes"), centroids(shape, scene.cameras[0].to_world[:3, 3], 100))
    assert found.error < bound and found.served > 0.95


def test_records_do_not_clump_on_finely_tessellated_surfaces() -> None:
    """A surface of four times finer facets is the same surface: about as many records, about the same error."""
    counts = []
    for segments in (48, 192):
        scene = tessellated(segments)
        cache_of = eclat.solve(scene, size=SIZE)
        counts.append(len(cache_of))
        for mesh in scene.meshes[2:]:
            found = read(scene, cache_of, centroids(mesh, scene.cameras[0].to_world[:3, 3], 40), samples=512)
            assert found.error < 0.1, mesh.name
    assert 0.8 < counts[1] / counts[0] < 1.25


@pytest.mark.parametrize(
    ("where", "region"),
    [
        ("back wall", back(0.1, 0.3, 1.4, 1.7, (9, 9))),
        ("left wall", rectangle((0, 0.3, 0.1), (0, 0, 1.4), (0, 1.7, 0), (1, 0, 0), (9, 9))),
    ],
    ids=lambda v: v.replace(" ", "-") if isinstance(v, str) else "",
)
def test_no_splotches_under_a_small_bright_spot(where: str, region: Region) -> None:
    # One ray in five hundred meets the spot: only many tell what is true.
    found = read(scene_of("bright-spot"), solved("bright-spot"), region, samples=8192)
    print(f"{where}: splotches {found.splotches:.4f}, error {found.error:.3f}, bias {found.bias:.3f}")
    assert found.splotches < 0.06 and found.error < 0.12  # measured 0.008 to 0.035 and 0.02 to 0.07, by the seed


def test_points_inside_of_solids_take_no_part() -> None:
    """The floor under a block, seen by a solve for all surfaces: dark in truth, and not read from outside or to it."""
    scene = scene_of("sunk")
    everywhere = eclat.solve(scene, eclat.IrradianceCache(max_error=0.08, rows=8), view_independent=True, check=False)
    inside = floor(0.65, 0.85, 0.5, 0.5, (6, 6))
    counts: dict[str, float] = {}
    dark = eclat.irradiance(scene, inside.points, inside.normals, everywhere, component="indirect", statistics=counts)
    assert counts["served"] == 0 and not dark.any()
    deep = ((everywhere.positions > (0.65, -0.1, 0.85)) & (everywhere.positions < (1.35, 0.1, 1.55))).all(axis=1)
    # Close under the ball, whose front it sees, a point may not know that it is inside; it is as dark all the same.
    assert deep.any() and everywhere.enclosed[deep].mean() > 0.99 and not everywhere.irradiance[deep].any()
    assert 0 < everywhere.enclosed.mean() < 0.5
    assert read(scene, everywhere, floor(0.7, 1.605, 0.55, 0.055, (4, 20))).error < 0.25


def test_leaves_as_small_as_records_are_left_to_paths() -> None:
    """It says so, and makes far fewer records than there are pixels of leaves; a bare room has hardly such a place."""
    size = (160, 120)
    found = eclat.solve(scene_of("foliage"), size=size, check=False)
    assert found.statistics["left_to_paths"] > 500
    leaves = (found.positions[:, 1] > 1.2) & (np.linalg.norm(found.positions[:, [0, 2]], axis=1) < 1.1)
    assert leaves.sum() < found.statistics["left_to_paths"]
    bare = eclat.solve(eclat.load("cornell-box"), size=size, check=False)
    assert bare.statistics["left_to_paths"] < 0.01 * size[0] * size[1]


def test_foliage_keeps_its_brightness() -> None:
    """Where leaves are as small as records, the mean of what they reflect must stay, whatever the cache does there."""
    scene: Scene = scene_of("foliage")
    ours = eclat.render(scene, solved("foliage"), samples=16, size=SIZE)
    a, b = (eclat.render(scene, eclat.Path(), samples=48, size=SIZE, seed=s) for s in (8, 9))
    albedo = a.layers["albedo"]
    leaves = albedo[..., 1] > 1.5 * albedo[..., 0]
    truth = (a.pixels + b.pixels) / 2
    assert 0.05 < leaves.mean() < 0.3
    assert ours.pixels[leaves].mean() == pytest.approx(truth[leaves].mean(), rel=0.03)
    assert relative_rmse(ours.pixels, a.pixels, b.pixels, mask=~leaves) < 0.04
