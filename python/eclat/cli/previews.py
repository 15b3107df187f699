# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Unfinished pictures in the output files of `eclat render`, so that there is something to look at while it works."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from eclat.images.image import Image


class Previews:
    """Writes each picture that it is called with to the output files, each of which is replaced as a whole.

    Parameters
    ----------
    outputs : names of the files.
    exposure : the exposure in stops; "auto" chooses it anew for each picture.
    """

    def __init__(self, outputs: Sequence[str], exposure: float | Literal["auto"], tone_mapping: str) -> None:
        self._outputs, self._exposure, self._tone_mapping = outputs, exposure, tone_mapping
        self.written = False

    def __call__(self, image: Image) -> None:
        for output in self._outputs:
            image.save(output, exposure=self._exposure, tone_mapping=self._tone_mapping)
            self.written = True


def wants_previews(flags: dict[str, Any]) -> bool:
    """Return whether to write previews: only for whole pictures for which neither the number of samples nor the time is
    given. A picture that is continued stays in its file until the better one is finished.
    """
    if flags["continued"]:
        return False
    return flags["samples"] is None and flags["time"] is None and not flags["replay"] and flags["crop"] is None
