# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures: their checks, and saving as the user sees it."""

from __future__ import annotations

import errno
import io
import os
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.images.image import Image, check_size

SUFFIXES = (".exr", ".png", ".pfm", ".npy")


def picture(height: int = 4, width: int = 6) -> Image:
    return Image(np.random.default_rng(5).random((height, width, 3), dtype=np.float32), metadata={"seed": 5})


@pytest.mark.parametrize("suffix", [".exr", ".pfm", ".npy", ".EXR"])
def test_radiance_formats_give_back_the_same_bits(tmp_path: Path, suffix: str) -> None:
    image = picture()
    image.save(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(Image.load(tmp_path / f"a{suffix}").pixels, image.pixels)


def test_png_as_pillow_reads_it(tmp_path: Path) -> None:
    pixels = np.zeros((2, 2, 3), dtype=np.float32)
    pixels[0, 1] = (1.0, 0.5, 0.18)
    Image(pixels).save(tmp_path / "a.png")
    with PIL.Image.open(tmp_path / "a.png") as read:
        assert read.mode == "RGB"
        assert read.size == (2, 2)
        # 255 · srgb(0.5) = 187.5 → 188 (half to even), 255 · srgb(0.18) = 117.6
        assert read.getpixel((1, 0)) == (255, 188, 118)
        assert read.info["srgb"] == 0


def test_png_with_exposure_and_tone_mapping(tmp_path: Path) -> None:
    grey = Image(np.full((1, 1, 3), 0.09, dtype=np.float32))
    grey.save(tmp_path / "a.png", exposure=1.0, tone_mapping="filmic")
    with PIL.Image.open(tmp_path / "a.png") as read:
        assert read.getpixel((0, 0)) == (118, 118, 118)


def test_a_notebook_shows_a_png() -> None:
    with PIL.Image.open(io.BytesIO(picture()._repr_png_())) as read:
        assert (read.format, read.size) == ("PNG", (6, 4))


def test_the_repr_is_a_line() -> None:
    pixels = np.zeros((30, 40, 3), np.float32)
    assert repr(Image(pixels)) == "<Image: 40×30>"
    assert repr(Image(pixels, {"direct": pixels, "depth": pixels[..., 0]})) == "<Image: 40×30, layers direct, depth>"


def test_arrays_of_other_types_become_float32() -> None:
    image = Image(np.ones((2, 3, 3)), {"depth": np.ones((2, 3), dtype=np.int64)})
    assert image.pixels.dtype == np.float32
    assert image.layers["depth"].dtype == np.float32
    assert (image.width, image.height) == (3, 2)


@pytest.mark.parametrize(
    ("pixels", "layers", "message"),
    [
        (np.zeros((2, 3)), {}, "image: expected pixels of shape (height, width, 3), got (2, 3)"),
        (np.zeros((2, 3, 4)), {}, "image: expected pixels of shape (height, width, 3), got (2, 3, 4)"),
        (
            np.zeros((0, 3, 3)),
            {},
            "image: expected a width and a height between 1 and 65,536 pixels, got 3x0",
        ),
        (
            np.zeros((2, 3, 3)),
            {"depth": np.zeros((3, 2))},
            "image, layer 'depth': expected the shape (2, 3) or (2, 3, 3), got (3, 2)",
        ),
    ],
)
def test_shapes_that_do_not_fit(pixels: np.ndarray, layers: dict[str, np.ndarray], message: str) -> None:
    with pytest.raises(EclatError) as caught:
        Image(pixels, layers)
    assert str(caught.value) == message


@pytest.mark.parametrize("size", [(0, 1), (1, 0), (-1, 5), (10**6, 1), (10**6, 10**6)])
def test_impossible_sides(size: tuple[int, int]) -> None:
    with pytest.raises(EclatError) as caught:
        check_size(*size)
    assert str(caught.value) == (
        f"size: expected a width and a height between 1 and 65,536 pixels, got {size[0]}x{size[1]}"
    )


def test_too_many_pixels() -> None:
    check_size(16384, 8192)
    with pytest.raises(EclatError) as caught:
        check_size(60000, 60000, "--size")
    assert str(caught.value) == "--size: expected at most 134,217,728 pixels in total, got 60000x60000"


@pytest.mark.parametrize(
    ("suffix", "treatment"), [(".exr", "they are written as they are"), (".png", "they are shown in magenta")]
)
def test_pixels_that_are_not_finite_are_warned_about(tmp_path: Path, suffix: str, treatment: str) -> None:
    image = picture()
    image.pixels[1, 2, 0] = np.nan
    image.pixels[3, 0] = np.inf
    path = tmp_path / f"a{suffix}"
    with pytest.warns(EclatWarning) as caught:
        image.save(path)
    assert (
        str(caught[0].message)
        == f"{path}: 2 of 24 pixels are not finite, the first one at column 2, row 1; {treatment}"
    )


def test_unknown_suffixes(tmp_path: Path) -> None:
    for name, got in (
        ("a.exe", "'.exe'; did you mean '.exr'?"),
        ("a", "a name without a suffix"),
        ("a.tiff", "'.tiff'"),
    ):
        with pytest.raises(EclatError) as caught:
            picture().save(tmp_path / name)
        assert (
            str(caught.value)
            == f"{tmp_path / name}: expected an image file with one of the suffixes .exr, .png, .hdr, .pfm, .npy, got {got}"
        )


def test_metadata_that_json_cannot_hold(tmp_path: Path) -> None:
    for suffix in (".exr", ".png"):
        with pytest.raises(EclatError, match="image metadata: expected values that JSON can represent"):
            Image(np.zeros((1, 1, 3), dtype=np.float32), metadata={"what": object()}).save(tmp_path / f"a{suffix}")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_full_disk_leaves_the_old_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str) -> None:
    path = tmp_path / f"a{suffix}"
    picture().save(path)
    before = path.read_bytes()

    def full(*arguments: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(EclatError) as caught:
        picture(8, 8).save(path)
    assert str(caught.value) == f"{path}: the file cannot be written: No space left on device"
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == [path.name]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_ctrl_c_while_writing_leaves_the_old_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    path = tmp_path / f"a{suffix}"
    picture().save(path)
    before = path.read_bytes()

    def interrupted(*arguments: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        picture(8, 8).save(path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == [path.name]


def test_layers_are_read_like_a_dict() -> None:
    image = Image(picture().pixels, {"depth": np.ones((4, 6), np.float32)})
    assert image["pixels"] is image.pixels and image["depth"] is image.layers["depth"]
    assert list(image) == image.keys() == ["pixels", "depth"] and "depth" in image and "normal" not in image
    with pytest.raises(KeyError, match="no layer 'dept', expected one of pixels, depth; did you mean 'depth'"):
        image["dept"]
    np.testing.assert_array_equal(np.asarray(image), image.pixels)


def test_images_from_arrays() -> None:
    grey = np.random.default_rng(1).random((3, 5))
    for array in (grey, grey[:, :, None]):
        np.testing.assert_array_equal(
            Image.from_array(array).pixels, np.repeat(grey[..., None], 3, 2).astype(np.float32)
        )
    layered = Image.from_array(np.ones((3, 5, 3)), {"depth": grey})
    np.testing.assert_array_equal(layered["depth"], grey.astype(np.float32))
    for wrong in ("picture", np.ones(3), np.ones((3, 5, 2)), [[object()]]):
        with pytest.raises(EclatError, match="image: expected"):
            Image.from_array(wrong)


def test_images_to_pillow_and_back(tmp_path: Path) -> None:
    image = picture()
    image.save(tmp_path / "a.png", exposure=1.0, tone_mapping="filmic")
    with PIL.Image.open(tmp_path / "a.png") as read:
        np.testing.assert_array_equal(np.asarray(read), np.asarray(image.to_pil(1.0, "filmic")))
    bytes_ = np.random.default_rng(2).integers(0, 256, (4, 5, 3), dtype=np.uint8)
    again = Image.from_pil(PIL.Image.fromarray(bytes_)).to_pil()
    np.testing.assert_array_equal(np.asarray(again), bytes_)
    assert Image.from_pil(PIL.Image.new("RGBA", (2, 1), (255, 0, 0, 0))).pixels.tolist() == [[[1, 0, 0]] * 2]
    assert Image.from_pil(PIL.Image.fromarray(np.full((1, 1), 2.5, np.float32))).pixels.tolist() == [[[2.5] * 3]]
    with pytest.raises(EclatError, match="from_pil: expected a Pillow image, got ndarray"):
        Image.from_pil(bytes_)  # type: ignore[arg-type]
    with pytest.raises(EclatError, match="tone_mapping: expected one of none, filmic"):
        image.to_pil(tone_mapping="film")


def test_an_image_is_a_dict_of_its_layers() -> None:
    image = Image(np.ones((2, 3, 3), np.float32), {"depth": np.full((2, 3), 2, np.float32)})
    assert len(image) == 2 and list(image) == image.keys() == ["pixels", "depth"]
    assert [(name, array.shape) for name, array in image.items()] == [("pixels", (2, 3, 3)), ("depth", (2, 3))]
    assert [array.max() for array in image.values()] == [1, 2]
    assert dict(image)["depth"] is image["depth"] and np.asarray(image).shape == (2, 3, 3)
