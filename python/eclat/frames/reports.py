# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Reports about the progress of all frames of an animation."""

from __future__ import annotations

from eclat.bridge.running import ProgressReport


class Report:
    """Turns reports about the picture of one frame into reports about all frames.

    The share of a frame that is finished counts only while samples are taken, because it starts again in each phase, and
    the time that is left is computed from it.
    """

    def __init__(self, progress: ProgressReport | None, done: int, count: int) -> None:
        self._progress, self._done, self._count = progress, done, count
        self._last = 0.0

    def of_picture(self, k: int, pictures: int) -> ProgressReport | None:
        """Make the function that takes the reports about picture `k` of the pictures of the frame."""
        if self._progress is None:
            return None
        progress = self._progress

        def report(phase: str, fraction: float, statistics: dict[str, float]) -> None:
            if phase == "render":
                self._last = max(self._last, (k + min(fraction, 1.0)) / pictures)
            progress("frames", (self._done + self._last) / self._count, {"rays": statistics.get("rays", 0.0)})

        return report
