# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture in two halves: two films with the same number of samples and different seeds, from whose differences the
error is measured.

Each half uses its own scramble of the Sobol' sequence. The two halves of one sequence would be stratified against each
other, and the error measured from their differences would be too small.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.images import denoiser
from eclat.sampling.denoised_halves import (
    DenoisedHalves,
    JudgedPicture,
    Quadruple,
    judged_halves,
    sampled_halves,
    with_picture,
)

Region = tuple[int, int, int, int]
"""A rectangle of pixels (x0, y0, x1, y1); x1 and y1 are exclusive."""

ODD_SEED = 0x9E3779B9
"""Difference between the seeds of the halves: 2³² divided by the golden ratio, a difference that the seeds a person
chooses for two pictures hardly ever have."""


def seed_of_half(seed: int, half: int) -> int:
    """Return the seed of the even half (0) or the odd half (1) of a picture; greater numbers give further seeds, for what
    judges the halves."""
    return (seed + half * ODD_SEED) % (1 << 32)


class Halves:
    """Two films of the same size. The film `even` holds the even samples of the picture, the film `odd` the odd
    samples: sample n of the picture is sample n // 2 of its film.

    Parameters
    ----------
    region : rectangle of the pixels that are rendered. The other pixels are black, and their error is not measured.
    other : a picture of the region by another method, which is shown where that reduces the error, or None. Its errors must be
        independent of the noise of the films.
    """

    each = 2
    """Number of samples of the picture for one sample of each half."""

    def __init__(self, even: _core.Film, odd: _core.Film, region: Region, other: JudgedPicture | None = None) -> None:
        x0, y0, x1, y1 = region
        self.even, self.odd = even, odd
        self.region, self.other = region, other
        self._inside = np.s_[y0:y1, x0:x1]

    @property
    def radiance(self) -> NDArray[np.float32]:
        """(H, W, 3) mean of all samples."""
        return np.asarray(self.whole().radiance)

    def copy(self) -> Halves:
        """Copy both films."""
        return Halves(self.even.copy(), self.odd.copy(), self.region, self.other)

    def whole(self) -> _core.Film:
        """Make one film that holds the samples of both halves."""
        film = self.even.copy()
        film.interleave(self.odd)
        return film

    def sampled(self) -> DenoisedHalves:
        """Measure the error of the picture without denoising it."""
        a, b = (film.radiance[self._inside] for film in (self.even, self.odd))
        return self._beside_other(sampled_halves(a, b), (a, b, a, b))

    def denoised(self) -> DenoisedHalves:
        """Denoise the picture and measure the error that remains. A million pixels take some seconds.

        Raises EclatError if no denoiser is installed.
        """
        films = (self.even, self.odd)
        sampled = [film.radiance[self._inside] for film in films]
        # The albedo and normals that guide the denoiser come from the same half, so that neither half depends on the
        # other.
        clean = [
            denoiser.denoise(picture, film.rough_albedo[self._inside], film.rough_normal[self._inside])
            for picture, film in zip(sampled, films, strict=True)
        ]
        halves = (sampled[0], sampled[1], clean[0], clean[1])
        return self._beside_other(judged_halves(*halves), halves)

    def _beside_other(self, found: DenoisedHalves, halves: Quadruple) -> DenoisedHalves:
        return found if self.other is None else with_picture(found, halves, self.other)

    def within(self, layer: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the pixels of the region out of an array over the whole picture."""
        return layer[self._inside]

    def pasted(self, values: NDArray[np.floating] | NDArray[np.uint32]) -> NDArray[np.float32]:
        """Copy an array that covers the region into an array that covers the whole picture and is 0 elsewhere."""
        size = (self.even.radiance.shape[0], self.even.radiance.shape[1])
        whole = np.zeros((*size, *values.shape[2:]), np.float32)
        whole[self._inside] = values
        return whole
