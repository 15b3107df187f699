# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files of measured BRDFs, made of BRDFs that are known in closed form."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[Any]]
Brdf = Callable[[Array, Array], Array]
"""The value (N, 3) for directions of the viewer and of light, (N, 3) each with z > 0."""

_TYPE_CODES = {"|u1": 1, "<f4": 10, "<f8": 11}
SIDE = 32
"""Nodes along each side of the squares of a file of RGL."""


def directions(theta: Array, phi: Array) -> Array:
    """Unit vectors (…, 3) by the angle from the normal and the azimuth in radians."""
    theta, phi = np.broadcast_arrays(theta, phi)
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def ggx_density(m: Array, alpha: float) -> Array:
    """The distribution of normals."""
    return np.asarray(alpha**2 / (np.pi * (m[..., 2] ** 2 * (alpha**2 - 1) + 1) ** 2))


def ggx_area(w: Array, alpha: float) -> Array:
    """The projected area σ = cos θ / G1."""
    z = np.maximum(w[..., 2], 1e-3)
    return np.asarray((z + np.sqrt(alpha**2 + (1 - alpha**2) * z**2)) / 2)


def shiny_paint(alpha: float = 0.3, diffuse: tuple[float, float, float] = (0.3, 0.2, 0.1), share: float = 0.5) -> Brdf:
    """A diffuse base, and facets of GGX with Schlick's reflectance for F0 = 0.3, which have a `share` of the light."""

    def brdf(wo: Array, wi: Array) -> Array:
        half = wo + wi
        half = half / np.linalg.norm(half, axis=-1, keepdims=True)
        fresnel = 0.3 + 0.7 * (1 - np.sum(wo * half, axis=-1)) ** 5
        facets = fresnel * ggx_density(half, alpha) / (4 * ggx_area(wo, alpha) * ggx_area(wi, alpha))
        return np.asarray(np.asarray(diffuse) / np.pi + share * facets[..., None])

    return brdf


def merl_file(brdf: Brdf) -> bytes:
    """A file of MERL; what lies below the horizon is marked as not measured."""
    h, d, p = np.meshgrid(np.arange(90) + 0.5, np.arange(90) + 0.5, np.arange(180) + 0.5, indexing="ij")
    theta_h, theta_d, phi_d = ((h / 90) ** 2 * np.pi / 2).ravel(), np.radians(d).ravel(), np.radians(p).ravel()
    half, rising = directions(theta_h, np.array(0.0)), directions(theta_h + np.pi / 2, np.array(0.0))
    across = np.cos(phi_d)[:, None] * rising + np.sin(phi_d)[:, None] * np.array([0.0, 1.0, 0.0])
    aside, along = np.sin(theta_d)[:, None] * across, np.cos(theta_d)[:, None] * half
    wi, wo = along + aside, along - aside
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    values = np.full((3, len(half)), -1.0)
    values[:, above] = brdf(wo[above], wi[above]).T / np.array([[1 / 1500], [1.15 / 1500], [1.66 / 1500]])
    return struct.pack("<3i", 90, 90, 180) + values.astype("<f8").tobytes()


def tensor_file(fields: Mapping[str, Array]) -> bytes:
    """A file of arrays by name, as RGL's are."""
    head, offset = b"tensor_file\0" + struct.pack("<2BI", 1, 0, len(fields)), 0
    offset = len(head) + sum(2 + len(name) + 11 + 8 * array.ndim for name, array in fields.items())
    for name, array in fields.items():
        head += struct.pack("<H", len(name)) + name.encode()
        head += struct.pack("<HBQ", array.ndim, _TYPE_CODES[array.dtype.str], offset)
        head += struct.pack(f"<{array.ndim}Q", *array.shape)
        offset += array.nbytes
    return head + b"".join(np.ascontiguousarray(array).tobytes() for array in fields.values())


def rgl_fields(brdf: Brdf, alpha: float) -> dict[str, Array]:
    """The arrays of an isotropic RGB file of RGL, whose facets are supposed to be those of GGX."""
    place = np.linspace(0, 1, SIDE)
    u, v = np.meshgrid(place, place)
    nodes = directions(u**2 * np.pi / 2, (2 * v - 1) * np.pi)
    theta = np.radians(np.minimum(np.arange(10) * 10.0, 88.0))
    wo = directions(theta, np.array(0.0))
    density = ggx_density(nodes, alpha)
    facing = np.maximum(np.einsum("tk,vuk->tvu", wo, nodes), 0)
    visible = facing * density * u * np.sin(u**2 * np.pi / 2)
    uniform = np.stack([u, v], axis=-1).reshape(-1, 2)
    found = np.stack([warped(table, uniform) for table in visible])
    m = directions(found[..., 0] ** 2 * np.pi / 2, (2 * found[..., 1] - 1) * np.pi)
    view = np.broadcast_to(wo[:, None], m.shape)
    wi = 2 * np.sum(view * m, axis=-1, keepdims=True) * m - view
    up = wi[..., 2] > 1e-6
    wi[~up] = (0, 0, 1)
    at = bilinear(density, found)
    scale = 4 * ggx_area(view, alpha) * wi[..., 2] / at * up
    channels = (brdf(view, wi) * scale[..., None]).reshape(1, len(theta), SIDE, SIDE, 3)
    return {
        "description": np.frombuffer(b"made by a test", np.uint8),
        "phi_i": np.zeros(1, "<f4"),
        "theta_i": theta.astype("<f4"),
        "ndf": density.astype("<f4"),
        "sigma": ggx_area(nodes, alpha).astype("<f4"),
        "vndf": visible[None].astype("<f4"),
        "luminance": np.maximum(channels.mean(axis=-1), 1e-6).astype("<f4"),
        "jacobian": np.ones(1, np.uint8),
        "rgb": np.moveaxis(channels, -1, 2).astype("<f4"),
    }


def as_spectra(fields: Mapping[str, Array], wavelengths: Array, of_rgb: Array) -> dict[str, Array]:
    """Replace the RGB of a file by spectra at `wavelengths` (L,): the sums of the channels times `of_rgb` (3, L)."""
    spectra = np.einsum("ptchw,cl->ptlhw", fields["rgb"], of_rgb).astype("<f4")
    return {name: array for name, array in fields.items() if name != "rgb"} | {
        "wavelengths": wavelengths.astype("<f4"),
        "spectra": spectra,
    }


def warped(table: Array, uniform: Array) -> Array:
    """Map uniform points (N, 2) of the square in proportion to a table (SIDE, SIDE) that is bilinear between its nodes."""
    step = 1 / (SIDE - 1)
    rows = np.zeros((SIDE, SIDE))
    rows[:, 1:] = np.cumsum((table[:, 1:] + table[:, :-1]) / 2 * step, axis=1)
    total = np.concatenate([[0], np.cumsum((rows[1:, -1] + rows[:-1, -1]) / 2 * step)])

    def inside(area: Array, first: Array, second: Array) -> Array:
        """Solve first · t + (second − first) t² / 2 = area for t."""
        root = first + np.sqrt(np.maximum(first**2 + 2 * area * (second - first), 0))
        return np.clip(np.divide(2 * area, root, out=np.zeros_like(area), where=root > 0), 0, 1)

    target = uniform[:, 1] * total[-1]
    i = np.clip(np.searchsorted(total, target, side="right") - 1, 0, SIDE - 2)
    y = inside((target - total[i]) / step, rows[i, -1], rows[i + 1, -1])[:, None]
    row, below = table[i] * (1 - y) + table[i + 1] * y, rows[i] * (1 - y) + rows[i + 1] * y
    goal = uniform[:, 0] * below[:, -1]
    j = np.clip((below <= goal[:, None]).sum(axis=1) - 1, 0, SIDE - 2)
    n = np.arange(len(uniform))
    x = inside((goal - below[n, j]) / step, row[n, j], row[n, j + 1])
    return np.stack([(j + x) * step, (i + y[:, 0]) * step], axis=-1)


def bilinear(table: Array, at: Array) -> Array:
    """Values of a table (SIDE, SIDE) at points (…, 2), the place along rows first."""
    place = np.clip(at, 0, 1) * (SIDE - 1)
    low = np.minimum(place.astype(int), SIDE - 2)
    x, y = np.moveaxis(place - low, -1, 0)
    i, j = low[..., 1], low[..., 0]
    above = table[i, j] * (1 - x) + table[i, j + 1] * x
    return np.asarray(above * (1 - y) + (table[i + 1, j] * (1 - x) + table[i + 1, j + 1] * x) * y)
