# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Baked files in three.js: a server on this machine, headless Chromium, and pixels as linear radiance."""

from __future__ import annotations

import base64
import functools
import http.server
import io
import json
import os
import shutil
import subprocess
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn
from urllib.parse import quote

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from eclat.viewer.page import PAGE
from eclat.viewer.showing import Viewer

WEB = Path(__file__).resolve().parents[2] / "web"

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

DOES_NOT_START = 3
"""web/tests/browser.mjs ends with it; a browser that tells its version may still be barred from running (snaps in containers)."""

SECONDS = 400
"""After which a browser that says nothing has failed."""


@dataclass(frozen=True)
class View:
    """A picture of a file by three.js."""

    pixels: NDArray[np.float32]
    """(H, W, 3) radiance, row 0 at the top."""
    light_maps: dict[str, dict[str, Any]]
    """What each material's light map came out as, by the material's name."""


def require_node() -> str:
    """Node with the packages of web/, or a skip that says what is missing; on CI a failure."""
    node = shutil.which("node")
    if node is None:
        _missing("Node.js is not installed")
    if not (WEB / "node_modules/playwright-core").is_dir():
        _missing("the packages of web/ are not installed: run `npm ci` there, or `make test`")
    return str(node)


@functools.cache
def require_browser() -> str:
    """A Chromium that starts, or a skip that says why there is none; on CI a failure."""
    named = os.environ.get("ECLAT_CHROMIUM")
    tried = []
    for name in [named] if named else BROWSERS:
        path = shutil.which(name)
        if path is None:
            continue
        # Ubuntu's package is a stub that asks for a snap: it is there and does not start.
        asked = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=SECONDS)
        if asked.returncode == 0 and "Chrom" in asked.stdout:
            return path
        tried.append(f"{path} does not start: {(asked.stderr or asked.stdout).strip()}")
    _missing("; ".join(tried) or f"no Chromium found (looked for {', '.join([named] if named else BROWSERS)})")


def require_page() -> None:
    """The built page of `eclat view`, or a skip that says how to build it; on CI a failure."""
    if not (PAGE / "index.html").is_file():
        _missing("the page of the viewer is not built: run `make page`, or `make test`")


def _missing(why: str) -> NoReturn:
    if os.environ.get("CI"):
        pytest.fail(f"CI must run what needs a browser: {why}")
    pytest.skip(why)


@contextmanager
def serve(folder: Path) -> Iterator[str]:
    """Serve web/ at /web/ and `folder` at /files/ on this machine only; the URL, without a slash at its end."""

    class Handler(http.server.SimpleHTTPRequestHandler):
        def translate_path(self, path: str) -> str:
            roots = {"/web/": WEB, "/files/": folder}
            for prefix, root in roots.items():
                if path.startswith(prefix):
                    self.directory = str(root)
                    return super().translate_path(path.removeprefix(prefix.rstrip("/")))
            return str(folder / "no such file")

        def log_message(self, format: str, *arguments: Any) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def render_in_three(folder: Path, jobs: Sequence[dict[str, Any]]) -> tuple[list[View | str], list[str]]:
    """Render files below `folder` with the cameras they hold, in one browser.

    Parameters
    ----------
    jobs : "file" below the folder, "width", "height"; "camera", which of the file's (0); "plugin", the options of
        EclatLightmap (none);
        "supersampling", samples of a pixel along each side (1).

    Returns
    -------
    A `View` of each job, or why it could not be rendered; what the page said on its console.
    """
    node, chromium = require_node(), require_browser()
    with serve(folder) as url:
        wanted = [
            {"camera": 0, "plugin": {}, "supersampling": 1, **job, "url": f"{url}/files/{quote(job['file'])}"}
            for job in jobs
        ]
        request = json.dumps({"page": f"{url}/web/tests/page.html", "jobs": wanted})
        answer = _node([node, str(WEB / "tests/render.mjs"), chromium], request)
    return [_view(job, result) for job, result in zip(jobs, answer["results"], strict=True)], answer["messages"]


def open_example(folder: Path, file: str) -> tuple[dict[str, tuple[str, NDArray[np.uint8]]], list[str]]:
    """Open web/example.html with a file below `folder`.

    Returns
    -------
    For "exr", "embedded" and "none": what the page tells instead of showing the file ("" where it does), and the (H, W, 3)
    page. Then what it said on its console.
    """
    node, chromium = require_node(), require_browser()
    with serve(folder) as url:
        page = f"{url}/web/example.html?file=/files/{file}"
        answer = _node([node, str(WEB / "tests/example.mjs"), chromium, page], "")
    shown = {
        light: (seen["message"], np.array(Image.open(io.BytesIO(base64.b64decode(seen["png"]))).convert("RGB")))
        for light, seen in answer["shown"].items()
    }
    return shown, answer["messages"]


def _view(job: dict[str, Any], result: dict[str, Any]) -> View | str:
    if "error" in result:
        return str(result["error"])
    pixels = np.frombuffer(base64.b64decode(result["pixels"]), dtype="<f4").reshape(job["height"], job["width"], 3)
    return View(pixels, {light_map["material"]: light_map for light_map in result["lightMaps"]})


def gltf_issues(*files: Path) -> dict[str, list[dict[str, Any]]]:
    """What Khronos' glTF validator says of each file, by severity: "errors", "warnings", "infos", "hints"."""
    answer = _node([require_node(), str(WEB / "tests/validate.mjs"), *map(str, files)], "")
    kinds = ("errors", "warnings", "infos", "hints")
    issues = [{"file": file, **issue} for file, found in answer.items() for issue in found]
    return {kind: [issue for issue in issues if issue["severity"] == i] for i, kind in enumerate(kinds)}


def _node(command: list[str], request: str) -> Any:
    done = subprocess.run(command, input=request, capture_output=True, text=True, timeout=SECONDS)
    if done.returncode == DOES_NOT_START:
        _missing(f"{command[2]} does not start: {done.stderr.strip()}")
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(command)} ended with code {done.returncode}:\n{done.stderr}")
    return json.loads(done.stdout)


@dataclass(frozen=True)
class ViewedPage:
    """What the page of `eclat view` gave."""

    pictures: list[NDArray[np.float32]]
    """(H, W, 3) linear radiance each, row 0 at the top."""
    approximated: list[NDArray[np.bool_]]
    """(H, W) where these show gloss by an approximation."""
    sums: NDArray[np.float32]
    """(looks · N, 4) sums of (w E, w) over the records at the points that were asked for, with each look."""
    errors: NDArray[np.float32]
    """(M, 4) at the first 2000 points: the estimated error relative to the irradiance, and 1 where a record serves."""
    shot: NDArray[np.uint8] | None
    """(H, W, 3) the page as it looks."""
    message: str
    """What it shows instead of a picture; "" where there is one."""
    messages: list[str]
    """What it said on its console."""
    requests: list[str]
    """The addresses that it asked for."""
    work: list[dict[str, float] | None]
    """For pictures that ask for `work`, the `fragments` of splats and the `serving` ones among them, per pixel."""
    seconds: list[float | None]
    """For these pictures, how long one takes."""
    result: Any = None
    """What a script left in the variable that the shot names as its `result`."""


def keep_records(viewer: Viewer) -> None:
    """Make the page show the records that were solved, without a live server that adds those which its views lack."""
    viewer._files.update(viewer.contents.files())


def look_at_page(
    url: str,
    pictures: Sequence[dict[str, Any]] = (),
    points: NDArray[np.floating] | None = None,
    normals: NDArray[np.floating] | None = None,
    shot: dict[str, Any] | None = None,
    looks: Sequence[dict[str, Any]] = ({},),
    halves: bool = False,
) -> ViewedPage:
    """Open the page of `eclat view` and ask it for pictures and for sums of records; web/tests/view.mjs says how. With
    `halves` its graphics card seems to blend half floats only."""

    def encoded(array: NDArray[np.floating] | None) -> str | None:
        return None if array is None else base64.b64encode(np.asarray(array, "<f4").tobytes()).decode()

    node, chromium = require_node(), require_browser()
    request = {"page": url, "pictures": list(pictures), "points": encoded(points), "normals": encoded(normals)}
    request |= {"looks": list(looks), "halves": halves}
    command = [node, str(WEB / "tests/view.mjs"), chromium]
    answer = _node(command, json.dumps(request | ({"shot": shot} if shot else {})))

    def decoded(text: str | None) -> NDArray[np.float32]:
        return np.frombuffer(base64.b64decode(text or ""), dtype="<f4").reshape(-1, 4)

    made = [
        decoded(pixels).reshape(asked["height"], asked["width"], 4)[::-1]
        for asked, pixels in zip(pictures, answer.get("pictures", []), strict=False)
    ]
    png = answer.get("shot")
    page = None if png is None else np.array(Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB"))
    sums = np.concatenate([decoded(of_look) for of_look in answer.get("sums") or [None]])
    errors = decoded(answer.get("errors"))
    told = (answer["message"], answer["messages"], answer["requests"])
    colors, marks = [p[..., :3] for p in made], [p[..., 3] > 0.5 for p in made]
    work = (answer.get("work", []), answer.get("seconds", []), answer.get("result"))
    return ViewedPage(colors, marks, sums, errors, page, *told, *work)


def use_page(url: str) -> dict[str, Any]:
    """Use the page of `eclat view` by keys, pointer and settings, and let axe-core look at it; see
    web/tests/view-access.mjs for what is returned."""
    answer: dict[str, Any] = _node([require_node(), str(WEB / "tests/view-access.mjs"), require_browser(), url], "")
    return answer


def compare_with_truth(
    url: str, size: tuple[int, int], samples: int, steps: Sequence[dict[str, Any]]
) -> dict[str, Any]:
    """Ask the page of `eclat view` for the truth beside its picture of `size`; web/tests/view-truth.mjs describes the
    steps and what is returned."""
    request = {"page": url, "width": size[0], "height": size[1], "samples": samples, "steps": list(steps)}
    command = [require_node(), str(WEB / "tests/view-truth.mjs"), require_browser()]
    answer: dict[str, Any] = _node(command, json.dumps(request))
    return answer
