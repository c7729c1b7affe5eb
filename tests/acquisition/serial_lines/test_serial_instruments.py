"""Serial instruments as dialogues: every byte sent and received, nothing left over."""

from collections.abc import Callable

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import FormatError, InstrumentError
from jointbench.acquisition.serial_lines import diavite, mark10, mitutoyo
from jointbench.acquisition.serial_lines.line import Line, SerialLine
from jointbench.acquisition.serial_lines.line_faults import LineBroken
from jointbench.simulators.twins.dialogue import (
    DiaviteTwin,
    Mark10Twin,
    MitutoyoTwin,
    wave_counts,
)
from jointbench.simulators.twins.twin import Twin


class Dialogue:
    """A line that knows what will be sent and what comes back."""

    def __init__(self, *turns: tuple[bytes, bytes]) -> None:
        self._turns = list(turns)
        self._waiting = b""

    def send(self, data: bytes) -> None:
        """Check what is sent, and let its answer wait."""
        assert not self._waiting, f"unread: {self._waiting!r}"
        expected, self._waiting = self._turns.pop(0)
        assert data == expected

    def receive(self, count: int) -> bytes:
        """Return what waits."""
        if len(self._waiting) < count:
            raise LineBroken("silent", self._waiting)
        taken, self._waiting = self._waiting[:count], self._waiting[count:]
        return taken

    def receive_to(self, end: bytes, *, limit: int) -> bytes:
        """Return what waits up to an end."""
        where = self._waiting.find(end)
        if where < 0 or where >= limit:
            raise LineBroken("silent", self._waiting)
        return self.receive(where + len(end))

    def settle(self) -> None:
        """Drop what waits."""
        self._waiting = b""

    def require_over(self) -> None:
        """Fail where a turn or a byte is left over."""
        assert not self._turns
        assert not self._waiting


def test_the_dh8_is_asked_for_its_name_between_escape_and_etx() -> None:
    """One request, one answer between ACK and EOT."""
    line = Dialogue((b"\x1b0\x03", b"\x06DH-8\x04"))
    assert diavite.ask_text(line, "name") == "DH-8"
    line.require_over()


def test_the_dh8_takes_traverse_and_cutoff_as_raw_bytes() -> None:
    """Index 2 is 4.8 mm; index 3 is 0.8 mm; 3 is also the code of ETX."""
    line = Dialogue((b"\x1bP\x02\x03", b"\x06\x04"), (b"\x1bQ\x03\x03", b"\x06\x04"))
    diavite.set_traverse(line, 2)
    diavite.set_cutoff(line, 3)
    line.require_over()


def test_a_dh8_profile_is_framed_by_its_count_though_eot_and_ack_occur_in_it() -> None:
    """Heights 4, 6 and -252 counts hold the codes of EOT and ACK; z = n / 128 um."""
    body = b"\x04\x00\x06\x00\x04\xff"
    line = Dialogue(
        (b"\x1bU0\x03", b"\x06\x04"),
        (b"\x1b<\x03", b"\x06\x01\x00\x03\x00" + body + b"\x04"),
    )
    profile = diavite.read_profile(line, name="face", traverse=4.8e-3)
    np.testing.assert_allclose(profile.heights, np.array([4, 6, -252]) / 128e6)
    assert profile.spacing == pytest.approx(1.6e-3)
    line.require_over()


def test_whether_dh8_heights_are_signed_is_an_option() -> None:
    """The same two bytes are -1 or 65535 counts."""
    turns = (
        (b"\x1bU0\x03", b"\x06\x04"),
        (b"\x1b+\x03", b"\x06\x01\x00\x01\x00\xff\xff\x04"),
    )
    line = Dialogue(*turns)
    profile = diavite.read_profile(
        line, name="f", traverse=1.5e-3, filtered=True, signed=False
    )
    assert profile.heights[0] == pytest.approx(65535 / 128e6)
    line.require_over()


def test_a_dh8_that_does_not_acknowledge_is_refused() -> None:
    """NAK in the place of ACK is an error, not a profile."""
    with pytest.raises(FormatError, match="ACK is expected"):
        diavite.ask_text(Dialogue((b"\x1b1\x03", b"\x15")), "version")


def test_mitutoyo_conditions_are_read_by_their_places() -> None:
    """Standard 1, profile P, cut-off 2, five sampling lengths, 4.00 mm, filter G."""
    line = Dialogue((b"RDCON\r", b"OK1P20504.00.G\r"))
    found = mitutoyo.read_conditions(line)
    assert found == mitutoyo.EvaluationConditions(
        "1", "P", "2", 5, pytest.approx(4e-3), "G"
    )
    line.require_over()


def test_a_mitutoyo_profile_is_joined_from_its_files() -> None:
    """Two files of two and one heights, over 4 mm."""
    line = Dialogue(
        (b"RDCON\r", b"OK1P20504.00.G\r"),
        (b"RDEVA00\r", b"OK00;02\r"),
        (b"RDEVA01\r", b"OK01;+0001.500-0000.250\r"),
        (b"RDEVA02\r", b"OK02;+0000.125\r"),
    )
    profile = mitutoyo.read_profile(line, name="face")
    np.testing.assert_allclose(profile.heights, [1.5e-6, -0.25e-6, 0.125e-6])
    assert profile.spacing == pytest.approx(4e-3 / 3)
    line.require_over()


def test_a_mitutoyo_that_refuses_says_its_code() -> None:
    """NG and a code become one error line."""
    with pytest.raises(InstrumentError, match="code '05'"):
        mitutoyo.ask(Dialogue((b"RDSTU\r", b"NG05\r")), "STU")


@pytest.mark.parametrize(
    ("shown", "value", "kind"),
    [
        (b"4.285 Nm", 4.285, "torque"),
        (b"-12.5 kN", -12_500.0, "force"),
        (b"10 lbFin", 1.1298482902761668, "torque"),
    ],
)
def test_a_mark10_reading_is_si_with_its_kind(
    shown: bytes, value: float, kind: str
) -> None:
    """The unit distinguishes torque from force."""
    line = Dialogue((b"?\r", shown + b"\r\n"))
    reading = mark10.read_gauge(line)
    assert (reading.value, reading.kind) == (pytest.approx(value), kind)
    line.require_over()


def test_a_mark10_error_is_an_instrument_error() -> None:
    """``*10`` is no reading."""
    with pytest.raises(InstrumentError, match="error"):
        mark10.read_gauge(Dialogue((b"?\r", b"*10\r\n")))


@pytest.mark.parametrize("over_socket", [False, True])
def test_the_simulated_dh8_delivers_9600_points_exactly(over_socket: bool) -> None:
    """Through pyserial, on a pseudo-terminal and on a socket, nothing left over."""
    counts = wave_counts(9600)
    with Twin(DiaviteTwin(counts).answer, over_socket=over_socket) as device:
        line = SerialLine(device.name, baud=diavite.BAUD)
        profile = diavite.read_profile(line, name="face", traverse=4.8e-3)
        assert line.waiting() == 0
        line.close()
    np.testing.assert_array_equal(np.round(profile.heights * 128e6), counts)


def _read_dh8(line: Line) -> object:
    return diavite.read_profile(line, name="f", traverse=4.8e-3)


def _read_mitutoyo(line: Line) -> object:
    return mitutoyo.read_profile(line, name="f")


@pytest.mark.parametrize(
    ("answer", "read", "after"),
    [
        (DiaviteTwin(wave_counts(500)).answer, _read_dh8, 300),
        (MitutoyoTwin((1.0, 2.0, 3.0)).answer, _read_mitutoyo, 27),
    ],
)
def test_a_disconnection_keeps_the_received_part(
    answer: Callable[[bytes], tuple[int, bytes] | None],
    read: Callable[[Line], object],
    after: int,
) -> None:
    """The error is one line, and holds the bytes of the answer that broke off."""
    with Twin(answer, over_socket=True, unplug_after=after) as device:
        line = SerialLine(device.name, baud=9600, timeout=1.0)
        with pytest.raises(LineBroken) as broken:
            read(line)
        line.close()
    assert broken.value.received
    assert "\n" not in str(broken.value)


def test_the_simulated_mark10_answers_through_pyserial() -> None:
    """A torque tester on a pseudo-terminal."""
    with Twin(Mark10Twin("20.02 Nm").answer) as device:
        line = SerialLine(device.name, baud=mark10.BAUD)
        assert mark10.read_gauge(line).value == pytest.approx(20.02)
        line.close()
