# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parcels: a scene has one of its own, which is packed once, and opened objects share it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import eclat
from eclat.farm.parcels import OPENED, Opened

packing = pytest.importorskip("eclat.farm.packing")


def test_objects_come_out_as_they_went_in_and_share_their_scene() -> None:
    scene, packed = eclat.load("cornell-box"), packing.Packed()
    first, parcels = packed.pack({"scene": scene, "again": scene, "number": 1})
    second, more = packed.pack([scene, 2])
    scenes = [name for name in parcels if name.startswith("eclat-scene-")]
    assert len(scenes) == 1 and len(parcels) == 2 and scenes[0] in more
    assert more[scenes[0]] is parcels[scenes[0]]
    assert len(parcels[first]) < 500 < len(parcels[scenes[0]])
    opened = Opened()
    one, two = opened.open(first, parcels), opened.open(second, more)
    assert one["scene"] is one["again"] is two[0] and one["number"] == 1
    assert [mesh.name for mesh in two[0].meshes] == [mesh.name for mesh in scene.meshes]


def test_a_closure_travels() -> None:
    def adder(n: int) -> Callable[[int], int]:
        return lambda m: m + n

    name, parcels = packing.Packed().pack(adder(3))
    assert Opened().open(name, parcels)(4) == 7


def test_few_parcels_stay_open() -> None:
    opened = Opened()
    for n in range(3 * OPENED):
        name, parcels = packing.Packed().pack(n)
        assert opened.open(name, parcels) == n
    assert len(opened._things) == OPENED
