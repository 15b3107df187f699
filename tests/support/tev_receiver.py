# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A receiver of tev's messages, which keeps what tev would show. It is written by the description of the protocol in tev's
README and in its headers Ipc.h and VectorGraphics.h, and shares nothing with the sender."""

from __future__ import annotations

import socket
import struct
import threading
from dataclasses import dataclass, field
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

FLOATS_OF_COMMAND = {0: 0, 1: 0, 2: 4, 3: 0, 4: 4, 5: 0, 6: 0, 7: 0, 8: 1, 10: 2, 11: 2, 15: 3, 16: 4, 18: 4}
"""The number of floats of each kind of drawing command; 2 is a fill colour, 3 fills, 6 begins a path, and 18 is a rectangle."""


@dataclass
class Shown:
    """A picture as tev shows it: its channels (H, W) by name, the rectangles that were updated, and what is drawn over it."""

    channels: dict[str, NDArray[np.float32]]
    updates: list[tuple[int, int, int, int]] = field(default_factory=list)
    drawn: list[tuple[int, tuple[float, ...]]] = field(default_factory=list)


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def values(self, form: str) -> tuple[int, ...]:
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values

    def text(self) -> str:
        end = self.data.index(b"\0", self.at)
        text = self.data[self.at : end].decode()
        self.at = end + 1
        return text


class TevReceiver:
    """Listens at `address` ("localhost:port") inside a `with` block, and keeps the pictures by name.

    Parameters
    ----------
    most : the number of messages after which it ends the connection, or None.
    deaf : it accepts a connection, and reads nothing.
    """

    def __init__(self, most: int | None = None, deaf: bool = False) -> None:
        self.pictures: dict[str, Shown] = {}
        self.created: list[tuple[str, ...]] = []
        self.failure: BaseException | None = None
        self._most, self._deaf = most, deaf
        self._listening = socket.create_server(("localhost", 0))
        self.address = f"localhost:{self._listening.getsockname()[1]}"
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self) -> TevReceiver:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join(10)
        self._listening.close()
        if self.failure is not None and error is None:
            raise self.failure

    def _serve(self) -> None:
        self._listening.settimeout(10)
        try:
            connection, _ = self._listening.accept()
            with connection:
                if self._deaf:
                    self._ended.wait(20)
                    return
                while self._most is None or self._most > 0:
                    length = self._exactly(connection, 4)
                    if length is None:
                        return
                    rest = self._exactly(connection, struct.unpack("<I", length)[0] - 4)
                    assert rest is not None, "the connection ends inside a message"
                    self._read(_Reader(rest))
                    self._most = None if self._most is None else self._most - 1
        except BaseException as error:
            self.failure = error

    @staticmethod
    def _exactly(connection: socket.socket, count: int) -> bytes | None:
        data = b""
        while len(data) < count:
            part = connection.recv(count - len(data))
            if not part:
                assert not data, "the connection ends inside a message"
                return None
            data += part
        return data

    def _read(self, message: _Reader) -> None:
        (kind,) = message.values("b")
        {4: self._create, 6: self._update, 8: self._draw}[kind](message)
        assert message.at == len(message.data), f"{len(message.data) - message.at} bytes are left of a message {kind}"

    def _create(self, message: _Reader) -> None:
        message.values("?")
        name = message.text()
        width, height, count = message.values("3i")
        channels = [message.text() for _ in range(count)]
        self.created.append(tuple(channels))
        self.pictures[name] = Shown({channel: np.zeros((height, width), np.float32) for channel in channels})

    def _update(self, message: _Reader) -> None:
        message.values("?")
        picture = self.pictures[message.text()]
        (count,) = message.values("i")
        names = [message.text() for _ in range(count)]
        x, y, width, height = message.values("4i")
        offsets, strides = message.values(f"{count}q"), message.values(f"{count}q")
        last = max(o + (width * height - 1) * s for o, s in zip(offsets, strides, strict=True))
        numbers = np.frombuffer(message.data, "<f4", last + 1, message.at)
        message.at += 4 * (last + 1)
        picture.updates.append((x, y, width, height))
        for name, offset, stride in zip(names, offsets, strides, strict=True):
            plane = numbers[offset::stride][: width * height].reshape(height, width)
            assert plane.shape == picture.channels[name][y : y + height, x : x + width].shape
            picture.channels[name][y : y + height, x : x + width] = plane

    def _draw(self, message: _Reader) -> None:
        message.values("?")
        picture = self.pictures[message.text()]
        append, count = message.values("?i")
        if not append:
            picture.drawn.clear()
        for _ in range(count):
            (command,) = message.values("b")
            picture.drawn.append((command, message.values(f"{FLOATS_OF_COMMAND[command]}f")))
