# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""From gathered texels to the pages of a light map: texels are fitted to what viewers interpolate, and those between charts are
filled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat.lightmap.fit import bilinear, differences, fit
from eclat.lightmap.gathering import GatheredTexels
from eclat.lightmap.gutters import dilate
from eclat.lightmap.layout import Layout
from eclat.lightmap.seams import seam_samples
from eclat.scene import FloatArray


def fitted_pages(
    layout: Layout, gathered: GatheredTexels, values: FloatArray, gutter: int, least: float = -np.inf
) -> NDArray[np.float32]:
    """Fit the values (N, C) of the texels, and return the pages one below the other, (pages · height, W, C).

    Texels that no viewer can see take the mean of their neighbours. No fitted value is below `least`.
    """
    texels, atlas, seen = layout.texels, layout.atlas, gathered.seen
    numbers = np.full((atlas.stack_height, atlas.width), -1, np.int64)
    numbers[texels.rows[seen], texels.columns[seen]] = np.arange(int(seen.sum()))
    a, b = (bilinear(numbers, ends) for ends in seam_samples(layout.corners))
    fitted = fit(values[seen], bilinear(numbers, gathered.places[seen]), differences(a, b), least)
    image: FloatArray = np.zeros((*numbers.shape, values.shape[1]))
    image[texels.rows[seen], texels.columns[seen]] = fitted
    known = numbers >= 0
    hidden = np.zeros_like(known)
    hidden[texels.rows[~seen], texels.columns[~seen]] = True
    image, known = dilate(image, known, gutter + 1, hidden)
    image, _ = dilate(image, known | hidden, gutter + 1)
    return layout.pages(image).astype(np.float32)


def fitted_harmonics(
    layout: Layout, gathered: GatheredTexels, harmonics: FloatArray, gutter: int
) -> NDArray[np.float32]:
    """Fit the coefficients (N, 4, 3) of the texels likewise, (pages · height, W, 4, 3)."""
    pages = fitted_pages(layout, gathered, harmonics.reshape(len(harmonics), -1), gutter)
    return pages.reshape(*pages.shape[:2], *harmonics.shape[1:])
