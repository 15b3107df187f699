# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The web socket of the viewer: the page asks for what its view lacks, and gets records as they are made.

From the page come texts, JSON objects of at most `LARGEST_REQUEST` bytes:

    {"kind": "wish", "view": VIEW}     solve the records that this view lacks
    {"kind": "truth", "view": VIEW, "by": "paths", "number": n}
                                       render this view by paths, or by "records": as `eclat render` would with the records
                                       so far; until the next such request or "stop"
    {"kind": "stop"}                   end this picture
    {"kind": "hemisphere", "place": [3 numbers], "normal": [3 numbers], "number": n}
                                       show what this point sees, relative to the scene's center

A VIEW is {"to_world": 16 numbers, "half_extent": [x, y], "shift": [x, y], "orthographic": bool, "size": [w, h]}: the
matrix row by row, from the camera, which looks along −z, to the scene relative to its center; half the width and height of
the picture at distance 1 (orthographic: in metres); and pixels.

To the page go texts, {"kind": "state", "solving", "passes_left", "everywhere", "records"} (`growth.State`), and binary
messages (`messages`) of the kinds

    records    as in the file: changed rows, and new ones
    gloss      the same of records of radiance
    truth      the `number` of the request, `samples` per pixel, and `first` and `second` (height, width, 3) of "f4", linear
               radiance, row 0 at the top: the picture is their mean, and each has half of the samples
    hemisphere what a point sees, see `hemisphere`

A page that does not read, sends too much, or sends anything else is disconnected: each connection holds at most one
message that was not taken, because the next is made of what has changed until then.
"""

from __future__ import annotations

import asyncio
import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np

from eclat import _core
from eclat.bridge.reach import FARTHEST
from eclat.methods.path import Path as PathMethod
from eclat.methods.records.solution import Solution
from eclat.methods.work import Work
from eclat.scene import Scene
from eclat.viewer.gloss import GlossRecords, GlossSource
from eclat.viewer.growth import Growth
from eclat.viewer.hemisphere import ORDER, look_around
from eclat.viewer.messages import encode_message
from eclat.viewer.record_rows import reading_of
from eclat.viewer.truth import EstimatorMaker, TruthPicture, by_paths

if TYPE_CHECKING:
    from starlette.routing import BaseRoute
    from starlette.websockets import WebSocket

LARGEST_REQUEST = 4096
"""Largest size of a text from the page in bytes; a wish has about 600."""
MOST_CONNECTIONS = 8
"""Number of pages that may be open at once."""
MOST_PIXELS = 1280 * 960
"""Number of pixels of a view; a larger one is made smaller, with the same records up to their smallest radius."""
SECONDS_TO_READ = 20.0
"""Time after which a page that takes no message is disconnected."""
ROWS_AT_ONCE = 4096
"""Number of records of a message, of 208 bytes each."""
GLOSS_ROWS_AT_ONCE = 512
"""Number of records of radiance of a message, of 3 KB each at order 8."""
GAP = 16
"""Number of unchanged records between changed ones that are sent along, which costs less than a message."""

POLICY, TOO_MANY, WRONG = 1008, 1013, 1007
"""Codes with which web sockets are closed [RFC 6455]."""


class View(msgspec.Struct, forbid_unknown_fields=True):
    """What a page sees."""

    to_world: tuple[
        float, float, float, float, float, float, float, float,
        float, float, float, float, float, float, float, float,
    ]  # fmt: skip
    half_extent: tuple[float, float]
    shift: tuple[float, float]
    orthographic: bool
    size: tuple[int, int]


class Request(msgspec.Struct, forbid_unknown_fields=True):
    """A text from the page."""

    kind: str
    view: View | None = None
    by: Literal["paths", "records"] = "paths"
    number: int = 0
    place: tuple[float, float, float] | None = None
    normal: tuple[float, float, float] | None = None


def parsed_request(text: str | bytes) -> Request:
    """Decode a request. Raises ValueError if it is not one."""
    request = msgspec.json.decode(text, type=Request)
    needs_view, needs_place = request.kind in ("wish", "truth"), request.kind == "hemisphere"
    complete = needs_view == (request.view is not None) and (
        needs_place == (request.place is not None) == (request.normal is not None)
    )
    if request.kind not in ("wish", "truth", "stop", "hemisphere") or not complete:
        raise ValueError(f"a request of the kind {request.kind[:20]!r} is unknown or incomplete")
    return request


def camera_of(view: View) -> tuple[_core.Camera, tuple[int, int]]:
    """Make the camera of a view, and the size of its picture, of at most `MOST_PIXELS`. Raises ValueError if the view
    makes no sense: axes that are not orthonormal, positions out of reach, fields of view of nothing or of more than
    179.9°."""
    matrix = np.array(view.to_world).reshape(4, 4)
    axes, position = matrix[:3, :3], matrix[:3, 3]
    if not np.isfinite(matrix).all() or np.abs(axes.T @ axes - np.eye(3)).max() > 1e-3:
        raise ValueError("the axes are not orthonormal")
    if np.abs(position).max() > FARTHEST or max(map(abs, view.shift)) > 10:
        raise ValueError("the position or the shift is out of reach")
    least, most = (1e-6, FARTHEST) if view.orthographic else (1e-6, math.tan(math.radians(89.95)))
    if not all(least <= half <= most for half in view.half_extent):
        raise ValueError("the field of view is out of range")
    width, height = view.size
    if not (1 <= width <= 1 << 14 and 1 <= height <= 1 << 14):
        raise ValueError("the size is out of range")
    scale = min(1.0, math.sqrt(MOST_PIXELS / (width * height)))
    size = max(1, int(scale * width)), max(1, int(scale * height))
    camera = _core.Camera(
        axes=tuple(tuple(map(float, axes[:, i])) for i in range(3)),
        position=tuple(map(float, position)),
        size=size,
        half_extent=view.half_extent,
        shift=view.shift,
        lens=(0.0, 1.0),
        orthographic=view.orthographic,
    )
    return camera, size


def point_of(request: Request) -> tuple[np.ndarray, np.ndarray]:
    """Return the place and the unit normal of a request. Raises ValueError if they make no sense."""
    place, normal = np.array(request.place, float), np.array(request.normal, float)
    if not np.isfinite([place, normal]).all() or np.abs(place).max() > FARTHEST:
        raise ValueError("the place is out of reach")
    if abs(np.linalg.norm(normal) - 1) > 1e-3:
        raise ValueError("the normal is no unit vector")
    return place, normal / np.linalg.norm(normal)


def changed_rows(sent: np.ndarray, rows: np.ndarray, at_once: int = ROWS_AT_ONCE) -> Iterator[tuple[int, np.ndarray]]:
    """Iterate over the first index and the rows of the parts of `rows` that differ from those `sent` or are new, each of
    at most `at_once` rows."""
    old = len(sent)
    different = np.ones(len(rows), bool)
    different[:old] = (rows[:old] != sent).any(axis=1)
    at = np.flatnonzero(different)
    if not len(at):
        return
    for part in np.split(at, np.flatnonzero(np.diff(at) > GAP) + 1):
        for first in range(int(part[0]), int(part[-1]) + 1, at_once):
            yield first, rows[first : min(first + at_once, int(part[-1]) + 1)]


def with_live(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Tell the page, among its `files`, that a web socket answers it."""
    marked = files["index.html"].replace(b"<head>", b'<head>\n    <meta name="eclat-live" content="live" />', 1)
    return {**files, "index.html": marked}


class Live:
    """The web sockets of one scene."""

    def __init__(
        self,
        scene: Scene,
        solution: Solution,
        gloss: GlossSource | None = None,
        *,
        whole: bool = False,
        threads: int = 0,
        seed: int = 0,
    ) -> None:
        """Begin with the records of `solution`, and those of radiance in `gloss`, which pages have loaded before they
        connect."""
        self.gloss = gloss or GlossSource(scene, solution)
        self._loaded_gloss = self.gloss.records
        self.growth = Growth(scene, solution, self.gloss, whole=whole, threads=threads, seed=seed)
        self._scene, self._max_depth, self._threads = scene, solution.max_depth, threads
        # It refines for minutes, on the machine of a page that must go on drawing, perhaps without a graphics card.
        self.truth_threads = threads or max(1, (os.cpu_count() or 1) - 1)
        self._reading = reading_of(solution)
        self._loaded = self.growth.rows
        self._connections: set[_Connection] = set()

    def routes(self, token: str) -> list[BaseRoute]:
        """Make the routes of the server: the web socket `live`, and the cache file `cache.npz`."""
        from starlette.routing import Route, WebSocketRoute

        return [WebSocketRoute(f"/{token}/live", self._serve), Route(f"/{token}/cache.npz", self._saved)]

    def close(self) -> None:
        """Stop solving, and all pictures."""
        for connection in list(self._connections):
            connection.stop()
        self.growth.close()

    async def _serve(self, socket: WebSocket) -> None:
        if len(self._connections) >= MOST_CONNECTIONS:
            await socket.accept()
            await socket.close(TOO_MANY)
            return
        await socket.accept()
        connection = _Connection(self, socket)
        self._connections.add(connection)
        try:
            await connection.run()
        finally:
            self._connections.discard(connection)

    async def _saved(self, request: Any) -> Any:
        """Answer with the usual cache file of what was solved."""
        import tempfile
        from pathlib import Path

        from starlette.responses import Response

        from eclat.viewer.server import HEADERS

        def encoded() -> bytes:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "cache.npz"
                self.growth.solution().save(path)
                return path.read_bytes()

        data = await asyncio.to_thread(encoded)
        return Response(data, media_type="application/octet-stream", headers=HEADERS)

    def truth_by(self, way: Literal["paths", "records"]) -> EstimatorMaker:
        """Return what makes the estimator of a picture, which for records waits for the pass that is being made."""
        if way == "paths":
            depths = {"max_depth": self._max_depth, "roulette_depth": PathMethod().roulette_depth}
            return partial(by_paths, self._scene, **depths)
        work = Work(max_depth=self._max_depth, threads=self._threads)
        return lambda: self.growth.solution().radiance_estimator(self._scene, work)

    def hemisphere_message(self, place: np.ndarray, normal: np.ndarray, number: int) -> bytes:
        """Render what a point sees, and encode it."""
        corners = np.concatenate([np.asarray(mesh.positions) for mesh in self._scene.meshes])
        lift = 1e-5 * float(np.linalg.norm(np.ptp(corners, axis=0)))
        found = look_around(self.truth_by("paths")(), place, normal, lift=lift, threads=self._threads)
        return encode_message("hemisphere", {"number": number, "order": ORDER}, found.arrays())

    def records_message(self, first: int, rows: np.ndarray, count: int) -> bytes:
        """Encode rows of records from the record `first` on, after which there are `count`."""
        return encode_message(
            "records", {"first": first, "count": count, "reading": self._reading}, {"rows": np.ascontiguousarray(rows)}
        )


class _Connection:
    """One page: what it was sent, and what it asked for."""

    def __init__(self, live: Live, socket: WebSocket) -> None:
        self._live, self._socket = live, socket
        self._sent, self._sent_gloss = live._loaded, live._loaded_gloss
        self._truth: TruthPicture | None = None
        self._samples_sent, self._truth_number = 0, 0
        self._hemisphere: bytes | None = None
        self._changed = asyncio.Event()
        self._loop = asyncio.get_running_loop()

    def changed(self) -> None:
        """Note, from any thread, that there is something to send."""
        self._loop.call_soon_threadsafe(self._changed.set)

    def stop(self) -> None:
        """End the picture that is being rendered."""
        truth, self._truth = self._truth, None
        if truth is not None:
            truth.stop()

    async def run(self) -> None:
        """Serve the page until it leaves or misbehaves."""
        self._live.growth.join(self, self.changed)
        self._changed.set()
        tasks = [asyncio.create_task(part) for part in (self._receive(), self._send())]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            code = next((task.result() for task in done if not task.exception()), None)
        finally:
            self._live.growth.leave(self)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            await asyncio.to_thread(self.stop)
        if code is not None:
            try:
                await asyncio.wait_for(self._socket.close(code), SECONDS_TO_READ)
            except (TimeoutError, RuntimeError, OSError):
                return

    async def _receive(self) -> int | None:
        """Take requests; return the code with which to close the socket, or None if the page has left."""
        while True:
            message = await self._socket.receive()
            if message["type"] != "websocket.receive":
                return None
            text = message.get("text")
            if text is None or len(text) > LARGEST_REQUEST:
                return WRONG
            try:
                await self._answer(parsed_request(text))
            except (ValueError, OverflowError):  # msgspec's errors are ValueErrors
                return POLICY

    async def _answer(self, request: Request) -> None:
        if request.kind == "hemisphere":
            place, normal = point_of(request)
            self._hemisphere = await asyncio.to_thread(self._live.hemisphere_message, place, normal, request.number)
            self._changed.set()
            return
        if request.view is None:
            await asyncio.to_thread(self.stop)
            return
        camera, size = camera_of(request.view)
        if request.kind == "wish":
            self._live.growth.wish(self, camera)
            return
        await asyncio.to_thread(self.stop)
        self._samples_sent, self._truth_number = 0, request.number
        self._truth = TruthPicture(
            camera, size, self._live.truth_by(request.by), self.changed, threads=self._live.truth_threads
        )

    async def _send(self) -> int:
        """Send what has changed; return the code with which to close the socket of a page that does not read."""
        try:
            while True:
                await self._changed.wait()
                self._changed.clear()
                await self._send_changes()
        except TimeoutError:
            return POLICY

    async def _send_changes(self) -> None:
        growth = self._live.growth
        state, rows, gloss = growth.grown
        for first, part in changed_rows(self._sent, rows):
            count = max(len(self._sent), first + len(part))
            await self._in_time(self._socket.send_bytes(self._live.records_message(first, part, count)))
        self._sent = rows
        await self._send_gloss(gloss)
        await self._in_time(self._socket.send_text(json.dumps({"kind": "state", **asdict(state)})))
        hemisphere, self._hemisphere = self._hemisphere, None
        if hemisphere is not None:
            await self._in_time(self._socket.send_bytes(hemisphere))
        latest = self._truth.latest if self._truth is not None else None
        if latest is not None and latest.samples > self._samples_sent:
            self._samples_sent = latest.samples
            halves = dict(zip(("first", "second"), latest.halves, strict=True))
            request = {"number": self._truth_number, "samples": latest.samples}
            message = encode_message("truth", request, halves)
            await self._in_time(self._socket.send_bytes(message))

    async def _send_gloss(self, records: GlossRecords) -> None:
        """Send what is new or has changed of the records of radiance."""
        sent = self._sent_gloss
        with_lobes = len(records.lobes) > len(sent.lobes)
        for first, part in changed_rows(sent.rows, records.rows, GLOSS_ROWS_AT_ONCE):
            end = first + len(part)
            count = max(len(sent.rows), end)
            message = self._live.gloss.message(records, first, end, count, with_lobes=with_lobes)
            await self._in_time(self._socket.send_bytes(message))
            with_lobes = False
        self._sent_gloss = records

    async def _in_time(self, sending: Any) -> None:
        await asyncio.wait_for(sending, SECONDS_TO_READ)
