# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The tiles of a picture that is being rendered, each of which is shown when it has the samples of a pass."""

from __future__ import annotations

from eclat import _core
from eclat.tev.display import Display


class GrowingPicture:
    """Passes finished tiles from the threads that render to a display.

    A picture in two halves shows the tiles of the half that is being rendered; the mean of both comes with the picture
    between passes.

    Parameters
    ----------
    display : where the tiles are shown.
    size : width and height of the picture.
    denoise : whether the picture will be denoised. Tiles are then shown as the layer `noisy`, because they would look worse than
        the denoised picture that is there before.
    """

    def __init__(self, display: Display, size: tuple[int, int], denoise: bool) -> None:
        self.finished = _core.FinishedTiles()
        self._display, self._size, self._samples = display, size, "noisy" if denoise else ""

    def show(self) -> None:
        """Show the tiles that were finished since the last call. Call it in the main thread, where warnings are heard."""
        for column, row, film in self.finished.take():
            radiance, direct = film.radiance, film.direct
            layers = {
                self._samples: radiance, "direct": direct, "indirect": radiance - direct,
                "albedo": film.albedo, "normal": film.normal, "depth": film.depth,
            }  # fmt: skip
            self._display.update((column, row), layers, self._size)
        self._display.warn_if_lost()
