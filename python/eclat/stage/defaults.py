# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Overrides of a scene by the user, and the default camera and light of a scene that has none."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from eclat.daylight.sky import sun_direction, sun_sky, upright_frame
from eclat.errors import EclatError, warn
from eclat.images.tone import srgb_decode
from eclat.loaders.files import read_bytes
from eclat.loaders.images import read_image_file
from eclat.loaders.linear_images import check_growth
from eclat.measure.photometry import LUMENS_PER_WATT
from eclat.scene import (
    Camera,
    DirectionalLight,
    Environment,
    FloatArray,
    Material,
    Mesh,
    Scene,
    grey,
    look_at,
)
from eclat.scenes.geometry import icosphere
from eclat.stage.framing import framed_camera, free_distances, sky_above, sphere_directions
from eclat.stage.surface import emits, is_part, surface

Point = tuple[float, float, float]

GROUND_ALBEDO = 0.2
"""Albedo of the ground below the horizon of the default sky, that of grass and soil."""
SUN_ELEVATION = 48.0
"""Elevation of the default sun in degrees."""
SUN_ASIDE = 50.0
"""Angle in degrees between the azimuth of the default sun and the direction straight behind the camera."""


def complete(
    scene: Scene,
    *,
    camera_from: Point | None = None,
    camera_to: Point | None = None,
    camera_up: Point | None = None,
    fov: float | None = None,
    sun: tuple[float, float] | None = None,
    environment: Path | Point | None = None,
    size: tuple[int, int] | None = None,
) -> Scene:
    """Apply the overrides of the user to a scene, and add a camera and a light if it has none.

    Parameters
    ----------
    camera_from, camera_to, camera_up
        Position of the cameras, the point at which they look, and the upward direction of the picture. What is None
        stays as it is in each camera. If the scene has no camera and only `camera_from` is given, the camera looks at
        the middle of the scene.
    fov
        Vertical field of view of the cameras in degrees.
    sun
        Azimuth from north and elevation in degrees of a sun that, with a sky, replaces the scene's suns and
        environment.
    environment
        An EXR, HDR, PFM or other image file, or a constant radiance, that replaces the scene's environment.
    size
        Width and height of the pictures in pixels.

    Returns
    -------
    Scene
        The changed scene. A missing camera or light is added with a warning: a camera that shows the scene; a sun and a
        sky, or, in a closed room, a small lamp that gives a radiance of about 1 W·sr⁻¹·m⁻².

    Raises
    ------
    EclatError
        A number is out of range, a camera looks at its own position, or an image cannot be read.
    """
    scene = _with_camera(scene, camera_from, camera_to, camera_up, fov, size)
    if environment is not None:
        scene = replace(scene, environment=_environment(environment, scene.up))
    if sun is not None:
        scene = _with_sun(scene, sun, keep_environment=environment is not None)
    if not has_light(scene):
        scene = _with_light(scene)
    return scene


def wants_exposure(
    scene: Scene, *, sun: tuple[float, float] | None = None, environment: Path | Point | None = None
) -> bool:
    """Return whether `complete`, with these overrides, lights the scene by real daylight or by a default lamp, or whether its
    light is in candela and lux.

    The brightness of such pictures was not chosen for a screen, so they are displayed with `auto_exposure`.
    """
    return scene.photometric or sun is not None or (environment is None and not has_light(scene))


def has_light(scene: Scene) -> bool:
    """Return whether the scene has a light, an environment or a material that emits."""
    return bool(scene.lights) or scene.environment is not None or any(emits(m.material) for m in scene.meshes)


def _with_camera(
    scene: Scene,
    origin: Point | None,
    target: Point | None,
    up: Point | None,
    fov: float | None,
    size: tuple[int, int] | None,
) -> Scene:
    for name, vector in (("from", origin), ("to", target), ("up", up)):
        if vector is not None and not np.isfinite(vector).all():
            raise EclatError(f"camera-{name}: expected three finite numbers, got {vector}")
    if up is not None and not np.any(up):
        raise EclatError(f"camera-up: expected a direction, got {up}")
    if fov is not None and not 0 < fov < 180:
        raise EclatError(f"fov: expected degrees between 0 and 180, got {fov}")
    if size is not None and min(size) < 1:
        raise EclatError(f"size: expected at least 1×1 pixels, got {size[0]}×{size[1]}")
    cameras = scene.cameras
    if not cameras:
        camera, kind = framed_camera(scene)
        if origin is None:
            warn(f"the scene has no camera: {_VIEWS[kind]}")
        elif target is None:
            target = _middle(scene)
        cameras = (camera,)
    return replace(scene, cameras=tuple(_overridden(c, scene, origin, target, up, fov, size) for c in cameras))


_VIEWS = {
    "room": "it looks like a room, so a camera is placed inside",
    "stage": "it looks like a room with one open side, so a camera is placed in front of that side",
    "object": "a camera is placed outside of it",
    "nothing": "nor any surface, so the picture will be empty",
}
"""The views of a default camera, by the kind of scene that `framed_camera` recognises, as the warning states them."""


def _overridden(
    camera: Camera,
    scene: Scene,
    origin: Point | None,
    target: Point | None,
    up: Point | None,
    fov: float | None,
    size: tuple[int, int] | None,
) -> Camera:
    if origin is not None or target is not None or up is not None:
        matrix = np.asarray(camera.to_world, dtype=np.float64)
        eye = matrix[:3, 3] if origin is None else np.array(origin)
        ahead = eye - matrix[:3, 2] if target is None else np.array(target)
        try:
            placed = look_at(_point(eye), _point(ahead), up or scene.up)
        except ValueError:
            raise EclatError(
                f"camera-from, camera-to: expected two different points, got {_point(eye)} twice"
            ) from None
        camera = replace(camera, to_world=placed)
    if fov is not None:
        camera = replace(camera, fov=fov, fov_axis="y", projection="perspective")
    return camera if size is None else replace(camera, size=size)


def _with_sun(scene: Scene, sun: tuple[float, float], keep_environment: bool) -> Scene:
    others = tuple(
        light for light in scene.lights if not (isinstance(light, DirectionalLight) and light.angular_radius > 0)
    )
    scene = replace(scene, lights=others, environment=scene.environment if keep_environment else None)
    return _with_daylight(scene, sun, "sun" if keep_environment else "sunsky")


def _with_daylight(scene: Scene, sun: tuple[float, float], parts: Literal["sun", "sunsky"]) -> Scene:
    """Add daylight of its real intensity in the units of the scene; pictures then need an exposure."""
    scale = LUMENS_PER_WATT if scene.photometric else 1.0
    to_sun = sun_direction(*sun, scene.up)
    light, sky = sun_sky(to_sun, up=scene.up, albedo=GROUND_ALBEDO, sun_scale=scale, sky_scale=scale, parts=parts)
    lights = scene.lights if light is None else (*scene.lights, light)
    return replace(scene, lights=lights, environment=sky or scene.environment)


def _environment(source: Path | Point, up: Point) -> Environment:
    if isinstance(source, tuple):
        if not np.isfinite(source).all() or min(source) < 0:
            raise EclatError(f"environment: expected three finite numbers of at least 0, got {source}")
        return Environment(np.array(source, dtype=np.float32).reshape(1, 1, 3))
    path = Path(source)
    data = read_bytes(path, where="environment")
    try:
        image, linear = read_image_file(path, data)
        # In the environment each texel takes three floats, in addition to the memory of the decoded image.
        check_growth(12 * image.shape[0] * image.shape[1], len(data))
    except EclatError as error:
        raise EclatError(f"environment: {path}: {error}") from None
    image = np.repeat(image, 3, axis=2) if image.shape[2] == 1 else image[..., :3]
    if not linear:
        warn(f"environment: {path.name} holds no values brighter than white, so a sun in it will be too dim")
    if image.dtype == np.uint8:
        # The values are decoded with a table, because float64 texels would take gigabytes for a picture of some
        # kilobytes.
        return Environment(srgb_decode(np.arange(256) / 255).astype(np.float32)[image], upright_frame(up))
    colour: FloatArray = image.astype(np.float32) if linear else srgb_decode(image).astype(np.float32)
    good = np.isfinite(colour) & (colour >= 0)
    if not good.all():
        warn(
            f"environment: {path.name} has {int((~good).sum())} values that are negative or not finite; they are replaced by 0"
        )
        colour = np.where(good, colour, np.float32(0))
    return Environment(np.ascontiguousarray(colour), upright_frame(up))


def _with_light(scene: Scene) -> Scene:
    camera = scene.cameras[0]
    if len(surface(scene)) == 0 or _rays_escape(scene, camera):
        warn("the scene has no light: a sun and a sky are added")
        ahead = -np.asarray(upright_frame(scene.up).T @ np.asarray(camera.to_world)[:3, 2])
        azimuth = math.degrees(math.atan2(ahead[0], -ahead[2])) + 180 + SUN_ASIDE
        return _with_daylight(scene, (azimuth, SUN_ELEVATION), "sunsky")
    warn("the scene has no light, and the camera is in a closed room: a lamp under the ceiling is added")
    return replace(scene, meshes=(*scene.meshes, _lamp(scene, camera)))


def _lamp(scene: Scene, camera: Camera) -> Mesh:
    """Make a small spherical lamp. Its position is reached from the camera along rays that hit nothing, so it cannot be
    inside a wall."""
    matrix = np.asarray(camera.to_world, dtype=np.float64)
    up = upright_frame(scene.up)[:, 1]
    place = matrix[:3, 3]
    ahead = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    for direction, part in ((ahead, 0.12), (up, 0.72)):
        free = float(_free(scene, place, direction[None])[0])
        place = place + direction * (part * free if math.isfinite(free) else 0.0)
    distances = _free(scene, place, sphere_directions(128))
    distances = distances[np.isfinite(distances)]
    radius = 0.15 * float(distances.min())
    # In a cavity of area A and reflectance ½, a flux of π A gives a radiance near 1. A is about 4π times the mean
    # square distance, and the flux is π · 4π radius² times the radiance of the lamp.
    radiance = float(np.mean(distances**2)) / radius**2 * (LUMENS_PER_WATT if scene.photometric else 1.0)
    ball = icosphere(2)
    glow = Material("diffuse", {"reflectance": grey(0.0)}, name="default lamp", emission=grey(radiance))
    return Mesh(place + radius * ball.positions, ball.triangles, glow, name="default lamp")


def _openness(scene: Scene, camera: Camera) -> float:
    """Return the share of the rays from the camera that leave the scene, 0..1."""
    if len(surface(scene)) == 0:
        return 1.0
    origin = np.asarray(camera.to_world, dtype=np.float64)[:3, 3]
    if not is_part(scene):
        return float(np.isinf(_free(scene, origin, sphere_directions(64))).mean())
    share = float(np.isinf(_free(scene, origin, sphere_directions(1024))).mean())
    # A smaller share of rays may have passed through cracks between cells.
    return share if share > 0.005 else 0.0


def _free(scene: Scene, origin: FloatArray, directions: FloatArray) -> FloatArray:
    """Return the free distances (N,) in metres from a point along unit directions (N, 3); they are infinite for rays
    that leave the scene. In scenes with many triangles they are computed on a grid.
    """
    if is_part(scene):
        return free_distances(scene, origin, directions)
    return _distances(surface(scene), origin, directions)


def _rays_escape(scene: Scene, camera: Camera) -> bool:
    """Return whether rays from the camera leave the scene, or rays that go up from the surfaces that they hit, as under
    an arcade, which hides the sky from the camera."""
    return _openness(scene, camera) > 0 or sky_above(scene, camera)


def _distances(corners: FloatArray, origins: FloatArray, directions: FloatArray) -> FloatArray:
    """Compute the distances (N,) to triangles (T, 3, 3) along unit directions (N, 3) from one origin or N origins.

    The distance is infinite for rays that hit nothing. The test is that of [MollerTrumbore97], for some thousand
    triangles at a time. Rays that hit an edge count as hits, so that a crack between triangles does not look like a
    window.
    """
    nearest = np.full(len(directions), np.inf)
    # Positions are relative to the first origin, which preserves precision in scenes far from zero.
    centre = np.atleast_2d(origins)[0]
    start_at = np.broadcast_to(origins, directions.shape) - centre
    moment = np.cross(directions, start_at)
    for start in range(0, len(corners), 4096):
        a, b, c = np.moveaxis(corners[start : start + 4096] - centre, 1, 0)
        normal = np.cross(b - a, c - a)
        # These are scalar triple products of directions, edges and origins, written as matrix products.
        u = directions @ np.cross(c, a).T + moment @ (c - a).T
        v = directions @ np.cross(a, b).T + moment @ (a - b).T
        slope = directions @ normal.T
        with np.errstate(divide="ignore", invalid="ignore"):
            u, v = u / slope, v / slope
            t = (np.einsum("tk,tk->t", a, normal) - start_at @ normal.T) / slope
            hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0) & np.isfinite(t)
        nearest = np.minimum(nearest, np.where(hit, t, np.inf).min(axis=1))
    return nearest


def _middle(scene: Scene) -> Point:
    corners = surface(scene).reshape(-1, 3)
    return _point((corners.min(axis=0) + corners.max(axis=0)) / 2) if len(corners) else (0.0, 0.0, 0.0)


def _point(vector: FloatArray) -> Point:
    return float(vector[0]), float(vector[1]), float(vector[2])
