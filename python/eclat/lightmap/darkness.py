# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Texels that next to no light reaches, found by few paths, so that nothing more is spent on them.

Models of buildings have many surfaces that nobody sees: the outsides of rooms, what lies between two shells of a wall. Records
are as dear there as anywhere, or dearer, since walls are close to each other. In the cathedral of Sibenik, with texels of half a
metre, four paths find no light at 64 % of the texels.

Texels are looked at in groups, which are neighbours in one chart. Each texel sends a few paths, and the groups that find no
more than `DARK_SHARE` of the usual light send more, `GROUP_PATHS` at least. Those that still find no more are dark: their
texels take the mean of what all paths of the group found, which has no bias.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eclat.lightmap.gathering import GatheredTexels, Settings, TexelPoints
from eclat.lightmap.layout import Layout
from eclat.lightmap.solids import Mask
from eclat.measure.photometry import luminance
from eclat.methods import Path
from eclat.sampling.halves import seed_of_half
from eclat.scene import FloatArray, Scene
from eclat.verbs.irradiance import irradiance_at
from eclat.verbs.light_at_points import Component

DARK_SHARE = 1e-3
"""Irradiance, relative to the mean over all texels, up to which a group is dark. In a picture whose mean is middle grey, it is
less than one step of 8 bits."""

GROUP_SIDE = 8
"""Side of a group in texels."""

TEXEL_PATHS = 4
"""Number of paths of each texel. One lit texel among the 64 of a group is found if it has 6 % of the usual light or more."""

GROUP_PATHS = 256
"""Least number of paths of a group that is dark. A place from which one path in a hundred finds light is missed with a chance of
8 %, and then has less than a hundredth of the light of the places that its paths find."""

SEEDS = 2
"""Number of the first seed of the paths, after those of the halves of a denoised map (`sampling.halves`)."""


@dataclass(frozen=True, eq=False)
class Dark:
    """A mask (N,) of texels that are dark, their irradiance `values` (N, 3), which are 0 elsewhere, and the number of rays that
    it took to find them."""

    mask: Mask
    values: FloatArray
    rays: float


def dark_texels(
    scene: Scene, groups_of_texels: NDArray[np.int64], points: TexelPoints, free: Mask, settings: Settings
) -> Dark:
    """Find the texels that next to no light reaches, among those with points that are `free`, a mask (N, n).

    `groups_of_texels` (N,) says which texels are looked at together (`groups_of`).

    Direct light alone takes no more than the look at the texels would, so none is looked for then.
    """
    nothing = Dark(np.zeros(len(free), bool), np.zeros((len(free), 3)), 0.0)
    asked = np.flatnonzero(free[:, 1:].any(axis=1))
    if settings.component == "direct" or not len(asked):
        return nothing
    groups = groups_of_texels[asked]
    count = int(groups.max()) + 1
    at = asked, np.argmax(free[asked], axis=1)
    rays = 0.0

    def sums(which: NDArray[np.int64], number: int, component: Component = "total") -> FloatArray:
        """Return the sums (groups, 3) of the paths of the texels `which`, by their indices in `asked`."""
        nonlocal rays
        counted: dict[str, float] = {}
        keywords = settings.keywords(component, TEXEL_PATHS) | {"seed": seed_of_half(settings.seed, SEEDS + number)}
        places = at[0][which], at[1][which]
        found = irradiance_at(
            scene, points.positions[places], points.normals[places], Path(), statistics=counted, **keywords
        )
        rays += counted["rays"]
        of = groups[which]
        return np.column_stack([np.bincount(of, found[:, i].astype(np.float64), minlength=count) for i in range(3)])

    sizes = np.bincount(groups, minlength=count)
    total, looks = sums(np.arange(len(asked)), 0), sizes.astype(np.float64)
    least = DARK_SHARE * float(luminance(total).sum()) / len(asked)
    dark = luminance(total) <= least * looks
    if least == 0 or not dark.any():
        return replace(nothing, rays=rays)
    wanted = -(-GROUP_PATHS // TEXEL_PATHS)
    more = np.where(dark, np.maximum(0, -(-wanted // np.maximum(sizes, 1)) - 1), 0)
    again = np.repeat(np.arange(len(asked)), more[groups])
    if len(again):
        total, looks = total + sums(again, 1), looks + more * sizes
        dark &= luminance(total) <= least * looks
    which = np.flatnonzero(dark[groups])
    if settings.component != "total":
        total, looks = sums(which, 2, settings.component), sizes.astype(np.float64)
    mask, values = nothing.mask.copy(), nothing.values.copy()
    mask[asked[which]] = True
    values[asked[which]] = (total / np.maximum(looks, 1)[:, None])[groups[which]]
    return Dark(mask, values, rays)


def groups_of(layout: Layout) -> NDArray[np.int64]:
    """Number the groups: for each texel, the square of `GROUP_SIDE` texels of its chart that it lies in, (N,)."""
    texels = layout.texels
    charts = layout.corners.charts[texels.triangles]
    keys = np.column_stack((charts, texels.rows // GROUP_SIDE, texels.columns // GROUP_SIDE))
    return np.asarray(np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1), np.int64)


def with_dark(gathered: GatheredTexels, dark: Dark, points: TexelPoints, free: Mask) -> GatheredTexels:
    """Add dark texels to those that were gathered without them; `free` (N, n) are the points that a viewer may see."""
    share = free[:, 1:] / np.maximum(free[:, 1:].sum(axis=1, keepdims=True), 1)
    places = (points.uvs[:, 1:] * share[..., None]).sum(axis=1)
    return replace(
        gathered,
        values=np.where(dark.mask[:, None], dark.values, gathered.values),
        places=np.where(dark.mask[:, None], places, gathered.places),
        seen=gathered.seen | dark.mask,
        counts=gathered.counts | {"rays": gathered.counts["rays"] + dark.rays},
    )
