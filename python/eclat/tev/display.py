# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture in tev, whose pixels are sent as they change.

What tev should show is kept here, with the places where it does not show it yet. A thread sends these places one after the
other, so that a slow connection delays nothing but what it shows: places that change again before they are sent are sent once.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Mapping
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, shown, warn
from eclat.images.image import LAYERS, RECORD_MARK, Image
from eclat.images.tone import srgb_encode
from eclat.tev import packets

PORT = 14158
"""The port to which tev listens if it is not told another."""

PATIENCE = 5.0
"""Seconds after which a server that takes nothing is given up."""
LAST_PATIENCE = 10.0
"""Seconds that the end of a picture waits for what was not sent yet."""

SIDE = 64
"""The side in pixels of the squares that are sent. With the ten layers of a picture one has half a megabyte."""

MARK_SIDE = 2.0
"""Side in pixels of the square that marks a record, small enough to tell records apart that lie three pixels apart. Squares
have four corners, where tev draws a disc from some twenty, and pictures have ten thousand records."""


class Display:
    """A picture in tev, or in another program that understands its messages.

    Connecting and sending take place in a thread of their own. If the server cannot be reached, is too slow or goes away,
    there is one warning, and nothing more is shown. Leaving the `with` block sends what is left, for at most
    `LAST_PATIENCE` seconds.

    Parameters
    ----------
    server : "host:port"; without a port, it is that of tev, 14158.
    name : the name of the picture in tev. A picture that has this name there is replaced.

    Raises
    ------
    EclatError : `server` is no address.

    Examples
    --------
    >>> import eclat
    >>> with eclat.Display("localhost:14158", "room") as display:  # doctest: +SKIP
    ...     display.show(eclat.Image.load("room.exr"))
    """

    def __init__(self, server: str, name: str) -> None:
        self._server, self._name = address_of(server), name
        self._changed = threading.Condition()
        self._layers: dict[str, NDArray[np.float32]] = {}
        self._created = False
        self._squares: dict[tuple[int, int], set[str]] = {}  # what changed, by the column and row of the square
        self._marks: bytes | None = None
        self._marked = True  # whether tev has drawn the marks
        self._ending = False
        self._lost, self._warned = "", False
        self._thread = threading.Thread(target=self._send_all, daemon=True)
        self._thread.start()

    def __enter__(self) -> Display:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None:
            with self._changed:
                self._squares.clear()
        self.close()

    def show(self, image: Image) -> None:
        """Show an image with all its layers."""
        self.update((0, 0), {"": image.pixels, **image.layers}, (image.width, image.height))
        self.warn_if_lost()

    def update(
        self,
        corner: tuple[int, int],
        layers: Mapping[str, NDArray[np.float32]],
        size: tuple[int, int] | None = None,
    ) -> None:
        """Replace a rectangle of pixels.

        Parameters
        ----------
        corner : the column and the row of its upper left pixel.
        layers : layers by name, (h, w, 3) or (h, w); "" is the picture itself. Others keep what they show.
        size : width and height of the whole picture, or None for those that it has. Before it has a size, nothing is shown.
        """
        if self._lost:
            return
        height, width = next(iter(layers.values())).shape[:2]
        x, y = corner
        with self._changed:
            if size is not None and self._size not in (None, size):
                self._layers.clear()
            whole = self._size or size
            if whole is None:
                return
            for name, layer in layers.items():
                if name not in self._layers or self._layers[name].ndim != layer.ndim:
                    # tev learns the channels of a picture when it is created.
                    self._layers[name] = np.zeros((whole[1], whole[0], *layer.shape[2:]), np.float32)
                    self._created = False
                self._layers[name][y : y + height, x : x + width] = layer
            for row in range(y // SIDE, -(-(y + height) // SIDE)):
                for column in range(x // SIDE, -(-(x + width) // SIDE)):
                    self._squares.setdefault((column, row), set()).update(layers)
            self._changed.notify()

    def mark_records(self, places: NDArray[np.floating]) -> None:
        """Draw a square at each of the `places` (N, 2) in pixels, instead of those drawn before."""
        red, green, blue = (float(value) for value in srgb_encode(np.asarray(RECORD_MARK)))
        with self._changed:
            self._marks = packets.squares(self._name, places, MARK_SIDE, (red, green, blue, 1.0))
            self._marked = False
            self._changed.notify()

    def close(self) -> None:
        """Send what is left, for at most `LAST_PATIENCE` seconds, and end the connection."""
        with self._changed:
            self._ending = True
            self._changed.notify()
        self._thread.join(LAST_PATIENCE)
        if self._thread.is_alive():
            self._lost = self._lost or f"took too long to read the end of the picture, more than {LAST_PATIENCE:g} s"
        self.warn_if_lost()

    def warn_if_lost(self) -> None:
        """Warn if the server is lost and that was not yet said. Call it in the main thread."""
        if self._lost and not self._warned:
            self._warned = True
            host, port = self._server
            warn(f"the display server {host}:{port} {self._lost}; the picture is not affected, but not shown there")

    @property
    def _size(self) -> tuple[int, int] | None:
        """Width and height of the picture, or None before there is one."""
        for layer in self._layers.values():
            return layer.shape[1], layer.shape[0]
        return None

    def _send_all(self) -> None:
        """Connect, and send what has changed, until the picture ends or the server is lost."""
        reached = False
        try:
            with socket.create_connection(self._server, PATIENCE) as connection:
                reached = True
                connection.settimeout(PATIENCE)
                while (message := self._next_message()) is not None:
                    connection.sendall(message)
        except TimeoutError:
            self._lost = f"took nothing for {PATIENCE:g} s" if reached else "does not answer"
        except OSError as error:
            reason = error.strerror or str(error)
            self._lost = f"ended the connection ({reason})" if reached else f"cannot be reached ({reason})"

    def _next_message(self) -> bytes | None:
        """Wait for a change and make the message that tells it; None if the picture has ended and all is told."""
        with self._changed:
            while not (self._squares or (self._created and not self._marked)):
                if self._ending:
                    return None
                self._changed.wait()
            size = self._size
            assert size is not None
            if not self._created:
                # A created picture is black, and nothing is drawn over it.
                self._created, self._marked = True, self._marks is None
                for row in range(-(-size[1] // SIDE)):
                    for column in range(-(-size[0] // SIDE)):
                        self._squares[column, row] = set(self._layers)
                return packets.create_image(self._name, size, self._channels_of(self._layers))
            if self._squares:
                square = min(self._squares, key=lambda at: (at[1], at[0]))
                return self._square(square, self._squares.pop(square))
            self._marked = True
            return self._marks

    def _square(self, square: tuple[int, int], names: set[str]) -> bytes:
        x, y = SIDE * square[0], SIDE * square[1]
        parts = {name: layer[y : y + SIDE, x : x + SIDE] for name, layer in self._layers.items() if name in names}
        planes = [plane for part in parts.values() for plane in np.atleast_3d(part).transpose(2, 0, 1)]
        return packets.update_image(self._name, (x, y), dict(zip(self._channels_of(parts), planes, strict=True)))

    @staticmethod
    def _channels_of(layers: Mapping[str, NDArray[np.float32]]) -> list[str]:
        """List the names of the channels of layers, as in an EXR file."""
        names = []
        for name, layer in layers.items():
            letters = LAYERS.get(name, "RGB" if layer.ndim == 3 else "Y")
            names += [f"{name}.{letter}" if name else letter for letter in letters]
        return names


def address_of(server: str) -> tuple[str, int]:
    """Return the host and the port of "host:port" or "host", where an IPv6 address stands in brackets.

    Raises EclatError if it is neither.
    """
    host, colon, port = server.rpartition(":")
    if not colon or server.endswith("]"):
        host, port = server, str(PORT)
    host = host.removeprefix("[").removesuffix("]")
    if not host or not port.isdecimal() or not 1 <= int(port) <= 65535:
        raise EclatError(f"display server: expected host:port, as in localhost:{PORT}, got {shown(server)}")
    return host, int(port)
