# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A courtyard in the Florentine style with groin-vaulted arcades, a gallery above them, a sun and an open sky. Lengths
are in metres."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from eclat.daylight.sky import sun_direction, sun_sky
from eclat.errors import EclatError
from eclat.images.tone import srgb_encode
from eclat.scene import Camera, FloatArray, Material, Mesh, Scene, Texture, Value, look_at, rgb
from eclat.scenes import architecture as parts
from eclat.scenes.geometry import Point2, Solid, arch, box, extrude, groin_vault, half_circle, join, mesh, ring

BAY = 3.2
"""Distance between the axes of two columns; a walk is one bay deep."""
AXES = tuple(BAY * k for k in (-2.5, -1.5, -0.5, 0.5, 1.5, 2.5))
"""Positions of the columns along each side."""
COURT = AXES[-1]
"""Distance of the columns from the centre of the court."""
WALK = COURT + BAY / 2
"""Distance of the middle of the walk from the centre of the court."""
WALL_FACE = 10.95
"""Distance of the face of the outer wall from the centre of the court."""
PAVEMENT = -0.18
"""Height of the pavement of the court; the walks are at height 0."""
SPRING = 3.45
"""Height at which arches and vaults begin."""
CORNICE = 5.14
"""Height of the lower edge of the cornice."""
GALLERY = 5.44
"""Height of the floor of the gallery."""
PARAPET = GALLERY + 0.98
"""Height of the top of the balustrade."""
DADO = (1.2, GALLERY + 0.9)
"""Heights of the upper edge of the dado (the painted lower part of the wall), in the walks and on the gallery."""
EAVES = 8.72
"""Height of the tops of the upper columns."""

LIGHT_SCALE = 0.02
"""Brightness of the light relative to real daylight; sunlit plaster then has a radiance near 1, and pictures
need no exposure."""


def build(sun_azimuth: float = 287.0, sun_elevation: float = 52.0, turbidity: float = 3.0) -> Scene:
    """Build the scene. The first camera looks from the southern walk into the court, the second down from the gallery;
    both have 1280 × 720 pixels.

    Parameters
    ----------
    sun_azimuth, sun_elevation
        Direction of the sun in degrees: the azimuth is clockwise from north (−z), the elevation above 0 and at most 90.
    turbidity
        Haze of the sky, from 1.7 (clear) to 10 (hazy).
    """
    if not 0 < sun_elevation <= 90:
        raise EclatError(f"built-in scene atrium: expected sun_elevation above 0 and at most 90, got {sun_elevation}")
    to_sun = sun_direction(sun_azimuth, sun_elevation)
    sun, sky = sun_sky(to_sun, turbidity, sun_scale=LIGHT_SCALE, sky_scale=LIGHT_SCALE)
    assert sun is not None
    camera = Camera(look_at((-4.3, 1.6, 10.65), (1.9, 2.85, 2.4)), fov=59, size=(1280, 720), name="walk")
    above = Camera(look_at((-9.6, 7.1, 9.9), (3.0, 3.6, -3.0)), fov=55, size=(1280, 720), name="gallery")
    return Scene(meshes=_meshes(), lights=(sun,), environment=sky, cameras=(camera, above), name="atrium")


def _meshes() -> tuple[Mesh, ...]:
    plaster = _paint("plaster", 0.76, 0.69, 0.58)
    stone = _paint("pietra-serena", 0.36, 0.36, 0.35)
    terracotta = _paint("terracotta", 0.55, 0.24, 0.13)
    wood = _paint("wood", 0.2, 0.11, 0.06)
    pavement = _tiled("pavement", pavement_image())
    bricks = _tiled("bricks", brick_image())
    floors = [ring([(7.55, -0.55), (11.4, -0.55), (11.4, 0), (7.52, 0), (7.5, -0.015), (7.5, -0.05), (7.55, -0.075)])]
    court = box((-7.7, -0.6, -7.7), (7.7, PAVEMENT, 7.7))
    doors = list(_doors())
    tondi = list(_tondi())
    return (
        mesh([court], pavement, "pavement", uv=lambda p: p[:, [0, 2]] / 15.4 + 0.5),
        mesh(floors, bricks, "walks", uv=lambda p: p[:, [0, 2]] / 1.6),
        mesh(_walls(), plaster, "walls"),
        mesh(_dado(), _paint("pompeian-red", 0.42, 0.12, 0.08), "dado"),
        mesh([*_stonework(), *(frame for frame, _ in doors)], stone, "stonework"),
        mesh(_columns(), stone, "columns"),
        mesh(_balustrade(), _paint("limestone", 0.66, 0.62, 0.54), "balustrade"),
        mesh([leaf for _, leaf in doors] + list(_timber()), wood, "timber"),
        mesh([_roof()], terracotta, "roof"),
        mesh([frame for frame, _ in tondi], _paint("white-glaze", 0.8, 0.79, 0.75), "tondi-frames"),
        mesh([dish for _, dish in tondi], _paint("blue-glaze", 0.08, 0.2, 0.5), "tondi"),
        mesh([parts.fountain().moved(y=PAVEMENT)], _paint("marble", 0.72, 0.69, 0.64), "fountain"),
        *_plants(terracotta, wood),
    )


def _four_sides(solid: Solid) -> Iterator[Solid]:
    """Copy a solid that stands on the +z side of the court to all four sides."""
    return (solid.turned(90.0 * k) for k in range(4))


def _walls() -> Iterator[Solid]:
    """Make the walls of the arcades, the vaults and the outer wall."""
    yield from (_arcade_wall(8.24, 0.02, CORNICE + 0.02).moved(z=COURT * s) for s in (-1, 1))
    yield from (_arcade_wall(8.1, 0.015, CORNICE + 0.01).turned(90).moved(x=COURT * s) for s in (-1, 1))
    vault = groin_vault(1.35, 0.03, CORNICE + 0.03 - SPRING, 14).moved(y=SPRING + 0.005)
    line = [BAY * k for k in range(-3, 4)]
    yield from (vault.moved(x=x, z=z) for x in line for z in line if max(abs(x), abs(z)) == line[-1])
    yield ring([(WALL_FACE, -0.65), (11.5, -0.65), (11.5, 9.3), (WALL_FACE, 9.3)])


def _arcade_wall(half_length: float, foot: float, top: float) -> Solid:
    outline: list[Point2] = [(-half_length, SPRING - foot)]
    for left, right in pairwise(AXES):
        curve = half_circle((left + right) / 2, 1.33, 20)
        outline += [(curve[0][0], SPRING - foot), *((x, y + SPRING) for x, y in curve), (curve[-1][0], SPRING - foot)]
    outline += [(half_length, SPRING - foot), (half_length, top), (-half_length, top)]
    return extrude(outline, 0.5).smooth(20)


def _dado() -> Iterator[Solid]:
    for floor, top in zip((0.0, GALLERY), DADO, strict=True):
        face = WALL_FACE - 0.015
        yield ring([(face, floor - 0.02), (11.0, floor - 0.02), (11.0, top), (face, top)])


def _stonework() -> Iterator[Solid]:
    """Make the archivolts, the ribs and corbels of the vaults, and the mouldings."""
    half = [(1.3, 0.275), (1.38, 0.275), (1.39, 0.287), (1.46, 0.287), (1.475, 0.305), (1.515, 0.3)]
    archivolt = arch([*half, *((r, -z) for r, z in reversed(half))], 0.03, 20).moved(y=SPRING)
    middles = [(a + b) / 2 for a, b in pairwise(AXES)]
    yield from _four_sides(join([archivolt.moved(x=x, z=COURT) for x in middles]))
    soffit = [(1.6, -0.24), (1.3, -0.24), (1.3, -0.17), (1.32, -0.15)]
    soffit += [(r, -z) for r, z in reversed(soffit)]
    rib = arch(soffit, 0.03, 18).turned(90).moved(y=SPRING, z=WALK)
    shelf = box((-0.29, SPRING - 0.1, WALL_FACE - 0.14), (0.29, SPRING, WALL_FACE + 0.1))
    bell = parts.corbel(0.5, 0.125, 0.5).turned(180).moved(y=SPRING - 0.08, z=WALL_FACE)
    yield from _four_sides(join([join([rib, shelf, bell]).moved(x=x) for x in AXES]))
    corner = parts.corbel(0.4, 0.2, 0.45).moved(x=WALL_FACE, y=SPRING + 0.03, z=WALL_FACE)
    yield from _four_sides(corner)
    yield from _mouldings()


def _mouldings() -> Iterator[Solid]:
    edge = [(7.72, 0.0), (7.72, 0.05), (7.69, 0.06), (7.68, 0.09), (7.63, 0.12), (7.57, 0.15), (7.55, 0.17)]
    edge += [(7.55, 0.24), (7.53, 0.25), (7.5, 0.28), (7.5, 0.3)]
    yield ring([(d, CORNICE + y) for d, y in [(11.3, 0.0), *edge, (11.3, 0.3)]])
    beam = [(0.16, -0.02), (0.16, 0.12), (0.18, 0.125), (0.18, 0.26), (0.21, 0.28), (0.24, 0.34)]
    outline = [(-d, y) for d, y in beam] + [(d, y) for d, y in reversed(beam)]
    yield ring([(COURT + d, EAVES + y) for d, y in outline])
    rail = [(0.05, -0.03), (-0.03, -0.02), (-0.05, 0.03), (-0.05, 0.05), (0.05, 0.06)]
    for height in DADO:
        yield ring([(WALL_FACE + d, height + y) for d, y in rail])


def _columns() -> Iterator[Solid]:
    lower = parts.column(SPRING, 0.22, 20)
    upper = parts.column(EAVES - PARAPET, 0.15, 12, fine=3).moved(y=PARAPET)
    both = join([lower, upper])
    yield from (both.moved(x=x, z=z) for x in AXES for z in AXES if max(abs(x), abs(z)) == COURT)


def _balustrade() -> Iterator[Solid]:
    pedestal = join(
        [
            box((-0.25, GALLERY - 0.02, -0.25), (0.25, GALLERY + 0.13, 0.25)),
            box((-0.215, GALLERY, -0.215), (0.215, GALLERY + 0.9, 0.215)),
            box((-0.25, GALLERY + 0.88, -0.25), (0.25, PARAPET, 0.25)),
        ]
    )
    yield from (pedestal.moved(x=x, z=z) for x in AXES for z in AXES if max(abs(x), abs(z)) == COURT)
    side = []
    baluster = parts.baluster(0.74, 8).moved(y=GALLERY + 0.09, z=COURT)
    for left, right in pairwise(AXES):
        side.append(box((left + 0.2, GALLERY - 0.02, COURT - 0.12), (right - 0.2, GALLERY + 0.1, COURT + 0.12)))
        side.append(box((left + 0.2, GALLERY + 0.82, COURT - 0.13), (right - 0.2, GALLERY + 0.95, COURT + 0.13)))
        side += [baluster.moved(x=x) for x in np.linspace(left + 0.42, right - 0.42, 8)]
    yield from _four_sides(join(side))


def _timber() -> Iterator[Solid]:
    """Make the ceiling of the gallery: boards on beams, whose ends carry the eaves."""
    y = EAVES + 0.32
    beams = [box((x - 0.06, y, 7.15), (x + 0.06, y + 0.15, 11.0)) for x in np.arange(-11, 12) * 0.64]
    yield from _four_sides(join(beams))
    corner = [box((x - 0.06, y, 8.1), (x + 0.06, y + 0.15, 11.0)) for x in 7.68 + np.arange(6) * 0.64]
    yield from _four_sides(join(corner))
    hip = box((-0.08, y - 0.005, 7.15 * 2**0.5), (0.08, y + 0.16, 8.1 * 2**0.5)).turned(45)
    yield from _four_sides(hip)
    yield ring([(7.05, y + 0.14), (11.2, y + 0.14), (11.2, y + 0.19), (7.05, y + 0.19)])


def _roof() -> Solid:
    y = EAVES + 0.5
    return ring([(6.98, y), (11.8, y - 0.01), (11.8, y + 1.6), (6.98, y + 0.07)])


def _doors() -> Iterator[tuple[Solid, Solid]]:
    """Make the frames and leaves of the doors: in every second bay of the walks, and in the other bays of the
    gallery."""
    low = parts.door(1.3, 2.45)
    high = parts.door(1.0, 2.1)
    for k in range(4):
        for x in (-2 * BAY, 0.0, 2 * BAY):
            yield _on_wall(low, x, 0.0, k)
        for x in (-BAY, BAY):
            yield _on_wall(high, x, GALLERY, k)


def _on_wall(pair: tuple[Solid, Solid], x: float, y: float, side: int) -> tuple[Solid, Solid]:
    a, b = (part.turned(180).moved(x=x, y=y, z=WALL_FACE).turned(90.0 * side) for part in pair)
    return a, b


def _tondi() -> Iterator[tuple[Solid, Solid]]:
    frame, dish = (part.turned(180).moved(y=SPRING + 1.08, z=COURT - 0.25) for part in parts.tondo())
    for k in range(4):
        for x in AXES[1:-1]:
            yield frame.moved(x=x).turned(90.0 * k), dish.moved(x=x).turned(90.0 * k)


def _plants(terracotta: Material, wood: Material) -> Iterator[Mesh]:
    places = [(6.75 * a, 1.6 * b) for a in (-1, 1) for b in (-3, -1, 1, 3)]
    places = [p for p in places if abs(p[1]) < 2] + [(x, z) for z, x in places if abs(x) < 2]
    pots = [parts.pot().moved(x=x, y=PAVEMENT - 0.01, z=z) for x, z in places]
    jars = [parts.jar().moved(x=x, y=-0.01, z=z) for x, z in ((1.6, 10.42), (10.4, -4.8), (4.8, -10.4))]
    yield mesh(pots + jars, terracotta, "pots")
    earth = [parts.earth().moved(x=x, y=PAVEMENT, z=z) for x, z in places]
    yield mesh(earth, _paint("earth", 0.07, 0.045, 0.03), "earth")
    yield mesh([parts.trunk().moved(x=x, y=PAVEMENT, z=z) for x, z in places], wood, "trunks")
    crowns = [parts.crown(0.52, seed, 3).moved(x=x, y=1.72 + PAVEMENT, z=z) for seed, (x, z) in enumerate(places)]
    yield mesh(crowns, _paint("leaves", 0.09, 0.19, 0.04), "crowns")


def _paint(name: str, r: float, g: float, b: float) -> Material:
    return Material("diffuse", {"reflectance": rgb(r, g, b)}, name=name)


def _tiled(name: str, image: FloatArray) -> Material:
    texture = Texture(np.round(image * 255).astype(np.uint8), srgb=True, name=name)
    return Material("diffuse", {"reflectance": Value((1, 1, 1), texture)}, name=name)


def pavement_image() -> FloatArray:
    """Draw the pavement of the whole court, an sRGB-encoded image (1232, 1232, 3).

    It consists of diagonal travertine slabs, bands of grey stone from column to column, and a ring of red marble around
    the fountain.
    """
    centres = (np.arange(1232) + 0.5) / 1232 * 15.4 - 7.7
    x, z = np.meshgrid(centres, centres)
    image = np.array([0.62, 0.55, 0.45]) * _slabs((x + z) / 0.62, (x - z) / 0.62, 0.018, seed=1)[..., None]
    band = (np.abs(np.abs(x)[..., None] - AXES[3:5]).min(axis=2) < 0.16) | (np.abs(np.abs(x) - 7.3) < 0.3)
    band |= band.T
    joints = _slabs(x / 0.8, z / 0.8, 0.012, seed=2)
    image = np.where(band[..., None], np.array([0.34, 0.34, 0.33]) * joints[..., None], image)
    radius = np.hypot(x, z)
    rays = _slabs(np.arctan2(z, x) * (12 / np.pi), np.full_like(x, 0.5), 0.02, seed=3)
    image = np.where((radius < 3.3)[..., None], np.array([0.62, 0.56, 0.47]) * rays[..., None], image)
    image = np.where((np.abs(radius - 3.1) < 0.2)[..., None], np.array([0.4, 0.13, 0.09]) * rays[..., None], image)
    return srgb_encode(image)


def brick_image() -> FloatArray:
    """Draw a repeating square of the terracotta tiles of the walks, an sRGB-encoded image (256, 256, 3)."""
    tile = (np.arange(256) + 0.5) / 32
    u, v = np.meshgrid(tile, tile)
    pale = ((np.floor(u) + np.floor(v)) % 2)[..., None]
    colour = np.array([0.47, 0.23, 0.13]) * (1 - pale) + np.array([0.58, 0.37, 0.24]) * pale
    return srgb_encode(colour * _slabs(u, v, 0.03, seed=4)[..., None])


def _slabs(u: FloatArray, v: FloatArray, joint: float, seed: int) -> FloatArray:
    """Compute the brightness of slabs that are one unit wide: each has a random tone, and joints of half-width `joint`
    are darker."""
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    tones = np.random.default_rng(seed).uniform(0.86, 1.08, (64, 64))
    edge = np.minimum(0.5 - np.abs(u - i - 0.5), 0.5 - np.abs(v - j - 0.5))
    brightness: FloatArray = tones[i % 64, j % 64] * np.where(edge < joint, 0.55, 1.0)
    return brightness
