# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Who takes the samples of a picture: this process or the workers of a farm, into one film or into two halves."""

from __future__ import annotations

from eclat import _core
from eclat.farm.farm import current_farm
from eclat.sampling.adaptive_sampling import AdaptiveSamples
from eclat.sampling.convergence import Sampling
from eclat.sampling.denoised_halves import JudgedPicture
from eclat.sampling.halves import Halves, seed_of_half
from eclat.tev.display import Display
from eclat.tev.growing import GrowingPicture
from eclat.verbs.continuing import Begun
from eclat.verbs.picture import Picture, SampleTaker
from eclat.verbs.tiles_on_farm import TakerOnFarm, Tiles


def sampling_of(
    picture: Picture,
    count: int,
    tile_order: list[int],
    keep_partial: bool,
    display: Display | None,
    begun: Begun | None,
    other: JudgedPicture | None = None,
    kind: str = "",
) -> Sampling:
    """Make the object that takes the samples of the picture, in one film or in two halves with different seeds. It goes on from
    those of the given `kind` that were `begun`, if any. The halves show the picture `other` where that reduces their error.
    """
    view, region, work = picture.view, picture.region, picture.work
    growing = None if display is None else GrowingPicture(display, view.size, picture.denoise)
    pixels = [
        _core.RenderRange(
            crop=region,
            seed=seed_of_half(work.seed, picture.first_seed + half),
            threads=work.threads,
            filter=picture.filter,
            tile_order=tile_order,
            finished=None if growing is None else growing.finished,
        )
        for half in range(count)
    ]
    films = [_core.Film(*view.size) for _ in pixels]
    farm = current_farm()
    take: SampleTaker | TakerOnFarm
    if farm is None:
        take = SampleTaker(picture.scene, picture.prepared, view, work, films, pixels, growing)
    else:
        seeds = tuple(seed_of_half(work.seed, picture.first_seed + half) for half in range(count))
        tiles = Tiles(picture.scene, picture.prepared, view, work, region, picture.filter.name, seeds)
        take = TakerOnFarm(farm, tiles, films)
    film = films[0] if len(films) == 1 else Halves(films[0], films[1], region, other)
    adaptive = AdaptiveSamples(view.size, region) if picture.adaptive else None
    by_denoised = picture.adaptive == "denoised"
    sampling = Sampling(film, take.samples, keep_partial, work.progress, adaptive, by_denoised=by_denoised)
    if begun is not None:
        begun.restore(sampling, kind)
    return sampling
