# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces while shaders are mixed: a material without its light, the light that it emits, and how much it covers."""

from __future__ import annotations

from dataclasses import dataclass

from eclat.scene import Material

from .fields import Field, combined, constant

OPAQUE, CLEAR = constant(1.0), constant(0.0)


@dataclass(frozen=True, eq=False)
class Surface:
    """`material` is None for a surface that reflects nothing; `emission` is its radiance, None for no light; `opacity` is
    the share of rays that meet it."""

    material: Material | None = None
    emission: Field | None = None
    opacity: Field = OPAQUE

    @property
    def is_clear(self) -> bool:
        """Whether no ray meets the surface."""
        return self.opacity.is_constant and self.opacity.number <= 0


def added(a: Surface, b: Surface) -> tuple[Surface, bool]:
    """Add two shaders. Two that reflect cannot be added: the first is kept, and the second value returned is False."""
    if a.emission is None or b.emission is None:
        emission = a.emission or b.emission
    else:
        emission, _ = combined(lambda x, y: x + y, a.emission, b.emission)
    solid = [s for s in (a, b) if not s.is_clear]
    opacity = solid[0].opacity if len(solid) == 1 else OPAQUE
    if emission is not None and not [s for s in solid if s.material is not None]:
        # Light that is added to what is clear stays clear in Blender; here what glows covers what is behind it.
        opacity = OPAQUE
    return Surface(a.material or b.material, emission, opacity), a.material is None or b.material is None


def mixed(share: Field, a: Surface, b: Surface) -> tuple[Surface, Field, bool]:
    """Mix two shaders by the share of the second.

    Returns the surface, whose material is that of `a` if both reflect; the weight of b among what covers; and whether
    images could be combined texel by texel.
    """
    share = share.mapped(lambda x: x.clip(0, 1))
    opacity, fits = combined(lambda f, x, y: x + f * (y - x), share, a.opacity, b.opacity)
    weight, fits_too = combined(_weight, share, a.opacity, b.opacity)
    emission: Field | None = None
    fits_light = True
    if a.emission is not None or b.emission is not None:
        dark = constant(0.0)
        light = lambda w, x, y: x + w * (y - x)  # noqa: E731
        emission, fits_light = combined(light, weight, a.emission or dark, b.emission or dark)
    return Surface(a.material or b.material, emission, opacity), weight, fits and fits_too and fits_light


def _weight(share, a, b):  # type: ignore[no-untyped-def]
    of_b, whole = share * b, share * b + (1 - share) * a
    return of_b / (whole + (whole == 0))
