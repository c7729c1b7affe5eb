# SPDX-License-Identifier: MIT
"""A serial instrument without hardware: on a pseudo-terminal or a socket.

`unplug_after` breaks the line in the middle of a message, as a disconnected plug does.
"""

import os
import select
import socket
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType

from jointbench.acquisition.serial_lines.serial_instrument import Answer
from jointbench.simulators.twins.dialogue import answer_all

_POLL = 0.05  # [s]
_LONGEST_DRAIN = 2.0  # [s]


class Twin:
    """An instrument on a separate line; pyserial opens `name`."""

    def __init__(
        self,
        answer: Answer,
        *,
        over_socket: bool = False,
        unplug_after: int | None = None,
        comes_back: bool = False,
    ) -> None:
        """Connect the instrument.

        Args:
            answer: of the instrument.
            over_socket: a socket instead of a pseudo-terminal; always so on Windows.
            unplug_after: bytes sent after which the line breaks, None for never.
            comes_back: whether a broken socket accepts a new client.
        """
        self._answer, self._left = answer, unplug_after
        self._comes_back = comes_back
        self._closing = threading.Event()
        self._end: _Socket | _Terminal
        use_socket = over_socket or sys.platform == "win32"
        self._end = _Socket() if use_socket else _Terminal()
        self.name = self._end.name
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self) -> "Twin":
        """Return the instrument."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Unplug."""
        self._closing.set()
        self._thread.join()

    def _serve(self) -> None:
        received = b""
        try:
            while not self._closing.is_set():
                new = self._end.receive()
                if new is None:
                    continue
                sent, received = answer_all(self._answer, received + new)
                if self._left is not None and len(sent) >= self._left:
                    self._end.send(sent[: self._left])
                    self._end.drain()
                    if not self._comes_back:
                        return
                    self._end.hang_up()
                    self._left, received = None, b""
                    continue
                self._end.send(sent)
                if self._left is not None:
                    self._left -= len(sent)
        finally:
            self._end.close()


class _Socket:
    """The far end of a ``socket://`` line."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(_POLL)
        self._peer: socket.socket | None = None
        self.name = f"socket://127.0.0.1:{self._listener.getsockname()[1]}"

    def receive(self) -> bytes | None:
        """Return the received bytes, or None."""
        try:
            if self._peer is None:
                self._peer = self._listener.accept()[0]
                self._peer.settimeout(_POLL)
            received = self._peer.recv(4096)
        except TimeoutError:
            return None
        except ConnectionError:
            received = b""
        if not received:
            self.hang_up()
        return received or None

    def drain(self) -> None:
        """Do nothing: a socket delivers all it accepted."""

    def hang_up(self) -> None:
        """Disconnect the client; another may connect."""
        if self._peer is not None:
            self._peer.close()
            self._peer = None

    def send(self, data: bytes) -> None:
        """Send all of `data`."""
        if self._peer is not None:
            with suppress(OSError):
                self._peer.sendall(data)

    def close(self) -> None:
        """Close the connection."""
        self.hang_up()
        self._listener.close()


class _Terminal:
    """The far end of a pseudo-terminal."""

    def __init__(self) -> None:
        # Looked up by name: there is no such module on Windows.
        tty: Callable[[int], object] = __import__("tty").setraw
        self._closing = threading.Event()
        self._near, self._far = os.openpty()
        tty(self._far)
        self.name = os.ttyname(self._far)

    def receive(self) -> bytes | None:
        """Return the received bytes, or None."""
        if not select.select([self._near], [], [], _POLL)[0]:
            return None
        try:
            return os.read(self._near, 4096)
        except OSError:
            return None

    def send(self, data: bytes) -> None:
        """Send all of `data`, piece by piece as the reader takes it."""
        with suppress(OSError):
            while data:
                data = data[os.write(self._near, data) :]

    def drain(self) -> None:
        """Wait until the reader has taken all: a hang-up discards unread bytes."""
        until = time.monotonic() + _LONGEST_DRAIN
        while select.select([self._far], [], [], 0)[0] and time.monotonic() < until:
            self._closing.wait(_POLL / 10)

    def hang_up(self) -> None:
        """Disconnect for good: a closed terminal cannot be reopened by name."""
        self.close()

    def close(self) -> None:
        """Disconnect."""
        for handle in (self._near, self._far):
            with suppress(OSError):
                os.close(handle)
