# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Who may read what from the server of the viewer."""

from __future__ import annotations

import http.client
import sys
from collections.abc import Iterator, Mapping

import pytest

import eclat
from eclat.viewer.server import HEADERS, Server

FILES = {"index.html": b"<!doctype html>", "assets/a.js": b"1", "data/scene.eclat": b"ECLV"}


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    running = Server(FILES)
    yield running
    running.close()


def ask(
    server: Server, path: str, headers: Mapping[str, str] | None = None, method: str = "GET"
) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    for name, value in {"Host": f"127.0.0.1:{server.port}", **(headers or {})}.items():
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    response.body = response.read()  # type: ignore[attr-defined]
    connection.close()
    return response


def test_the_page_and_its_data_are_served_below_the_token(server: Server) -> None:
    assert len(server.token) >= 32
    for name, data in FILES.items():
        response = ask(server, f"/{server.token}/{name}")
        assert response.status == 200 and response.body == data  # type: ignore[attr-defined]
        for header, value in HEADERS.items():
            assert response.getheader(header) == value
    response = ask(server, f"/{server.token}/")
    assert response.status == 200 and response.getheader("Content-Type", "").startswith("text/html")


@pytest.mark.parametrize("path", ["/", "/index.html", "/data/scene.eclat", "/{wrong}/", "/{short}/", "/{token}"])
def test_without_the_token_nothing_is_served(server: Server, path: str) -> None:
    names = {"wrong": "x" * len(server.token), "short": server.token[:-1], "token": server.token}
    assert ask(server, path.format(**names)).status == 404


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:{port}"},
        {"Host": "127.0.0.1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "https://127.0.0.1:{port}"},
        {"Origin": "http://127.0.0.1:1"},
    ],
)
def test_other_hosts_and_origins_are_refused(server: Server, headers: dict[str, str]) -> None:
    sent = {name: value.format(port=server.port) for name, value in headers.items()}
    assert ask(server, f"/{server.token}/", sent).status == 403


def test_the_own_origin_is_served(server: Server) -> None:
    for name in ("127.0.0.1", "localhost"):
        headers = {"Host": f"{name}:{server.port}", "Origin": f"http://{name}:{server.port}"}
        assert ask(server, f"/{server.token}/", headers).status == 200


@pytest.mark.parametrize(
    "name", ["../server.py", "..%2fserver.py", "%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "assets/../../x", "data/"]
)
def test_no_path_leads_out_of_the_scene(server: Server, name: str) -> None:
    assert ask(server, f"/{server.token}/{name}").status == 404


def test_only_reading_is_allowed(server: Server) -> None:
    for method in ("POST", "PUT", "DELETE", "OPTIONS"):
        assert ask(server, f"/{server.token}/", method=method).status == 405


def test_the_token_is_another_each_time() -> None:
    second = Server({})
    third = Server({})
    try:
        assert second.token != third.token and second.port != third.port
    finally:
        second.close()
        third.close()


def test_a_missing_package_is_named_before_any_work(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(*arguments: object, **keywords: object) -> None:
        raise AssertionError("light was computed")

    monkeypatch.setitem(sys.modules, "uvicorn", None)
    monkeypatch.setattr("eclat.viewer.showing.contents_of", work)
    with pytest.raises(eclat.EclatError, match=r"view: uvicorn is not installed.*eclat\[view\]"):
        eclat.view("cornell-box", open_browser=False)
