# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The web socket of the viewer: what a page gets, and what hostile or careless ones cannot do."""

from __future__ import annotations

import http.client
import json
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

import eclat
from eclat.methods.records.laws import core_options
from eclat.methods.records.solution import Solution
from eclat.scene import Camera, Environment, Material, Mesh, Scene, look_at
from eclat.scenes import build, glossy_box
from eclat.viewer import live as live_module
from eclat.viewer.gloss import GlossSource
from eclat.viewer.growth import empty_solution
from eclat.viewer.live import (
    LARGEST_REQUEST,
    MOST_CONNECTIONS,
    Live,
    camera_of,
    changed_rows,
    parsed_request,
    with_live,
)
from eclat.viewer.record_rows import ROW, record_rows
from eclat.viewer.server import Server

EYE = (0.0, 0.0, 2.5)

VIEW: dict[str, Any] = {
    "to_world": [1, 0, 0, EYE[0], 0, 1, 0, EYE[1], 0, 0, 1, EYE[2], 0, 0, 0, 1],
    "half_extent": [0.4, 0.3],
    "shift": [0, 0],
    "orthographic": False,
    "size": [64, 48],
}

PATIENCE = 60.0
"""Seconds after which something that was promised counts as missing."""


class Running:
    """A server with the web socket of a scene."""

    def __init__(self, scene: Scene, solution: Solution | None = None, *, live: Live | None = None) -> None:
        assert (solution is None) != (live is None)
        self.scene, self.live = scene, live or Live(scene, solution, threads=1)
        self.server = Server({"index.html": b"<!doctype html>"}, self.live.routes)

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.server.port}"

    def page(self, path: str | None = None, origin: str | None = None) -> ClientConnection:
        where = f"/{self.server.token}/live" if path is None else path
        address = f"ws://127.0.0.1:{self.server.port}{where}"
        return connect(address, origin=origin or self.origin, max_size=None, open_timeout=PATIENCE)  # type: ignore[arg-type]

    def close(self) -> None:
        self.live.close()
        self.server.close()


@pytest.fixture(scope="module")
def scene() -> Scene:
    return build("cornell-box")


@pytest.fixture
def running(scene: Scene) -> Iterator[Running]:
    found = Running(scene, empty_solution(scene, eclat.IrradianceCache(max_error=0.1)))
    yield found
    found.close()


def ask(page: ClientConnection, kind: str, **changes: Any) -> None:
    page.send(json.dumps({"kind": kind, "view": VIEW | changes}))


def decoded(message: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    length = int.from_bytes(message[8:12], "little")
    header = json.loads(message[12 : 12 + length])
    arrays = {
        name: np.frombuffer(message, "<f4", int(np.prod(entry["shape"])), entry["offset"]).reshape(entry["shape"])
        for name, entry in header["arrays"].items()
    }
    return header, arrays


def until(page: ClientConnection, done: Callable[[dict[str, Any]], bool]) -> list[Any]:
    """Take messages until a header or state is `done`."""
    taken: list[Any] = []
    while True:
        message = page.recv(timeout=PATIENCE)
        found = decoded(message) if isinstance(message, bytes) else (json.loads(message), {})
        taken.append(found)
        if done(found[0]):
            return taken


def solved(header: dict[str, Any]) -> bool:
    return header["kind"] == "state" and not header["solving"] and header["records"] > 0


def eventually(true: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE
    while not true():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def closing_code(page: ClientConnection) -> int | None:
    """Read until the server closes, and return its code."""
    try:
        while True:
            page.recv(timeout=PATIENCE)
    except ConnectionClosed as closed:
        return closed.rcvd.code if closed.rcvd else None


def test_a_page_is_shown_what_a_point_sees_and_points_without_sense_are_refused(running: Running) -> None:
    asked = {"kind": "hemisphere", "place": [0, 0, 0], "normal": [0, 1, 0], "number": 7}
    with running.page() as page:
        page.send(json.dumps(asked))
        header, arrays = until(page, lambda h: h["kind"] == "hemisphere")[-1]
    assert header["number"] == 7 and arrays["radiance"].max() > 1 and (arrays["distances"] < 3).all()
    for wrong in (
        {"normal": [0, 2, 0]},
        {"place": [1e30, 0, 0]},
        {"place": None},
        {"normal": [0, 1]},
        {"view": VIEW},
        {"kind": "wish"},
    ):
        with running.page() as page:
            page.send(json.dumps(asked | wrong))
            assert closing_code(page) == 1008, wrong


def test_a_page_gets_records_of_radiance_as_they_are_made() -> None:
    scene = glossy_box.build(alpha=0.4)
    running = Running(scene, empty_solution(scene, eclat.RadianceCache(max_error=0.3, least_pixels=1)))
    try:
        with running.page() as page:
            ask(page, "wish")
            taken = [(h, a) for h, a in until(page, solved) if h["kind"] == "gloss"]
        made = running.live.gloss.records
        names = ("rows", "lobe_of", "coefficients")
        arrays = {name: np.zeros_like(getattr(made, name)) for name in names}
        for header, sent in taken:
            for name in names:
                arrays[name][header["first"] : header["first"] + len(sent["rows"])] = sent[name]
        assert len(made.rows) == taken[-1][0]["count"] > 10 and len(taken) > 2
        for name in names:
            assert (arrays[name] == getattr(made, name)).all(), name
        # Lobes are sent when there are new ones, not with each message.
        lobes = [sent["lobes"] for _, sent in taken if len(sent["lobes"])]
        assert (lobes[-1] == made.lobes).all() and len(lobes) < len(taken)
        # What grew is what a file of the same records gives.
        whole = GlossSource(scene, running.live.growth.solution()).records
        assert (whole.rows == made.rows).all() and np.allclose(
            whole.coefficients, made.coefficients, rtol=0.2, atol=0.02
        )
    finally:
        running.close()


def test_all_surfaces_are_solved_from_when_a_page_is_open_and_what_it_sees_comes_first() -> None:
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    seen, behind = (
        Mesh(corners, triangles, Material()),
        Mesh(corners + np.array([0, 0, 5]), triangles[:, ::-1], Material()),
    )
    scene = Scene((seen, behind), environment=Environment(np.full((1, 1, 3), 0.5, np.float32)))
    live = Live(scene, empty_solution(scene, eclat.IrradianceCache(max_error=0.5)), whole=True, threads=1)
    running = Running(scene, live=live)
    try:
        time.sleep(0.3)
        assert len(live.growth.rows) == 0 and live.growth.state.everywhere
        with running.page() as page:
            ask(page, "wish")
            taken = until(page, lambda h: h["kind"] == "state" and h["records"] > 0 and not h["solving"])
            assert taken[-1][0]["everywhere"]
            until(page, lambda h: h["kind"] == "state" and not h["everywhere"])
        solution = live.growth.solution()
        assert solution.complete and len(solution) > taken[-1][0]["records"]
    finally:
        running.close()


def test_a_page_gets_the_records_that_its_view_lacks(running: Running, tmp_path: Path) -> None:
    with running.page() as page:
        ask(page, "wish")
        taken = until(page, solved)
    rows = np.zeros((0, ROW), np.float32)
    for header, arrays in taken:
        if header["kind"] == "records":
            grown = np.zeros((max(header["count"], len(rows)), ROW), np.float32)
            grown[: len(rows)] = rows
            grown[header["first"] : header["first"] + len(arrays["rows"])] = arrays["rows"]
            rows = grown
    solution = running.live.growth.solution()
    assert len(rows) == taken[-1][0]["records"] > 50
    assert (rows == record_rows(solution.core(), core_options(solution.options).spacing)).all()
    # The first records came before the far records, in several messages.
    assert len([h for h, _ in taken if h["kind"] == "records"]) > 5
    # The same view lacks nothing now; neither does a page that connects later, which gets all at once.
    with running.page() as page:
        first = until(page, lambda h: h["kind"] == "state")
        assert sum(len(a["rows"]) for h, a in first if h["kind"] == "records") == len(rows)
    connection = http.client.HTTPConnection("127.0.0.1", running.server.port, timeout=PATIENCE)
    connection.request("GET", f"/{running.server.token}/cache.npz")
    (tmp_path / "cache.npz").write_bytes(connection.getresponse().read())
    loaded = eclat.load_solved(tmp_path / "cache.npz")
    assert isinstance(loaded, Solution) and (loaded.near == solution.near).all() and (loaded.far == solution.far).all()
    with pytest.warns(eclat.EclatWarning, match="incomplete"):
        picture = eclat.render(running.scene, loaded, size=(16, 12), samples=1)
    assert picture.pixels.mean() > 0


def test_the_truth_is_the_picture_of_this_camera(running: Running) -> None:
    wide = VIEW | {"size": [48, 32], "half_extent": [0.45, 0.3], "shift": [0.1, -0.05]}
    with running.page() as page:
        page.send(json.dumps({"kind": "truth", "view": wide, "number": 7}))
        taken = until(page, lambda h: h.get("samples", 0) >= 256)
        told = [h for h, _ in taken if h["kind"] == "truth"]
        samples = [h["samples"] for h in told]
        assert samples == sorted(samples) and {h["number"] for h in told} == {7}
        first, second = (taken[-1][1][name] for name in ("first", "second"))
        found = (first + second) / 2
        assert not (first == second).all()  # so that their noise can be told from an error
        page.send(json.dumps({"kind": "stop"}))
        assert eventually(lambda: all(c._truth is None for c in running.live._connections))
    camera = Camera(look_at(EYE, (0, 0, 0)), fov=float(2 * np.degrees(np.arctan(0.3))), shift=(0.1, -0.05))
    expected = eclat.render(running.scene, eclat.Path(), size=(48, 32), samples=256, seed=7, camera=camera).pixels
    assert found.shape == (32, 48, 3)
    # The center of this scene is the origin up to a millimetre; what is left is noise of 256 paths each.
    error = np.sqrt(np.mean((found.clip(0, 2) - expected.clip(0, 2)) ** 2) / np.mean(expected.clip(0, 2) ** 2))
    assert error < 0.2
    flipped = np.sqrt(np.mean((found[::-1].clip(0, 2) - expected.clip(0, 2)) ** 2) / np.mean(expected.clip(0, 2) ** 2))
    assert flipped > 2 * error


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"])
def test_other_origins_get_no_socket(running: Running, origin: str) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        running.page(origin=origin.format(port=running.server.port))


@pytest.mark.parametrize(
    "path",
    ["/live", "/x/live", "/{token}x/live", "/{token}/live/../../etc/passwd", "/{token}/../live", "/{token}/nothing"],
)
def test_without_the_token_or_elsewhere_there_is_no_socket(running: Running, path: str) -> None:
    with pytest.raises((InvalidStatus, ConnectionClosed)):
        running.page(path.format(token=running.server.token)).recv(timeout=PATIENCE)


def test_ten_thousand_messages_are_survived(running: Running) -> None:
    with running.page() as page:
        for i in range(10_000):
            ask(page, "wish", shift=[i * 1e-7, 0])
        until(page, solved)
    with running.page() as page:
        ask(page, "wish")
        until(page, lambda h: h["kind"] == "state")


NONSENSE = {
    "no JSON": "{",
    "no object": "[]",
    "deep": "[" * 2000,
    "no kind": "{}",
    "unknown": '{"kind": "read", "view": null}',
    "a field too many": '{"kind": "stop", "path": "/etc/passwd"}',
    "a wish of nothing": '{"kind": "wish"}',
    "a stop with a view": json.dumps({"kind": "stop", "view": VIEW}),
    "too long": json.dumps({"kind": "wish" + " " * LARGEST_REQUEST, "view": VIEW}),
    "not a number": json.dumps({"kind": "wish", "view": VIEW | {"shift": [float("nan"), 0]}}),
    "too few numbers": json.dumps({"kind": "wish", "view": VIEW | {"to_world": [1] * 15}}),
    "skewed": json.dumps({"kind": "wish", "view": VIEW | {"to_world": [1] * 16}}),
    "far": json.dumps(
        {"kind": "wish", "view": VIEW | {"to_world": [1, 0, 0, 1e30, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}
    ),
    "no picture": json.dumps({"kind": "truth", "view": VIEW | {"size": [0, 10]}}),
    "a huge picture": json.dumps({"kind": "truth", "view": VIEW | {"size": [10**9, 10**9]}}),
    "a huge number": json.dumps({"kind": "truth", "view": VIEW | {"size": [10**30, 1]}}),
    "an unknown way": json.dumps({"kind": "truth", "view": VIEW, "by": "photons"}),
    "no field of view": json.dumps({"kind": "truth", "view": VIEW | {"half_extent": [0, 1]}}),
    "all round": json.dumps({"kind": "truth", "view": VIEW | {"half_extent": [1e9, 1e9]}}),
}


@pytest.mark.parametrize("what", NONSENSE)
def test_nonsense_closes_the_socket_and_harms_nobody(running: Running, what: str) -> None:
    with running.page() as page:
        page.send(NONSENSE[what])
        assert closing_code(page) in (live_module.POLICY, live_module.WRONG)
    assert eventually(lambda: not running.live._connections)
    assert running.live.growth.failure is None


def test_bytes_and_long_messages_close_the_socket(running: Running) -> None:
    with running.page() as page:
        page.send(b"ECLV")
        assert closing_code(page) == live_module.WRONG
    with running.page() as page:
        page.send("x" * 10_000_000)
        assert closing_code(page) in (1009, None)


def test_only_so_many_pages_are_served(running: Running) -> None:
    pages = [running.page() for _ in range(MOST_CONNECTIONS)]
    assert eventually(lambda: len(running.live._connections) == MOST_CONNECTIONS)
    with running.page() as page:
        assert closing_code(page) == live_module.TOO_MANY
    for page in pages:
        page.close()
    assert eventually(lambda: not running.live._connections)
    with running.page() as page:
        until(page, lambda h: h["kind"] == "state")


def test_a_page_that_never_reads_is_disconnected_and_others_are_served(
    running: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_module, "SECONDS_TO_READ", 0.5)
    deaf = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    deaf.connect(("127.0.0.1", running.server.port))
    deaf.sendall(
        f"GET /{running.server.token}/live HTTP/1.1\r\nHost: 127.0.0.1:{running.server.port}\r\nOrigin: {running.origin}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
    )
    # A large picture by paths, which gets better again and again: megabytes that are not taken.
    text = json.dumps({"kind": "truth", "view": VIEW | {"size": [640, 480]}}).encode()
    deaf.sendall(bytes([0x81, 0x80 | 126]) + len(text).to_bytes(2, "big") + bytes(4) + text)
    assert eventually(lambda: len(running.live._connections) == 1)
    with running.page() as page:
        ask(page, "wish")
        until(page, solved)
    assert eventually(lambda: not running.live._connections)
    deaf.close()


def test_a_tab_that_is_closed_while_it_is_served_ends_its_work(running: Running) -> None:
    page = running.page()
    ask(page, "wish", size=[640, 480])
    ask(page, "truth", size=[640, 480])
    until(page, lambda h: h["kind"] == "records")
    page.socket.close()  # as a process that was killed
    assert eventually(lambda: not running.live._connections)
    assert eventually(lambda: not running.live.growth.state.solving)
    assert running.live.growth.failure is None
    count = len(running.live.growth.rows)
    with running.page() as again:
        ask(again, "wish")
        until(again, solved)
    assert len(running.live.growth.rows) >= count


def test_closing_the_server_in_the_middle_ends_everything(scene: Scene) -> None:
    running = Running(scene, empty_solution(scene, eclat.IrradianceCache(max_error=0.005)))
    page = running.page()
    ask(page, "wish", size=[640, 480])
    ask(page, "truth", size=[640, 480])
    until(page, lambda h: h["kind"] == "records")
    running.close()
    with pytest.raises(ConnectionClosed):
        while True:
            page.recv(timeout=PATIENCE)


def test_views_become_cameras_of_bounded_size() -> None:
    request = parsed_request(json.dumps({"kind": "wish", "view": VIEW | {"size": [4000, 3000]}}))
    assert request.view is not None
    _, (width, height) = camera_of(request.view)
    assert width * height <= live_module.MOST_PIXELS and width / height == pytest.approx(4 / 3, rel=0.01)


def test_only_what_changed_is_sent() -> None:
    rows = np.arange(100 * ROW, dtype=np.float32).reshape(100, ROW)
    sent = rows[:80].copy()
    assert list(changed_rows(rows, rows)) == []
    sent[3] += 1
    sent[10, 5] += 1
    sent[60] += 1
    parts = [(first, len(part)) for first, part in changed_rows(sent, rows)]
    assert parts == [(3, 8), (60, 1), (80, 20)]
    assert [first for first, _ in changed_rows(sent[:0], np.repeat(rows, 100, axis=0))] == [0, 4096, 8192]


def test_the_page_is_told_of_the_socket() -> None:
    files = {"index.html": b"<html><head><title>a</title></head></html>", "a.js": b"1"}
    marked = with_live(files)
    assert b'<meta name="eclat-live"' in marked["index.html"] and marked["a.js"] == b"1"
    assert b"eclat-live" not in files["index.html"]
