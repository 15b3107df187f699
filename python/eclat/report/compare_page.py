# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A comparison as one self-contained HTML page, which embeds its pictures and needs no scripts and no network."""

from __future__ import annotations

import base64
import io
import math
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

from eclat.images.colormaps import AMOUNT, SIGNED, Anchors, colored
from eclat.images.tone import to_display
from eclat.measure.metrics import PIXELS_PER_DEGREE, Float64, has_flip, signed_error
from eclat.methods import METHODS
from eclat.report.svg_plot import log_log_plot

if TYPE_CHECKING:
    from eclat.verbs.compare import Comparison, MethodResult

# The style sheet of the page.
STYLE = """
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; padding: 0 1rem; max-width: 1600px; }
h1, h2 { font-weight: 600; line-height: 1.2; } h2 { margin-top: 2.5rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .8rem; text-align: right; border-bottom: 1px solid rgb(128 128 128 / 30%); }
th:first-child, td:first-child { text-align: left; } tr.last td { font-weight: 600; }
.row { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 320px), 1fr)); gap: 1rem; }
figure { margin: 0; } figure > img { width: 100%; height: auto; display: block; }
figcaption { font-size: 13px; margin-top: .3rem; }
.scale { display: flex; align-items: center; gap: .5rem; } .scale img { width: 160px; height: 10px; }
svg { max-width: 760px; width: 100%; } .scroll { overflow-x: auto; }
"""

STORED = ("records", "radiance_records", "photons", "patches")
"""Names of the statistics that count the records, photons or patches of a solution."""

FLIP_MISSING = "FLIP is not measured, because the package flip-evaluator is not installed (pip install flip-evaluator)."
"""The sentence on the page if FLIP cannot be measured."""


def compare_page(comparison: Comparison) -> str:
    """Write the HTML text of the page."""
    title = f"Éclat: {comparison.scene or 'scene'}"
    scale = error_scale(comparison)
    sections = [
        f"<h1>{escape(title)}</h1>",
        f"<p>{escape(_summary(comparison))}</p>",
        _table(comparison),
        f"<p>{escape(_notes())}</p>",
        "<h2>Error against time</h2>",
        _plot(comparison),
        "<h2>Reference</h2>",
        _reference(comparison, scale),
        *(_method(result, comparison.exposure, scale) for result in comparison.results),
    ]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(title)}</title>'
    body = "\n".join(sections)
    head += f"<style>{STYLE}</style>"
    return f'<!doctype html>\n<html lang="en">\n<head>{head}</head>\n<body>\n{body}\n</body>\n</html>\n'


def error_scale(comparison: Comparison) -> float:
    """Choose the error at the ends of the colour scale: 1, 2 or 5 times a power of ten, at least three times the
    smallest error.

    All maps share this scale, which is three standard deviations of the best method: its map is neither blank nor
    saturated.
    """
    errors = [result.measurements[-1].error for result in comparison.results]
    known = [error for error in errors if math.isfinite(error) and error > 0]
    if not known:
        return 0.1
    wanted = 3 * min(known)
    power = 10.0 ** math.floor(math.log10(wanted))
    return next(m * power for m in (1, 2, 5, 10) if m * power >= wanted * (1 - 1e-9))


def percent(value: float | None) -> str:
    """Format a number as in `1.23 %`, or as a dash if it is None or not finite."""
    if value is None or not math.isfinite(value):
        return "–"
    return f"{100 * value:.0f} %" if value >= 0.9995 else f"{100 * value:#.3g} %"


def _summary(comparison: Comparison) -> str:
    image, noise = comparison.reference.a, comparison.reference.noise
    samples = image.metadata.get("statistics", {}).get("samples")
    taken = f" of {samples:,.0f} paths per pixel each" if samples else ""
    if noise is None:
        truth = "one reference picture, whose noise counts as an error of the methods"
    else:
        truth = f"two independent reference pictures{taken}, whose mean has a noise of {percent(noise)}"
    shown = f"The pictures have {image.width}x{image.height} pixels and are shown at {comparison.exposure:+g} stops."
    return f"{shown} They are compared with {truth}."


def _notes() -> str:
    flip = f"FLIP is the mean of LDR-FLIP at {PIXELS_PER_DEGREE:g} pixels per degree." if has_flip() else FLIP_MISSING
    return (
        "The error is the relative RMSE over all pixels, without the noise of the references. The error away from edges "
        "is measured over the pixels that have no edge of the normal or the depth within two pixels. "
        f"{flip} The time is that of solving and rendering, without loading the scene. Stored is the number of records, "
        "photons or patches, and memory their size."
    )


def _table(comparison: Comparison) -> str:
    heads = (
        "method",
        "error",
        "away from edges",
        "FLIP",
        "time",
        "samples",
        "rays",
        "stored",
        "memory",
        "cache misses",
    )
    rows = ["<tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>"]
    for result in comparison.results:
        for measurement in result.measurements:
            statistics = measurement.statistics
            cells = [
                measurement.method,
                percent(measurement.error),
                percent(measurement.error_away_from_edges),
                "–" if measurement.flip is None else f"{measurement.flip:.4f}",
                f"{measurement.seconds:.2f} s",
                *(_count(statistics.get(name)) for name in ("samples", "rays")),
                _count(sum(statistics.get(name, 0) for name in STORED)),
                _megabytes(statistics.get("bytes")),
                _count(statistics.get("cache_misses")),
            ]
            last = ' class="last"' if measurement is result.measurements[-1] else ""
            rows.append(f"<tr{last}>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
    return '<div class="scroll"><table>\n' + "\n".join(rows) + "\n</table></div>"


def _count(value: float | None) -> str:
    return "–" if not value else f"{value:,.0f}"


def _megabytes(value: float | None) -> str:
    return "–" if not value else f"{value / 1e6:,.1f} MB"


def _plot(comparison: Comparison) -> str:
    series = {r.method: [(m.seconds, m.error) for m in r.measurements] for r in comparison.results}
    return log_log_plot(series, "seconds", "relative error", lambda error: f"{100 * error:g} %")


def _reference(comparison: Comparison, scale: float) -> str:
    reference, truth = comparison.reference, comparison.reference.image.pixels
    figures = [_figure(to_display(truth, comparison.exposure), "reference: picture", "Picture")]
    if reference.noise is not None:
        half = (reference.a.pixels - reference.b.pixels) / 2
        figures.append(_error_figure(signed_error(truth + half, truth), scale, "reference: noise", "Noise"))
    return f'<div class="row">{"".join(figures)}</div>'


def _method(result: MethodResult, exposure: float, scale: float) -> str:
    last, name = result.measurements[-1], escape(result.method)
    figures = [
        _figure(to_display(result.image.pixels, exposure), f"{result.method}: picture", "Picture"),
        _error_figure(result.signed_error, scale, f"{result.method}: signed error", "Signed relative error"),
    ]
    if result.flip_map is not None:
        caption = "FLIP" + _legend(AMOUNT, "0", "1")
        figures.append(_figure(colored(result.flip_map, AMOUNT), f"{result.method}: FLIP", caption))
    headline = f"{name}: {percent(last.error)} in {last.seconds:.2f} s"
    limits = f"<p>{escape(METHODS[result.method].cannot)}</p>"
    return f'<h2>{headline}</h2>\n{limits}\n<div class="row">{"".join(figures)}</div>'


def _error_figure(error: Float64, scale: float, alternative: str, caption: str) -> str:
    end = f"{100 * scale:g} %"
    legend = _legend(SIGNED, f"too dark −{end}", f"{end} too bright")
    return _figure(colored(error / scale, SIGNED), alternative, caption + legend)


def _figure(picture: NDArray[np.uint8], alternative: str, caption: str) -> str:
    height, width, _ = picture.shape
    image = f'<img src="{_data_uri(picture)}" width="{width}" height="{height}" alt="{escape(alternative)}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _legend(anchors: Anchors, low: str, high: str) -> str:
    bar = colored(np.linspace(anchors[0][0], anchors[-1][0], 64)[None], anchors)
    return f'<div class="scale">{low}<img src="{_data_uri(bar)}" alt="colour scale">{high}</div>'


def _data_uri(picture: NDArray[np.uint8]) -> str:
    file = io.BytesIO()
    PillowImage.fromarray(picture).save(file, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()


def page_facts(comparison: Comparison) -> dict[str, Any]:
    """Return the numbers of the page as JSON-compatible values, for programs."""
    return {
        "scene": comparison.scene,
        "exposure": comparison.exposure,
        "reference_noise": comparison.reference.noise,
        "measurements": comparison.table(),
    }
