# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Light through panes and curtains that know no end, by every method, against closed forms."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import eclat
from eclat.methods import Method
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    grey,
    look_at,
    rgb,
)

METHODS: dict[str, Method] = {
    "direct": eclat.Direct(),
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(),
    "radiance-cache": eclat.RadianceCache(),
    "photon-map": eclat.PhotonMap(photons=20_000),
    "radiosity": eclat.Radiosity(patches=500),
}
HALF = 60.0
"""Half the width of sheets and floor in metres, which are one metre apart: what comes in at the sides is a few 1e-4."""
TINT = (0.8, 0.5, 1.0)
SKY = Environment(np.ones((1, 1, 3), np.float32))

pytestmark = pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")


def level(height: float, material: Material) -> Mesh:
    corners = [(-HALF, height, HALF), (HALF, height, HALF), (HALF, height, -HALF), (-HALF, height, -HALF)]
    return Mesh(np.array(corners), np.array([(0, 1, 2), (0, 2, 3)]), material)


def under(
    sheet: Material, floor: float, light: DirectionalLight | PointLight | None, environment: Environment | None = None
) -> Scene:
    ground = level(0.0, Material("diffuse", {"reflectance": grey(floor)}))
    down = Camera(look_at((0, 0.6, 0), (0, 0, 0.01), up=(0, 0, -1)), fov=20.0)
    lights = () if light is None else (light,)
    return Scene((ground, level(1.0, sheet)), lights=lights, environment=environment, cameras=(down,))


def seen(scene: Scene, method: str, samples: int = 64) -> np.ndarray:
    image = eclat.render(scene, METHODS[method], size=(8, 8), samples=samples, seed=1, check=False)
    return np.asarray(image.pixels).mean(axis=(0, 1))


def passed(cosine: float, ior: float = 1.5) -> float:
    """Transmittance of a pane: both faces and all bounces between them."""
    inside = math.sqrt(1 - (1 - cosine**2) / ior**2)
    s, p = (cosine - ior * inside) / (cosine + ior * inside), (ior * cosine - inside) / (ior * cosine + inside)
    r = (s * s + p * p) / 2
    return (1 - r) / (1 + r)


PANE = Material("thin_dielectric", {"specular_transmittance": rgb(*TINT)})
SUN = DirectionalLight((math.sin(math.radians(40)), -math.cos(math.radians(40)), 0), (3.0, 3.0, 3.0))


@pytest.mark.parametrize("method", METHODS)
def test_a_sun_shines_through_a_pane(method: str) -> None:
    cosine = math.cos(math.radians(40))
    expected = 0.02 / math.pi * 3.0 * cosine * passed(cosine) * np.array(TINT)
    # The floor of 2 % is lit again by less than 0.4 % of its light.
    assert seen(under(PANE, 0.02, SUN), method) == pytest.approx(expected, rel=0.006)


@pytest.mark.parametrize("method", METHODS)
def test_a_lamp_shines_through_a_pane(method: str) -> None:
    lamp = PointLight((0.0, 2.0, 0.0), (4.0, 4.0, 4.0))
    found = seen(under(PANE, 0.02, lamp), method)
    expected = 0.02 / math.pi * 4.0 / 2.0**2 * passed(1.0) * np.array(TINT)
    assert found == pytest.approx(expected, rel=0.012)  # the picture's edges lie a little farther from the lamp


def stacked(panes: int, cosine: float) -> np.ndarray:
    """Transmittance of a stack of panes, with all bounces between them."""
    one, back = passed(cosine) * np.array(TINT), 1 - passed(cosine)
    through, reflected = one, np.full(3, back)
    for _ in range(panes - 1):
        between = 1 / (1 - reflected * back)
        through, reflected = through * one * between, reflected + through**2 * back * between
    return through


STACKED = METHODS | {"photon-map-without-gather": eclat.PhotonMap(photons=20_000, caustic_photons=20_000, gather=0)}


@pytest.mark.parametrize("panes", [2, 3])
@pytest.mark.parametrize("light", ["sun", "spot"])
@pytest.mark.parametrize("method", STACKED)
def test_lamps_shine_through_panes_behind_each_other(method: str, light: str, panes: int) -> None:
    """Light that is reflected between panes is missing where no path finds it: 0.7 % with two, 2 % with three. Photons
    find it, spread so thin over the wide floor that their discs reach above the panes."""
    cosine = math.cos(math.radians(40)) if light == "sun" else 1.0
    spot = SpotLight((0.0, 2.0, 0.0), (0.0, -1.0, 0.0), (4.0, 4.0, 4.0), 30.0, 30.0)
    scene = under(PANE, 0.02, SUN if light == "sun" else spot)
    scene = replace(scene, meshes=(scene.meshes[0], *(level(1.0 + 0.3 * i, PANE) for i in range(panes))))
    arriving = 3.0 * cosine if light == "sun" else 1.0
    image = eclat.render(scene, STACKED[method], size=(8, 8), samples=16, seed=1, check=False)
    found = np.asarray(image.pixels).mean(axis=(0, 1))
    assert found == pytest.approx(0.02 / math.pi * arriving * stacked(panes, cosine), rel=0.03)


def hemispherical(ior: float = 1.5) -> float:
    cosines = (np.arange(2000) + 0.5) / 2000
    return float(np.mean([2 * c * passed(c, ior) for c in cosines]))


@pytest.mark.parametrize("method", METHODS)
def test_a_sky_shines_through_a_pane(method: str) -> None:
    expected = 0.02 * hemispherical() * np.array(TINT)
    assert seen(under(PANE, 0.02, None, SKY), method, 256) == pytest.approx(expected, rel=0.025)


@pytest.mark.parametrize("light", ["sun", "sky"])
def test_points_behind_a_pane(light: str) -> None:
    scene = under(PANE, 0.02, SUN) if light == "sun" else under(PANE, 0.02, None, SKY)
    cosine = math.cos(math.radians(40))
    expected = 3.0 * cosine * passed(cosine) if light == "sun" else math.pi * hemispherical()
    found = eclat.irradiance(scene, [(0.0, 0.5, 0.0)], [(0.0, 1.0, 0.0)], eclat.Path(), samples=2048)
    assert np.asarray(found)[0] == pytest.approx(expected * np.array(TINT), rel=0.025)


CURTAIN = Material("translucent", {"reflectance": grey(0.3), "transmittance": grey(0.4)})


@pytest.mark.parametrize("method", ["path", "irradiance-cache", "radiance-cache", "radiosity"])
@pytest.mark.parametrize("light", ["sun", "sky"])
def test_light_through_a_curtain(light: str, method: str) -> None:
    """B = τ E / π + ρ_s ρ_g B below, and the floor of reflectance ρ_g sends ρ_g B back."""
    scene = under(CURTAIN, 0.5, SUN) if light == "sun" else under(CURTAIN, 0.5, None, SKY)
    above = 3.0 * math.cos(math.radians(40)) / math.pi if light == "sun" else 1.0
    below = 0.4 * above / (1 - 0.3 * 0.5)
    assert seen(scene, method, 256) == pytest.approx((0.5 * below,) * 3, rel=0.03)


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> Scene:
    """A curtain of twelve metres, so that photons lie close together against the height of the room."""
    monkeypatch.setitem(globals(), "HALF", 6.0)
    return under(CURTAIN, 0.5, SUN)


FLOOR = look_at((0, 0.6, 0), (0, 0, 0.01), up=(0, 0, -1))
CURTAIN_ABOVE = look_at((0, 0.1, 0), (0, 1, 0.01), up=(0, 0, -1))
CURTAIN_BELOW = look_at((0, 2.0, 0), (0, 0, 0.01), up=(0, 0, -1))
VIEWS = {"floor": FLOOR, "from-below": CURTAIN_ABOVE, "from-above": CURTAIN_BELOW}


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize(
    "method",
    [
        eclat.IrradianceCache(),
        eclat.PhotonMap(photons=20_000),
        eclat.PhotonMap(photons=20_000, gather=0),
        eclat.Radiosity(patches=2000),
        eclat.Radiosity(patches=2000, gather=0),
        eclat.Radiosity(patches=2000, gather=0, solver="shooting"),
    ],
    ids=["irradiance-cache", "photon-map", "photon-map-without-gather", "radiosity", "patches", "patches-by-shooting"],
)
def test_methods_agree_on_both_sides_of_a_curtain(small: Scene, method: Method, view: str) -> None:
    scene = replace(small, cameras=(Camera(VIEWS[view], fov=120.0),))
    truth, found = (
        np.asarray(eclat.render(scene, method, size=(16, 16), samples=128, seed=1, check=False).pixels).mean()
        for method in (eclat.Path(), method)
    )
    assert found == pytest.approx(truth, rel=0.02)


def test_records_lie_on_both_sides_of_a_curtain(small: Scene) -> None:
    """Seen from below, a sheet that only lets light through needs records of its upper side alone; both where it reflects."""
    below = Camera(CURTAIN_ABOVE, fov=120.0)
    for reflectance, sides in ((0.0, {1.0}), (0.3, {-1.0, 1.0})):
        sheet = Material("translucent", {"reflectance": grey(reflectance), "transmittance": grey(0.4)})
        scene = replace(under(sheet, 0.5, SUN), cameras=(below,))
        cache = eclat.solve(scene, eclat.IrradianceCache(), size=(16, 16), seed=1)
        on_sheet = cache.normals[cache.positions[:, 1] > 0.99]
        assert set(np.round(on_sheet[:, 1])) == sides


def test_a_view_independent_cache_contains_light_through_a_curtain(small: Scene) -> None:
    cache = eclat.solve(small, eclat.IrradianceCache(), view_independent=True, seed=1)
    scene = replace(small, cameras=(Camera(CURTAIN_ABOVE, fov=120.0),))
    truth = np.asarray(eclat.render(scene, eclat.Path(), size=(16, 16), samples=128, seed=1).pixels).mean()
    found = np.asarray(eclat.render(scene, cache, size=(16, 16), samples=64, seed=1).pixels).mean()
    assert found == pytest.approx(truth, rel=0.01)


@pytest.mark.parametrize("method", ["irradiance-cache", "photon-map", "radiosity"])
def test_points_behind_a_curtain(small: Scene, method: str) -> None:
    points, up = [(0.0, 0.2, 0.0), (2.0, 0.5, 1.0)], [(0.0, 1.0, 0.0)] * 2
    truth, found = (
        np.asarray(eclat.irradiance(small, points, up, m, samples=4096)) for m in (eclat.Path(), METHODS[method])
    )
    assert found == pytest.approx(truth, rel=0.025)


SHEETS = {
    "curtain": CURTAIN,
    "blend": Material("blend", {"weight": grey(0.5)}, children=(CURTAIN, CURTAIN)),
    "lace": replace(CURTAIN, opacity=grey(0.5)),
}
BEHIND: dict[str, tuple[PointLight | SpotLight | None, Environment | None]] = {
    "point": (PointLight((0.0, 3.0, 0.0), (4.0, 4.0, 4.0)), None),
    "spot": (SpotLight((0.0, 3.0, 0.0), (0.0, -1.0, 0.0), (4.0, 4.0, 4.0), 20.0, 30.0), None),
    "sky": (None, SKY),
}
AT_POINTS: dict[str, Method] = {
    "irradiance-cache": eclat.IrradianceCache(),
    "photon-map": eclat.PhotonMap(photons=10_000, caustic_photons=1000),
    "radiosity": eclat.Radiosity(patches=1000),
}


def arriving(sheet: Material, light: str, method: Method) -> np.ndarray:
    points, up = [(0.0, 0.3, 0.0), (0.7, 0.2, 0.4)], [(0.0, 1.0, 0.0)] * 2
    found = eclat.irradiance(under(sheet, 0.02, *BEHIND[light]), points, up, method, samples=4096)
    return np.asarray(found).mean(axis=1)


@pytest.mark.parametrize(
    ("light", "sheet"), [*((light, "curtain") for light in BEHIND), ("point", "blend"), ("point", "lace")]
)
@pytest.mark.parametrize("method", AT_POINTS)
@pytest.mark.usefixtures("small")
def test_light_of_each_lamp_arrives_at_points_behind_a_curtain(method: str, light: str, sheet: str) -> None:
    truth = arriving(SHEETS[sheet], light, eclat.Path())
    assert arriving(SHEETS[sheet], light, AT_POINTS[method]) == pytest.approx(truth, rel=0.015)


@pytest.mark.usefixtures("small")
def test_lace_lets_half_of_the_light_past_the_curtain() -> None:
    distance = np.array([2.7, math.sqrt(2.8**2 + 0.7**2 + 0.4**2)])
    bare = 4.0 * np.array([2.7, 2.8]) / distance**3
    behind = arriving(CURTAIN, "point", eclat.Path())
    found = arriving(SHEETS["lace"], "point", eclat.Path())
    assert found == pytest.approx(0.5 * bare + 0.5 * behind, rel=0.015)


def test_the_error_of_what_comes_through_a_curtain_is_stated(small: Scene) -> None:
    """Probes look at the records of both sides: those of one that was lit otherwise are found to be wrong."""
    scene = replace(small, cameras=(Camera(CURTAIN_ABOVE, fov=120.0),))
    image = eclat.render(scene, eclat.IrradianceCache(), size=(16, 16), samples=16, seed=1)
    assert image.metadata["statistics"]["unserved"] == 0
    assert image.metadata["statistics"]["estimated_error"] < 0.02


@pytest.mark.parametrize("method", ["path", "irradiance-cache", "photon-map", "radiosity"])
def test_a_white_sheet_that_lets_half_through_is_invisible_in_a_furnace(method: str) -> None:
    sheet = Material("translucent", {"reflectance": grey(0.5), "transmittance": grey(0.5)})
    camera = Camera(look_at((0, 3, 0), (0, 1, 0.01), up=(0, 0, -1)), fov=20.0)
    scene = Scene((level(1.0, sheet),), environment=SKY, cameras=(camera,))
    assert seen(scene, method) == pytest.approx((1.0,) * 3, rel=0.02)
