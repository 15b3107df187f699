# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures that grow in tev while they are rendered, against the pictures that `render` returns."""

from __future__ import annotations

import socket
from typing import Any

import numpy as np
import pytest

import eclat
import eclat.images.denoiser
from eclat.errors import EclatError, EclatWarning
from eclat.images.image import Image
from eclat.images.record_overlay import visible_places
from eclat.scenes import build
from support.tev_receiver import Shown, TevReceiver
from support.two_lamps import lamps_of_all_kinds

SIZE = (96, 64)


def colors(shown: Shown, layer: str = "") -> np.ndarray[Any, np.dtype[np.float32]]:
    return np.stack([shown.channels[f"{layer}{letter}"] for letter in "RGB"], axis=-1)


@pytest.mark.parametrize("halves", [False, True])
def test_every_tile_arrives_before_the_picture_is_finished(halves: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    # Without the pictures between passes, all that is shown comes from tiles.
    monkeypatch.setattr(eclat.Display, "show", lambda display, image: None)
    with TevReceiver() as tev:
        image = eclat.render(
            "cornell-box", eclat.Path(), samples=8, size=SIZE, halves=halves, display_server=tev.address
        )
    shown = tev.pictures["cornell-box (path)"]
    assert {tuple(update[:2]) for update in shown.updates} == {(0, 0), (64, 0)}
    np.testing.assert_array_equal(shown.channels["depth.Z"] == np.inf, image["depth"] == np.inf)
    if halves:
        # The tiles of one half differ from the mean of both by noise only.
        np.testing.assert_allclose(colors(shown).mean(), image.pixels.mean(), rtol=0.1)
    else:
        np.testing.assert_array_equal(colors(shown), image.pixels)
        np.testing.assert_array_equal(colors(shown, "direct."), image["direct"])
        np.testing.assert_array_equal(colors(shown, "indirect."), image["indirect"])


@pytest.mark.parametrize("what", [eclat.Path(), eclat.IrradianceCache(max_error=0.1)])
def test_at_the_end_all_layers_are_shown_and_the_picture_is_the_same_as_without(what: eclat.Method) -> None:
    plain = eclat.render("cornell-box", what, samples=4, size=SIZE)
    with TevReceiver() as tev:
        image = eclat.render("cornell-box", what, samples=4, size=SIZE, display_server=tev.address)
    np.testing.assert_array_equal(image.pixels, plain.pixels)
    shown = tev.pictures[f"cornell-box ({what.name})"]
    np.testing.assert_array_equal(colors(shown), image.pixels)
    assert {name.split(".")[0] for name in shown.channels} == {"R", "G", "B", *image.layers}


def test_records_are_marked_where_they_are() -> None:
    scene = build("cornell-box")
    solution = eclat.solve(scene, eclat.IrradianceCache(max_error=0.1), size=SIZE)
    with TevReceiver() as tev:
        image = eclat.render(scene, solution, samples=4, size=SIZE, display_server=tev.address)
    records = solution.record_positions
    assert records is not None
    wanted = visible_places(image, scene.cameras[0], records)
    drawn = np.array([v for kind, v in tev.pictures["cornell-box (irradiance-cache)"].drawn if kind == 18])
    np.testing.assert_allclose(drawn[:, :2] + drawn[:, 2:] / 2, wanted, atol=1e-4)
    assert len(drawn) == int(image["record_density"].sum()) > 20


@pytest.mark.skipif(not eclat.images.denoiser.has_denoiser(), reason="Open Image Denoise is not installed")
def test_tiles_of_a_denoised_picture_leave_it_alone() -> None:
    with TevReceiver() as tev:
        image = eclat.render(
            "cornell-box", eclat.Path(), samples=4, size=SIZE, denoise=True, display_server=tev.address
        )
    shown = tev.pictures["cornell-box (path)"]
    np.testing.assert_array_equal(colors(shown), image.pixels)
    np.testing.assert_array_equal(colors(shown, "noisy."), image.layers.get("noisy", colors(shown, "noisy.")))


def test_groups_of_lamps_are_shown_as_layers_of_their_sum() -> None:
    with TevReceiver() as tev:
        image = eclat.render(
            lamps_of_all_kinds(), eclat.Direct(), samples=2, size=SIZE, light_groups=True, display_server=tev.address
        )
    (shown,) = tev.pictures.values()
    np.testing.assert_array_equal(colors(shown), image.pixels)
    np.testing.assert_array_equal(colors(shown, "light.globe."), image["light.globe"])


def test_previews_are_called_as_well() -> None:
    seen: list[Image] = []
    with TevReceiver() as tev:
        eclat.render("cornell-box", eclat.Path(), samples=2, size=SIZE, preview=seen.append, display_server=tev.address)
    assert len(seen) == 1 and tev.pictures


def test_without_a_server_the_picture_is_the_same() -> None:
    with socket.create_server(("localhost", 0)) as unused:
        address = f"localhost:{unused.getsockname()[1]}"
    plain = eclat.render("cornell-box", eclat.Path(), samples=2, size=SIZE)
    with pytest.warns(EclatWarning, match="cannot be reached") as heard:
        image = eclat.render("cornell-box", eclat.Path(), samples=2, size=SIZE, display_server=address)
    assert len(heard) == 1
    np.testing.assert_array_equal(image.pixels, plain.pixels)


def test_what_is_no_address_is_refused_before_anything_is_rendered() -> None:
    with pytest.raises(EclatError, match="expected host:port"):
        eclat.render("cornell-box", display_server="localhost:tev")
