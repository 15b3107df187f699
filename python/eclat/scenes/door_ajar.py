# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A study that is lit only through a door left ajar, after a scene by Veach.

The room is at 0 < x < 6 and 0 < z < 4.5, the lit corridor at 6.15 < x < 8; lengths are in metres.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from eclat.errors import EclatError
from eclat.scene import Camera, Material, Mesh, Scene, Value, grey, look_at, rgb
from eclat.scenes.geometry import Solid, box, extrude, icosphere, join, mesh, revolve

DEPTH, HEIGHT = 4.5, 2.8
"""Size of the room and the corridor along z and y."""
WALL = (6.0, 6.15)
"""Positions of the two faces of the wall between the room and the corridor along x."""
DOOR = (2.9, 3.8, 2.08)
"""Opening of the door: its lowest and highest z, and its height."""
TABLE = 0.75
"""Height of the table."""


def build(opening: float = 32.0, polished: bool = False) -> Scene:
    """Build the scene. The camera looks towards the door; it has 1280 × 720 pixels.

    Parameters
    ----------
    opening
        Angle of the door in degrees, 1 to 120.
    polished
        Whether the vase is of gold, the bowl glazed and the ball of glass; otherwise all surfaces are diffuse.
    """
    if not 1 <= opening <= 120:
        raise EclatError(f"built-in scene door-ajar: expected opening from 1 to 120 degrees, got {opening}")
    camera = Camera(look_at((0.45, 1.5, 0.5), (5.0, 0.95, 3.05)), fov=46, size=(1280, 720), name="camera")
    meshes = (*_rooms(), *_door(opening), *_furniture(), *_still_life(polished))
    return Scene(meshes=meshes, cameras=(camera,), name="door-ajar")


def _rooms() -> Iterator[Mesh]:
    shell = box((0, -0.05, 0), (8, HEIGHT, DEPTH)).inside_out()
    low, high, top = DOOR
    outline = [(-0.05, -0.1), (low, -0.1), (low, top), (high, top), (high, -0.1), (DEPTH + 0.05, -0.1)]
    outline += [(DEPTH + 0.05, HEIGHT + 0.05), (-0.05, HEIGHT + 0.05)]
    partition = extrude(outline, WALL[1] - WALL[0]).turned(-90).moved(x=sum(WALL) / 2)
    yield mesh([shell, partition], _paint("walls", 0.77, 0.73, 0.66), "walls")
    boards = [box((0.2 * k - 0.1 + 0.001, -0.1, -0.1), (0.2 * k + 0.1 - 0.001, 0, DEPTH + 0.1)) for k in range(42)]
    screed = box((-0.1, -0.2, -0.1), (8.1, -0.004, DEPTH + 0.1))
    yield mesh([*boards, screed], _paint("oak", 0.42, 0.27, 0.15), "floor")
    skirting = [
        box((-0.05, -0.02, -0.05), (WALL[0] + 0.05, 0.1, 0.018)),
        box((-0.05, -0.02, DEPTH - 0.018), (WALL[0] + 0.05, 0.1, DEPTH + 0.05)),
        box((-0.05, -0.019, 0.01), (0.018, 0.099, DEPTH - 0.01)),
        box((WALL[0] - 0.018, -0.019, 0.01), (WALL[0] + 0.05, 0.099, low - 0.09)),
        box((WALL[0] - 0.018, -0.019, high + 0.09), (WALL[0] + 0.05, 0.099, DEPTH - 0.01)),
    ]
    yield mesh(skirting, _paint("skirting", 0.75, 0.74, 0.7), "skirting")
    lamp = Material("diffuse", {"reflectance": grey(0.5)}, name="lamp", emission=rgb(300, 255, 195))
    yield mesh([box((6.7, HEIGHT - 0.09, 0.5), (7.5, HEIGHT - 0.04, 3.9))], lamp, "lamp")


def _door(opening: float) -> Iterator[Mesh]:
    low, high, top = DOOR
    white = _paint("door", 0.7, 0.68, 0.63)
    frame = []
    for x0, x1 in ((WALL[0] - 0.025, WALL[0] + 0.03), (WALL[1] - 0.03, WALL[1] + 0.025)):
        frame += [box((x0, -0.02, low - 0.09), (x1, top + 0.005, low - 0.004))]
        frame += [box((x0, -0.02, high + 0.004), (x1, top + 0.005, high + 0.09))]
        frame += [box((x0 - 0.004, top + 0.003, low - 0.1), (x1 + 0.004, top + 0.09, high + 0.1))]
    yield mesh(frame, white, "door-frame")
    width, height = high - low - 0.012, top - 0.016
    # In the leaf's own coordinates the hinge is at the origin; the leaf extends along −z, and its thickness along x.
    leaf = [box((-0.02, 0.0, -width), (0.02, height, 0.0))]
    for bottom, up in ((0.14, 0.9), (1.05, height - 0.14)):
        leaf.append(box((-0.026, bottom, -width + 0.13), (0.026, up, -0.13)))
        leaf.append(box((-0.033, bottom + 0.05, -width + 0.18), (0.033, up - 0.05, -0.18)))
    hinge = {"x": WALL[0] + 0.02, "y": 0.008, "z": high - 0.006}
    yield mesh([part.turned(opening).moved(**hinge) for part in leaf], white, "door-leaf")
    shape = [(0.026, -0.08), (0.026, -0.075), (0.009, -0.07), (0.009, 0.07), (0.026, 0.075), (0.026, 0.08)]
    bar = revolve(shape, 16).turned(90, axis=2).moved(y=1.0, z=-width + 0.06)
    grip = revolve([(0.008, 0), (0.01, 0.005), (0.01, 0.125), (0.008, 0.13)], 12).turned(90, axis=0)
    grips = [grip.moved(x=x, y=1.0, z=-width + 0.05) for x in (-0.07, 0.07)]
    handle = join([bar, *grips]).turned(opening).moved(**hinge)
    yield mesh([handle], _paint("brass", 0.5, 0.38, 0.16), "door-handle")


def _furniture() -> Iterator[Mesh]:
    walnut = _paint("walnut", 0.3, 0.17, 0.09)
    legs = [
        box((x - 0.03, -0.01, z - 0.03), (x + 0.03, TABLE - 0.02, z + 0.03)) for x in (2.75, 4.25) for z in (1.95, 2.65)
    ]
    rails = [box((2.74, TABLE - 0.11, z - 0.012), (4.26, TABLE - 0.03, z + 0.012)) for z in (1.945, 2.655)]
    rails += [box((x - 0.012, TABLE - 0.112, 1.94), (x + 0.012, TABLE - 0.028, 2.66)) for x in (2.745, 4.255)]
    top = box((2.65, TABLE - 0.035, 1.85), (4.35, TABLE, 2.75))
    yield mesh([*legs, *rails, top, *_chair()], walnut, "table-and-chair")
    yield mesh([box((2.2, -0.01, 1.4), (4.9, 0.012, 3.2))], _paint("rug", 0.38, 0.09, 0.07), "rug")
    shelves = [box((1.2, y, DEPTH - 0.32), (3.0, y + 0.025, DEPTH + 0.02)) for y in (0.42, 0.82, 1.22, 1.62)]
    sides = [box((x - 0.0125, -0.01, DEPTH - 0.33), (x + 0.0125, 2.0, DEPTH + 0.03)) for x in (1.2, 3.0)]
    lids = [box((1.17, y, DEPTH - 0.34), (3.03, y + 0.03, DEPTH + 0.04)) for y in (0.06, 1.985)]
    yield mesh([*shelves, *sides, *lids], walnut, "bookcase")
    colours = ((0.45, 0.12, 0.08), (0.12, 0.2, 0.36), (0.16, 0.28, 0.14), (0.55, 0.45, 0.28), (0.3, 0.1, 0.2))
    for k, (r, g, b) in enumerate(colours):
        yield mesh(_books(k, len(colours)), _paint(f"book-{k}", r, g, b), f"books-{k}")
    frame = [box((3.7, 1.2, DEPTH - 0.03), (5.1, 2.15, DEPTH + 0.02))]
    yield mesh(frame, _paint("frame", 0.5, 0.38, 0.16), "picture-frame")
    yield mesh(
        [box((3.77, 1.27, DEPTH - 0.034), (5.03, 2.08, DEPTH - 0.01))], _paint("picture", 0.2, 0.34, 0.42), "picture"
    )


def _chair() -> Iterator[Solid]:
    parts = [box((-0.21, 0.43, -0.21), (0.21, 0.46, 0.21))]
    parts += [box((x - 0.02, 0.0, 0.17), (x + 0.02, 0.445, 0.205)) for x in (-0.18, 0.18)]
    parts += [box((x - 0.02, 0.0, -0.205), (x + 0.02, 0.92, -0.17)) for x in (-0.18, 0.18)]
    parts += [box((-0.19, y, -0.2), (0.19, y + 0.08, -0.175)) for y in (0.6, 0.8)]
    yield join(parts).turned(-32).moved(x=3.1, y=0.002, z=1.55)


def _books(colour: int, colours: int) -> Iterator[Solid]:
    """Make the books of one colour on the four shelves, which have `colours` colours; their sizes vary without a
    visible pattern."""
    for row, y in enumerate((0.445, 0.845, 1.245, 1.645)):
        x = 1.23
        for k in range(60):
            wave = math.sin(12.9898 * (k + 61 * row))
            thickness, height = 0.028 + 0.012 * wave, 0.25 + 0.05 * math.sin(7.7 * k + row)
            if x + thickness > 2.3 + 0.6 * math.sin(2.1 * row + 1.0):
                break
            if (k * 7 + row * 3 + k // 4) % colours == colour:
                yield box((x, y - 0.01, DEPTH - 0.29 + 0.02 * wave), (x + thickness, y + height, DEPTH - 0.08))
            x += thickness + 0.0015


def _still_life(polished: bool) -> Iterator[Mesh]:
    """Make the vase, the bowl, the ball and the two books on the table."""
    vase = [(0.05, 0.0), (0.055, 0.01), (0.045, 0.03), (0.07, 0.09), (0.1, 0.17), (0.105, 0.22), (0.085, 0.28)]
    vase += [(0.05, 0.33), (0.038, 0.38), (0.042, 0.42), (0.06, 0.45), (0.05, 0.45), (0.032, 0.41), (0.028, 0.38)]
    bowl = [(0.05, 0.0), (0.055, 0.015), (0.1, 0.035), (0.14, 0.07), (0.16, 0.11), (0.15, 0.112), (0.13, 0.07)]
    bowl += [(0.08, 0.04)]
    yellow, blue, red = _paint("vase", 0.6, 0.45, 0.18), _paint("bowl", 0.15, 0.3, 0.5), _paint("ball", 0.6, 0.12, 0.08)
    if polished:
        gold = {"eta": rgb(0.143, 0.375, 1.442), "k": rgb(3.983, 2.386, 1.603), "alpha_u": grey(0.12)}
        yellow = Material("conductor", gold, name="vase")
        blue = Material("plastic", {"diffuse_reflectance": rgb(0.15, 0.3, 0.5), "alpha_u": grey(0.08)}, name="bowl")
        red = Material("dielectric", {"ior": grey(1.5)}, name="ball")
    yield mesh([revolve(vase, 48).moved(x=3.75, y=TABLE - 0.002, z=2.25)], yellow, "vase")
    yield mesh([revolve(bowl, 48).moved(x=3.3, y=TABLE - 0.002, z=2.45)], blue, "bowl")
    ball = icosphere(4).scaled(0.09, 0.09, 0.09).smooth(30)
    yield mesh([ball.moved(x=3.42, y=TABLE + 0.089, z=2.08)], red, "ball")
    books = [
        box((-0.11, -0.001, -0.15), (0.11, 0.035, 0.15)),
        box((-0.1, 0.0345, -0.14), (0.1, 0.065, 0.13)).turned(17),
    ]
    placed = [part.moved(x=2.95, y=TABLE, z=2.2) for part in books]
    yield mesh(placed, _paint("books", 0.14, 0.22, 0.3), "table-books")


def _paint(name: str, r: float, g: float, b: float) -> Material:
    parameters: dict[str, Value] = {"reflectance": rgb(r, g, b)}
    return Material("diffuse", parameters, name=name)
