# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Daylight as irradiance caching draws it, beside path tracing: through a pane and a curtain, and from a sky image.

Writes docs/pictures/pane-and-curtain.jpg and docs/pictures/sun-in-a-sky-image.jpg. Both sides of a picture have the same
samples a pixel, and both are denoised. Says the seconds and the stated error of each side, and by how much the mean radiance
of the two differs.

    python benchmarks/daylight_pictures.py --size 480 --samples 64 --max-error 0.015
"""

from __future__ import annotations

import argparse

import numpy as np
from PIL import Image as PillowImage

import eclat
from eclat.daylight.sky import sun_direction, sun_sky
from eclat.images.tone import to_display
from eclat.measure.error_estimate import error_text
from eclat.scene import Camera, Environment, Material, Mesh, Scene, grey, look_at, rgb
from eclat.scenes.geometry import Solid, box, loft, mesh
from harness.machine import ROOT

FOLDER = ROOT / "docs" / "pictures"
GAP = 6
"""Width in pixels of the white line between the two sides."""

TONE_MAPPING = "filmic"
"""The curve of the display: a room and the daylight outside of its window differ by more than a screen can show."""

LIGHT_SCALE = 0.02
"""Brightness relative to real daylight, so that sunlit plaster has a radiance near 1."""

Rectangle = tuple[float, float, float, float]
"""Low x, low y, high x and high y, in metres."""


def paint(name: str, r: float, g: float, b: float) -> Material:
    return Material("diffuse", {"reflectance": rgb(r, g, b)}, name=name)


def frame(outer: Rectangle, inner: Rectangle, back: float, front: float) -> Solid:
    """Make a wall between the depths z = `back` and `front`, from `outer` without the opening `inner`."""

    def corners(edge: Rectangle) -> list[tuple[float, float]]:
        return [(edge[0], edge[1]), (edge[2], edge[1]), (edge[2], edge[3]), (edge[0], edge[3])]

    pairs = zip(corners(outer), corners(inner), strict=True)
    return loft([[(*o, back), (*o, front), (*i, front), (*i, back)] for o, i in pairs], closed=True)


def sheet(edge: Rectangle, z: float, folds: int = 0, depth: float = 0.0) -> Solid:
    """Make a sheet without thickness at the depth `z`, with sine-shaped folds of ±`depth` metres."""
    x = np.linspace(edge[0], edge[2], 16 * folds + 2)
    row = z + depth * np.sin(2 * np.pi * folds * (x - edge[0]) / (edge[2] - edge[0]))
    positions = np.concatenate([np.column_stack([x, np.full_like(x, y), row]) for y in (edge[1], edge[3])])
    a = np.arange(len(x) - 1)
    b, c, d = a + 1, a + 1 + len(x), a + len(x)
    return Solid(positions, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))


def pane_and_curtain() -> Scene:
    """Build a room with two windows towards the sun: one has a pane of glass, before the other hangs a curtain."""
    window, opening, curtain = (0.7, 0.9, 1.7, 2.1), (2.7, 0.9, 4.1, 2.2), (2.55, 0.72, 4.25, 2.42)
    walls = [
        frame((-0.2, -0.2, 2.2, 2.9), window, -0.2, 0.0),
        frame((2.2, -0.2, 5.2, 2.9), opening, -0.2, 0.0),
        box((-0.2, -0.2, 0.0), (0.0, 2.9, 4.7)),
        box((5.0, -0.2, 0.0), (5.2, 2.9, 4.7)),
        box((0.0, -0.2, 4.5), (5.0, 2.9, 4.7)),
        box((0.0, 2.7, 0.0), (5.0, 2.9, 4.5)),
    ]
    glass = Material("thin_dielectric", {"ior": grey(1.5)}, name="glass")
    cloth = Material("translucent", {"reflectance": rgb(0.45, 0.42, 0.36), "transmittance": rgb(0.4, 0.37, 0.3)})
    meshes = (
        mesh(walls, paint("plaster", 0.75, 0.7, 0.62), "walls"),
        mesh([box((0.0, -0.2, 0.0), (5.0, 0.0, 4.5))], paint("floor", 0.45, 0.34, 0.25), "floor"),
        mesh([sheet(window, -0.1)], glass, "pane"),
        mesh([sheet(curtain, 0.12, folds=8, depth=0.05).smooth(60)], cloth, "curtain"),
    )
    sun, sky = sun_sky(sun_direction(345, 42), sun_scale=LIGHT_SCALE, sky_scale=LIGHT_SCALE)
    assert sun is not None
    camera = Camera(look_at((3.3, 1.55, 4.3), (2.25, 1.2, 0.0)), fov=52)
    return Scene(meshes=meshes, lights=(sun,), environment=sky, cameras=(camera,), name="pane-and-curtain")


def sun_in_a_sky_image() -> Scene:
    """Build three boxes on the ground under an image of the sky whose sun is a few texels."""
    to_sun = np.asarray(sun_direction(55, 38))
    width, height = 512, 256
    theta = (np.arange(height) + 0.5) * np.pi / height
    phi = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    across = np.sin(theta)[:, None]
    directions = np.stack(
        np.broadcast_arrays(across * np.sin(phi), np.cos(theta)[:, None], -across * np.cos(phi)), axis=-1
    )
    up = directions[..., 1:2]
    image = np.where(up > 0, (0.35, 0.42, 0.6) + 0.3 * (1 - np.clip(up, 0, 1)) ** 4, (0.1, 0.09, 0.08))
    disc = directions @ to_sun > np.cos(np.radians(0.8))
    solid_angle = float(np.broadcast_to(across, disc.shape)[disc].sum() * np.pi / height * 2 * np.pi / width)
    image[disc] = np.array([2.2, 2.0, 1.7]) / solid_angle
    boxes = (
        ("white", (0.75, 0.73, 0.7), box((-0.5, 0, -0.5), (0.5, 0.6, 0.5)).turned(20).moved(-1.7, 0, 0.1)),
        ("red", (0.65, 0.2, 0.13), box((-0.55, 0, -0.55), (0.55, 1.1, 0.55)).turned(-25).moved(0, 0, 0.2)),
        ("green", (0.2, 0.45, 0.2), box((-0.45, 0, -0.45), (0.45, 1.9, 0.45)).turned(35).moved(1.6, 0, 0.0)),
    )
    ground = mesh([box((-15, -0.5, -15), (15, 0, 15))], paint("ground", 0.4, 0.4, 0.4), "ground")
    meshes: tuple[Mesh, ...] = (ground, *(mesh([solid], paint(name, *c), name) for name, c, solid in boxes))
    camera = Camera(look_at((-1.3, 1.9, 5.6), (-0.05, 0.75, 0.0)), fov=36)
    environment = Environment(image.astype(np.float32))
    return Scene(meshes=meshes, environment=environment, cameras=(camera,), name="sun-in-a-sky-image")


PICTURES = {"pane-and-curtain": (pane_and_curtain, 1.6), "sun-in-a-sky-image": (sun_in_a_sky_image, 0.2)}
"""Maps the name of a file to its scene and the exposure in stops."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"pictures to draw: {', '.join(PICTURES)} (default all)"
    )
    parser.add_argument("--size", type=int, default=480, metavar="PIXELS", help="width of one side")
    parser.add_argument("--samples", type=int, default=64, help="paths per pixel of both sides (default %(default)s)")
    parser.add_argument("--max-error", type=float, default=0.015, help="of the records (default %(default)s)")
    arguments = parser.parse_args()
    size = (arguments.size, round(0.7 * arguments.size))
    for name in arguments.names or PICTURES:
        if name not in PICTURES:
            parser.error(f"expected {' or '.join(PICTURES)}, got {name}")
        build, stops = PICTURES[name]
        scene = build()
        sides = []
        for method in (eclat.IrradianceCache(max_error=arguments.max_error), eclat.Path()):
            image = eclat.render(scene, method, samples=arguments.samples, size=size, denoise=True)
            statistics = image.metadata["statistics"]
            method_name, seconds = image.metadata["method"], statistics["seconds"]
            print(f"{name}, {method_name}: {seconds:.0f} s, {error_text(statistics)}", flush=True)
            sides.append(image.pixels)
        print(f"{name}: mean radiance {100 * (sides[0].mean() / sides[1].mean() - 1):+.2f} % from that of path tracing")
        line = np.full((size[1], GAP, 3), 255, np.uint8)
        shown = [to_display(pixels, stops, TONE_MAPPING) for pixels in sides]
        pair = np.concatenate([shown[0], line, shown[1]], axis=1)
        PillowImage.fromarray(pair).save(FOLDER / f"{name}.jpg", quality=90)


if __name__ == "__main__":
    main()
