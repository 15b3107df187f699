# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The poses of a file at later times, which are built long after it was loaded."""

from __future__ import annotations

import warnings
from collections.abc import Callable

from eclat.errors import EclatWarning
from eclat.files.confinement import confined_to, current_root
from eclat.motion.animation import Pose


def later(pose: Callable[[float], Pose]) -> Callable[[float], Pose]:
    """Make a function that poses a file later as it was loaded: it reads files only below the folder that the scene is
    confined to now, and does not repeat the warnings about the file.
    """
    root = current_root()

    def posed(time: float) -> Pose:
        with confined_to(root), warnings.catch_warnings():
            warnings.simplefilter("ignore", EclatWarning)
            return pose(time)

    return posed
