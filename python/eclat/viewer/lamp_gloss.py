# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Direct light at records of radiance, as coefficients in the basis of the records, for the gloss that the page draws.

Records hold indirect light, because `eclat render` samples lamps for each pixel. The page cannot, so that the highlights of
lamps are added to the records: each lamp is a set of points, whose directions are projected like the rays of a gather. A
lobe that a record can hold is wider than the details that are lost thereby. Light of the sharp part of the sky is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eclat import _core, harmonics
from eclat.bridge.compiled import compiled
from eclat.gltf_export.textures import average, constant_of
from eclat.measure.photometry import luminance
from eclat.scene import DirectionalLight, FloatArray, Scene, SpotLight
from eclat.viewer.even_lights import even_light

POINTS = 256
"""Number of points on all glowing surfaces together."""

TIKHONOV = 1e-4
"""`radiance_tikhonov` of core/hemisphere/radiance_projection.h, which defines the basis."""

STEP = 0.25
"""Distance of the finite differences, in units of a record's radius."""

BATCH = 64
"""Records at a time, which bounds the memory."""


@dataclass(frozen=True)
class Emitters:
    """Points that emit, and suns: `position` is infinitely far away for them, and `axis` is where their light goes."""

    position: FloatArray  # (P, 3) relative to the scene's center, NaN for suns
    axis: FloatArray  # (P, 3) normal of a glowing surface, axis of a spot, direction of a sun
    power: FloatArray  # (P, 3) radiance times area, intensity, or irradiance
    kind: np.ndarray  # (P,) one of SURFACE, TWO_SIDED, LAMP, SUN
    lamp: list[object]  # the light of each point; None for surfaces


SURFACE, TWO_SIDED, LAMP, SUN = range(4)


def emitters_of(scene: Scene) -> Emitters:
    """Return the emitters of a scene; the points on surfaces are the same for all records."""
    center = compiled(scene).center
    found: list[tuple[FloatArray, FloatArray, FloatArray, int, object]] = []
    glowing = _glowing_triangles(scene, center)
    areas = np.array([0.5 * np.linalg.norm(np.cross(c[1] - c[0], c[2] - c[0])) for c, _, _ in glowing])
    for i, share in _chosen(areas * np.array([luminance(radiance) for _, radiance, _ in glowing])):
        corners, radiance, kind = glowing[i]
        axis = np.cross(corners[1] - corners[0], corners[2] - corners[0]) / (2 * areas[i])
        places = _places(corners, max(1, POINTS // len(glowing)))
        found += [(p, axis, radiance * (share * areas[i] / len(places)), kind, None) for p in places]
    for light in map(even_light, scene.lights):
        if isinstance(light, DirectionalLight):
            axis = np.asarray(light.direction, float) / np.linalg.norm(light.direction)
            found.append((np.full(3, np.nan), axis, np.asarray(light.irradiance, float), SUN, light))
        else:
            axis = np.asarray(light.direction if isinstance(light, SpotLight) else (0, 0, 1), float)
            position = np.asarray(light.position, float) - center
            found.append((position, axis / np.linalg.norm(axis), np.asarray(light.intensity, float), LAMP, light))
    if not found:
        return Emitters(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, int), [])
    columns = list(zip(*found, strict=True))
    position, direction, power, kinds = (np.array(column) for column in columns[:4])
    return Emitters(position, direction, power, kinds, list(columns[4]))


def direct_coefficients(
    scene: Scene, positions: FloatArray, normals: FloatArray, radii: FloatArray, order: int
) -> np.ndarray:
    """Compute the coefficients (N, 3, order², 3) of direct light: values, and derivatives along u and v, of RGB.

    Parameters
    ----------
    positions : (N, 3) of the records, relative to the scene's center. `normals` are (N, 3) and `radii` (N,).
    """
    emitters = emitters_of(scene)
    out = np.zeros((len(positions), 3, order**2, 3))
    if not len(emitters.kind):
        return out
    to_basis = to_orthonormal(order)
    corners = np.concatenate([np.asarray(m.positions, float)[np.asarray(m.triangles)] for m in scene.meshes])
    scene_in_core, corners = compiled(scene).core, corners - compiled(scene).center
    for first in range(0, len(positions), BATCH):
        part = slice(first, first + BATCH)
        p, n, step = (
            positions[part].astype(float),
            normals[part].astype(float),
            STEP * radii[part].astype(float)[:, None],
        )
        seen = _visible(scene_in_core, corners, emitters, p, n, step)
        u, v = frames(n)
        for number, along in enumerate((None, u, v)):
            if along is None:
                out[part, 0] = _projected(emitters, p, n, seen, order, to_basis)
                continue
            ahead = _projected(emitters, p + step * along, n, seen, order, to_basis)
            behind = _projected(emitters, p - step * along, n, seen, order, to_basis)
            out[part, number] = (ahead - behind) / (2 * step[:, :, None])
    return out


def _chosen(powers: FloatArray) -> list[tuple[int, float]]:
    """Return the triangles that stand for all, with the factors of their power: all, or POINTS of them by their powers."""
    if len(powers) <= POINTS:
        return [(i, 1.0) for i in range(len(powers))]
    shares = powers / powers.sum()
    chosen = np.searchsorted(np.cumsum(shares), (np.arange(POINTS) + 0.5) / POINTS)
    return [(int(i), float(1 / (POINTS * shares[i]))) for i in np.minimum(chosen, len(powers) - 1)]


def _glowing_triangles(scene: Scene, center: FloatArray) -> list[tuple[FloatArray, FloatArray, int]]:
    found = []
    for mesh in scene.meshes:
        if mesh.material.emission is None:
            continue
        radiance = np.array(constant_of(average(mesh.material.emission)))
        kind = TWO_SIDED if mesh.material.emission_two_sided else SURFACE
        if luminance(radiance) > 0:
            corners = np.asarray(mesh.positions, float)[np.asarray(mesh.triangles)] - center
            areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
            found += [(triangle, radiance, kind) for triangle in corners[areas > 0]]
    return found


def _places(corners: FloatArray, count: int) -> FloatArray:
    """Return `count` points (count, 3), evenly distributed over a triangle."""
    i = np.arange(count) + 0.5
    a, b = i / count, (i * 0.6180339887498949) % 1
    root = np.sqrt(a)
    weights = np.stack([1 - root, root * (1 - b), root * b], axis=1)
    places: FloatArray = weights @ corners
    return places


def frames(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the axes u and v (N, 3) of `Frame::around` of the core."""
    x, y, z = normal.T
    sign = np.copysign(1.0, z)
    a = -1 / (sign + z)
    b = x * y * a
    u = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1)
    return u, np.stack([b, sign + y * y * a, -y], axis=1)


def to_orthonormal(order: int) -> np.ndarray:
    """Return the matrix that `HemisphereFit::orthonormalize` of the core applies to inner products."""
    directions, weights = harmonics.quadrature(2 * order, "hemisphere")
    values = harmonics.evaluate("spherical", order, directions)
    gram = values.T @ (values * weights[:, None]) + TIKHONOV * np.eye(order**2)
    inverse: np.ndarray = np.linalg.inv(np.linalg.cholesky(gram))
    return inverse


def _towards(emitters: Emitters, p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the directions (N, P, 3) to the emitters and the distances (N, P), infinite for suns."""
    away = emitters.position - p[:, None]
    distance = np.linalg.norm(away, axis=2)
    sun = emitters.kind == SUN
    distance[:, sun] = np.inf
    direction = np.where(
        sun[:, None], -emitters.axis, away / np.maximum(np.linalg.norm(away, axis=2), 1e-30)[..., None]
    )
    return direction, distance


def _projected(
    emitters: Emitters, p: FloatArray, n: FloatArray, seen: np.ndarray, order: int, to_basis: np.ndarray
) -> np.ndarray:
    """Return the coefficients (N, order², 3) of the light of the emitters that are `seen` (N, P)."""
    direction, distance = _towards(emitters, p)
    u, v = frames(n)
    local = np.stack([(direction * axis[:, None]).sum(axis=2) for axis in (u, v, n)], axis=2)
    leaving = -(direction * emitters.axis).sum(axis=2)
    square = np.square(distance)
    factor = np.ones_like(distance)
    for number, (kind, lamp) in enumerate(zip(emitters.kind, emitters.lamp, strict=True)):
        if kind == LAMP:
            factor[:, number] = _falloff(lamp, leaving[:, number]) / square[:, number]
    surface = (emitters.kind == SURFACE) | (emitters.kind == TWO_SIDED)
    facing = np.where(emitters.kind == TWO_SIDED, np.abs(leaving), np.maximum(leaving, 0))
    factor[:, surface] = (facing / square)[:, surface]
    factor *= seen & (local[..., 2] > 0)
    values = harmonics.evaluate("spherical", order, local.reshape(-1, 3)).reshape(*factor.shape, -1)
    inner = np.einsum("npi,np,pc->nic", values, factor, emitters.power, optimize=True)
    found: np.ndarray = np.einsum("ij,njc->nic", to_basis, inner)
    return found


def _falloff(light: object, cosine: FloatArray) -> FloatArray:
    """Return the share of its intensity that a lamp emits at the cosine from its axis."""
    found: FloatArray = np.ones_like(cosine)
    if not isinstance(light, SpotLight):
        return found
    inner, outer = np.radians(light.inner_angle), np.radians(light.outer_angle)
    if light.falloff == "linear":
        angle = np.arccos(np.clip(cosine, -1, 1))
        found = np.clip((outer - angle) / max(outer - inner, 1e-6), 0, 1)
    else:
        found = np.square(np.clip((cosine - np.cos(outer)) / max(np.cos(inner) - np.cos(outer), 1e-6), 0, 1))
    return found


def _visible(
    core: _core.Scene, corners: FloatArray, emitters: Emitters, p: FloatArray, n: FloatArray, step: FloatArray
) -> np.ndarray:
    """Return which emitters (N, P) the records see: what a ray meets first must not be nearer than the emitter."""
    direction, distance = _towards(emitters, p)
    origins = np.broadcast_to((p + 1e-3 * step * n)[:, None], direction.shape).reshape(-1, 3)
    rays = np.ascontiguousarray(direction.reshape(-1, 3), np.float32)
    hit = np.asarray(core.first_hits(np.ascontiguousarray(origins, np.float32), rays, 0))
    triangle = corners[np.maximum(hit, 0)]
    across = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
    steep = (across * rays).sum(axis=1)
    reached = (across * (triangle[:, 0] - origins)).sum(axis=1) / np.where(steep == 0, 1e-30, steep)
    free = (hit < 0) | (reached > distance.ravel() * (1 - 1e-3))
    seen: np.ndarray = free.reshape(distance.shape)
    return seen
