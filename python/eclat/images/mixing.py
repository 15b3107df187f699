# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures whose light is divided into groups of lamps: changing the strength and colour of each group afterwards."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, did_you_mean, shown
from eclat.images.image import Image
from eclat.images.tone import srgb_decode
from eclat.typed import typed

PREFIX = "light."
"""The beginning of the names of layers that hold the light of a group: `light.lamp` is that of the group `lamp`."""

OF_ALL_LIGHT = (
    "direct",
    "indirect",
    "noisy",
    "error",
    "denoiser_weight",
    "record_density",
    "record_weight",
    "gloss_cached",
    "gloss_traced",
)
"""Layers that depend on all groups together and are not kept for each, so that a mixed picture does not have them."""

Weight = float | str | Sequence[float]
"""A factor, three factors for red, green and blue, or a text as `weight_of` reads it."""

_COLOR = re.compile(r"#([0-9a-fA-F]{6})")


def groups_of(picture: Image) -> dict[str, NDArray[np.float32]]:
    """Return the light of each group of a picture, (H, W, 3), by the name of the group."""
    layers = picture.layers.items()
    return {name.removeprefix(PREFIX): layer for name, layer in layers if name.startswith(PREFIX)}


@typed
def mix(picture: Image, weights: Mapping[str, Weight]) -> Image:
    """Change the light of a picture that was rendered with `light_groups`, without rendering it again.

    Each group was sampled, and denoised if the picture was denoised, on its own, so that the mixed picture is as good as
    the layers are: its relative error is at most about the largest of the groups.

    Parameters
    ----------
    picture : a picture with a layer for each group, from `render` or from its .exr file.
    weights : for each group to change, a factor, three factors for red, green and blue, or a text such as "0.3",
        "#ffcc88" or "0.3,#ffcc88", which is a factor, an sRGB colour, or both. Groups that are not named keep their light.

    Returns
    -------
    An Image whose layers of groups are multiplied by their weights and whose pixels are the sum of these layers. Layers of
    geometry are kept. Those that depend on all light, such as `direct` and `error`, and the statistics are left out.

    Raises
    ------
    EclatError : the picture has no groups, a name is unknown, or a weight is negative, not finite or not a weight.

    Examples
    --------
    >>> lamp, sky = (np.full((1, 1, 3), level, np.float32) for level in (1.0, 0.5))
    >>> picture = Image(lamp + sky, {"light.lamp": lamp, "light.sky": sky})
    >>> mix(picture, {"lamp": 0.25, "sky": (0, 0, 2)}).pixels.tolist()
    [[[0.25, 0.25, 1.25]]]
    """
    groups = groups_of(picture)
    if not groups:
        raise EclatError(
            "mix: expected a picture that was rendered with light_groups, got one without layers of groups"
        )
    for name in weights:
        if name not in groups:
            known = ", ".join(groups)
            raise EclatError(f"mix: expected one of the groups {known}, got {name!r}{did_you_mean(str(name), groups)}")
    factors = {name: _factors(name, weights.get(name, 1.0)) for name in groups}
    layers = {name: layer for name, layer in picture.layers.items() if name not in OF_ALL_LIGHT}
    layers |= {PREFIX + name: layer * factors[name].astype(np.float32) for name, layer in groups.items()}
    metadata = {name: value for name, value in picture.metadata.items() if name not in ("statistics", "settings")}
    metadata["mix"] = {name: [float(f) for f in factors[name]] for name in groups}
    return Image(sum_of([layers[PREFIX + name] for name in groups]), layers, metadata)


def sum_of(layers: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Add up layers of the same shape in float64, and round once."""
    total = np.zeros(layers[0].shape)
    for layer in layers:
        total += layer
    return total.astype(np.float32)


def weight_of(text: str) -> NDArray[np.float64]:
    """Read a weight such as "0.3", "#ffcc88" or "0.3,#ffcc88" as three linear factors. Raises ValueError if it is none."""
    factors = np.ones(3)
    for part in text.split(","):
        color = _COLOR.fullmatch(part.strip())
        factors = factors * (
            float(part) if color is None else srgb_decode(np.array(list(bytes.fromhex(color[1]))) / 255)
        )
    return factors


def _factors(name: str, weight: Weight) -> NDArray[np.float64]:
    try:
        factors = weight_of(weight) if isinstance(weight, str) else np.asarray(weight, np.float64)
    except (TypeError, ValueError):
        factors = np.empty(0)
    if factors.shape not in ((), (3,)) or (isinstance(weight, Real) and not math.isfinite(weight)):
        factors = np.empty(0)
    if factors.size == 0 or not np.isfinite(factors).all() or factors.min() < 0:
        raise EclatError(
            f"mix, {name}: expected a factor of at least 0, three of them, or a text such as '0.3,#ffcc88', got {shown(weight)}"
        )
    return np.broadcast_to(factors, (3,))
