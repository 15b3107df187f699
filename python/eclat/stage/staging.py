# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scene that a verb works on, which is loaded if it is given by name, and completed with a camera and a light."""

from __future__ import annotations

import os
import weakref

from eclat.errors import EclatError
from eclat.loaders import load
from eclat.scene import Scene
from eclat.stage.defaults import complete, has_light
from eclat.stage.scene_checks import check_scene

_staged: weakref.WeakKeyDictionary[Scene, Scene] = weakref.WeakKeyDictionary()
"""Completed scenes, which are kept so that the same scene always gives the same object, which is compiled and warned
about only once."""


def staged(scene: Scene | str | os.PathLike[str]) -> Scene:
    """Return the scene with a camera and a light, as the command line does; if either is missing, it is added with a
    warning.

    A scene that has both is returned unchanged. The additions depend only on the scene, so a solution fits the scene
    when it is rendered later.

    Raises
    ------
    EclatError : `load` raises it for the file or name, `check_scene` for the scene, or `scene` is neither a scene nor a name.
    """
    if isinstance(scene, str | os.PathLike):
        scene = load(scene)
    if not isinstance(scene, Scene):
        raise EclatError(
            f"scene: expected a scene, the path of a scene file or the name of a built-in scene, got {type(scene).__name__}"
        )
    check_scene(scene)
    if scene.cameras and has_light(scene):
        return scene
    found = _staged.get(scene)
    if found is None:
        found = _staged[scene] = complete(scene)
    return found
