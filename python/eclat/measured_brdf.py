# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Measured reflection of materials, as the databases of MERL and RGL hold it. `eclat.load_brdf` reads their files, and a
Material of the kind "measured" uses it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError

Floats = NDArray[np.float32]

MERL_SHAPE = (3, 90, 90, 180)
"""The shape of the values of a MerlBrdf."""


@dataclass(frozen=True, eq=False)
class MerlBrdf:
    """An isotropic material of the MERL database [Matusik03], 18 MB. Materials that use the same object share it.

    Parameters
    ----------
    values : (3, 90, 90, 180) reflectance in sr⁻¹ by channel, θ_h, θ_d and φ_d, finite and at least 0. Cell (h, d, p) holds the
        value at θ_h = ((h + ½) / 90)² · 90°, θ_d = (d + ½)° and φ_d = (p + ½)° of the half vector and the difference vector
        [Rusinkiewicz98]; between these points it is interpolated.
    name : a name for messages.

    Raises
    ------
    EclatError : the values have another shape, are negative or not finite.
    """

    values: Floats
    name: str = ""

    def __post_init__(self) -> None:
        values = _checked("values", self.values, self.name or "MERL BRDF", 4)
        if values.shape != MERL_SHAPE:
            raise EclatError(f"{self.name or 'MERL BRDF'}: expected values of shape {MERL_SHAPE}, got {values.shape}")
        if values.min() < 0:
            raise EclatError(f"{self.name or 'MERL BRDF'}: expected values of at least 0, got {values.min():g}")
        object.__setattr__(self, "values", values)

    def __repr__(self) -> str:
        return f"<MerlBrdf {self.name!r}>"


@dataclass(frozen=True, eq=False)
class RglBrdf:
    """A material of the RGL database [DupuyJakob18], isotropic or not. Materials that use the same object share it.

    All angles are in radians, P is the number of azimuths of the viewer and T that of its angles from the normal. Tables over the
    square have the place of the angle from the normal along rows, and that of the azimuth along columns (`core/bsdf/rgl.h`).

    Parameters
    ----------
    phi : (P,) ascending azimuths of the viewer; at most two mean an isotropic material. They go from −π over a whole circle, or
        over half or a quarter of it, whose symmetry gives the rest.
    theta : (T,) ascending angles of the viewer from the normal.
    normals : (h, w) the distribution D of the normals of microfacets.
    projected : (h, w) the projected area σ of microfacets by the direction of the viewer.
    visible : (P, T, h, w) the distribution of visible normals.
    luminance : (P, T, h, w) the distribution of the luminance over the square that `visible` is a map of.
    channels : (3, P, T, h, w) linear sRGB on the same square: f · cos θ_i, divided by D / 4σ if `jacobian`.
    jacobian : whether the channels are divided by D / 4σ.
    name : a name for messages.

    Raises
    ------
    EclatError : shapes do not match, angles do not ascend, or values are not finite.
    """

    phi: Floats
    theta: Floats
    normals: Floats
    projected: Floats
    visible: Floats
    luminance: Floats
    channels: Floats
    jacobian: bool = True
    name: str = ""

    def __post_init__(self) -> None:
        name = self.name or "RGL BRDF"
        dimensions = {"phi": 1, "theta": 1, "normals": 2, "projected": 2, "visible": 4, "luminance": 4, "channels": 5}
        for field, count in dimensions.items():
            object.__setattr__(self, field, _checked(field, getattr(self, field), name, count))
        for field in ("phi", "theta"):
            angles = getattr(self, field)
            if not len(angles) or (np.diff(angles) <= 0).any():
                raise EclatError(f"{name}: expected {field} in ascending order, at least one, got {_few(angles)}")
        slices = (len(self.phi), len(self.theta))
        for field, table in (("visible", self.visible), ("luminance", self.luminance), ("channels", self.channels[:1])):
            if table.shape[-4:-2] != slices:
                raise EclatError(
                    f"{name}: expected {field} for {slices} directions of the viewer, got {table.shape[-4:-2]}"
                )
            if field != "channels" and not (np.maximum(table, 0).sum(axis=(-2, -1)) > 0).all():
                raise EclatError(f"{name}: expected distributions {field} above 0, got one without")
        if self.channels.shape[0] != 3:
            raise EclatError(f"{name}: expected three channels, got {self.channels.shape[0]}")
        for field in ("normals", "projected", "visible", "luminance", "channels"):
            if min(getattr(self, field).shape[-2:]) < 2:
                raise EclatError(
                    f"{name}: expected {field} of at least 2 x 2 nodes, got {getattr(self, field).shape[-2:]}"
                )
        if len(self.phi) > 2:
            span = float(self.phi[-1] - self.phi[0])
            if round(2 * np.pi / span) not in (1, 2, 4):
                raise EclatError(
                    f"{name}: expected azimuths of a whole, half or quarter circle, got {np.degrees(span):g}°"
                )

    def __repr__(self) -> str:
        kind = "isotropic" if len(self.phi) <= 2 else "anisotropic"
        return f"<RglBrdf {self.name!r}: {kind}, {len(self.phi)} × {len(self.theta)} directions of the viewer>"


MeasuredBrdf = MerlBrdf | RglBrdf


def normal_albedo(brdf: MeasuredBrdf) -> NDArray[np.float64]:
    """Return the share (3,) of light along the normal that is reflected, in linear sRGB."""
    if isinstance(brdf, RglBrdf):
        # The square of the channels is that of a perfect sampling of D, so that their mean over it is the albedo.
        nearest = np.asarray(brdf.channels[:, :, 0], np.float64).mean(axis=1)
        return np.maximum(_mean_between_nodes(_mean_between_nodes(nearest)), 0)
    # θ_h = θ_d = θ/2, and φ_d has no effect.
    theta = (np.arange(90) + 0.5) * np.pi / 180
    cells = np.sqrt(theta / 2 / (np.pi / 2)) * 90 - 0.5
    of_difference = np.asarray(brdf.values, np.float64).mean(axis=3)
    rows = np.stack([of_difference[:, :, min(int(half / np.pi * 180), 89)] for half in theta / 2])
    at = np.array(
        [[np.interp(cell, np.arange(90), channel) for channel in row] for cell, row in zip(cells, rows, strict=True)]
    )
    weights = 2 * np.pi * np.cos(theta) * np.sin(theta) * np.pi / 180
    return np.asarray(weights @ at)


def _mean_between_nodes(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean over the last axis of what is linear between the values."""
    return np.asarray((values[..., 1:] + values[..., :-1]).mean(axis=-1) / 2)


def _checked(what: str, values: ArrayLike, name: str, dimensions: int) -> Floats:
    """Return an array of float32. Raises EclatError if it has other dimensions or a value is not finite."""
    try:
        array = np.ascontiguousarray(values, np.float32)
    except (TypeError, ValueError):
        raise EclatError(f"{name}: expected {what} of numbers, got something else") from None
    if array.ndim != dimensions:
        raise EclatError(f"{name}: expected {what} of {dimensions} dimensions, got the shape {array.shape}")
    bad = int(np.count_nonzero(~np.isfinite(array)))
    if bad:
        raise EclatError(f"{name}: expected finite {what}, got {bad:,} of {array.size:,} that are not")
    return array


def _few(numbers: Floats) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:4]) + (", …" if len(numbers) > 4 else "")
