# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A transparent film: how much of each pixel surfaces cover, and the picture without its background."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import eclat
from eclat.scene import Material, Scene, grey

SAMPLES = 64
"""Paths per pixel of the two pictures, which end where they first meet something."""


def without_background(image: Any, scene: Scene, camera: Any, **settings: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the radiance (H, W, 3) of surfaces alone, and their share (H, W) of each pixel.

    `settings` are those arguments of `eclat.render` that choose pixels: size, crop, seed, filter, threads and progress.
    """
    take = {"samples": SAMPLES, "max_depth": 1, "adaptive": False, "denoise": False, "camera": camera, **settings}
    shapes = tuple(replace(mesh, material=_flat(mesh.material, 1.0)) for mesh in scene.meshes)
    if not shapes:
        return np.zeros_like(image.pixels), np.zeros(image.pixels.shape[:2], np.float32)
    lone = replace(scene, meshes=shapes, lights=(), environment=None)
    share = np.clip(eclat.render(lone, eclat.Direct(), **take).pixels[..., 0], 0, 1)
    if scene.environment is None:
        return image.pixels, share
    dark = tuple(replace(mesh, material=_flat(mesh.material, None)) for mesh in scene.meshes)
    behind = eclat.render(replace(scene, meshes=dark, lights=()), eclat.Direct(), **take).pixels
    surfaces = np.where(share[..., None] > 0, np.maximum(image.pixels - behind, 0), 0)
    return surfaces.astype(np.float32), share


def _flat(material: Material, glow: float | None) -> Material:
    """A black surface of the same outline that emits `glow` from all that is seen of it."""
    return Material(
        "diffuse",
        {"reflectance": grey(0)},
        two_sided=material.two_sided,
        back_culled=material.back_culled,
        hidden_from_camera=material.hidden_from_camera,
        opacity=material.opacity,
        alpha_cutoff=material.alpha_cutoff,
        emission=None if glow is None else grey(glow),
        emission_two_sided=True,
        vertex_colors=material.vertex_colors,
    )
