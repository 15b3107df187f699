# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Two rooms with a closed wall between them. The light is in one room, so no light reaches the other."""

from __future__ import annotations

from eclat.errors import EclatError
from eclat.scene import Camera, Material, Scene, grey, look_at, rgb
from eclat.scenes.geometry import box, mesh


def build(wall_thickness: float = 0.01) -> Scene:
    """Build the scene. The first camera looks at the lit side of the wall, the second at its dark side.

    Each room is 2 m wide, 2.5 m high and 3 m deep. The middle of the wall is at x = 0, the light at x < 0.

    Parameters
    ----------
    wall_thickness
        Thickness of the wall in metres, above 0 and at most 1.
    """
    if not 0 < wall_thickness <= 1:
        raise EclatError(
            f"built-in scene two-rooms: expected wall_thickness above 0 and at most 1, got {wall_thickness}"
        )
    half = wall_thickness / 2
    white = Material("diffuse", {"reflectance": rgb(0.75, 0.72, 0.68)}, name="white")
    blue = Material("diffuse", {"reflectance": rgb(0.2, 0.35, 0.6)}, name="blue")
    lamp = Material("diffuse", {"reflectance": grey(0.5)}, name="lamp", emission=rgb(12, 11, 9))
    # The wall passes through the shell, so that its edges are outside the rooms.
    meshes = (
        mesh([box((-2, 0, -1.5), (2, 2.5, 1.5)).inside_out()], white, "shell"),
        mesh([box((-half, -0.1, -1.6), (half, 2.6, 1.6))], white, "wall"),
        mesh([box((-1.2, 2.35, -0.3), (-0.8, 2.45, 0.3))], lamp, "lamp"),
        mesh([box((-1.4, -0.05, -1.1), (-0.8, 0.6, -0.5)), box((0.8, -0.05, -1.1), (1.4, 0.6, -0.5))], blue, "boxes"),
    )
    cameras = (
        Camera(look_at((-1.8, 1.3, 1.3), (-0.1, 1.0, -0.6)), fov=60, size=(512, 384), name="lit"),
        Camera(look_at((1.8, 1.3, 1.3), (0.1, 1.0, -0.6)), fov=60, size=(512, 384), name="dark"),
    )
    return Scene(meshes=meshes, cameras=cameras, name="two-rooms")
