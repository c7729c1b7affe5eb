# SPDX-License-Identifier: MIT
"""Diavite DH-8 roughness tester: ESC command ETX, answered by ACK payload EOT.

115200 baud, 8N1. Codes 04 and 06 occur inside a binary profile, so its end is found by
its count, never by looking for EOT.

Source:
    Public protocol notes of the DH-8. They state neither whether heights are signed nor
    the end of the traverse with the last point: `signed` is an option, and the spacing
    is taken as traverse over number of points.
"""

import struct

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument
from jointbench.acquisition.serial_lines.line import TRIES, Line, ask_again, plain_text
from jointbench.acquisition.serial_lines.line_faults import (
    LineBroken,
    LineSilent,
    ProfileBroken,
    ProfileSilent,
    Unreadable,
)
from jointbench.acquisition.serial_lines.serial_instrument import (
    ProfileOptions,
    SerialInstrument,
)

BAUD = 115_200
TRAVERSES = (0.48e-3, 1.5e-3, 4.8e-3, 15e-3)
"""Traverse by its index [m]."""
CUTOFFS = (None, 0.08e-3, 0.25e-3, 0.8e-3, 2.5e-3)
"""Cut-off by its index [m]."""
_HEIGHT_STEP = 1e-6 / 128
"""Height of one count [m]."""
_ESC, _ETX, _EOT, _ACK, _NAK = b"\x1b", b"\x03", b"\x04", b"\x06", b"\x15"
_MOST_TEXT = 4096
_LETTERS = {
    "name": b"0",
    "version": b"1",
    "unit": b"2",
    "values": b"@",
    "start": b">",
}


def ask_text(line: Line, what: str) -> str:
    """Ask for a text, or start a measurement.

    A text that cannot be read is asked for again; a measurement is started once.

    Args:
        line: of the instrument.
        what: ``"name"``, ``"version"``, ``"unit"``, ``"values"`` (the R values, two
            lines) or ``"start"``.

    Raises:
        UsageError: there is no such question.
        FormatError: the answer does not begin with ACK, or is no text.
        LineBroken: it does not come to its end.
    """
    if what not in _LETTERS:
        raise UsageError(f"the DH-8 knows no {what!r}; ask for {', '.join(_LETTERS)}")

    def ask() -> str:
        _request(line, _LETTERS[what])
        return plain_text(line.receive_to(_EOT, limit=_MOST_TEXT)[:-1], "DH-8")

    return ask_again(line, ask, tries=1 if what == "start" else TRIES)


def set_traverse(line: Line, index: int) -> None:
    """Set the traverse by its index in `TRAVERSES`.

    Raises:
        UsageError: there is no such index.
    """
    if not 0 <= index < len(TRAVERSES):
        raise UsageError(f"traverse index is {index}; give 0 to {len(TRAVERSES) - 1}")
    ask_again(line, lambda: _order(line, b"P" + bytes([index])))


def set_cutoff(line: Line, index: int) -> None:
    """Set the cut-off by its index in `CUTOFFS`.

    Raises:
        UsageError: there is no such index.
    """
    if not 0 <= index < len(CUTOFFS):
        raise UsageError(f"cut-off index is {index}; give 0 to {len(CUTOFFS) - 1}")
    ask_again(line, lambda: _order(line, b"Q" + bytes([index])))


def read_profile(
    line: Line,
    *,
    name: str,
    traverse: float,
    filtered: bool = False,
    signed: bool = True,
) -> Profile:
    """Fetch the profile of the last measurement; one that is garbled, once more.

    Args:
        line: of the instrument.
        name: of the profile.
        traverse: that was measured [m].
        filtered: the roughness profile instead of the one as traced.
        signed: whether heights are signed; the public notes do not say.

    Raises:
        FormatError: the answer is not framed as the notes say, or holds no point.
        ProfileBroken: it breaks off; the error keeps bytes and heights that came.
        LineBroken: it breaks off before the first point.
    """
    gain, body = ask_again(line, lambda: _profile(line, traverse, filtered, signed))
    count = len(body) // 2
    if count == 0:
        raise FormatError("the DH-8 sent a profile without points; measure first")
    return Profile(
        name=name,
        heights=_heights(body, signed=signed),
        spacing=traverse / count,
        valid=np.ones(count, dtype=bool),
        instrument=SurfaceInstrument(name="Diavite DH-8"),
        provenance=(
            step("diavite", gain=gain, points=count, signed=signed, filtered=filtered),
        ),
    )


def _profile(
    line: Line, traverse: float, filtered: bool, signed: bool
) -> tuple[int, bytes]:
    """Return gain and heights of a profile, as they are sent."""
    _order(line, b"U0")
    _request(line, b"+" if filtered else b"<")
    head = line.receive(4)
    gain, count = struct.unpack("<HH", head)
    try:
        body = line.receive(2 * count)
    except LineBroken as error:
        whole = error.received[: len(error.received) // 2 * 2]
        heights = _heights(whole, signed=signed)
        kind = ProfileSilent if isinstance(error, LineSilent) else ProfileBroken
        raise kind(
            f"{error}; {heights.size} of {count} points came",
            head + error.received,
            heights,
            traverse / count,
        ) from error
    _end(line)
    return gain, body


def _heights(body: bytes, *, signed: bool) -> FloatArray:
    counts = np.frombuffer(body, dtype="<i2" if signed else "<u2")
    return _HEIGHT_STEP * counts.astype(np.float64)


def _request(line: Line, command: bytes) -> None:
    line.send(_ESC + command + _ETX)
    first = line.receive(1)
    if first != _ACK:
        kind = FormatError if first == _NAK else Unreadable
        raise kind(
            f"the DH-8 answered {first!r} to {command!r} where ACK is expected; check "
            f"the baud rate, it is {BAUD}"
        )


def _order(line: Line, command: bytes) -> None:
    """Send what is answered without a payload."""
    _request(line, command)
    _end(line)


def _end(line: Line) -> None:
    last = line.receive(1)
    if last != _EOT:
        raise Unreadable(
            f"the DH-8 ended its answer with {last!r} instead of EOT; the profile was "
            "not taken, ask again"
        )


def _fetch(line: Line, options: ProfileOptions) -> Profile:
    if options.traverse is None:
        raise UsageError("a DH-8 does not state the length of its traverse; give it")
    return read_profile(
        line,
        name=options.name,
        traverse=options.traverse,
        filtered=options.filtered,
        signed=options.signed,
    )


INSTRUMENT = SerialInstrument(
    name="diavite",
    title="DH-8",
    baud=BAUD,
    read_profile=_fetch,
    needs_traverse=True,
)
