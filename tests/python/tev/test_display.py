# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a receiver of tev's messages sees, and what happens without one."""

from __future__ import annotations

import socket

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.images.image import Image
from eclat.tev import display as module
from eclat.tev.display import Display, address_of
from support.tev_receiver import TevReceiver

Float32 = np.typing.NDArray[np.float32]


def random(*shape: int) -> Float32:
    return np.random.default_rng(sum(shape)).random(shape, np.float32)


def test_an_image_arrives_with_all_its_layers_bit_for_bit() -> None:
    image = Image(random(70, 130, 3), {"depth": random(70, 130), "light.stove": random(70, 130, 3)})
    with TevReceiver() as tev, Display(tev.address, "room") as display:
        display.show(image)
    shown = tev.pictures["room"].channels
    assert list(shown) == ["R", "G", "B", "depth.Z", "light.stove.R", "light.stove.G", "light.stove.B"]
    np.testing.assert_array_equal(np.stack([shown[c] for c in "RGB"], -1), image.pixels)
    np.testing.assert_array_equal(shown["depth.Z"], image["depth"])
    np.testing.assert_array_equal(shown["light.stove.B"], image["light.stove"][..., 2])


def test_a_tile_changes_its_pixels_only() -> None:
    image, tile = Image(random(100, 100, 3)), random(9, 11, 3)
    with TevReceiver() as tev, Display(tev.address, "room") as display:
        display.show(image)
        display.update((60, 50), {"": tile})
    wanted = image.pixels.copy()
    wanted[50:59, 60:71] = tile
    shown = tev.pictures["room"].channels
    np.testing.assert_array_equal(np.stack([shown[c] for c in "RGB"], -1), wanted)


def test_a_new_layer_keeps_what_was_there_and_the_marks() -> None:
    image = Image(random(20, 30, 3))
    with TevReceiver() as tev, Display(tev.address, "room") as display:
        display.show(image)
        display.mark_records(np.array([[3.0, 4.0]]))
        display.update((0, 0), {"depth": random(20, 30)})
    shown = tev.pictures["room"]
    np.testing.assert_array_equal(np.stack([shown.channels[c] for c in "RGB"], -1), image.pixels)
    assert tev.created[-1] == ("R", "G", "B", "depth.Z")
    assert [values for kind, values in shown.drawn if kind == 18] == [(2, 3, 2, 2)]


def test_a_picture_of_another_size_replaces_the_first() -> None:
    with TevReceiver() as tev, Display(tev.address, "room") as display:
        display.show(Image(random(20, 30, 3)))
        display.show(Image(random(8, 9, 3)))
    assert tev.pictures["room"].channels["R"].shape == (8, 9)


def test_a_server_that_is_absent_is_one_warning() -> None:
    with socket.create_server(("localhost", 0)) as unused:
        port = unused.getsockname()[1]
    with pytest.warns(EclatWarning) as heard, Display(f"localhost:{port}", "room") as display:
        for _ in range(3):
            display.show(Image(random(8, 8, 3)))
            display._thread.join(5)
    reason = "cannot be reached (Connection refused); the picture is not affected, but not shown there"
    assert [str(w.message) for w in heard] == [f"the display server localhost:{port} {reason}"]


def test_a_server_that_dies_is_one_warning() -> None:
    with (
        TevReceiver(most=1) as tev,
        pytest.warns(EclatWarning, match="ended the connection") as heard,
        Display(tev.address, "room") as display,
    ):
        for _ in range(3):
            display.show(Image(random(900, 900, 3)))
            display._thread.join(0.5)
    assert len(heard) == 1


def test_a_server_that_reads_nothing_is_one_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PATIENCE", 0.3)
    with (
        TevReceiver(deaf=True) as tev,
        pytest.warns(EclatWarning, match="took nothing for 0.3 s") as heard,
        Display(tev.address, "room") as display,
    ):
        display.show(Image(random(2000, 2000, 3)))
    assert len(heard) == 1


def test_the_end_of_a_picture_waits_for_a_limited_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LAST_PATIENCE", 0.3)
    with (
        TevReceiver(deaf=True) as tev,
        pytest.warns(EclatWarning, match="took too long") as heard,
        Display(tev.address, "room") as display,
    ):
        display.show(Image(random(2000, 2000, 3)))
    assert len(heard) == 1


def test_an_error_of_the_render_is_not_held_up() -> None:
    with TevReceiver() as tev, pytest.raises(KeyboardInterrupt), Display(tev.address, "room") as display:
        display.show(Image(random(300, 300, 3)))
        raise KeyboardInterrupt


@pytest.mark.parametrize(
    "text, address",
    [
        ("localhost:14158", ("localhost", 14158)),
        ("studio", ("studio", 14158)),
        ("10.0.0.7:80", ("10.0.0.7", 80)),
        ("[::1]:5000", ("::1", 5000)),
        ("[::1]", ("::1", 14158)),
    ],
)
def test_addresses(text: str, address: tuple[str, int]) -> None:
    assert address_of(text) == address


@pytest.mark.parametrize("text", ["", ":14158", "host:", "host:0", "host:65536", "host:tev"])
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(EclatError, match="expected host:port, as in localhost:14158, got"):
        address_of(text)
