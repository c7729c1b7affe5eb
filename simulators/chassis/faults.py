# SPDX-License-Identifier: MIT
"""Faults of the simulated chassis, as a short script."""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.errors import UsageError


class FaultKind(StrEnum):
    """Kind of fault; the comment of each explains `at` and `value`."""

    OVERRUN = "overrun"
    """At a sample, `value` samples are overwritten before they are read."""
    ERROR = "error"
    """At a sample, one read ends with NI's error number -`value`."""
    DROP = "drop"
    """At a sample, the server is unreachable for `value` seconds."""
    SLOW = "slow"
    """From a sample on, every read takes `value` seconds longer."""
    OPEN = "open"
    """From a sample on, the IEPE loop of input number `value` is open."""
    CLOSE = "close"
    """From a sample on, the IEPE loop of input number `value` is closed again."""
    REFUSE = "refuse"
    """From the start, input number `value` does not exist."""
    TEDS_ERROR = "teds_error"
    """From the start, every TEDS is refused with NI's error number -`value`."""
    WRONG_TEDS = "wrong_teds"
    """From the start, input number `value` returns another sensor's TEDS."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault.

    Attributes:
        kind: of fault.
        at: sample at which it happens, counted over all streams of the chassis.
        value: parameter, see `FaultKind`.
    """

    kind: FaultKind
    at: int
    value: float


def parse_faults(text: str) -> tuple[Fault, ...]:
    """Read a script of faults, ``"drop@40000:0.5,open@90000:2"``.

    Args:
        text: faults joined by commas: kind, ``@`` sample, ``:`` value.

    Raises:
        UsageError: a fault has another form.
    """
    return tuple(_parse(word) for word in text.split(",") if word.strip())


def _parse(word: str) -> Fault:
    kind, _, rest = word.strip().partition("@")
    at, _, value = rest.partition(":")
    try:
        return Fault(FaultKind(kind), int(at), float(value))
    except ValueError:
        known = ", ".join(each.value for each in FaultKind)
        raise UsageError(
            f"fault {word.strip()!r} must read kind@sample:value, for example "
            f"drop@40000:0.5; kinds are {known}"
        ) from None
