# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Encoded images become arrays, or an EclatError."""

from __future__ import annotations

import io
import struct
import tracemalloc
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from eclat.errors import EclatError
from eclat.loaders import images
from eclat.loaders.images import decode_image, read_image_file

NUMBERS = np.random.default_rng(1)
COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def png(array: np.ndarray, size: tuple[int, int] | None = None) -> bytes:
    """A PNG of 8 or 16 bits that may lie about its size."""
    height, width = size or array.shape[:2]
    bits = 8 * array.dtype.itemsize
    rows = b"".join(b"\0" + row.astype(f">u{array.dtype.itemsize}").tobytes() for row in array)
    header = struct.pack(">IIBBBBB", width, height, bits, COLOR_TYPES[array.shape[2]], 0, 0, 0)
    parts = [(b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    chunks = [
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def encoded(mode: str, kind: str) -> bytes:
    buffer = io.BytesIO()
    Image.new(mode, (9, 5)).save(buffer, kind)
    return buffer.getvalue()


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_sixteen_bits_are_kept(channels: int) -> None:
    array = NUMBERS.integers(0, 65536, (5, 7, channels)).astype(np.uint16)
    image = decode_image(png(array))
    assert image.dtype == np.float32
    np.testing.assert_array_equal(np.round(image * 65535.0), array)


@pytest.mark.parametrize(
    ("mode", "kind", "channels"),
    [
        *(("1", "PNG", 1), ("L", "PNG", 1), ("LA", "PNG", 4), ("P", "PNG", 3), ("RGB", "PNG", 3), ("RGBA", "PNG", 4)),
        *(("L", "JPEG", 1), ("RGB", "JPEG", 3), ("CMYK", "JPEG", 3), ("RGB", "BMP", 3), ("RGBA", "TGA", 4)),
        *(("RGB", "TIFF", 3), ("P", "GIF", 3), ("RGBA", "WEBP", 4)),
    ],
)
def test_channels_of_each_mode(mode: str, kind: str, channels: int) -> None:
    image = decode_image(encoded(mode, kind))
    assert (image.shape, image.dtype) == ((5, 9, channels), np.uint8)


def test_grey_with_alpha_becomes_rgba() -> None:
    image = decode_image(png(np.array([[[10, 20]]], np.uint8)))
    np.testing.assert_array_equal(image, [[[10, 10, 10, 20]]])


@pytest.mark.parametrize("size", [(100_000, 100_000), (16_000, 8_000), (0, 5)])
def test_false_sizes_allocate_no_memory(size: tuple[int, int]) -> None:
    data = png(np.zeros((2, 2, 3), np.uint8), size)
    tracemalloc.start()
    with pytest.raises(EclatError):
        decode_image(data)
    assert tracemalloc.get_traced_memory()[1] < 1 << 24
    tracemalloc.stop()


def exr(array: np.ndarray, path: Path, names: str = "RGB", layer: str = "") -> Path:
    import OpenEXR

    channels = {layer + name: np.ascontiguousarray(array[..., i]) for i, name in enumerate(names)}
    with OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels) as file:
        file.write(str(path))
    return path


def pfm(array: np.ndarray, path: Path) -> Path:
    height, width = array.shape[:2]
    path.write_bytes(f"PF\n{width} {height}\n1.0\n".encode() + array[::-1].astype(">f4").tobytes())
    return path


def hdr(array: np.ndarray, path: Path, packed: bool = True) -> Path:
    """Radiance: each component of a row as literals, its last value as a run; or flat."""
    exponents = np.frexp(array.max(axis=2))[1]
    mantissas = np.floor(np.ldexp(array, 8 - exponents[..., None])).astype(np.uint8)
    texels = np.dstack((mantissas, (exponents + 128).astype(np.uint8)))
    height, width = array.shape[:2]
    body = texels.tobytes()
    if packed:
        rows = [
            b"\x02\x02"
            + struct.pack(">H", width)
            + b"".join(bytes([width - 1]) + row[:-1, c].tobytes() + b"\x81" + row[-1:, c].tobytes() for c in range(4))
            for row in texels
        ]
        body = b"".join(rows)
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y {height} +X {width}\n".encode() + body)
    return path


@pytest.mark.parametrize("write", [exr, pfm])
def test_float_formats_are_exact_and_linear(tmp_path: Path, write: Callable[[np.ndarray, Path], Path]) -> None:
    array = NUMBERS.random((5, 9, 3), dtype=np.float32) * 100
    path = write(array, tmp_path / f"a.{write.__name__}")
    image, linear = read_image_file(path, path.read_bytes())
    assert linear and image.dtype == np.float32
    np.testing.assert_array_equal(image, array)


@pytest.mark.parametrize("packed", [True, False])
def test_radiance_files_divide_by_their_exposure(tmp_path: Path, packed: bool) -> None:
    array = (NUMBERS.random((6, 20, 3)) * 100).astype(np.float32)
    path = hdr(array, tmp_path / "a.hdr", packed)
    image, linear = read_image_file(path, path.read_bytes())
    assert linear
    np.testing.assert_allclose(image * 2, array, atol=128 / 256)


def with_line(path: Path, line: bytes) -> Path:
    path.write_bytes(path.read_bytes().replace(b"EXPOSURE=2", line))
    return path


@pytest.mark.parametrize(
    ("line", "factors"),
    [(b"EXPOSURE= 4E0\nEXPOSURE=5e-1", (2, 2, 2)), (b"EXPOSURE=2\nCOLORCORR= 1 2 0.5", (2, 4, 1))],
)
def test_all_factors_of_a_radiance_header_count(tmp_path: Path, line: bytes, factors: tuple[float, ...]) -> None:
    array = (NUMBERS.random((6, 20, 3)) * 100).astype(np.float32)
    path = with_line(hdr(array, tmp_path / "a.hdr", True), line)
    image, _ = read_image_file(path, path.read_bytes())
    np.testing.assert_allclose(image * np.array(factors), array, atol=128 / 256)


@pytest.mark.parametrize(
    "line",
    [
        b"EXPOSURE=1.0..",
        b"EXPOSURE=",
        b"EXPOSURE=nan",
        b"EXPOSURE=-1",
        b"EXPOSURE=1e999",
        b"COLORCORR=1 1",
        b"COLORCORR=1 0 1",
    ],
)
def test_a_factor_that_is_no_positive_number_is_refused(tmp_path: Path, line: bytes) -> None:
    path = with_line(hdr(np.ones((6, 20, 3), np.float32), tmp_path / "a.hdr", True), line)
    with pytest.raises(EclatError, match=f"{line.split(b'=')[0].decode()}: expected .* above 0"):
        read_image_file(path, path.read_bytes())


def test_exr_layers_and_single_channels(tmp_path: Path) -> None:
    array = NUMBERS.random((3, 4, 4), dtype=np.float32)
    for names, layer, channels in (("RGBA", "", 4), ("RGB", "diffuse.", 3), ("Y", "", 1), ("Z", "", 1)):
        path = exr(array, tmp_path / "a.exr", names, layer)
        np.testing.assert_array_equal(read_image_file(path, path.read_bytes())[0], array[..., :channels])


@settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_damaged_images_are_refused_or_read(tmp_path: Path, data: st.DataObject) -> None:
    array = (np.indices((6, 20)).sum(axis=0)[..., None] % [5, 7, 9] + 1).astype(np.float32)
    makers: dict[str, Callable[[], bytes]] = {
        "a.png": lambda: png(array.astype(np.uint16)),
        "a.jpg": lambda: encoded("RGB", "JPEG"),
        "a.hdr": lambda: hdr(array, tmp_path / "a.hdr").read_bytes(),
        "a.pfm": lambda: pfm(array, tmp_path / "a.pfm").read_bytes(),
    }
    name = data.draw(st.sampled_from(sorted(makers)))
    damaged = bytearray(makers[name]())
    for place, byte in data.draw(
        st.lists(st.tuples(st.integers(0, len(damaged) - 1), st.integers(0, 255)), max_size=4)
    ):
        damaged[place] = byte
    damaged = damaged[: data.draw(st.integers(0, len(damaged)))]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            image, _ = read_image_file(tmp_path / name, bytes(damaged))
        except EclatError:
            return
    assert image.ndim == 3 and image.shape[2] in (1, 3, 4)


def test_exr_files_that_end_in_their_pixels_say_so(tmp_path: Path) -> None:
    path = exr(NUMBERS.random((40, 40, 3), dtype=np.float32), tmp_path / "a.exr")
    data = path.read_bytes()
    with pytest.raises(EclatError, match="expected the pixels that the header announces"):
        read_image_file(path, data[: len(data) // 2])


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan])
def test_exr_texels_that_are_not_finite_pass_without_foreign_warnings(tmp_path: Path, value: float) -> None:
    path = exr(np.full((4, 4, 3), value, np.float32), tmp_path / "a.exr")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        image, _ = read_image_file(path, path.read_bytes())
    np.testing.assert_array_equal(image, np.float32(value))


@pytest.mark.parametrize("keep", [0, 10, 100, 300])
def test_truncated_exr_files(tmp_path: Path, keep: int) -> None:
    path = exr(NUMBERS.random((40, 40, 3), dtype=np.float32), tmp_path / "a.exr")
    data = path.read_bytes()[:keep]
    path.write_bytes(data)
    with pytest.raises(EclatError, match="cannot be decoded"):
        read_image_file(path, data)


def test_images_of_one_scene_share_a_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    file = io.BytesIO()
    Image.new("L", (1000, 1000)).save(file, "PNG")
    data = file.getvalue()
    monkeypatch.setattr(images, "_ALLOWANCE", 2_500_000)
    monkeypatch.setattr(images, "_GROWTH", 2)
    with images.image_budget():
        for _ in range(2):
            images.decode_image(data)
        with pytest.raises(EclatError, match="the image would take 0 MiB, and all images of the scene together"):
            images.decode_image(data)
    images.decode_image(data)


@pytest.mark.parametrize(("channels", "bits", "taken"), [(1, 8, 1), (3, 8, 4), (1, 16, 4), (3, 16, 12), (4, 16, 16)])
def test_the_budget_counts_the_bytes_that_texels_take(
    channels: int, bits: int, taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = png(np.zeros((8, 8, channels), np.uint8 if bits == 8 else np.uint16))
    monkeypatch.setattr(images, "_GROWTH", 0)
    for allowance, fits in ((64 * taken, True), (64 * taken - 1, False)):
        monkeypatch.setattr(images, "_ALLOWANCE", allowance)
        with images.image_budget():
            if fits:
                pixels = images.decode_image(data)
                assert pixels.nbytes <= 64 * taken
            else:
                with pytest.raises(EclatError, match="all images of the scene together"):
                    images.decode_image(data)


def test_small_files_of_linear_images_must_not_fill_gigabytes() -> None:
    rows = b"\2\2\x20\0" + (b"\xff\x60" * 64 + b"\xc0\x60") * 4
    data = b"#?RADIANCE\n\n-Y 16000 +X 8192\n" + rows * 4000
    with pytest.raises(EclatError, match="would take 1500 MiB, more than 512 MiB plus 256 times"):
        read_image_file(Path("a.hdr"), data[:3_000_000])


@pytest.mark.parametrize(
    "mode", ["P", "P with transparency", "RGB", "RGB with transparency", "RGBA", "LA", "PA", "CMYK"]
)
def test_conversion_in_strips_is_conversion_at_once(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Converted at once, a palette image of a hundred bytes took 1.3 GB for 400 MB of texels."""
    texels = np.random.default_rng(1).integers(0, 255, (7, 5, 4), dtype=np.uint8)
    image = Image.fromarray(texels, "RGBA")
    kind, _, transparent = mode.partition(" with ")
    image = image.convert("RGB").quantize(16) if kind in ("P", "PA") else image
    image = image.convert(kind)
    if transparent:
        image.info["transparency"] = 3 if kind == "P" else image.getpixel((2, 3))
    wanted = "RGBA" if transparent or kind in ("RGBA", "LA", "PA") else "RGB"
    monkeypatch.setattr(images, "_STRIP", 11)  # two rows
    assert np.array_equal(images._converted(image, wanted), np.array(image.convert(wanted)))
