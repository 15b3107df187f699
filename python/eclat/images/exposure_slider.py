# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture with a slider for its exposure, as HTML that needs nothing but a browser.

The radiance is sent as four bytes a pixel in the format of Radiance pictures (8-bit mantissas and a common exponent), and a
script displays it as the PNG encoder does. Where scripts do not run, the picture of exposure 0 is shown.
"""

from __future__ import annotations

import base64
import itertools
from html import escape
from string import Template

import numpy as np
from numpy.typing import NDArray

MOST_COLUMNS = 960
"""The greatest width that is sent; wider pictures are shown by the means of squares of pixels, since a notebook is narrower."""

_PAGE = Template("""<div id="$id"><canvas width="$width" height="$height" style="display:none"></canvas>
<img alt="$alt" src="data:image/png;base64,$png"><div style="display:none">exposure
<input type="range" min="-8" max="8" step="0.25" value="0"> <output>+0 stops</output></div>
<script>(() => {
const root = document.getElementById("$id"), canvas = root.querySelector("canvas"), slider = root.querySelector("input");
const data = Uint8Array.from(atob("$rgbe"), c => c.charCodeAt(0)), context = canvas.getContext("2d");
const out = context.createImageData($width, $height);
const encode = x => x <= 0.0031308 ? 12.92 * x : 1.055 * Math.pow(x, 1 / 2.4) - 0.055;
const show = () => {
  const stops = Number(slider.value);
  for (let i = 0; i < data.length; i += 4) {
    const scale = data[i + 3] ? Math.pow(2, data[i + 3] - 136 + stops) : 0;
    for (let c = 0; c < 3; ++c) out.data[i + c] = 255 * encode(Math.min(1, data[i + c] * scale));
    out.data[i + 3] = 255;
  }
  context.putImageData(out, 0, 0);
  root.querySelector("output").value = (stops < 0 ? "" : "+") + stops + " stops";
};
slider.addEventListener("input", show); show();
canvas.style.display = "block"; slider.parentElement.style.display = "block"; root.querySelector("img").style.display = "none";
})();</script></div>""")

_numbers = itertools.count()


def exposure_slider(pixels: NDArray[np.float32], png: bytes) -> str:
    """Return the HTML of a picture with a slider.

    Parameters
    ----------
    pixels : (H, W, 3) linear radiance; values that are negative or not finite are shown black.
    png : the picture at exposure 0, for where scripts do not run.
    """
    shown = _reduced(np.nan_to_num(pixels, nan=0.0, posinf=0.0, neginf=0.0))
    height, width = shown.shape[:2]
    return _PAGE.substitute(
        id=f"eclat-picture-{next(_numbers)}-{abs(hash(png)) % 10**9}",
        width=width,
        height=height,
        alt=escape(f"{pixels.shape[1]}×{pixels.shape[0]} pixels"),
        png=base64.b64encode(png).decode("ascii"),
        rgbe=base64.b64encode(encode_rgbe(shown).tobytes()).decode("ascii"),
    )


def encode_rgbe(pixels: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Encode radiance (H, W, 3) as (H, W, 4) bytes: three mantissas m and an exponent e, which stand for m · 2^(e − 136)."""
    radiance = np.maximum(pixels, 0).astype(np.float64)
    largest = radiance.max(axis=2)
    exponent = np.frexp(largest)[1]
    # A largest mantissa of 255.5 or more would round to 256.
    exponent += np.rint(largest * np.exp2(8.0 - exponent)) > 255
    exponent = np.clip(exponent, -127, 127)
    mantissas = np.clip(np.rint(radiance * np.exp2(8.0 - exponent)[..., None]), 0, 255)
    lit = mantissas.any(axis=2)
    return np.concatenate([mantissas, np.where(lit, exponent + 128, 0)[..., None]], axis=2).astype(np.uint8)


def _reduced(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    factor = -(-pixels.shape[1] // MOST_COLUMNS)
    if factor == 1:
        return pixels
    height, width = (max(side // factor, 1) * factor for side in pixels.shape[:2])
    if height > pixels.shape[0]:
        return pixels[:, ::factor]
    squares = pixels[:height, :width].reshape(height // factor, factor, width // factor, factor, 3)
    means: NDArray[np.float32] = squares.mean(axis=(1, 3), dtype=np.float64).astype(np.float32)
    return means
