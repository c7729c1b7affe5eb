# SPDX-License-Identifier: MIT
"""A serial line with a deadline: the one module that talks to pyserial."""

import re
import sys
import time
from collections.abc import Callable
from typing import Protocol, TypeVar

import serial

from jointbench.acquisition.basics.errors import (
    InstrumentError,
    UsageError,
)
from jointbench.acquisition.serial_lines.line_faults import (
    LineBroken,
    LineSilent,
    Unreadable,
)

if sys.platform == "win32":
    _BROKEN: tuple[type[Exception], ...] = (serial.SerialException, OSError, TypeError)
else:
    import termios

    # pyserial lets an error of the terminal through, and trips over a closed port.
    _BROKEN = (serial.SerialException, OSError, TypeError, termios.error)

_Answer = TypeVar("_Answer")
TRIES = 3
"""Times that an answer which cannot be read is asked for."""
_QUIET = 0.05  # [s], 48 characters at 9600 baud
_LONGEST_NOISE = 1.0  # [s]
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x0c\x0e-\x1f\x7f]")


class Line(Protocol):
    """What a driver needs of a line; a test may be one."""

    def send(self, data: bytes) -> None:
        """Send all of `data`."""
        ...

    def receive(self, count: int) -> bytes:
        """Return exactly `count` bytes, or raise `LineBroken`."""
        ...

    def receive_to(self, end: bytes, *, limit: int) -> bytes:
        """Return bytes up to and with `end`, or raise `LineBroken`."""
        ...

    def settle(self) -> None:
        """Drop what still arrives, until the line is quiet, or raise `LineBroken`."""
        ...


def ask_again(line: Line, ask: Callable[[], _Answer], *, tries: int = TRIES) -> _Answer:
    """Return an answer that can be read; one that cannot is asked for again.

    Args:
        line: of the instrument.
        ask: sends the request and reads its answer; asking twice must do no harm.
        tries: times that it is asked at the most.

    Raises:
        Unreadable: no answer can be read.
        LineSilent: they stop short; the error keeps the longest.
        LineBroken: the line was unplugged; that is not tried again.
    """
    kept: LineBroken | Unreadable | None = None
    for left in reversed(range(tries)):
        try:
            if kept is not None:
                line.settle()
            return ask()
        except (LineBroken, Unreadable) as error:
            if kept is None or _came(error) > _came(kept):
                kept = error
            if not (left and isinstance(error, LineSilent | Unreadable)):
                break
    assert kept is not None, "tries is at least 1"
    raise kept


def _came(error: LineBroken | Unreadable) -> int:
    """Return how many bytes of an answer an error keeps."""
    return len(error.received) if isinstance(error, LineBroken) else 0


def plain_text(answer: bytes, instrument: str) -> str:
    """Return an answer as text.

    Args:
        answer: as received, in Windows-1252.
        instrument: for the message.

    Raises:
        Unreadable: a byte of it stands for no character.
    """
    try:
        text = answer.decode("cp1252")
    except UnicodeDecodeError:
        text = ""
    if (not text and answer) or _CONTROL.search(text):
        raise Unreadable(
            f"the {instrument} answered {answer[:20]!r}, which is no text; check cable "
            "and baud rate"
        )
    return text


class SerialLine:
    """A line by its name, ``COM3``, ``/dev/ttyUSB0`` or ``socket://host:port``."""

    def __init__(self, name: str, *, baud: int, timeout: float = 5.0) -> None:
        """Open a line of 8 data bits, no parity, one stop bit.

        Args:
            name: of the port, or a URL that pyserial knows.
            baud: bits per second.
            timeout: longest silence within an answer [s].

        Raises:
            InstrumentError: it cannot be opened.
            UsageError: the name is a URL of an unknown kind.
        """
        self.name = name
        try:
            self._port = serial.serial_for_url(name, baudrate=baud, timeout=timeout)
        except ValueError as error:
            raise UsageError(
                f"{name!r} is no serial line ({error}); type COM3, /dev/ttyUSB0 or "
                "socket://host:port"
            ) from error
        except _BROKEN as error:
            raise InstrumentError(
                f"serial line {name!r} cannot be opened ({error}); check the cable and "
                "whether another program has it"
            ) from error

    def send(self, data: bytes) -> None:
        """Send all of `data`; what arrived before it answers nothing, and is dropped.

        Raises:
            LineBroken: the line was unplugged.
        """
        try:
            self._port.reset_input_buffer()
            self._port.write(data)
            self._port.flush()
        except _BROKEN as error:
            raise self._broken("was unplugged", b"") from error

    def receive(self, count: int) -> bytes:
        """Return exactly `count` bytes.

        Raises:
            LineBroken: they do not come; what came is in the error.
        """
        received = bytearray()
        while len(received) < count:
            self._more(received, count - len(received), f"{count} bytes")
        return bytes(received)

    def receive_to(self, end: bytes, *, limit: int) -> bytes:
        """Return bytes up to and with `end`.

        Args:
            end: one byte or more.
            limit: longest answer believed [bytes].

        Raises:
            LineBroken: the end does not come, or not within the limit.
        """
        received = bytearray()
        while not received.endswith(end):
            if len(received) >= limit:
                words = f"sent {limit} bytes without an end"
                raise self._broken(words, bytes(received), LineSilent)
            self._more(received, 1, f"an answer that ends in {end!r}")
        return bytes(received)

    def settle(self) -> None:
        """Drop what still arrives, until the line is quiet.

        Raises:
            LineBroken: the line was unplugged.
        """
        until = time.monotonic() + _LONGEST_NOISE
        try:
            time.sleep(_QUIET)
            while self._port.in_waiting and time.monotonic() < until:
                self._port.reset_input_buffer()
                time.sleep(_QUIET)
        except _BROKEN as error:
            raise self._broken("was unplugged", b"") from error

    def waiting(self) -> int:
        """Return the number of unread bytes."""
        return int(self._port.in_waiting)

    def close(self) -> None:
        """Let go of the line."""
        self._port.close()

    def _more(self, received: bytearray, count: int, wanted: str) -> None:
        try:
            # One byte is waited for, the rest taken as it lies there: a read of many
            # that breaks off throws away what had come.
            new = self._port.read(1)
            received += new
            rest = min(int(self._port.in_waiting), count - 1) if new else 0
            if rest > 0:
                received += self._port.read(rest)
        except _BROKEN as error:
            raise self._broken("was unplugged", bytes(received)) from error
        if not new:
            words = f"is silent, {wanted} were expected"
            raise self._broken(words, bytes(received), LineSilent)

    def _broken(
        self, what: str, received: bytes, kind: type[LineBroken] = LineBroken
    ) -> LineBroken:
        return kind(
            f"serial line {self.name!r} {what} after {len(received)} bytes of the "
            "answer; check plug, power and baud rate, then ask again",
            received,
        )
