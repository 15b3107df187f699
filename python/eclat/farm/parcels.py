# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Opening what travels to workers: parcels, each with a scene or another shared object."""

from __future__ import annotations

import io
import pickle
from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any

Parcels = dict[str, bytes]
"""Maps the names of parcels to their contents."""

OPENED = 8
"""The number of parcels that a worker keeps as objects, so that a scene is compiled once for many ranges."""


class Opened:
    """Opens parcels, and keeps the objects of the last ones."""

    def __init__(self) -> None:
        self._things: OrderedDict[str, Any] = OrderedDict()

    def open(self, name: str, parcels: Mapping[str, bytes]) -> Any:
        """Return the object in a parcel."""
        if name not in self._things:
            self._things[name] = _Unpacker(parcels[name], lambda inner: self.open(inner, parcels)).load()
            while len(self._things) > OPENED:
                self._things.popitem(last=False)
        self._things.move_to_end(name)
        return self._things[name]


class _Unpacker(pickle.Unpickler):
    def __init__(self, content: bytes, open_scene: Callable[[str], Any]) -> None:
        super().__init__(io.BytesIO(content))
        self._open_scene = open_scene

    def persistent_load(self, name: Any) -> Any:
        return self._open_scene(str(name))
