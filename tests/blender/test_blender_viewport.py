# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of a viewport is refined until it is stopped."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest

import eclat
from eclat.scene import Camera, Scene, look_at
from eclat_blender.viewport import FIRST_SIDE, STEPS, Refiner


def test_pictures_get_finer_and_the_last_is_that_of_all_samples():
    calls, done = [], threading.Event()

    def render(scene, method, **given):
        calls.append(given)
        return SimpleNamespace(pixels=np.full((1, 1, 3), given["samples"]))

    def changed():
        if refiner.samples == STEPS[-1]:
            done.set()

    refiner = Refiner(changed, render)
    refiner.start(Scene(), Camera(np.eye(4)), (640, 480), denoise=False)
    assert done.wait(10)
    refiner.stop()
    assert not refiner.busy and refiner.picture[0, 0, 0] == STEPS[-1]
    assert calls[0]["size"] == (FIRST_SIDE, FIRST_SIDE * 3 // 4) and calls[1]["size"] == (640, 480)
    assert [given["samples"] for given in calls[1:]] == list(STEPS)
    assert all("continued" in given for given in calls[2:])


def test_a_real_scene_is_refined_and_stopped():
    scene = eclat.load("furnace")
    camera = Camera(look_at((0.1, 0, 0), (0.5, 0.2, 0.1)))
    twice = threading.Semaphore(0)
    refiner = Refiner(twice.release)
    refiner.start(scene, camera, (32, 24), denoise=False)
    for _ in range(3):
        assert twice.acquire(timeout=60)
    refiner.stop()
    assert not refiner.busy and refiner.error == "" and refiner.samples >= STEPS[1]
    assert refiner.picture.shape == (24, 32, 3)
    assert refiner.picture.mean() == pytest.approx(2.0, rel=0.1)


def test_a_fault_is_shown_and_not_raised():
    def render(*given, **more):
        raise eclat.EclatError("no")

    told = threading.Event()
    refiner = Refiner(told.set, render)
    refiner.start(Scene(), Camera(np.eye(4)), (8, 8), denoise=False)
    assert told.wait(10) and refiner.error == "no"
