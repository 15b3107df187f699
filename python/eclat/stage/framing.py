# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The choice of a view for a scene without a camera: from outside for an object, from inside for a room.

The choice is made on a coarse grid of occupied cells, so that it takes only a second for a million triangles. Lengths
are in cells, and +y is up: the scene is first rotated upright, and the choice does not depend on its size or position.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eclat.daylight.sky import upright_frame
from eclat.scene import Camera, DirectionalLight, FloatArray, Mesh, Scene, look_at
from eclat.stage.surface import emits, surface

CELLS = 96
"""Number of cells of the grid along the longest side of the scene."""
ROOM_FOV, OBJECT_FOV = 65.0, 40.0
"""Field of view of the default camera inside a room and outside of an object, in degrees."""
_LAMPS = 16
"""The largest number of lamps from which rays are sent to find whether surfaces enclose them."""
THREE_QUARTER = np.array([0.55, 0.38, 0.74])
"""Direction from the middle of an object to the camera: to the right, above and in front (+z) of the object."""


@dataclass(frozen=True, eq=False)
class Grid:
    """A grid of cells. For each cell it holds whether the cell contains a surface, and the mean normal of that surface.
    Cell (0, 0, 0) begins at `low`; `cell` is the side of a cell in metres.
    """

    occupied: NDArray[np.bool_]
    normals: NDArray[np.float32]
    low: FloatArray
    cell: float

    def march(self, origins: FloatArray, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Find the first occupied cell along rays (N, 3); return its distance (N,) in cells and the facing (N,) of its
        surface.

        The distance is infinite for rays that leave the grid. The facing is the cosine between the mean normal of the
        cell and the reversed ray; it is positive if the ray hits the front.
        """
        count = len(origins)
        distance, facing = np.full(count, np.inf), np.zeros(count)
        alive = np.arange(count)
        shape = np.array(self.occupied.shape)
        for step in np.arange(1.0, float(np.linalg.norm(shape)), 0.5):
            index = np.floor(origins[alive] + step * directions[alive]).astype(np.int64)
            inside = ((index >= 0) & (index < shape)).all(axis=1)
            alive, index = alive[inside], index[inside]
            hit = self.occupied[tuple(index.T)]
            distance[alive[hit]] = step
            normal = self.normals[tuple(index[hit].T)]
            facing[alive[hit]] = -np.einsum("ij,ij->i", normal, directions[alive[hit]])
            alive = alive[~hit]
            if len(alive) == 0:
                break
        return distance, facing


def free_distances(scene: Scene, origin: FloatArray, directions: FloatArray) -> FloatArray:
    """Return distances (N,) in metres from a point along unit directions (N, 3) up to which there is certainly no
    surface.

    They are found on the grid, so they are up to three cells too short, and infinite where a ray leaves the scene.
    """
    upright = upright_frame(scene.up)
    corners = _without_strays(surface(scene) @ upright)
    grid = _grid(corners, corners.min(axis=(0, 1)), corners.max(axis=(0, 1)))
    if grid is None:
        return np.full(len(directions), np.inf)
    place = (np.asarray(origin, dtype=np.float64) @ upright - grid.low) / grid.cell
    distance, _ = grid.march(np.tile(place, (len(directions), 1)), directions @ upright)
    # A ray has entered the cell up to half a step before, and the surface may be nearer than the cell's middle.
    free: FloatArray = np.maximum(distance - 2.0, 0.1) * grid.cell
    return free


def _place_in(grid: Grid, camera: Camera, upright: FloatArray) -> FloatArray:
    """Return the position of the camera in units of the grid's cells."""
    place: FloatArray = (np.asarray(camera.to_world, dtype=np.float64)[:3, 3] @ upright - grid.low) / grid.cell
    return place


def framed_camera(scene: Scene) -> tuple[Camera, str]:
    """Choose a camera that shows the scene; return it with the kind of the scene: "room", "stage" (a room with one open
    side), "object" or "nothing"."""
    upright = upright_frame(scene.up)
    corners = _without_strays(surface(scene) @ upright)
    if len(corners) == 0:
        return Camera(look_at((0, 0, 5), (0, 0, 0)), fov=OBJECT_FOV, fov_axis="smaller"), "nothing"
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    grid = _grid(corners, low, high)
    if grid is not None:
        eyes = _eyes(grid, any_side=_is_lit_within(scene, grid, upright))
        side = _open_side(grid) if len(eyes) else None
        if side is not None:
            return Camera(_placed(upright, *_stage_view(low, high, side)), fov=OBJECT_FOV, fov_axis="smaller"), "stage"
        view = _room_view(grid, eyes)
        if view is not None:
            return Camera(_placed(upright, *view), fov=ROOM_FOV, fov_axis="x"), "room"
    return Camera(_placed(upright, *_object_view(corners, low, high)), fov=OBJECT_FOV, fov_axis="smaller"), "object"


def _without_strays(corners: FloatArray) -> FloatArray:
    """Remove the triangles (T, 3, 3) that lie more than a thousand median distances from the median of all corners.

    Otherwise a stray triangle, such as one at the origin of a national grid, would make the room a point in the
    picture.
    """
    if len(corners) == 0:
        return corners
    points = corners.reshape(-1, 3)
    distance = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    near: FloatArray = corners[(distance <= 1e3 * np.median(distance)).reshape(-1, 3).all(axis=1)]
    return near if len(near) else corners


def sky_above(scene: Scene, camera: Camera) -> bool:
    """Return whether the sky lights anything that the camera can see, even if a roof hides the sky itself."""
    upright = upright_frame(scene.up)
    corners = _without_strays(surface(scene) @ upright)
    if len(corners) == 0:
        return True
    grid = _grid(corners, corners.min(axis=(0, 1)), corners.max(axis=(0, 1)))
    if grid is None:
        return True
    eye = _place_in(grid, camera, upright)
    around = sphere_directions(512)
    distance, _ = grid.march(np.tile(eye, (512, 1)), around)
    seen = np.isfinite(distance) & (distance > 2)
    # The rays start more than one cell in front of the surface, because a ray that starts in an occupied cell would end
    # there.
    places = eye + (distance[seen] - 2)[:, None] * around[seen]
    upwards = np.array([0.0, 1.0, 0.0]) + 0.7 * sphere_directions(16)
    upwards /= np.linalg.norm(upwards, axis=1, keepdims=True)
    distance, _ = grid.march(np.repeat(places, 16, axis=0), np.tile(upwards, (len(places), 1)))
    # A smaller share of rays may have passed through cracks between cells.
    return bool(np.isinf(distance).sum() > 0.005 * max(len(distance), 1))


def usual_bounds(scene: Scene) -> tuple[FloatArray, FloatArray] | None:
    """Return the corners (3,) of the box around the scene's surfaces without its stray parts; None if it has none."""
    corners = _without_strays(surface(scene))
    if len(corners) == 0:
        return None
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    return (low, high) if (low < high).any() else None


def _placed(upright: FloatArray, origin: FloatArray, target: FloatArray) -> FloatArray:
    o, t = (tuple(float(c) for c in p) for p in (origin, target))
    matrix = np.eye(4)
    matrix[:3, :3] = upright
    placed: FloatArray = matrix @ look_at((o[0], o[1], o[2]), (t[0], t[1], t[2]))
    return placed


def _object_view(corners: FloatArray, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    centre = (low + high) / 2
    radius = float(np.linalg.norm(corners.reshape(-1, 3) - centre, axis=1).max())
    radius = max(radius, 1e-6 * float(np.abs(centre).max()), 1e-12)
    away = THREE_QUARTER / np.linalg.norm(THREE_QUARTER)
    return centre + away * (1.03 * radius / math.sin(math.radians(OBJECT_FOV / 2))), centre


def _grid(corners: FloatArray, low: FloatArray, high: FloatArray) -> Grid | None:
    """Mark the cells that contain a surface, with about 8 random points per square cell of a triangle's area; return
    None if the scene has no extent."""
    cell = float(np.max(high - low)) / CELLS
    if cell == 0:
        return None
    shape = np.floor((high - low) / cell).astype(np.int64) + 1
    local = (corners - low) / cell
    cross = np.cross(local[:, 1] - local[:, 0], local[:, 2] - local[:, 0])
    # Each point represents about the same area, so that sums of normals are means over the surface.
    points = np.ceil(4 * np.linalg.norm(cross, axis=1)).astype(np.int64) + 1
    which = np.repeat(np.arange(len(local)), points)
    u, v = np.random.default_rng(1).random((2, len(which)))
    fold = u + v > 1
    u, v = np.where(fold, 1 - u, u), np.where(fold, 1 - v, v)
    a, b, c = (local[which, k] for k in range(3))
    index = np.floor(a + u[:, None] * (b - a) + v[:, None] * (c - a)).astype(np.int64)
    index = np.clip(index, 0, shape - 1)
    flat = np.ravel_multi_index((index[:, 0], index[:, 1], index[:, 2]), tuple(shape))
    weight = cross[which] / points[which, None]
    cells = int(np.prod(shape))
    sums = np.stack([np.bincount(flat, weight[:, k], cells) for k in range(3)], axis=1)
    normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
    occupied = np.bincount(flat, minlength=cells) > 0
    return Grid(occupied.reshape(shape), normals.astype(np.float32).reshape(*shape, 3), low, cell)


def _open_side(grid: Grid) -> tuple[int, int] | None:
    """Find the one side on which a room has no wall, like a doll's house: its horizontal axis (0 or 2) and sign; None
    if there is no such side or more than one."""
    found = []
    for axis in (0, 2):
        middle = grid.occupied.shape[axis] // 2
        for sign, half in ((-1, slice(None, middle)), (1, slice(middle, None))):
            wall = np.take(grid.occupied, np.arange(grid.occupied.shape[axis])[half], axis=axis)
            shadow = np.asarray(wall.any(axis=axis))
            # The margin of two cells excludes the edges of floor and ceiling; objects inside may hide a part of the
            # opening.
            if shadow[2:-2, 2:-2].mean() < 0.35:
                found.append((axis, sign))
    return found[0] if len(found) == 1 else None


def _stage_view(low: FloatArray, high: FloatArray, side: tuple[int, int]) -> tuple[FloatArray, FloatArray]:
    axis, sign = side
    centre, half = (low + high) / 2, (high - low) / 2
    opening = centre.copy()
    opening[axis] += sign * half[axis]
    eye = opening.copy()
    eye[axis] += sign * 1.03 * max(half[1], half[2 - axis]) / math.tan(math.radians(OBJECT_FOV / 2))
    return eye, opening


def _room_view(grid: Grid, eyes: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Choose the position and the target of a camera in a room, along its longest free line of sight; None if the scene
    is better seen from outside."""
    if len(eyes) == 0:
        return None
    angles = np.arange(48) * (2 * math.pi / 48)
    fan = np.stack([np.sin(angles), np.zeros(48), np.cos(angles)], axis=1)
    distance, _ = grid.march(np.repeat(eyes, 48, axis=0), np.tile(fan, (len(eyes), 1)))
    # Rays that leave the scene count as hitting a near wall, so that the view is not out of the open side of an arcade.
    distance = np.where(np.isfinite(distance), distance, 4.0).reshape(len(eyes), 48)
    breadth = np.mean([np.roll(distance, k, axis=1) for k in range(-3, 4)], axis=0)
    clearance = distance.min(axis=1, keepdims=True)
    score = np.where(
        clearance >= 2.5, breadth + 0.5 * np.minimum(distance, 3 * breadth) + 2 * np.minimum(clearance, 6), -1.0
    )
    best = int(np.argmax(score))
    if score.flat[best] < 0:
        return None
    row, column = divmod(best, 48)
    eye = eyes[row]
    target = eye + fan[column] * breadth[row, column] * (1.0, 0.0, 1.0)
    return grid.low + grid.cell * eye, grid.low + grid.cell * target


def _is_lit_within(scene: Scene, grid: Grid, upright: FloatArray) -> bool:
    """Return whether all light comes from lamps that surfaces enclose, and these surfaces reflect on both sides.

    Such a scene is a room even if the normals of its walls point outwards, because the picture from outside is black.
    """
    if scene.environment is not None or any(isinstance(light, DirectionalLight) for light in scene.lights):
        return False
    if not any(mesh.material.two_sided for mesh in scene.meshes if not emits(mesh.material)):
        return False
    lamps: list[tuple[FloatArray, FloatArray]] = [
        (np.array([light.position]), np.zeros((1, 3)))
        for light in scene.lights
        if not isinstance(light, DirectionalLight)
    ]
    lamps += [_some_triangles(mesh) for mesh in scene.meshes if emits(mesh.material) and len(mesh.triangles)]
    if not lamps:
        return False
    places, axes = (np.concatenate(parts) for parts in zip(*lamps[:_LAMPS], strict=True))
    origins = np.repeat((places @ upright - grid.low) / grid.cell, 48, axis=0)
    directions = np.tile(sphere_directions(48), (len(places), 1))
    # A lamp on a wall lights only the side of its normal.
    lit = np.einsum("ij,ij->i", np.repeat(axes @ upright, 48, axis=0), directions) >= 0
    distance, _ = grid.march(origins[lit], directions[lit])
    # A smaller share of rays may have passed through cracks between cells.
    return bool(np.isfinite(distance).mean() > 0.98)


def _some_triangles(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Return the middles (N, 3) of some triangles of a lamp, and its normals (N, 3), which are 0 if both sides emit."""
    chosen = mesh.triangles[:: max(1, len(mesh.triangles) // 8)]
    a, b, c = np.moveaxis(np.asarray(mesh.positions, dtype=np.float64)[chosen], 1, 0)
    normals = np.zeros_like(a) if mesh.material.emission_two_sided else np.cross(b - a, c - a)
    return (a + b + c) / 3, normals


def _eyes(grid: Grid, any_side: bool) -> FloatArray:
    """Find positions at eye height inside a room: there is a floor below, and most rays hit a surface from its front,
    or from any side with `any_side`."""
    shape = np.array(grid.occupied.shape)
    if shape.min() < 6:
        return np.zeros((0, 3))
    fractions = np.linspace(0.06, 0.94, 13)
    x, y, z = np.meshgrid(fractions * shape[0], np.array([0.3, 0.5]) * shape[1], fractions * shape[2], indexing="ij")
    places = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    places = places[~grid.occupied[tuple(np.floor(places).astype(np.int64).T)]]
    down, level = grid.march(places, np.tile([0.0, -1.0, 0.0], (len(places), 1)))
    up, _ = grid.march(places, np.tile([0.0, 1.0, 0.0], (len(places), 1)))
    up = np.minimum(up, shape[1] - places[:, 1])
    stands = np.isfinite(down)
    places, down, up = places[stands], down[stands], up[stands]
    # A room has a level floor, unlike the inside of a pot, which is round.
    level = np.abs(level[stands]) if any_side else level[stands]
    if len(places) == 0 or (level > 0.97).mean() < 0.5:
        return np.zeros((0, 3))
    height = np.minimum(0.4 * (down + up), 0.12 * math.hypot(float(shape[0]), float(shape[2])))
    eyes = places + np.stack([0 * height, np.maximum(height, 2.0) - down, 0 * height], axis=1)
    eyes = eyes[~grid.occupied[tuple(np.floor(eyes).astype(np.int64).T)]]
    directions = sphere_directions(48)
    distance, facing = grid.march(np.repeat(eyes, 48, axis=0), np.tile(directions, (len(eyes), 1)))
    hits = np.isfinite(distance).reshape(-1, 48)
    front = (hits & (facing.reshape(-1, 48) > 0)).sum(axis=1) / np.maximum(hits.sum(axis=1), 1)
    inside = (hits.mean(axis=1) >= 0.7) & ((front >= 0.6) | any_side)
    # Any object may have a few such positions, for example between the legs of a chair; in a room most positions are
    # such.
    return eyes[inside] if len(eyes) and inside.mean() >= 0.35 else np.zeros((0, 3))


def sphere_directions(count: int) -> FloatArray:
    """Make `count` directions (N, 3) that are distributed evenly over the sphere, on a Fibonacci spiral."""
    k = np.arange(count) + 0.5
    y, angle = 1 - 2 * k / count, math.pi * (3 - math.sqrt(5)) * k
    r = np.sqrt(1 - y * y)
    return np.stack([r * np.cos(angle), y, r * np.sin(angle)], axis=1)
