# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The part of a picture that one of several jobs renders, to be joined with the others by `merge_pictures`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eclat.bridge.arguments import chosen_camera, picture_size
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.stage.staging import staged

OF_WHOLE = {
    "crop": None, "time": None, "continued": None, "light_groups": False,
    "adaptive": (None, False), "denoise": (None, False), "halves": (None, False),
}  # fmt: skip
"""The arguments of `render` that would make a part depend on the whole picture or on the clock, and the values that do not."""


def part_of_picture(render: Callable[..., Image], arguments: dict[str, Any]) -> Image:
    """Render the rows of the arguments' `shard` (i, n), with what `merge_pictures` needs of them.

    Parameters
    ----------
    render : the verb.
    arguments : its arguments by name. Parts take `samples` per pixel, without adaptive sampling, halves or a denoiser.

    Raises
    ------
    EclatError : the picture has fewer than n rows, i is not 1..n, `samples` is missing, or an argument cannot be combined with
        `shard`; `render` raises it too.
    """
    number, count = arguments["shard"]
    if not 1 <= number <= count:
        raise EclatError(f"shard: expected i/n with 1 ≤ i ≤ n, got {number}/{count}")
    for name, allowed in OF_WHOLE.items():
        if not any(arguments[name] is value for value in (allowed if isinstance(allowed, tuple) else (allowed,))):
            raise EclatError(f"render: expected shard or {name}, got both")
    if arguments["samples"] is None:
        raise EclatError("render: expected samples with shard, because all parts must have the same number, got none")
    scene = staged(arguments["scene"])
    width, height = size = picture_size(chosen_camera(scene, arguments["camera"]), arguments["size"])
    if count > height:
        raise EclatError(f"shard: expected at most {height} parts, the number of rows of the picture, got {count}")
    crop = (0, height * (number - 1) // count, width, height * number // count)
    without = {"shard": None, "adaptive": False, "denoise": False, "halves": False}
    return render(**arguments | without | {"scene": scene, "size": size, "crop": crop, "continuable": True})
