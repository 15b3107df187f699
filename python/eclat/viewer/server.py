# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The server of `eclat view`.

It listens on 127.0.0.1 only, at a free port, and answers only requests whose path begins with a secret token, whose
`Host` is this address, and whose `Origin`, if they have one, is the page's own. Another page in the same browser knows
no token; a name that resolves to 127.0.0.1 has another host (DNS rebinding). It serves the contents of a dictionary and
reads no files, so that no path leads out of the scene.
"""

from __future__ import annotations

import secrets
import socket
import threading
import time
from collections.abc import Awaitable, Callable, Mapping, MutableMapping, Sequence
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from eclat.errors import EclatError
from eclat.viewer.page import TYPES

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute

HOST = "127.0.0.1"

LARGEST_MESSAGE = 1 << 14
"""Largest size in bytes of a message that a page may send; longer ones close its web socket."""

HEADERS = {
    # Scripts, styles and data come from the page's own address only; a notebook on this machine may frame the page.
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'self' http://127.0.0.1:* http://localhost:*"
    ),
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",  # the address holds the token
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]


class Guard:
    """Refuses requests that do not come from the page: 403 for another host or origin, 404 without the token."""

    def __init__(self, app: App, *, token: str, port: int) -> None:
        self._app = app
        self._prefix = f"/{token}/"
        self._hosts = {f"{name}:{port}".encode() for name in (HOST, "localhost")}
        self._origins = {b"http://" + host for host in self._hosts}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        status = self._refusal(scope)
        if not status:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await send({"type": "http.response.start", "status": status, "headers": []})
            await send({"type": "http.response.body", "body": b""})

    def _refusal(self, scope: Scope) -> int:
        """Return the status with which a request is refused, or 0."""
        named = [value for name, value in scope["headers"] if name == b"host"]
        origins = [value for name, value in scope["headers"] if name == b"origin"]
        if len(named) != 1 or named[0] not in self._hosts or any(origin not in self._origins for origin in origins):
            return 403
        begin = scope["path"][: len(self._prefix)].encode("utf-8", "surrogateescape")
        if not secrets.compare_digest(begin, self._prefix.encode()):
            return 404
        return 0


def application(files: Mapping[str, bytes], token: str, port: int, routes: Sequence[BaseRoute] = ()) -> Starlette:
    """Make the application.

    Parameters
    ----------
    files : what is served, by path below the token. The mapping is read at each request, so it may change.
    routes : further routes, whose paths begin with the token.
    """
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.responses import Response
    from starlette.routing import Route

    def serve(request: Request) -> Response:
        name = request.path_params["name"] or "index.html"
        data = files.get(name)
        if data is None:
            return Response(status_code=404, headers=HEADERS)
        kind = TYPES.get(PurePosixPath(name).suffix, "application/octet-stream")
        return Response(data, media_type=kind, headers=HEADERS)

    guard = Middleware(Guard, token=token, port=port)
    return Starlette(routes=[*routes, Route(f"/{token}/{{name:path}}", serve, methods=["GET"])], middleware=[guard])


def require_server() -> None:
    """Raise EclatError if starlette or uvicorn is not installed. Call it before a long computation."""
    try:
        import starlette  # noqa: F401
        import uvicorn  # noqa: F401
    except ImportError as error:
        raise EclatError(
            f"view: {error.name} is not installed; install it with: pip install 'eclat[view]', or write files with --export"
        ) from error


class Server:
    """A running server, in a thread of its own until it is closed."""

    def __init__(self, files: Mapping[str, bytes], routes: Callable[[str], Sequence[BaseRoute]] | None = None) -> None:
        """Start to serve `files`. `routes` makes further routes for the token.

        Raises EclatError if starlette or uvicorn is not installed.
        """
        require_server()
        import uvicorn

        self.token = secrets.token_urlsafe(24)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.bind((HOST, 0))
        self.port: int = self._socket.getsockname()[1]
        app = application(files, self.token, self.port, routes(self.token) if routes else ())
        # The access log would print the token of every request.
        self._server = uvicorn.Server(
            uvicorn.Config(
                app,
                log_level="critical",  # a page that leaves in the middle of a message is no error
                access_log=False,
                server_header=False,
                lifespan="off",
                ws_max_size=LARGEST_MESSAGE,
                timeout_graceful_shutdown=2,
            )
        )
        self._thread = threading.Thread(
            target=self._server.run, kwargs={"sockets": [self._socket]}, name="eclat view", daemon=True
        )
        self._thread.start()
        while self._thread.is_alive() and not self._server.started:
            time.sleep(0.01)

    @property
    def url(self) -> str:
        """The address of the page, with its token."""
        return f"http://{HOST}:{self.port}/{self.token}/"

    def wait(self) -> None:
        """Wait until the server is closed, or for Ctrl-C."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def close(self) -> None:
        """Stop the server; nothing happens if it has stopped."""
        self._server.should_exit = True
        self._thread.join()
        self._socket.close()
