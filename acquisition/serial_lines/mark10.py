# SPDX-License-Identifier: MIT
"""Mark-10 torque testers and force gauges: ``?`` CR, answered by a number and its unit.

Source:
    Public protocol of Mark-10 gauges: 8N1, ``4.285 Nm`` CR LF, errors ``*10`` and the
    like. The sign follows the instrument's own display, clockwise or compression
    positive as it is set there.
"""

import re

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.basics.units import is_unit, to_si
from jointbench.acquisition.serial_lines.line import Line, ask_again, plain_text
from jointbench.acquisition.serial_lines.line_faults import Unreadable
from jointbench.acquisition.serial_lines.serial_instrument import (
    Reading,
    SerialInstrument,
)

BAUD = 115_200
_MOST = 64
_READING = re.compile(r"\s*([+-]?[0-9]{1,9}\.?[0-9]{0,9})\s*(\S.*?)\s*")


def read_gauge(line: Line) -> Reading:
    """Read what the gauge shows; an answer that cannot be read is asked for again.

    Raises:
        InstrumentError: the gauge answers with an error.
        FormatError: no answer is a number with a unit of torque or force.
        LineBroken: it does not come to its end.
    """
    return ask_again(line, lambda: _reading(line))


def _reading(line: Line) -> Reading:
    line.send(b"?\r")
    raw = plain_text(line.receive_to(b"\r\n", limit=_MOST)[:-2], "Mark-10")
    if raw.startswith("*"):
        raise InstrumentError(f"the Mark-10 answers error {raw!r}; see its manual")
    match = _READING.fullmatch(raw)
    if match is not None:
        for kind in ("torque", "force"):
            unit = match[2].replace("lbFin", "lbfin").replace("lbFft", "lbfft")
            if is_unit(unit, kind):
                return Reading(float(match[1]) * to_si(unit, kind), kind, raw)
    raise Unreadable(
        f"the Mark-10 answered {raw!r}; a number with a unit of torque or force is "
        "expected"
    )


INSTRUMENT = SerialInstrument(
    name="mark10", title="Mark-10", baud=BAUD, read_torque=read_gauge
)
