# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Small rooms in which irradiance caches are known to fail, each with one kind of error; docs/defects.md describes
them.

Unless stated otherwise, a room is at 0 < x < 3, 0 < y < 2.5 and 0 < z < 3, in metres, and all surfaces are diffuse.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    FloatArray,
    Material,
    Mesh,
    Scene,
    SpotLight,
    Texture,
    Value,
    grey,
    look_at,
    rgb,
)
from eclat.scenes.geometry import Point2, Solid, box, mesh, revolve

WIDTH, HEIGHT = 3.0, 2.5
WHITE = (0.75, 0.73, 0.7)
SIZE = (480, 360)


def thin_wall(thickness: float = 0.01) -> Scene:
    """Make two rooms, of which the one at x > 1.5 has a tenth of the light of the other, with a closed wall at x = 1.5
    between them.

    `thickness` is that of the wall in metres; with 0, the wall is a sheet.
    """
    meshes = [_shell(), _lamp((0.5, 2.3, 1.2), (0.9, 2.36, 1.8), (12, 11, 9))]
    meshes.append(_lamp((2.1, 2.3, 1.2), (2.5, 2.36, 1.8), (0.8, 1.0, 1.2)))
    x = WIDTH / 2
    if thickness > 0:
        wall = mesh([box((x - thickness / 2, -0.1, -0.1), (x + thickness / 2, 2.6, 3.1))], _paint(WHITE), "wall")
    else:
        wall = _sheet([(x, -0.1, -0.1), (x, 2.6, -0.1), (x, 2.6, 3.1), (x, -0.1, 3.1)], "wall")
    cameras = (
        _camera((2.85, 1.1, 2.6), (1.6, 0.4, 0.8), "dim"),
        _camera((0.15, 1.1, 2.6), (1.4, 0.4, 0.8), "bright"),
    )
    return Scene((*meshes, wall), cameras=cameras, name="thin-wall")


def gap(width: float = 0.001) -> Scene:
    """Make a dim and a bright room whose dividing wall at x = 1.5 consists of two sheets with a slit between them.

    The slit is at z = 1.5, and `width` metres wide.
    """
    meshes = [_shell(), _lamp((0.5, 2.3, 1.2), (0.9, 2.36, 1.8), (12, 11, 9))]
    meshes.append(_lamp((2.1, 2.3, 1.2), (2.5, 2.36, 1.8), (0.8, 1.0, 1.2)))
    x = WIDTH / 2
    for name, z0, z1 in (("left", -0.1, 1.5 - width / 2), ("right", 1.5 + width / 2, 3.1)):
        meshes.append(_sheet([(x, -0.1, z0), (x, 2.6, z0), (x, 2.6, z1), (x, -0.1, z1)], f"wall-{name}"))
    return Scene(tuple(meshes), cameras=(_camera((2.85, 1.3, 2.5), (1.5, 0.7, 1.4), "dim"),), name="gap")


def lampshade(distance: float = 0.01) -> Scene:
    """Make a flat round lamp that shines down, `distance` metres below the ceiling, which is almost dark above it."""
    y = HEIGHT - distance
    shade = revolve([(0.45, y - 0.03), (0.45, y)], 48).moved(x=1.5, z=1.5)
    angles = np.arange(48) * (2 * math.pi / 48)
    rim = np.column_stack([1.5 + 0.4 * np.sin(angles), np.full(48, y - 0.031), 1.5 + 0.4 * np.cos(angles)])
    fan = np.column_stack([np.zeros(46, int), np.arange(2, 48), np.arange(1, 47)])
    glow = Mesh(rim, fan, _paint(WHITE, emission=(8, 7, 6)), name="glow")
    camera = _camera((0.2, 0.4, 2.85), (1.5, 2.2, 1.4), "below")
    return Scene((_shell(), mesh([shade], _paint(WHITE), "shade"), glow), cameras=(camera,), name="lampshade")


def skirting() -> Scene:
    """Make details that are thinner than the spacing of records: a skirting board 18 mm thick, a rail and a door
    frame."""
    boards = [
        box((-0.05, -0.02, -0.05), (WIDTH + 0.05, 0.1, 0.018)),
        box((-0.05, 0.9, -0.05), (WIDTH + 0.05, 0.94, 0.025)),
        box((-0.05, -0.019, -0.04), (0.018, 0.099, WIDTH + 0.04)),
    ]
    frame = [
        box((1.8 - a, -0.03, -0.05), (2.6 + a, 2.0 + a, depth))
        for a, depth in ((0.08, 0.015), (0.06, 0.03), (0.03, 0.022))
    ]
    meshes = (
        _shell(),
        _lamp((1.2, 2.3, 1.5), (1.8, 2.36, 2.1), (9, 8.5, 8)),
        mesh(boards, _paint((0.6, 0.6, 0.58)), "boards"),
        mesh(frame, _paint((0.55, 0.4, 0.25)), "door"),
    )
    return Scene(meshes, cameras=(_camera((0.9, 0.7, 1.7), (1.4, 0.5, 0.0), "corner"),), name="skirting")


def coarse_shapes(segments: int = 16) -> Scene:
    """Make a vase and a sphere of few facets with interpolated normals, which are lit from one side."""
    profile = [(0.12, 0.0), (0.2, 0.12), (0.26, 0.3), (0.2, 0.5), (0.1, 0.64), (0.09, 0.72), (0.14, 0.8)]
    ball = _ball(0.3, segments, segments // 2).smooth(80).moved(x=2.0, y=0.31, z=1.4)
    vase = revolve(profile, segments, crease=80).moved(x=1.1, y=-0.002, z=1.2)
    meshes = (
        _shell(left=(0.7, 0.15, 0.1), right=(0.15, 0.3, 0.65)),
        _lamp((0.2, 2.1, 1.9), (0.7, 2.16, 2.6), (14, 13, 12)),
        mesh([ball], _paint(WHITE), "ball"),
        mesh([vase], _paint((0.7, 0.65, 0.5)), "vase"),
    )
    return Scene(meshes, cameras=(_camera((1.55, 0.9, 2.75), (1.55, 0.4, 1.2), "front", 40),), name="coarse-shapes")


def tessellated(segments: int = 96) -> Scene:
    """Make a sphere, a torus and a niche (the inside of a quarter cylinder) of many small facets."""
    ball = _ball(0.3, segments, segments // 2).smooth(60).moved(x=0.9, y=0.31, z=1.3)
    turn = np.arange(segments // 2) * (4 * math.pi / segments)
    ring: list[Point2] = [(0.3 + 0.11 * math.cos(t), 0.112 + 0.11 * math.sin(t)) for t in turn]
    torus = _torus(ring, segments).smooth(60).moved(x=2.0, z=1.5)
    angles = np.linspace(math.pi / 2, math.pi, segments // 4 + 1)
    # The niche rounds off the corner between the floor and the back wall.
    inside = [(0.8 * (1 + math.cos(a)), 0.8 * (1 - math.sin(a))) for a in angles]
    niche = _swept([(y, z) for z, y in inside])
    meshes = (
        _shell(left=(0.7, 0.15, 0.1), right=(0.15, 0.3, 0.65)),
        _lamp((1.2, 2.3, 1.5), (1.8, 2.36, 2.1), (9, 8.5, 8)),
        mesh([ball], _paint(WHITE), "ball"),
        mesh([torus], _paint((0.7, 0.65, 0.5)), "torus"),
        niche,
    )
    return Scene(meshes, cameras=(_camera((1.5, 1.3, 2.85), (1.5, 0.35, 1.0), "front"),), name="tessellated")


def sunk() -> Scene:
    """Make one-sided solids that overlap: boxes that pass through the floor, a ball half inside a block, and two
    plates."""
    solid = _paint(WHITE, two_sided=False)
    meshes = (
        _shell(two_sided=False),
        _lamp((1.2, 2.3, 1.5), (1.8, 2.36, 2.1), (9, 8.5, 8)),
        mesh([box((0.6, -0.3, 0.8), (1.4, 0.5, 1.6)), _ball(0.35, 32, 16).moved(x=1.4, y=0.45, z=1.4)], solid, "block"),
        mesh([box((2.0, -0.01, 0.6), (2.4, 0.002, 2.0)), box((1.9, -0.2, 1.5), (2.7, 0.3, 1.8))], solid, "plates"),
    )
    return Scene(meshes, cameras=(_camera((2.2, 1.4, 2.85), (1.4, 0.2, 1.2), "front"),), name="sunk")


def foliage(leaves: int = 2000, seed: int = 1) -> Scene:
    """Make a tree in a court under an open sky, whose leaves are squares with the cut-out image of a leaf."""
    random = np.random.default_rng(seed)
    centre = _unit(random.normal(size=(leaves, 3))) * random.uniform(0.4, 1, (leaves, 1)) ** (1 / 3)
    centre = centre * (1.0, 0.85, 1.0) + (0.0, 2.4, 0.0)
    along = _unit(random.normal(size=(leaves, 3)))
    across = _unit(np.cross(along, random.normal(size=(leaves, 3))))
    size = random.uniform(0.06, 0.11, (leaves, 1))
    corners = np.stack([centre + size * (s * along + t * across) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))], 1)
    quads = np.arange(leaves)[:, None] * 4
    triangles = np.concatenate([quads + np.array([0, 1, 2]), quads + np.array([0, 2, 3])])
    uvs = np.tile([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], (leaves, 1))
    image = np.ones((64, 64, 4), np.float32)
    v, u = (np.mgrid[0:64, 0:64] + 0.5) / 32 - 1
    image[..., 3] = np.abs(v) < 0.7 * np.cos(math.pi / 2 * u)
    mask = Texture(image, filter="nearest", name="leaf")
    green = Material(
        "diffuse",
        {"reflectance": rgb(0.2, 0.36, 0.08)},
        name="leaf",
        opacity=Value((1.0, 1.0, 1.0), texture=mask, channel=3),
        alpha_cutoff=0.5,
    )
    court = [box((-3.2, -0.2, -3.2), (3.2, 0.0, 3.2)), box((-3.2, -0.1, -3.2), (3.2, 4.0, -3.0))]
    court += [box((-3.2, -0.1, -3.1), (-3.0, 4.0, 3.2))]
    meshes = (
        mesh(court, _paint((0.6, 0.55, 0.48)), "court"),
        mesh([revolve([(0.09, -0.1), (0.06, 2.2)], 12)], _paint((0.3, 0.2, 0.12)), "trunk"),
        Mesh(corners.reshape(-1, 3), triangles, green, uvs=uvs, name="leaves"),
    )
    sun = DirectionalLight((-0.4, -0.8, -0.45), (2.4, 2.2, 1.9))
    sky = Environment(np.full((1, 1, 3), (0.35, 0.45, 0.6), np.float32))
    camera = _camera((2.6, 1.5, 4.2), (0.0, 1.8, 0.0), "court", 48)
    return Scene(meshes, (sun,), sky, (camera,), name="foliage")


def bright_spot() -> Scene:
    """Make a room whose only light is a small sunlit spot on the floor, so that the noise of gathers shows as
    blotches."""
    sun = SpotLight((2.0, 2.4, 2.0), (0.05, -1.0, 0.1), (60.0, 56.0, 50.0), 5.0, 6.0)
    camera = _camera((2.7, 1.3, 2.7), (0.6, 0.9, 0.3), "corner")
    return Scene((_shell(left=(0.7, 0.15, 0.1)),), (sun,), cameras=(camera,), name="bright-spot")


CASES: dict[str, Callable[[], Scene]] = {
    "thin-wall": thin_wall,
    "sheet": lambda: thin_wall(0.0),
    "gap": gap,
    "lampshade": lampshade,
    "skirting": skirting,
    "coarse-shapes": coarse_shapes,
    "tessellated": tessellated,
    "sunk": sunk,
    "foliage": foliage,
    "bright-spot": bright_spot,
}
"""Maps the name of each scene to the function that makes it."""


def _paint(
    colour: tuple[float, float, float], two_sided: bool = True, emission: tuple[float, float, float] | None = None
) -> Material:
    shine = None if emission is None else rgb(*emission)
    return Material("diffuse", {"reflectance": rgb(*colour)}, two_sided=two_sided, emission=shine)


def _shell(
    left: tuple[float, float, float] = WHITE, right: tuple[float, float, float] = WHITE, two_sided: bool = True
) -> Mesh:
    """Make the inside of the room, whose walls at x = 0 and x = WIDTH have the colours `left` and `right`."""
    room = box((0, 0, 0), (WIDTH, HEIGHT, WIDTH)).inside_out()
    corners = room.positions[room.triangles]
    colours = np.tile(np.array([*WHITE, 1.0]), (len(corners) * 3, 1))
    for x, colour in ((0.0, left), (WIDTH, right)):
        colours[np.repeat((corners[:, :, 0] == x).all(axis=1), 3)] = (*colour, 1.0)
    material = Material("diffuse", {"reflectance": grey(1)}, name="shell", two_sided=two_sided, vertex_colors=True)
    triangles = np.arange(len(corners) * 3).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), triangles, material, colors=colours.astype(np.float32), name="shell")


def _lamp(low: tuple[float, float, float], high: tuple[float, float, float], radiance: tuple[float, ...]) -> Mesh:
    r, g, b = radiance
    return mesh([box(low, high)], _paint((0.5, 0.5, 0.5), emission=(r, g, b)), "lamp")


def _sheet(corners: list[tuple[float, float, float]], name: str) -> Mesh:
    return Mesh(np.array(corners), np.array([(0, 1, 2), (0, 2, 3)]), _paint(WHITE), name=name)


def _camera(
    origin: tuple[float, float, float], target: tuple[float, float, float], name: str, fov: float = 60
) -> Camera:
    return Camera(look_at(origin, target), fov=fov, size=SIZE, name=name)


def _ball(radius: float, segments: int, rings: int) -> Solid:
    """Make a sphere about the origin, from rings of latitude."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, rings + 1)[1:-1]
    return revolve(
        [(0.0, -radius), *((radius * math.cos(a), radius * math.sin(a)) for a in angles), (0.0, radius)], segments
    )


def _torus(ring: list[Point2], segments: int) -> Solid:
    """Revolve a closed profile of points (radius, height) about the y axis."""
    profile = np.array(ring)
    angles = np.arange(segments) * (2 * math.pi / segments)
    count = len(profile)
    rows = [np.column_stack([profile[:, 0] * math.sin(a), profile[:, 1], profile[:, 0] * math.cos(a)]) for a in angles]
    i, j = (k.ravel() for k in np.meshgrid(np.arange(segments), np.arange(count), indexing="ij"))
    a, b = i * count + j, i * count + (j + 1) % count
    c, d = (i + 1) % segments * count + (j + 1) % count, (i + 1) % segments * count + j
    return Solid(np.concatenate(rows), np.concatenate([np.column_stack([a, c, b]), np.column_stack([a, d, c])]))


def _swept(profile: list[Point2]) -> Mesh:
    """Make a smooth sheet by extruding a profile of points (height, z) along x through the room."""
    y, z = np.array(profile).T
    count = len(y)
    rows = np.concatenate([np.column_stack([np.full(count, x), y, z]) for x in (-0.01, WIDTH + 0.01)])
    i = np.arange(count - 1)
    quads = np.concatenate([np.column_stack([i, i + count, i + count + 1]), np.column_stack([i, i + count + 1, i + 1])])
    smooth = Solid(rows, quads).smooth(60)
    return Mesh(smooth.positions, smooth.triangles, _paint(WHITE), normals=smooth.normals, name="niche")


def _unit(v: FloatArray) -> FloatArray:
    unit: FloatArray = v / np.linalg.norm(v, axis=1, keepdims=True)
    return unit
