# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Directional light maps: from where the light of each texel comes, as spherical harmonics of order 1 in each channel.

A texel holds the coefficients c₀₀, c₁₋₁, c₁₀, c₁₁ of the radiance L(ω) that arrives on the side of its normal n₀, in the axes of
the world, for the constant 1/√4π and √(3/4π) times y, z and x. With Φ = ∫ L dω and M = ∫ L ω dω they are Φ/√4π and √(3/4π) M.
The irradiance for another normal n is, to the order that they hold [RamamoorthiHanrahan01],

    E(n) = Φ/4 + M·n/2

whereas E(n₀) = M·n₀ exactly, which is what the light map without directions holds. Its value has less noise than rays over the
hemisphere give, so M·n₀ is set to it.

===========  ===================================================================================================
Godot        Its shader multiplies the albedo by L₀ (1 + 4 (l₁·n)), with four slices: L₀ = Φ/4π, and l₁ = M/2Φ along y, z and
             x, stored as l₁/2 + 1/2.
Unity        Its shader multiplies the light map's value by (1/2 + n·d/2) / w, where d/2 + 1/2 and w are the red, green, blue
             and alpha of a second map: d = 2M/Φ of the luminance, no longer than 1, in axes with −x, and w = 1/2 + n₀·d/2,
             so that the surface's own normal gets the light map's value.
===========  ===================================================================================================
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.arguments import thread_count
from eclat.bridge.compiled import compiled
from eclat.bridge.running import run
from eclat.errors import warn
from eclat.lightmap.gathering import GatheredTexels, Settings, TexelPoints
from eclat.lightmap.solids import Mask
from eclat.measure.photometry import luminance
from eclat.methods import Direct
from eclat.methods.method import Prepared
from eclat.methods.work import AtPoints, Work
from eclat.scene import FloatArray, Scene

Directional = Literal["sh", "godot", "unity"]
"""The layouts of files that say from where the light comes."""

ORDER = 2
"""Number of bands."""

FLUX = 1 / math.sqrt(4 * math.pi)
"""c₀₀ / Φ."""

MOMENT = math.sqrt(3 / (4 * math.pi))
"""The coefficients of the first band divided by M."""

AXES = (1, 2, 0)
"""The axes of the coefficients of the first band: y, z, x."""


def gather_harmonics(
    scene: Scene, gathered: GatheredTexels, points: TexelPoints, free: Mask, settings: Settings
) -> FloatArray:
    """Compute the coefficients (N, 4, 3) of N texels, as means over their points that are `free`, a mask (N, n)."""
    spread = free[:, 1:]
    where = np.nonzero(spread)
    chosen = where[0], where[1] + 1
    work = Work(settings.max_depth, settings.seed, thread_count(settings.threads), settings.progress)
    source = Direct() if settings.component == "direct" else gathered.source
    places = AtPoints(points.positions[chosen], points.normals[chosen])
    prepared = source if isinstance(source, Prepared) else source.prepare(scene, places, work)
    asked = _core.ProbeOptions(
        component=_core.Component[settings.component],
        order=ORDER,
        samples=math.ceil(settings.samples / spread.shape[1]),
        seed=settings.seed,
        threads=work.threads,
    )
    positions = compiled(scene).to_core(places.positions).astype(np.float32)
    normals = np.ascontiguousarray(places.normals, np.float32)
    estimator = prepared.radiance_estimator(scene, work)
    found, _, dropped = run(
        "directions",
        lambda p: _core.surface_probes(compiled(scene).core, positions, normals, estimator, asked, p),
        settings.progress,
        _core.Progress(),
    )
    if dropped:
        warn(f"bake: {dropped} rays found light that is not finite, and count as dark")
    total = np.zeros((*spread.shape, ORDER * ORDER, 3))
    total[where] = np.asarray(found, np.float64)
    count = np.maximum(spread.sum(axis=1), 1)
    harmonics = total.sum(axis=1) / count[:, None, None]
    mean_normal = (points.normals[:, 1:] * spread[..., None]).sum(axis=1)
    lengths = np.linalg.norm(mean_normal, axis=1, keepdims=True)
    normal = np.where(lengths > 0, mean_normal / np.where(lengths > 0, lengths, 1), points.normals[:, 0])
    return with_irradiance(harmonics, normal, gathered.values)


def with_irradiance(harmonics: FloatArray, normals: FloatArray, values: FloatArray) -> FloatArray:
    """Change the coefficients (N, 4, 3) along unit `normals` (N, 3), so that M · n₀ is the irradiance `values` (N, 3)."""
    along = normals[:, AXES]
    missing = values - np.einsum("nic,ni->nc", harmonics[:, 1:], along) / MOMENT
    out = harmonics.copy()
    out[:, 1:] += MOMENT * along[:, :, None] * missing[:, None]
    return out


def irradiance_for(harmonics: FloatArray, normals: FloatArray) -> FloatArray:
    """Compute the irradiance (..., 3) for unit normals (..., 3) from coefficients (..., 4, 3), to the order they hold."""
    along = np.asarray(normals)[..., AXES]
    flux, moment = harmonics[..., 0, :] / FLUX, harmonics[..., 1:, :] / MOMENT
    found: FloatArray = flux / 4 + np.einsum("...ic,...i->...c", moment, along) / 2
    return found


def for_godot(harmonics: FloatArray) -> NDArray[np.float32]:
    """Return the four slices one below the other, (4 · H, W, 3), of coefficients (H, W, 4, 3)."""
    flux, moment = harmonics[..., :1, :] / FLUX, harmonics[..., 1:, :] / MOMENT
    share = np.divide(moment, 2 * flux, out=np.zeros_like(moment), where=flux > 0)
    slices = np.concatenate((flux / (4 * math.pi), np.clip(share, -0.5, 0.5) / 2 + 0.5), axis=-2)
    return np.concatenate(np.moveaxis(slices, -2, 0)).astype(np.float32)


def for_unity(harmonics: FloatArray, irradiance: FloatArray) -> NDArray[np.uint8]:
    """Return the directionality map (H, W, 4) of coefficients (H, W, 4, 3) and the light map's `irradiance` (H, W, 3).

    Its w follows from E(n₀) = M·n₀, so no normal is needed.
    """
    flux = luminance(harmonics[..., 0, :]) / FLUX
    moment = np.stack([luminance(harmonics[..., i, :]) for i in (3, 1, 2)], axis=-1) / MOMENT
    safe = np.where(flux > 0, flux, 1)
    d = np.where(flux[..., None] > 0, 2 * moment / safe[..., None], 0)
    length = np.linalg.norm(d, axis=-1)
    shorter = np.where(length > 1, 1 / np.where(length > 0, length, 1), 1)
    w = 0.5 + np.where(flux > 0, luminance(irradiance) / safe, 0) * shorter
    direction = d * shorter[..., None] * np.array([-1.0, 1.0, 1.0])
    packed = np.concatenate((0.5 + direction / 2, w[..., None]), axis=-1)
    bytes_of: NDArray[np.uint8] = np.rint(np.clip(packed, 0, 1) * 255).astype(np.uint8)
    return bytes_of
