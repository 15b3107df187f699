# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scene that a verb works on: loaded if it was given by name, and completed with a camera and light."""

from __future__ import annotations

import os
import weakref

from eclat.errors import EclatError
from eclat.loaders import load
from eclat.scene import Scene
from eclat.stage.defaults import complete, has_light

_staged: weakref.WeakKeyDictionary[Scene, Scene] = weakref.WeakKeyDictionary()
"""Kept, so that the same scene gives the same object, with what is compiled for it, and says what was made up once."""


def staged(scene: Scene | str | os.PathLike[str]) -> Scene:
    """`scene` as the command line would use it: the same stand-ins for a missing camera or light, the same warnings.

    A scene that has both is returned as it is. What stands in depends on the scene alone, so that what was solved fits
    what is rendered.

    Raises
    ------
    EclatError : what `load` raises for a file or a name, or something that is neither a scene nor the name of one.
    """
    if isinstance(scene, str | os.PathLike):
        scene = load(scene)
    if not isinstance(scene, Scene):
        raise EclatError(f"expected a scene, or the name of a file or of a built-in one, got {type(scene).__name__}")
    if scene.cameras and has_light(scene):
        return scene
    found = _staged.get(scene)
    if found is None:
        found = _staged[scene] = complete(scene)
    return found
