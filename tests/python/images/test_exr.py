# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""EXR files as other programs see them, and other programs' files as we do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eclat.errors import EclatError, EclatWarning
from eclat.images.exr import REC_709, decode_exr, encode_exr
from eclat.images.image import LAYERS, Image, check_size

RANDOM = np.random.default_rng(3)


def layered(height: int = 5, width: int = 7) -> Image:
    names = [name for name, letters in LAYERS.items() if len(letters) == 3]
    greys = [name for name, letters in LAYERS.items() if len(letters) == 1]
    colour = RANDOM.random((1 + len(names), height, width, 3), dtype=np.float32)
    grey = RANDOM.random((len(greys), height, width), dtype=np.float32)
    layers = dict(zip(names, colour[1:], strict=True)) | dict(zip(greys, grey, strict=True))
    return Image(colour[0], layers, {"scene": "Ümlaut", "seed": 7, "options": {"max_error": 0.01}, "version": "0.1"})


def test_channel_names_and_values_as_the_library_reads_them(tmp_path: Path) -> None:
    image = layered()
    image.save(tmp_path / "a.exr")
    file = OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True)
    channels = {name: channel.pixels for name, channel in file.channels().items()}
    colours = [f"{layer}.{letter}" for layer in ("direct", "indirect", "albedo") for letter in "RGB"]
    vectors = [f"{layer}.{letter}" for layer in ("normal", "motion_next", "motion_previous") for letter in "XYZ"]
    greys = ["depth.Z", "record_density.Y", "record_weight.Y", "object_id.Y"]
    assert sorted(channels) == sorted([*"RGB", *colours, *vectors, *greys])
    assert all(pixels.dtype == np.float32 for pixels in channels.values())
    np.testing.assert_array_equal(channels["G"], image.pixels[..., 1])
    np.testing.assert_array_equal(channels["indirect.B"], image.layers["indirect"][..., 2])
    np.testing.assert_array_equal(channels["normal.Z"], image.layers["normal"][..., 2])
    np.testing.assert_array_equal(channels["depth.Z"], image.layers["depth"])


def test_the_header_contains_primaries_and_metadata(tmp_path: Path) -> None:
    layered().save(tmp_path / "a.exr")
    header = OpenEXR.File(str(tmp_path / "a.exr")).header()
    assert header["chromaticities"] == pytest.approx(REC_709)
    assert header["eclat.scene"] == '"Ümlaut"'
    assert header["eclat.options"] == '{"max_error": 0.01}'


def test_loading_gives_back_everything(tmp_path: Path) -> None:
    image = layered()
    image.save(tmp_path / "a.exr")
    loaded = Image.load(tmp_path / "a.exr")
    np.testing.assert_array_equal(loaded.pixels, image.pixels)
    assert loaded.layers.keys() == image.layers.keys() == LAYERS.keys()
    for name, layer in image.layers.items():
        np.testing.assert_array_equal(loaded.layers[name], layer)
    assert loaded.metadata == image.metadata


def test_nan_and_infinity_survive(tmp_path: Path) -> None:
    pixels = np.zeros((2, 2, 3), dtype=np.float32)
    pixels[0, 1] = (np.nan, np.inf, -np.inf)
    with pytest.warns(EclatWarning):
        Image(pixels).save(tmp_path / "a.exr")
    np.testing.assert_array_equal(Image.load(tmp_path / "a.exr").pixels, pixels)


def foreign(tmp_path: Path, channels: dict[str, np.ndarray]) -> bytes:
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    OpenEXR.File(header, channels).write(str(tmp_path / "foreign.exr"))
    return (tmp_path / "foreign.exr").read_bytes()


def test_half_floats_and_grey_of_other_programs(tmp_path: Path) -> None:
    grey = RANDOM.random((3, 4)).astype(np.float16)
    pixels, layers, metadata = decode_exr(foreign(tmp_path, {"Y": grey}), "foreign.exr", check_size)
    np.testing.assert_array_equal(pixels, np.repeat(grey.astype(np.float32)[..., None], 3, axis=2))
    assert layers == {} and metadata == {}


def test_unknown_channels_are_named_in_a_warning(tmp_path: Path) -> None:
    plane = np.ones((3, 4), dtype=np.float32)
    data = foreign(tmp_path, dict.fromkeys(("R", "G", "B", "A", "id.a", "id.b"), plane))
    with pytest.warns(EclatWarning) as caught:
        decode_exr(data, "foreign.exr", check_size)
    assert [str(w.message) for w in caught] == ["foreign.exr: these channels are ignored: A, id.b"]


def test_a_file_without_colour(tmp_path: Path) -> None:
    data = foreign(tmp_path, {"depth.Z": np.ones((3, 4), dtype=np.float32)})
    with pytest.raises(EclatError) as caught:
        decode_exr(data, "foreign.exr", check_size)
    assert str(caught.value) == "foreign.exr: expected the channels R, G, B or the channel Y, got depth.Z"


def test_other_files_are_not_exr() -> None:
    with pytest.raises(EclatError) as caught:
        decode_exr(b"\x89PNG\r\n", "a.exr", check_size)
    assert str(caught.value) == "a.exr: expected an OpenEXR file, got one that starts with b'\\x89PNG'"


def test_a_window_that_is_too_large_is_refused_before_allocation() -> None:
    data = bytearray(encode_exr(np.zeros((1, 1, 3), dtype=np.float32), {}, {}, LAYERS))
    at = data.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
    data[at : at + 16] = np.array([0, 0, 999_999, 999_999], dtype="<i4").tobytes()
    with pytest.raises(EclatError, match=r"a\.exr: expected"):
        decode_exr(bytes(data), "a.exr", check_size)


VALID = encode_exr(RANDOM.random((4, 6, 3), dtype=np.float32), {"depth": np.ones((4, 6), np.float32)}, {"a": 1}, LAYERS)


@pytest.mark.filterwarnings("ignore::eclat.errors.EclatWarning")
@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damaged_files_never_crash(data: st.DataObject) -> None:
    broken = bytearray(VALID[: data.draw(st.integers(0, len(VALID)))])
    for _ in range(data.draw(st.integers(0, 4))):
        if broken:
            broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    try:
        pixels, _, _ = decode_exr(bytes(broken), "broken.exr", check_size)
    except EclatError as error:
        assert str(error).startswith("broken.exr: expected")
    else:
        assert pixels.shape[2] == 3
