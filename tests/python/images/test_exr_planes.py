# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""EXR files of other programs: other primaries, luminance-chroma, windows; read as textures and as pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.images.exr_planes import REC_709, read_planes, rgb_to_xyz
from eclat.images.image import Image
from eclat.loaders.images import read_image_file

COLOR = np.array([1, 0.25, 0.0625])
XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
ACESCG = (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767)


def written(path: Path, channels: dict[str, Any], **header: Any) -> Path:
    file = OpenEXR.File({"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION} | header, channels)
    file.write(str(path))
    return path


def plane(value: float, height: int = 8, width: int = 12) -> np.ndarray:
    return np.full((height, width), value, np.float32)


def both(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """As a picture, and as a texture or environment."""
    return Image.load(path).pixels, read_image_file(path, path.read_bytes())[0]


@pytest.mark.parametrize("chromaticities", [XYZ, ACESCG])
@pytest.mark.parametrize("layer", ["", "view."])
def test_other_primaries_become_rec_709(tmp_path: Path, chromaticities: tuple[float, ...], layer: str) -> None:
    to_xyz, standard = rgb_to_xyz(chromaticities), rgb_to_xyz(REC_709)
    assert to_xyz is not None and standard is not None
    stored = np.linalg.solve(to_xyz, standard @ COLOR)
    channels = {f"{layer}{letter}": plane(v) for letter, v in zip("RGB", stored, strict=True)}
    channels |= {letter: plane(v) for letter, v in zip("RGB", stored, strict=True)}
    path = written(tmp_path / "a.exr", channels, chromaticities=chromaticities)
    image = Image.load(path)
    for pixels in (*both(path), *image.layers.values()):
        np.testing.assert_allclose(pixels[3, 5], COLOR, atol=2e-6)


def test_matrices_of_the_standards() -> None:
    # The published matrix of sRGB [IEC61966], and XYZ which is its own.
    published = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    np.testing.assert_allclose(rgb_to_xyz(REC_709), published, atol=1e-4)
    np.testing.assert_allclose(rgb_to_xyz(XYZ), np.eye(3), atol=1e-12)
    assert rgb_to_xyz((0.3, 0.3) * 4) is None
    assert rgb_to_xyz((*REC_709[:7], 0.0)) is None
    assert rgb_to_xyz((*REC_709[:7], float("nan"))) is None


def test_rec_709_keeps_its_bits_and_invalid_primaries_cause_a_warning(tmp_path: Path) -> None:
    random = np.random.default_rng(1).random((3, 8, 12), dtype=np.float32)
    channels = dict(zip("RGB", random, strict=True))
    near = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329001)
    path = written(tmp_path / "near.exr", channels, chromaticities=near)
    for pixels in both(path):
        np.testing.assert_array_equal(pixels, np.moveaxis(random, 0, -1))
    path = written(tmp_path / "bad.exr", channels, chromaticities=(0.3, 0.3) * 4)
    with pytest.warns(EclatWarning, match="are not valid primaries; those of Rec. 709 are used"):
        np.testing.assert_array_equal(Image.load(path).pixels, np.moveaxis(random, 0, -1))


def test_textures_outside_the_gamut_are_cut_with_a_warning(tmp_path: Path) -> None:
    channels = {"R": plane(0), "G": plane(1), "B": plane(0)}
    path = written(tmp_path / "green.exr", channels, chromaticities=ACESCG)
    assert Image.load(path).pixels.min() < 0
    with pytest.warns(EclatWarning, match="96 texels lie outside the gamut of Rec. 709"):
        assert read_image_file(path, path.read_bytes())[0].min() == 0


@pytest.mark.parametrize("step", [1, 2])
def test_luminance_and_chroma_become_colours(tmp_path: Path, step: int) -> None:
    standard = rgb_to_xyz(REC_709)
    assert standard is not None
    y = float(standard[1] @ COLOR)
    ramp = np.linspace(1, 2, 12, dtype=np.float32)[None, :] * plane(y)
    chroma = {"RY": (COLOR[0] - y) / y, "BY": (COLOR[2] - y) / y}
    channels = {name: OpenEXR.Channel(plane(value), step, step) for name, value in chroma.items()}
    path = written(tmp_path / "yc.exr", {"Y": OpenEXR.Channel(ramp), **channels})
    for pixels in both(path):
        assert pixels.shape == (8, 12, 3)
        np.testing.assert_allclose(pixels, (ramp / y)[..., None] * COLOR, atol=1e-5)


def test_chroma_between_its_samples_is_interpolated(tmp_path: Path) -> None:
    # The library wants a plane of the whole size and stores every second value of it.
    ry = np.tile(np.linspace(0, 1.1, 12, dtype=np.float32), (8, 1))
    zero = OpenEXR.Channel(plane(0), 2, 2)
    path = written(tmp_path / "yc.exr", {"Y": plane(1), "RY": OpenEXR.Channel(ry, 2, 2), "BY": zero})
    stored = OpenEXR.File(str(path), separate_channels=True).channels()["RY"].pixels
    red = both(path)[0][0, :, 0] - 1
    np.testing.assert_allclose(red[::2], stored[0], atol=1e-6)
    np.testing.assert_allclose(red[1:-1:2], (stored[0, :-1] + stored[0, 1:]) / 2, atol=1e-6)


def window(x0: int, y0: int, x1: int, y1: int) -> Any:
    return (np.array([x0, y0], np.int32), np.array([x1, y1], np.int32))


def test_data_windows_are_placed_in_the_display_window(tmp_path: Path) -> None:
    # Six columns of data in the left half of twelve, two rows above the display window.
    channels = {letter: plane(v, 8, 6) for letter, v in zip("RGB", COLOR, strict=True)} | {"A": plane(1, 8, 6)}
    path = written(tmp_path / "w.exr", channels, dataWindow=window(0, -2, 5, 5), displayWindow=window(0, 0, 11, 7))
    with pytest.warns(EclatWarning, match="channels are ignored: A"):
        picture, texture = both(path)
    assert picture.shape == (8, 12, 3) and texture.shape == (8, 12, 4)
    for pixels in (picture, texture[..., :3]):
        np.testing.assert_array_equal(pixels[:6, :6], np.broadcast_to(COLOR, (6, 6, 3)))
        assert not pixels[6:].any() and not pixels[:, 6:].any()
    assert texture[0, 0, 3] == 1 and texture[7, 11, 3] == 0


@pytest.mark.parametrize(
    ("display", "message"),
    [
        (window(100, 0, 111, 7), "expected a data window that overlaps the display window"),
        (window(0, 0, 1 << 20, 1 << 20), "1048577"),
    ],
)
def test_impossible_windows_are_refused(tmp_path: Path, display: Any, message: str) -> None:
    path = written(tmp_path / "w.exr", {"Y": plane(1)}, dataWindow=window(0, 0, 11, 7), displayWindow=display)
    with pytest.raises(EclatError, match=message):
        Image.load(path)
    with pytest.raises(EclatError, match=message):
        read_image_file(path, path.read_bytes())


@pytest.mark.parametrize(
    ("header", "is_xyz"),
    [
        (b"FORMAT=32-bit_rle_xyze", True),
        (b"FORMAT=32-bit_rle_rgbe\nPRIMARIES= 1 0 0 1 0 0 0.33333333 0.33333333", True),
        (b"FORMAT=32-bit_rle_rgbe\nPRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333", False),
    ],
)
def test_radiance_pictures_in_other_primaries(header: bytes, is_xyz: bool) -> None:
    data = b"#?RADIANCE\n" + header + b"\n\n-Y 1 +X 1\n" + bytes([128, 128, 128, 129])
    image, _ = read_image_file(Path("a.hdr"), data)
    standard = rgb_to_xyz(REC_709)
    assert standard is not None
    wanted = np.linalg.solve(standard, (1, 1, 1)) if is_xyz else (1, 1, 1)
    np.testing.assert_allclose(image[0, 0], wanted, atol=1e-4)


def parts(path: Path, *channels: dict[str, Any]) -> Path:
    window = (np.array([0, 0], np.int32), np.array([11, 7], np.int32))
    header = {"type": OpenEXR.scanlineimage, "displayWindow": window}
    OpenEXR.File([OpenEXR.Part(header | {"name": f"part {i}"}, c) for i, c in enumerate(channels)]).write(str(path))
    return path


@pytest.mark.parametrize("first", [0, 1])
def test_the_part_with_colours_is_read(tmp_path: Path, first: int) -> None:
    colors = {letter: plane(v) for letter, v in zip("RGB", COLOR, strict=True)}
    both_parts = [colors, {"Z": plane(7)}]
    path = parts(tmp_path / "a.exr", both_parts[first], both_parts[1 - first])
    with pytest.warns(EclatWarning, match=f"a.exr: 1 of 2 parts of the file are ignored: 'part {1 - first}'"):
        for pixels in both(path):
            np.testing.assert_allclose(pixels[3, 5], COLOR)


def test_the_size_of_every_part_is_checked(tmp_path: Path) -> None:
    path = parts(tmp_path / "a.exr", {"Y": plane(1)}, {"Z": plane(7, 60, 70)})
    sizes = []
    with pytest.warns(EclatWarning, match="ignored"):
        read_planes(path.read_bytes(), "a.exr", lambda width, height: sizes.append((width, height)))
    assert set(sizes) == {(12, 8), (70, 60)}
