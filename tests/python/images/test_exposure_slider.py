# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures with a slider for their exposure."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess

import numpy as np
import pytest

from eclat.images.exposure_slider import MOST_COLUMNS, encode_rgbe
from eclat.images.image import Image
from eclat.images.tone import to_display

DIM = np.random.default_rng(4).random((6, 9, 3)).astype(np.float32) ** 3 * 4


def decoded(bytes_: np.ndarray) -> np.ndarray:
    return bytes_[..., :3] * np.exp2(bytes_[..., 3:].astype(np.float64) - 136) * (bytes_[..., 3:] > 0)


def test_rgbe_is_precise_to_half_a_mantissa() -> None:
    for scale in (1e-6, 1.0, 1e6):
        pixels = DIM * np.float32(scale)
        largest = pixels.max(axis=2, keepdims=True)
        assert (np.abs(decoded(encode_rgbe(pixels)) - pixels) <= largest / 256 * 1.0001).all()
    assert not decoded(encode_rgbe(np.zeros((1, 1, 3), np.float32))).any()
    assert decoded(encode_rgbe(np.full((1, 1, 3), 255.7 / 256, np.float32))).max() == pytest.approx(1)


def test_wide_pictures_are_reduced_by_their_means() -> None:
    pixels = np.zeros((10, 3 * MOST_COLUMNS - 1, 3), np.float32)
    pixels[:, ::3] = 3
    html = Image(pixels)._repr_html_()
    assert f'width="{(3 * MOST_COLUMNS - 1) // 3}" height="3"' in html
    assert decoded(sent(html).reshape(3, -1, 4)).mean() == pytest.approx(1, rel=0.01)
    pixels[0, 0] = np.nan
    assert "nan" not in Image(pixels)._repr_html_().lower().partition("base64")[0]


def sent(html: str) -> np.ndarray:
    found = re.search(r'atob\("([^"]*)"\)', html)
    assert found is not None
    return np.frombuffer(base64.b64decode(found[1]), np.uint8)


@pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")
def test_the_script_shows_what_a_png_shows() -> None:
    html = Image(DIM)._repr_html_()
    script = re.search(r"<script>(.*)</script>", html, re.S)
    assert script is not None
    # A document with just what the script uses, whose canvas keeps the last picture.
    stand_in = """
    let kept;
    const context = {createImageData: (w, h) => ({data: new Uint8ClampedArray(4 * w * h)}), putImageData: d => { kept = d; }};
    const element = {style: {}, parentElement: {style: {}}, value: "0", getContext: () => context,
      addEventListener: (name, run) => { element.run = run; }};
    globalThis.document = {getElementById: () => ({querySelector: () => element})};
    """
    ask = """for (const stops of [0, 2, -3]) {
      element.value = String(stops); element.run(); console.log(JSON.stringify([...kept.data]));
    }"""
    # The output element writes the value of the shared stand-in, so its text is set aside.
    code = script[1].replace('root.querySelector("output").value =', "globalThis.text =")
    done = subprocess.run(["node", "-e", stand_in + code + ask], capture_output=True, text=True, timeout=60, check=True)
    for line, stops in zip(done.stdout.splitlines(), (0, 2, -3), strict=True):
        shown = np.array(json.loads(line)).reshape(6, 9, 4)
        assert (shown[..., 3] == 255).all()
        # A dark channel beside a bright one is as coarse as the bright one's mantissa, so the bytes that were sent count.
        expected = to_display(decoded(encode_rgbe(DIM)), stops).astype(int)
        assert np.abs(shown[..., :3] - expected).max() <= 1
