# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Packing what travels to workers: each scene and each other shared object once, under a name that is a hash of its content.

This module needs Dask's `cloudpickle`, which also packs functions inside functions, such as the motions of scenes.
"""

from __future__ import annotations

import hashlib
import io
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import cloudpickle

from eclat.farm.parcels import OPENED, Parcels
from eclat.scene import Scene


class _Packer(cloudpickle.Pickler):  # type: ignore[misc]
    """Replaces scenes, which many objects refer to, by the names of parcels of their own."""

    def __init__(self, file: io.BytesIO, parcels: Parcels, known: Callable[[Scene], str]) -> None:
        super().__init__(file)
        self._parcels, self._known = parcels, known

    def persistent_id(self, thing: Any) -> str | None:
        return self._known(thing) if isinstance(thing, Scene) else None


class Packed:
    """Packs objects. The last scenes and other objects are packed once only."""

    def __init__(self) -> None:
        self._shared: OrderedDict[int, tuple[Any, str, Parcels]] = OrderedDict()
        self._scenes: OrderedDict[int, tuple[Scene, str, bytes]] = OrderedDict()

    def pack(self, thing: Any) -> tuple[str, Parcels]:
        """Return the name of the parcel of `thing`, and it with those of all scenes in it. It must not change afterwards."""
        if id(thing) in self._shared:
            return self._shared[id(thing)][1:]
        parcels: Parcels = {}

        def known(scene: Scene) -> str:
            if id(scene) not in self._scenes:
                content: bytes = cloudpickle.dumps(scene)
                self._scenes[id(scene)] = (scene, name_of("scene", content), content)
                while len(self._scenes) > OPENED:
                    self._scenes.popitem(last=False)
            _, name, content = self._scenes[id(scene)]
            parcels[name] = content
            return name

        file = io.BytesIO()
        _Packer(file, parcels, known).dump(thing)
        content = file.getvalue()
        name = name_of("shared", content)
        parcels[name] = content
        self._shared[id(thing)] = (thing, name, parcels)
        while len(self._shared) > OPENED:
            self._shared.popitem(last=False)
        return name, parcels


def name_of(kind: str, content: bytes) -> str:
    """Return the name of a parcel."""
    return f"eclat-{kind}-{hashlib.sha256(content).hexdigest()[:32]}"


def pickled(thing: Any) -> bytes:
    """Return the bytes of a small object, for one range."""
    content: bytes = cloudpickle.dumps(thing)
    return content
