# SPDX-License-Identifier: MIT
"""A serial line with a deadline: the one module that talks to pyserial."""

import sys
from typing import Protocol

import serial

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import InstrumentError, UsageError

if sys.platform == "win32":
    _BROKEN: tuple[type[Exception], ...] = (serial.SerialException, OSError, TypeError)
else:
    import termios

    # pyserial lets an error of the terminal through, and trips over a closed port.
    _BROKEN = (serial.SerialException, OSError, TypeError, termios.error)


class LineBroken(InstrumentError):
    """A line that went silent or was unplugged in the middle of an answer.

    Attributes:
        received: what had arrived of that answer; nothing of it is lost.
    """

    def __init__(self, message: str, received: bytes) -> None:
        super().__init__(message)
        self.received = received


class ProfileBroken(LineBroken):
    """A line that broke in the middle of a profile.

    Attributes:
        heights: of the points that had arrived, from the first on [m].
        spacing: between them, as far as it is known [m].
    """

    def __init__(
        self, message: str, received: bytes, heights: FloatArray, spacing: float | None
    ) -> None:
        super().__init__(message, received)
        self.heights, self.spacing = heights, spacing


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
        """Send all of `data`.

        Raises:
            LineBroken: the line was unplugged.
        """
        try:
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
                raise self._broken(
                    f"sent {limit} bytes without an end", bytes(received)
                )
            self._more(received, 1, f"an answer that ends in {end!r}")
        return bytes(received)

    def waiting(self) -> int:
        """Return how many bytes have arrived that nobody read."""
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
            raise self._broken(f"is silent, {wanted} were expected", bytes(received))

    def _broken(self, what: str, received: bytes) -> LineBroken:
        return LineBroken(
            f"serial line {self.name!r} {what} after {len(received)} bytes of the "
            "answer; check plug, power and baud rate, then ask again",
            received,
        )
