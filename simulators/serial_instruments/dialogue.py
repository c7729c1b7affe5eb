# SPDX-License-Identifier: MIT
"""What the serial instruments answer, byte for byte; no line is needed to ask them."""

import struct
from dataclasses import dataclass

from jointbench.acquisition.serial_lines.serial_instrument import Answer

_ESC, _ETX, _EOT, _ACK, _CR = b"\x1b", b"\x03", b"\x04", b"\x06", b"\r"
_PARAMETER = (b"P", b"Q")
# Share of its torque that a bolt has while the wrench turns, clicks and is let go.
_WRENCH = (0.0, 0.18, 0.55, 0.83, 1.0, 0.97, 0.31, 0.02)


@dataclass(frozen=True, slots=True)
class DiaviteSimulator:
    """A DH-8 that has measured.

    Attributes:
        counts: heights of the profile [counts].
        gain: as its profile states it.
    """

    counts: tuple[int, ...]
    gain: int = 1

    def answer(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer one request: ESC, command, parameter, ETX."""
        if len(received) < 3:
            return None
        takes_parameter = received[1:2] in _PARAMETER or received[1:2] == b"U"
        size = 4 if takes_parameter else 3
        if len(received) < size:
            return None
        if received[:1] != _ESC or received[size - 1 : size] != _ETX:
            return len(received), b"\x15"
        return size, _ACK + self._payload(received[1:2]) + _EOT

    def _payload(self, command: bytes) -> bytes:
        texts = {
            b"0": b"DH-8",
            b"1": b"V1.07",
            b"2": b"um",
            b"@": b"Ra,Rz,Rt\r\n0.412,2.871,3.406\r\n",
        }
        if command in b"<+":
            head = struct.pack("<HH", self.gain, len(self.counts))
            return head + struct.pack(f"<{len(self.counts)}h", *self.counts)
        return texts.get(command, b"")


@dataclass(frozen=True, slots=True)
class MitutoyoSimulator:
    """An SJ-410 that has measured.

    Attributes:
        heights: of the profile [um].
        per_file: heights in a file.
        length: of evaluation [mm].
    """

    heights: tuple[float, ...]
    per_file: int = 100
    length: float = 4.0

    def answer(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer one request: header, sub-field, data, CR."""
        request, end, _ = received.partition(_CR)
        if not end:
            return None
        return len(request) + 1, self._reply(request.decode("ascii")) + _CR

    def _reply(self, request: str) -> bytes:
        files = -(-len(self.heights) // self.per_file)
        if request == "RDCON":
            return f"OK1P205{self.length:05.2f}.G".encode()
        if request == "RDEVA00":
            return f"OK00;{files:02d}".encode()
        if request.startswith("RDEVA") and 1 <= int(request[5:]) <= files:
            number = int(request[5:])
            part = self.heights[(number - 1) * self.per_file : number * self.per_file]
            return f"OK{number:02d};{''.join(f'{z:+09.3f}' for z in part)}".encode()
        return b"NG01"


@dataclass(frozen=True, slots=True)
class Mark10Simulator:
    """A gauge that shows a reading.

    Attributes:
        shown: on its display.
    """

    shown: str = "4.285 Nm"

    def answer(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer ``?`` with the reading, anything else with an error."""
        request, end, _ = received.partition(_CR)
        if not end:
            return None
        reply = self.shown if request == b"?" else "*10"
        return len(request) + 1, f"{reply}\r\n".encode()


@dataclass(slots=True)
class WrenchSimulator:
    """A Mark-10 torque tester on a wrench that tightens bolt after bolt.

    Attributes:
        torques: targets, in their order [N m].
        bolts: of each target.
        error: torque of a bolt over its target less one, in turn [-].
    """

    torques: tuple[float, ...]
    bolts: int = 4
    error: tuple[float, ...] = (0.0,)
    _asked: int = 0

    def answer(self, received: bytes) -> tuple[int, bytes] | None:
        """Answer ``?`` with the reading of the moment, which the next one follows."""
        request, end, _ = received.partition(_CR)
        if not end:
            return None
        shown = f"{self._shown():.3f} Nm" if request == b"?" else "*10"
        return len(request) + 1, f"{shown}\r\n".encode()

    def _shown(self) -> float:
        """Return the reading of the moment [N m]; the wrench stays at the last one."""
        bolt, at = divmod(self._asked, len(_WRENCH))
        self._asked += 1
        target = self.torques[min(bolt // self.bolts, len(self.torques) - 1)]
        return target * (1 + self.error[bolt % len(self.error)]) * _WRENCH[at]


def answer_all(answer: Answer, received: bytes) -> tuple[bytes, bytes]:
    """Answer every whole request in what was received.

    Returns:
        What is sent back, and what is left of the bytes received.
    """
    sent = bytearray()
    while received and (reply := answer(received)) is not None:
        used, back = reply
        sent += back
        received = received[used:]
    return bytes(sent), received


def wave_counts(points: int, amplitude: int = 900) -> tuple[int, ...]:
    """Return a made-up profile [counts]: two waves, so that all bytes occur."""
    return tuple(
        (amplitude * ((i * 37) % 101 - 50)) // 50 + (i % 13) - 6 for i in range(points)
    )
