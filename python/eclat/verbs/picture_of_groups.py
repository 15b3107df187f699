# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture of a scene as the sum of pictures of its groups of lamps, each of which becomes a layer.

Each group is solved and sampled as a scene of its own, in which only its lamps shine. This costs as much as a picture of
each, and it is what makes the layers fit for mixing: records lie where this group needs them, samples go where it is noisy,
and the error that was asked for holds for each group. A faint lamp that shared the records and samples of a bright one would
be lost in their error as soon as someone turned it up. With factors of at least 0 the relative error of any mix is at most
that of the worst group.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.arguments import checked_seed, checked_time
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.images.mixing import PREFIX, sum_of
from eclat.measure.photometry import luminance
from eclat.methods import Solved
from eclat.sampling.halves import seed_of_half
from eclat.stage.light_groups import light_groups
from eclat.stage.staging import staged
from eclat.verbs.shown_while_rendered import with_display

Preview = Callable[[Image], None]

FIRST_SEED_OF_GROUPS = 1000
"""The first group has the seed of the picture, and the others have seeds of halves that no picture uses: these number its halves
and the passes of its probes from 0 on. The errors of the groups are then independent."""

SUMMED_LAYERS = ("direct", "indirect", "record_density")
"""Layers that add up over the groups; the others are the same for all, up to noise, so that their mean is taken."""

ERRORS = ("estimated_error", "noise_left")
"""The names of errors in the statistics; each may have a lower and an upper end."""


def picture_of_groups(render: Callable[..., Image], arguments: dict[str, Any]) -> Image:
    """Render each group of a scene and return their sum, with a layer `light.<group>` for each.

    Parameters
    ----------
    render : the verb.
    arguments : its arguments by name, whose `light_groups` is True or as in `light_groups`. The first group has their seed. Their
        `time` is divided equally among the groups that are left, and their `preview` is called with the sum of the groups so far,
        which a Display as their `display_server` shows.

    Raises
    ------
    EclatError : an argument cannot be combined with `light_groups`; `light_groups` and `render` raise it too.
    """
    arguments = dict(arguments)
    groups, what, display = arguments.pop("light_groups"), arguments["what"], arguments.pop("display_server")
    preview = with_display(arguments.pop("preview"), display)
    if isinstance(what, Solved):
        raise EclatError(
            "light_groups: expected a method, got a solution, which is that of all lamps together; "
            "to keep what each group needs, solve the scenes of eclat.light_groups(scene)"
        )
    for name, unset in (("continued", None), ("continuable", False), ("keep_partial", False)):
        if arguments[name] is not unset:
            raise EclatError(f"render: expected light_groups or {name}, got both")
    seed, time = checked_seed(arguments.pop("seed")), checked_time(arguments.pop("time"))
    started = clock.perf_counter()
    parts = light_groups(staged(arguments.pop("scene")), None if groups is True else groups)
    names = list(parts)
    pictures: dict[str, Image] = {}
    for number, name in enumerate(names):
        left = None if time is None else _time_left(time, clock.perf_counter() - started, number, len(names))
        own_seed = seed if number == 0 else seed_of_half(seed, FIRST_SEED_OF_GROUPS + number)
        show = None if preview is None else _shown_with(pictures, preview)
        # The scene of a finished group is dropped, and its compiled form with it.
        pictures[name] = render(parts.pop(name), **arguments, seed=own_seed, time=left, preview=show)
    image = _joined(pictures, seed)
    if display is not None:
        display.show(image)
    return image


def _time_left(time: float, passed: float, number: int, count: int) -> float:
    """Return the seconds of group `number` of `count`. One that comes late still gets a tenth of an equal share, so that its
    picture exists.
    """
    return max(0.1 * time / count, (time - passed) / (count - number))


def _shown_with(done: Mapping[str, Image], preview: Preview) -> Preview:
    """Make the function that shows an unfinished picture of a group together with the groups that are finished."""

    def show(image: Image) -> None:
        finished = [other.pixels for other in done.values()]
        if all(pixels.shape == image.pixels.shape for pixels in finished):
            preview(replace(image, pixels=sum_of([image.pixels, *finished]), layers={}))

    return show


def _joined(pictures: Mapping[str, Image], seed: int) -> Image:
    """Make the sum of the pictures of all groups."""
    images = list(pictures.values())
    pixels = sum_of([image.pixels for image in images])
    layers: dict[str, NDArray[np.float32]] = {}
    for name in dict.fromkeys(name for image in images for name in image.layers):
        if name in ("error", "noisy"):
            continue
        found = [image.layers[name] for image in images if name in image.layers]
        layers[name] = sum_of(found)
        if name not in SUMMED_LAYERS:
            layers[name] /= np.float32(len(found))
    if any("noisy" in image.layers for image in images):
        layers["noisy"] = sum_of([image.layers.get("noisy", image.pixels) for image in images])
    if all("error" in image.layers for image in images):
        layers["error"] = _joined_error(images, pixels)
    layers |= {PREFIX + name: image.pixels for name, image in pictures.items()}
    metadata = dict(images[0].metadata) | {
        "seed": seed,
        "denoised": any(image.metadata.get("denoised") for image in images),
        "light_groups": {name: image.metadata.get("statistics", {}) for name, image in pictures.items()},
        "statistics": _joined_statistics(images, pixels),
    }
    metadata.pop("bad_samples", None)  # Each group has warned of its own.
    return Image(pixels, layers, metadata)


def _joined_error(images: Sequence[Image], pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the relative error around each pixel. The errors of the groups are independent, so their squares add up."""
    squared = sum((image.layers["error"] * _share(image, pixels)) ** 2 for image in images)
    error: NDArray[np.float32] = np.sqrt(np.asarray(squared)).astype(np.float32)
    return error


def _share(image: Image, pixels: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the part of the luminance of each pixel that comes from the group."""
    whole = np.asarray(luminance(pixels), np.float64)
    share: NDArray[np.float64] = np.where(whole > 0, luminance(image.pixels) / np.where(whole > 0, whole, 1), 0.0)
    return share


def _joined_statistics(images: Sequence[Image], pixels: NDArray[np.float32]) -> dict[str, float]:
    """Add up the numbers of samples, rays, records and seconds, and join the errors.

    The relative error of the sum at a pixel is at most the sum of those of the groups times their parts of the light there.
    By Minkowski's inequality the root of its mean square is at most the sum over groups of the error of the group times the
    root mean square of its part, where the error of a group is taken to be alike in its bright and its dark places.
    """
    statistics = [dict[str, Any](image.metadata.get("statistics", {})) for image in images]
    names = ("samples", "rays", "records", "seconds", "photons")
    joined = {
        name: float(sum(s.get(name, 0.0) for s in statistics)) for name in names if any(name in s for s in statistics)
    }
    parts = [float(np.sqrt(np.mean(_share(image, pixels) ** 2))) for image in images]
    for error in ("noise", *(error + end for error in ERRORS for end in ("", "_low", "_high"))):
        if all(error in s for s in statistics):
            joined[error] = float(sum(s[error] * part for s, part in zip(statistics, parts, strict=True)))
    return joined
