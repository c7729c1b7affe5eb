# SPDX-License-Identifier: MIT
"""Mitutoyo SJ-210 and SJ-410 roughness testers.

A command is a header of two letters, a sub-field of three, data and CR; the answer is
``OK`` data CR, or ``NG`` code CR. 9600 to 57600 baud, 8 data bits.

Source:
    User's manuals 99MBB122A, ch. 17.12 (SJ-210), and 99MBB765A, ch. 22.14 (SJ-410).
    Their public parts do not list the sub-fields that start and stop a measurement:
    there is no function for it here, press the key on the instrument. Nor do they print
    what parts the heights of one file: both a separator and none are read.
"""

import re
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.errors import FormatError, InstrumentError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument
from jointbench.acquisition.serial_lines.line import Line, ask_again, plain_text
from jointbench.acquisition.serial_lines.line_faults import (
    LineBroken,
    ProfileBroken,
    Unreadable,
)
from jointbench.acquisition.serial_lines.serial_instrument import (
    ProfileOptions,
    SerialInstrument,
)

BAUD = 9600
_CR = b"\r"
_MOST = 65_536
_DIGITS = 9
_MOST_FILES = 50
_NUMBER = re.compile(r"\s*[0-9]{1,4}\s*")
_LENGTH = re.compile(r" *[0-9]+(\.[0-9]*)? *")
_HEIGHT = re.compile(r"(?=.{9}$) *[+-]?[0-9]+(\.[0-9]*)? *")


@dataclass(frozen=True, slots=True)
class EvaluationConditions:
    """How the instrument is set, by the codes of its manual.

    Attributes:
        standard: of roughness.
        profile: kind of profile.
        cutoff: code of the cut-off.
        sampling_lengths: how many.
        length: of evaluation [m].
        filter: code of the filter.
    """

    standard: str
    profile: str
    cutoff: str
    sampling_lengths: int
    length: float
    filter: str


def ask(line: Line, field: str, data: str = "") -> str:
    """Read a sub-field, ``"STU"``, ``"CON"``, ``"PAR"``, ``"RES"`` or ``"EVA"``.

    An answer that cannot be read is asked for again.

    Raises:
        InstrumentError: the instrument answers NG.
        FormatError: no answer is OK or NG.
        LineBroken: it does not come to its end.
    """
    return ask_again(line, lambda: _asked(line, field, data))


def _asked(line: Line, field: str, data: str = "") -> str:
    line.send(f"RD{field}{data}".encode("ascii") + _CR)
    answer = plain_text(line.receive_to(_CR, limit=_MOST)[:-1], "Mitutoyo")
    if answer.startswith("OK"):
        return answer[2:]
    if answer.startswith("NG"):
        raise InstrumentError(
            f"the Mitutoyo refuses {field!r} with code {answer[2:]!r}; its manual "
            "lists the codes"
        )
    raise Unreadable(
        f"the Mitutoyo answered {answer[:20]!r} where OK or NG is expected; check the "
        "baud rate"
    )


def read_conditions(line: Line) -> EvaluationConditions:
    """Read how the instrument is set.

    Raises:
        FormatError: no answer reads as the manual says.
    """
    return ask_again(line, lambda: _conditions(_asked(line, "CON")))


def _conditions(text: str) -> EvaluationConditions:
    count, length = text[3:5], text[5:10]
    right = len(text) > 11 and _NUMBER.fullmatch(count) and _LENGTH.fullmatch(length)
    if not right or not float(length) > 0:
        raise Unreadable(
            f"the Mitutoyo's conditions {text[:20]!r} do not read as its manual says"
        )
    return EvaluationConditions(
        standard=text[0],
        profile=text[1],
        cutoff=text[2],
        sampling_lengths=int(count),
        length=1e-3 * float(length),
        filter=text[11],
    )


def read_profile(line: Line, *, name: str) -> Profile:
    """Fetch the evaluated profile of an SJ-410, file by file.

    Args:
        line: of the instrument.
        name: of the profile.

    Returns:
        Heights over the evaluation length that its conditions state.

    Raises:
        FormatError: a file is missing, out of turn or no list of heights.
        ProfileBroken: it breaks off; the error keeps the heights that came.
        LineBroken: it breaks off before the first file.
    """
    length = read_conditions(line).length
    count = ask_again(line, lambda: _number_of_files(_asked(line, "EVA", "00")))
    heights: list[float] = []
    for number in range(1, count + 1):
        try:
            heights += _file(line, number)
        except LineBroken as error:
            # How many points a file holds shows in those before it alone.
            heights += _whole_heights(error.received)
            raise ProfileBroken(
                f"{error}; {len(heights)} points came, in file {number} of {count}",
                error.received,
                1e-6 * np.array(heights),
                None,
            ) from error
    if not heights:
        raise FormatError("the Mitutoyo sent a profile without points; measure first")
    return Profile(
        name=name,
        heights=1e-6 * np.array(heights),
        spacing=length / len(heights),
        valid=np.ones(len(heights), dtype=bool),
        instrument=SurfaceInstrument(name="Mitutoyo Surftest"),
        provenance=(step("mitutoyo", files=count, points=len(heights)),),
    )


def _file(line: Line, number: int) -> list[float]:
    """Return the heights of one file [um]."""

    def ask_once() -> list[float]:
        return parse_heights(_asked(line, "EVA", f"{number:02d}"), number)

    return ask_again(line, ask_once)


def parse_heights(text: str, number: int) -> list[float]:
    """Read the heights of one file [um].

    Args:
        text: ``NN;`` and heights of nine characters each, parted or not.
        number: of the file, as asked for.

    Raises:
        FormatError: it is another file, or no list of heights.
    """
    head, _, body = text.partition(";")
    words = [
        word[i : i + _DIGITS]
        for part in re.split(r"[,;\t\r\n]+", body)
        for word in ([part] if len(part) % _DIGITS == 0 else part.split())
        for i in range(0, len(word), _DIGITS)
    ]
    if not _NUMBER.fullmatch(head) or not all(map(_HEIGHT.fullmatch, words)):
        raise Unreadable(
            f"the Mitutoyo's profile file {number} begins {text[:20]!r}; heights of "
            "nine characters after its number are expected"
        )
    if int(head) != number:
        raise Unreadable(
            f"the Mitutoyo sent profile file {int(head)} where {number} was asked for; "
            "ask for the profile again"
        )
    return [float(word) for word in words]


def _whole_heights(received: bytes) -> list[float]:
    """Return the heights at the beginning of an answer that broke off [um]."""
    _, _, body = received.partition(b";")
    found: list[float] = []
    for part in re.findall(rb"[^,;\s]{9}", body):
        if not _HEIGHT.fullmatch(part.decode("latin-1")):
            break
        found.append(float(part))
    return found


def _number_of_files(text: str) -> int:
    digits = _NUMBER.fullmatch(text.rpartition(";")[2])
    count = int(digits[0]) if digits else -1
    if not 0 <= count <= _MOST_FILES:
        raise Unreadable(
            f"the Mitutoyo's number of profile files is {text!r}, 0 to {_MOST_FILES} "
            "are expected"
        )
    return count


def _fetch(line: Line, options: ProfileOptions) -> Profile:
    return read_profile(line, name=options.name)


INSTRUMENT = SerialInstrument(
    name="mitutoyo", title="Mitutoyo Surftest", baud=BAUD, read_profile=_fetch
)
