# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What geometric optics says of light through smooth glass: Snell, Fresnel, and where rays that lie close together land.

Written from the laws, with nothing of the core. Light is unpolarised at every interface, as the core has it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def cosine_inside(cos_i: Floats, eta: float) -> Floats:
    """Of the refracted ray [Snell]; `eta` is the index behind the interface over that before it; 0 for total reflection."""
    return np.sqrt(np.maximum(0, 1 - (1 - cos_i**2) / eta**2))


def reflectance(cos_i: Floats, eta: float) -> Floats:
    """Mean of both polarisations [Fresnel]; 1 where reflection is total."""
    cos_t = cosine_inside(cos_i, eta)
    across = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    along = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    return (across**2 + along**2) / 2


@dataclass(frozen=True)
class Landing:
    """Rays of a rotationally symmetric bundle on the floor, in the order in which they left."""

    radius: Floats
    """(n,) where each ray lands, metres; nan where it does not."""
    flux: Floats
    """(n,) flux between neighbours on either side, W."""

    def irradiance(self, at: Floats) -> Floats:
        """(m,) W·m⁻² on circles of radius `at`: flux between neighbours over the area of the ring between them."""
        between = (self.flux[1:] + self.flux[:-1]) / 2
        inner, outer = np.minimum(self.radius[1:], self.radius[:-1]), np.maximum(self.radius[1:], self.radius[:-1])
        found = [np.sum((between / (np.pi * (outer**2 - inner**2)))[(inner <= r) & (r < outer)]) for r in at]
        return np.array(found)

    def ring_flux(self, edges: Floats) -> Floats:
        """(m − 1,) W that arrive between radii `edges`."""
        landed = np.isfinite(self.radius)
        return np.histogram(self.radius[landed], edges, weights=self.flux[landed])[0]


def through_slab(
    intensity: float, height: float, thickness: float, ior: float, *, crossings: int = 4, rays: int = 100_000
) -> list[Landing]:
    """Light of a point source `height` over the floor, a plane-parallel slab of glass between: straight through, and
    after 1, 2, … returns inside."""
    theta = (np.arange(rays) + 0.5) * (0.49 * np.pi / rays)
    cos_i = np.cos(theta)
    cos_t, r = cosine_inside(cos_i, ior), reflectance(cos_i, ior)
    tan_t = np.sin(theta) / ior / cos_t
    emitted = 2 * np.pi * intensity * np.sin(theta) * (theta[1] - theta[0])
    return [
        Landing(
            (height - thickness) * np.tan(theta) + (2 * m + 1) * thickness * tan_t,
            emitted * (1 - r) ** 2 * r ** (2 * m),
        )
        for m in range(crossings)
    ]


def through_ball(
    irradiance: float, radius: float, height: float, ior: float, *, chords: int = 4, rays: int = 400_000
) -> list[Landing]:
    """A beam straight down on a ball of glass whose centre is `height` over the floor: what its outside reflects, and what
    leaves after 1, 2, … chords inside. Rays are traced in the plane of axis and ray."""
    offset = (np.arange(rays) + 0.5) * (radius / rays)
    arriving = 2 * np.pi * irradiance * offset * (radius / rays)
    p = np.stack([offset, np.sqrt(radius**2 - offset**2)])  # from the centre
    d = np.stack([np.zeros(rays), -np.ones(rays)])

    def landed(p: Floats, d: Floats, flux: Floats) -> Landing:
        down = d[1] < 0
        distance = np.where(down, (height + p[1]) / np.where(down, -d[1], 1), np.nan)
        return Landing(np.abs(p[0] + distance * d[0]), flux)

    n = p / radius
    cos_i = -np.sum(d * n, axis=0)
    r = reflectance(cos_i, ior)
    leaving = [landed(p, d + 2 * cos_i * n, arriving * r)]
    inside = arriving * (1 - r)
    cos_t = cosine_inside(cos_i, ior)
    d = d / ior + (cos_i / ior - cos_t) * n
    for _ in range(chords):
        p = p - 2 * np.sum(p * d, axis=0) * d
        n = -p / radius  # inwards
        c = -np.sum(d * n, axis=0)
        r = reflectance(c, 1 / ior)
        leaving.append(landed(p, d * ior + (c * ior - cosine_inside(c, 1 / ior)) * n, inside * (1 - r)))
        inside = inside * r
        d = d + 2 * c * n
    return leaving
