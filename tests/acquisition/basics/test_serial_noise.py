"""Noise on a serial line: what cannot be read is asked for again, and ends nothing."""

from collections.abc import Callable

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.serial_lines import diavite, mark10, mitutoyo
from jointbench.acquisition.serial_lines.line import TRIES, SerialLine, plain_text
from jointbench.acquisition.serial_lines.line_faults import (
    LineBroken,
    LineSilent,
    ProfileBroken,
    Unreadable,
)
from jointbench.simulators.serial_instruments.dialogue import (
    Answer,
    DiaviteSimulator,
    Mark10Simulator,
    MitutoyoSimulator,
    wave_counts,
)
from jointbench.simulators.serial_instruments.serial_simulator import SerialSimulator

JUNK = (b"\x81", b"\x8d", b"\x8f", b"\x90", b"\x9d", b"\x00", b"\x7f")
"""The bytes that stand for nothing in Windows-1252, and control characters."""
Noise = Callable[[bytes], bytes]


class Noisy:
    """An instrument whose answers of some turns arrive otherwise than sent."""

    def __init__(self, answer: Answer, noise: dict[int, Noise]) -> None:
        self._answer, self._noise, self.turn = answer, noise, 0

    def __call__(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer, changed where it is its turn."""
        reply = self._answer(received)
        if reply is None:
            return None
        turn, self.turn = self.turn, self.turn + 1
        used, sent = reply
        return used, self._noise.get(turn, bytes)(sent)


def put(junk: bytes, at: int) -> Noise:
    """Return noise that puts bytes into an answer."""
    return lambda sent: sent[:at] + junk + sent[at:]


def without(at: int) -> Noise:
    """Return noise that swallows a byte of an answer."""
    return lambda sent: sent[:at] + sent[at + 1 :]


def instead(answer: bytes) -> Noise:
    """Return noise that makes another answer of it."""
    return lambda sent: answer


def gauge(noise: dict[int, Noise]) -> tuple[mark10.Reading, int]:
    """Return a reading of 4.285 N m through noise, and how often it was asked."""
    noisy = Noisy(Mark10Simulator().answer, noise)
    with SerialSimulator(noisy, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        try:
            return mark10.read_gauge(line), noisy.turn
        finally:
            line.close()


def dh8(noise: dict[int, Noise], points: int = 50) -> np.ndarray:
    """Return the counts of a DH-8's profile through noise."""
    noisy = Noisy(DiaviteSimulator(wave_counts(points)).answer, noise)
    with SerialSimulator(noisy, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        try:
            profile = diavite.read_profile(line, name="f", traverse=4.8e-3)
        finally:
            line.close()
    return np.round(profile.heights * 128e6)


def surftest(noise: dict[int, Noise]) -> np.ndarray:
    """Return three heights [um] of a Surftest, two a file, through noise."""
    noisy = Noisy(MitutoyoSimulator((1.5, -0.25, 0.125), per_file=2).answer, noise)
    with SerialSimulator(noisy, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        try:
            profile = mitutoyo.read_profile(line, name="f")
        finally:
            line.close()
    assert profile.spacing == pytest.approx(4e-3 / 3)
    return 1e6 * profile.heights


@pytest.mark.parametrize("junk", JUNK)
@pytest.mark.parametrize("at", [0, 3, 8])
def test_a_torque_with_a_junk_byte_is_asked_for_again(junk: bytes, at: int) -> None:
    """In front of the number, in it, and in front of the line's end."""
    reading, asked = gauge({0: put(junk, at)})
    assert (reading.value, asked) == (pytest.approx(4.285), 2)


@pytest.mark.parametrize(
    "answer",
    [
        b"\r\n",
        b"4.285\r\n",
        b"4.2\r\n85 Nm\r\n",
        b"nan Nm\r\n",
        b"inf Nm\r\n",
        b"4..285 Nm\r\n",
        b"9" * 40 + b" Nm\r\n",
        b"4.285 Nm",
        b"4.2",
        b"",
        b"?" * 100,
    ],
)
def test_a_torque_that_is_none_is_asked_for_again(answer: bytes) -> None:
    """Empty, without unit, in two parts, no number, endless, cut short, not at all."""
    reading, asked = gauge({0: instead(answer)})
    assert (reading.value, asked) == (pytest.approx(4.285), 2)


def test_a_gauge_that_never_makes_sense_is_one_line_after_three_tries() -> None:
    """What came is in it, escaped."""
    noise = dict.fromkeys(range(TRIES), put(b"\x81", 2))
    with pytest.raises(FormatError, match="x81") as error:
        gauge(noise)
    assert "\n" not in str(error.value)


def test_what_came_before_the_request_answers_nothing() -> None:
    """A tester that repeats itself, with noise at the end, is not a reading late."""
    shown = iter(("1.000", "2.000", "3.000"))

    def answer(received: bytes) -> tuple[int, bytes]:
        return len(received), f"{next(shown)} Nm\r\n0.500 Nm\r\n\x81".encode("latin-1")

    with SerialSimulator(answer, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        found = []
        for _ in range(3):
            found.append(mark10.read_gauge(line).value)
            line.settle()
        line.close()
    assert found == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
@pytest.mark.parametrize("junk", JUNK)
def test_a_surftest_with_a_junk_byte_is_asked_again(junk: bytes, turn: int) -> None:
    """In its conditions, its number of files, and either file."""
    np.testing.assert_allclose(surftest({turn: put(junk, 5)}), [1.5, -0.25, 0.125])


@pytest.mark.parametrize(
    ("turn", "noise"),
    [
        (0, instead(b"OK1P205nan  .G\r")),
        (0, instead(b"OK1P2_504.00.G\r")),
        (0, instead(b"OK1P20500.00.G\r")),
        (0, instead(b"OK1P\r")),
        (1, instead(b"OK00;\r")),
        (1, instead(b"OK00;9999\r")),
        (2, without(8)),
        (2, without(13)),
        (2, instead(b"OK02;+0000.125\r")),
        (2, instead(b"OK01;     nan+0000.125\r")),
        (2, instead(b"OK01;+0001.500-0000")),
        (3, instead(b"OK02;+0000.12\r")),
        (3, instead(b"\r")),
        (3, instead(b"")),
    ],
)
def test_a_surftest_that_sends_nonsense_is_asked_again(turn: int, noise: Noise) -> None:
    """Lengths and heights that are none, files out of turn, lost characters."""
    np.testing.assert_allclose(surftest({turn: noise}), [1.5, -0.25, 0.125])


def test_heights_padded_by_blanks_are_read() -> None:
    """Nine characters each, whatever fills them."""
    heights = mitutoyo.parse_heights("01;    1.500   -0.250", 1)
    assert heights == [1.5, -0.25]


@pytest.mark.parametrize(
    ("turn", "noise"),
    [
        (0, put(b"\x81", 0)),
        (0, put(b"\x81", 1)),
        (0, instead(b"")),
        (1, put(b"\x81", 0)),
        (1, put(b"\x81", 5)),
        (1, put(b"\x81", 40)),
        (1, without(3)),
        (1, without(40)),
        (1, without(105)),
        (1, instead(b"\x06\x01")),
    ],
)
def test_a_dh8_profile_that_is_garbled_is_fetched_again(
    turn: int, noise: Noise
) -> None:
    """A byte too many or too few, in head, heights and end; all counts are right."""
    np.testing.assert_array_equal(dh8({turn: noise}), wave_counts(50))


@pytest.mark.parametrize("junk", JUNK[:5])
def test_a_text_of_the_dh8_with_a_junk_byte_is_asked_for_again(junk: bytes) -> None:
    """Its unit, with a byte that is no character."""
    noisy = Noisy(DiaviteSimulator((1,)).answer, {0: put(junk, 2)})
    with SerialSimulator(noisy, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        assert diavite.ask_text(line, "unit") == "um"
        line.close()


def test_a_measurement_is_started_once_whatever_the_answer() -> None:
    """A second start would trace again."""
    noisy = Noisy(DiaviteSimulator((1,)).answer, {0: put(b"\x81", 1)})
    with SerialSimulator(noisy, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.6)
        with pytest.raises(Unreadable):
            diavite.ask_text(line, "start")
        line.close()
    assert noisy.turn == 1


def test_a_profile_that_breaks_off_keeps_the_longest_of_its_answers() -> None:
    """Forty bytes of heights came at first, nothing at all later."""
    noise = {1: lambda sent: sent[:45], 2: bytes, 3: instead(b"\x06")}
    noise |= dict.fromkeys(range(4, 9), instead(b""))
    with pytest.raises(ProfileBroken) as broken:
        dh8(noise)
    np.testing.assert_array_equal(
        np.round(broken.value.heights * 128e6), wave_counts(50)[:20]
    )


def test_a_silent_line_is_distinguished_from_one_that_was_unplugged() -> None:
    """The one may answer when it is asked again."""
    with SerialSimulator(lambda received: None, over_socket=True) as device:
        line = SerialLine(device.name, baud=9600, timeout=0.1)
        with pytest.raises(LineSilent):
            mark10.read_gauge(line)
        line_name = device.name
    with pytest.raises(LineBroken) as broken:
        line.receive(1)
    line.close()
    assert line_name in str(broken.value)
    assert not isinstance(broken.value, LineSilent)


def test_text_keeps_what_stands_for_characters() -> None:
    """Micro sign and line ends; an empty answer is an empty text."""
    assert plain_text(b"\xb5m\r\n", "DH-8") == "\u00b5m\r\n"
    assert not plain_text(b"", "DH-8")
