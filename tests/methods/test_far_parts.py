# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What lies far away changes no light here: a part astray, coordinates of a country, a ground a hundred times as wide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import Camera, Environment, Material, Mesh, PointLight, Scene, grey, look_at

METHODS: dict[str, Method] = {
    "direct": eclat.Direct(),
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(),
    "radiance-cache": eclat.RadianceCache(),
    "photon-map": eclat.PhotonMap(photons=50_000),
    "radiosity": eclat.Radiosity(patches=2000),
}
QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
UTM = np.array([500_000.25, 4_649_776.5, 120.0])


def quad(corner: np.ndarray, u: tuple[float, ...], v: tuple[float, ...], material: Material) -> Mesh:
    a, b = np.array(u, float), np.array(v, float)
    return Mesh(np.array([corner, corner + a, corner + a + b, corner + b]), QUAD, material)


def room(at: np.ndarray, *far: Mesh) -> Scene:
    """4 m × 3 m × 5 m of white, a lamp of a square metre in one wall, seen from within."""
    white = Material("diffuse", {"reflectance": grey(0.7)})
    lamp = Material("diffuse", {"reflectance": grey(0.0)}, emission=grey(10.0))
    x, y, z = (4.0, 0, 0), (0, 3.0, 0), (0, 0, 5.0)
    walls = [
        quad(corner, u, v, white)
        for corner, u, v in [
            (at, x, y), (at + z, x, y), (at, x, z), (at + y, x, z), (at, y, z), (at + x, y, z),
        ]
    ]  # fmt: skip
    walls.append(quad(np.add(at, (1.5, 2.99, 2)), (1.0, 0, 0), (0, 0, 1.0), lamp))
    eye = look_at(tuple(np.add(at, (2, 0.1, 2.5))), tuple(np.add(at, (2.5, 3, 2.0))), (0, 0, 1))
    return Scene(meshes=(*walls, *far), cameras=(Camera(eye, fov=80),), up=(0, 0, 1))


def stray(at: tuple[float, float, float] = (0, 0, 0)) -> Mesh:
    return Mesh(np.array(at) + np.eye(3), QUAD[:1], Material(), name="stray")


def mean(scene: Scene, method: str) -> float:
    return float(eclat.render(scene, METHODS[method], size=(24, 24), samples=64, seed=3).pixels.mean())


@pytest.mark.filterwarnings("ignore:.*lie so far from most of the scene")
@pytest.mark.parametrize("method", METHODS)
def test_a_room_in_a_countrys_coordinates_with_a_stray_triangle_at_their_origin(method: str) -> None:
    """It was 0.017 of 0.240: nothing was shifted, so that coordinates rounded to half a metre."""
    here, there = room(np.zeros(3)), room(UTM, stray())
    assert mean(there, method) == pytest.approx(mean(here, method), rel=0.02)


@pytest.mark.parametrize("method", ["irradiance-cache", "radiance-cache"])
@pytest.mark.parametrize("far", ["ground", "another room", "stray"])
def test_the_spacing_of_records_does_not_depend_on_distant_parts(method: str, far: str) -> None:
    """Far records had a least radius of a hundredth of the scene's, which reached through walls of this room."""
    dark = Material("diffuse", {"reflectance": grey(0.2)})
    others: dict[str, tuple[Mesh, ...]] = {
        "ground": (quad(np.array([-500.0, -500, -0.5]), (1000.0, 0, 0), (0, 1000.0, 0), dark),),
        "another room": room(np.array([1000.0, 0, 0])).meshes,
        "stray": (stray((0, 0, 5000.0)),),
    }
    assert mean(room(np.zeros(3), *others[far]), method) == pytest.approx(mean(room(np.zeros(3)), method), rel=0.01)


@pytest.mark.filterwarnings("ignore:.*lie so far from most of the scene")
@pytest.mark.parametrize("distance", [50.0, 5000.0])
def test_patches_are_linked_as_finely_beside_stray_parts(distance: float) -> None:
    """Clusters that hold a stray part were thought to be as far away as their centres: 0.17 of the light got lost."""

    def on_the_floor(scene: Scene) -> np.ndarray:
        solution = eclat.solve(scene, eclat.Radiosity(patches=1000))
        floor = (np.abs(solution.corners[..., 2]).max(axis=1) < 1e-3) & (solution.triangles < 12) & ~solution.is_back
        mean: np.ndarray = np.average(solution.irradiance[floor], axis=0, weights=solution.areas[floor])
        return mean

    beside = room(np.zeros(3), stray((0, 0, distance)), stray((distance, 0, 0)))
    assert on_the_floor(beside) == pytest.approx(on_the_floor(room(np.zeros(3))), rel=0.01)


@pytest.mark.filterwarnings("ignore:.*lie so far from most of the scene")
def test_patches_of_a_stray_part_are_no_smaller_than_its_rounding() -> None:
    """Halves of its rounded corners had no area, over which light was divided: no patch of the scene had any, silently."""
    far = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), QUAD[:1], Material(), name="stray")
    method = eclat.Radiosity(patches=6000)
    alone, beside = (eclat.solve(scene, method, check=False) for scene in (room(np.zeros(3)), room(UTM, far)))
    assert beside.areas.min() > 0
    light = [np.average(s.irradiance[s.triangles < 12, 0], weights=s.areas[s.triangles < 12]) for s in (alone, beside)]
    assert light[1] == pytest.approx(light[0], rel=0.02)


@pytest.mark.parametrize("gather", [0, 4])
@pytest.mark.parametrize("far", ["ground", "large stray part"])
def test_patches_here_are_as_fine_beside_large_parts(far: str, gather: int) -> None:
    """A ground of a square kilometre took nearly all patches, and pixels differed by 8 %. Its patches lie mostly below the
    horizon of the walls; if no pair of points faced each other, nothing was taken to be between them: 3.4 % of the light
    straight from patches got lost, and 1.3 % with a gather."""
    dark = Material("diffuse", {"reflectance": grey(0.2)})
    corners = np.array([[-1000.0, -1000, -800], [1000, -1000, -800], [0, 1000, -800]])
    others = {
        "ground": quad(np.array([-500.0, -500, -0.5]), (1000.0, 0, 0), (0, 1000.0, 0), dark),
        "large stray part": Mesh(corners, QUAD[:1], Material(), name="stray"),
    }
    method = eclat.Radiosity(patches=2000, gather=gather)
    beside, alone = (
        eclat.render(room(np.zeros(3), *parts), method, size=(24, 24), samples=64, seed=3).pixels
        for parts in ((others[far],), ())
    )
    assert beside.mean() == pytest.approx(alone.mean(), rel=0.006)
    assert np.abs(beside - alone).max() < (0.04 if gather else 0.15) * alone.mean()


@pytest.mark.filterwarnings("ignore:.*lie so far from most of the scene")
def test_irradiance_at_points_beside_a_stray_part() -> None:
    points, normals = np.array([[2.0, 1.5, 0], [0.5, 0.5, 0]]), np.array([[0, 0, 1.0], [0, 0, 1]])
    for method in (eclat.Path(), eclat.IrradianceCache()):
        here, there = (
            eclat.irradiance(scene, points + shift, normals, method, samples=256)
            for scene, shift in ((room(np.zeros(3)), 0), (room(UTM, stray()), UTM))
        )
        np.testing.assert_allclose(there, here, rtol=0.03)


def test_solving_everywhere_needs_no_more_records_for_a_ground_far_below() -> None:
    """Without a camera a thousandth of the scene's diameter stood for a pixel."""
    scene = room(np.zeros(3))
    far = replace(scene, meshes=(*scene.meshes, stray((0, 0, -5000.0))))
    here, there = (eclat.solve(s, eclat.IrradianceCache(), view_independent=True, check=False) for s in (scene, far))
    inside = [len(s.positions[np.abs(s.positions).max(axis=1) < 10]) for s in (here, there)]
    assert inside[1] == pytest.approx(inside[0], rel=0.15)


def test_rays_start_as_close_to_surfaces_beside_a_wide_ground() -> None:
    """Rays started a millionth of the longest edge of the scene above each surface, and so above a card on the floor."""
    black = Material("diffuse", {"reflectance": grey(0.0)})
    lamp = PointLight((0.0, 0.0, 2.0), (1.0, 1.0, 1.0))
    floor = quad(np.array([-1.0, -1, 0]), (2.0, 0, 0), (0, 2.0, 0), black)
    card = quad(np.array([-0.5, -0.5, 0.0005]), (1.0, 0, 0), (0, 1.0, 0), black)
    ground = quad(np.array([-1000.0, -1000, -50]), (2000.0, 0, 0), (0, 2000.0, 0), black)
    scene = Scene((floor, card, ground), lights=(lamp,), up=(0, 0, 1))
    points, up = [(0.0, 0.0, 0.0), (0.75, 0.0, 0.0), (20.0, 30.0, -50.0)], [(0.0, 0, 1)] * 3
    found = np.asarray(eclat.irradiance(scene, points, up, eclat.Path(), samples=64))[:, 0]
    beside, below = (2 / (x * x + y * y + z * z) ** 1.5 for x, y, z in ((0.75, 0.0, 2.0), (20.0, 30.0, 52.0)))
    assert found == pytest.approx((0, beside, below * 52 / 2), rel=1e-3, abs=1e-9)
    solution = eclat.solve(scene, eclat.Radiosity(patches=200))
    under = (solution.triangles < 2) & (np.abs(solution.corners[..., :2]).max(axis=(1, 2)) < 0.45) & ~solution.is_back
    assert solution.irradiance[under & ~solution.is_unknown].max(initial=0.0) < 1e-3


@pytest.mark.parametrize("gather", [0, 4])
def test_photons_in_the_dark_part_of_a_room(gather: int) -> None:
    """Discs of photons were bounded by the area of the whole scene: beside a ground of a square kilometre they reached into
    the bright part, and what the eye sees here was 5.4 times too bright without a gather, 17 % with one."""
    white, dark = (Material("diffuse", {"reflectance": grey(albedo)}) for albedo in (0.7, 0.2))
    partition = quad(np.array([2.8, 0.0, 0]), (0, 3.0, 0), (0, 0, 4.8), white)  # leaves 20 cm below the ceiling
    ground = quad(np.array([-500.0, -500, -0.5]), (1000.0, 0, 0), (0, 1000.0, 0), dark)
    behind = Camera(look_at((3.6, 2.6, 0.6), (3.4, 0.2, 1.0), (0, 0, 1)), fov=80.0)
    method = eclat.PhotonMap(photons=20_000, gather=gather)
    alone, beside = (
        eclat.render(
            replace(room(np.zeros(3), partition, *far), cameras=(behind,)), method, size=(12, 12), samples=64, seed=3
        )
        for far in ((), (ground,))
    )
    truth = eclat.render(
        replace(room(np.zeros(3), partition), cameras=(behind,)), eclat.Path(), size=(12, 12), samples=512
    )
    assert beside.pixels.mean() == pytest.approx(alone.pixels.mean(), rel=0.01)
    assert beside.pixels.mean() == pytest.approx(truth.pixels.mean(), rel=0.06)


SKY = Environment(np.ones((1, 1, 3), np.float32))


def with_window(scene: Scene) -> Scene:
    """The room without its lamp, and with an open window of 1.8 m² in the wall at x = 4 m."""
    wall, (low, high), (bottom, top) = scene.meshes[5], (1.5, 3.0), (1.0, 2.2)
    frame = [
        quad(np.array([4.0, y, z]), (0, dy, 0), (0, 0, dz), wall.material)
        for y, dy, z, dz in (
            (0, 3.0, 0, low), (0, 3.0, high, 5 - high), (0, bottom, low, high - low), (top, 3 - top, low, high - low),
        )
    ]  # fmt: skip
    return replace(scene, meshes=(*scene.meshes[:5], *frame, *scene.meshes[7:]))


@pytest.mark.parametrize("far", ["ground", "stray"])
def test_photons_of_a_sky_start_before_the_room(far: str) -> None:
    """They started on a disc as wide as the scene, and a lamp was chosen by its power beside that of this disc: of 7 million
    emissions 40 photons were stored, and without a gather 9 to 25 % of the light of the lamp was missing."""
    ground = quad(np.array([-500.0, -500, -0.5]), (1000.0, 0, 0), (0, 1000.0, 0), Material())
    scene = replace(room(np.zeros(3), ground if far == "ground" else stray((0, 0, 1000.0))), environment=SKY)
    method = eclat.PhotonMap(photons=5000, caustic_photons=1000, gather=0)
    truth, found = (
        eclat.render(scene, m, size=(12, 12), samples=n, seed=3).pixels.mean()
        for m, n in ((eclat.Path(), 400), (method, 16))
    )
    assert found == pytest.approx(truth, rel=0.04)
    photons = eclat.solve(with_window(scene), method).positions
    assert np.count_nonzero((np.abs(photons - (2, 1.5, 2.5)) < (2.01, 1.51, 2.51)).all(axis=1)) > 1000
