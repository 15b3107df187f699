# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Twenty scenes on which the stated error is compared with the true one: those of other benchmarks, and the same rooms
with other lamps, colours and skies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eclat.scene import Environment, Scene, Value, rgb
from harness.scenes import SCENES, BenchmarkScene

SMALL = 0.25
"""The side of a small lamp over that of the lamp that it replaces."""


def small_lamp(scene: Scene) -> Scene:
    """Every emitting mesh shrinks about its centre, and gives as much light as before."""
    meshes = []
    for mesh in scene.meshes:
        if mesh.material.emission is None:
            meshes.append(mesh)
            continue
        centre = mesh.positions.mean(axis=0)
        brighter = _scaled(mesh.material.emission, 1 / SMALL**2)
        meshes.append(
            replace(
                mesh,
                positions=np.asarray(centre + SMALL * (mesh.positions - centre), mesh.positions.dtype),
                material=replace(mesh.material, emission=brighter),
            )
        )
    return replace(scene, meshes=tuple(meshes), name=f"{scene.name} (small lamp)")


def overcast(scene: Scene) -> Scene:
    """The sky gives the same light from everywhere, and there is no sun."""
    sky = np.full((1, 1, 3), (0.9, 1.0, 1.1), np.float32)
    return replace(scene, lights=(), environment=Environment(sky), name=f"{scene.name} (overcast)")


def turned(scene: Scene) -> Scene:
    """The sky is turned by a quarter about the vertical."""
    assert scene.environment is not None
    quarter = np.array([(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
    environment = replace(scene.environment, to_world=quarter @ np.asarray(scene.environment.to_world))
    return replace(scene, environment=environment, name=f"{scene.name} (turned)")


def _scaled(value: Value, factor: float) -> Value:
    r, g, b = value.constant
    return replace(value, constant=rgb(factor * r, factor * g, factor * b).constant)


def _paint(r: float, g: float, b: float) -> dict[str, object]:
    return {"type": "diffuse", "reflectance": (r, g, b)}


ROOMS: dict[str, BenchmarkScene] = {
    **{
        name: SCENES[name]
        for name in (
            "cornell-box", "glossy-box", "glossy-box-0.4", "two-rooms", "door-ajar", "atrium", "living-room", "classroom",
            "sponza", "sponza-polished", "sibenik", "sibenik-polished",
        )
    },
    "cornell-white": replace(
        SCENES["cornell-box"], materials={"red": _paint(0.8, 0.8, 0.8), "green": _paint(0.8, 0.8, 0.8)}
    ),
    "cornell-small-lamp": replace(SCENES["cornell-box"], change=small_lamp),
    "two-rooms-red": replace(SCENES["two-rooms"], materials={"white": _paint(0.7, 0.25, 0.2)}),
    "door-ajar-white": replace(SCENES["door-ajar"], materials={"walls": _paint(0.85, 0.85, 0.85)}),
    "atrium-evening": replace(SCENES["atrium"], parameters={"sun_elevation": 15.0}),
    "atrium-overcast": replace(SCENES["atrium"], change=overcast),
    "living-room-turned": replace(SCENES["living-room"], change=turned),
    "classroom-overcast": replace(SCENES["classroom"], change=overcast),
}  # fmt: skip
"""The names of the scenes; those of files are found through ECLAT_SCENES."""
