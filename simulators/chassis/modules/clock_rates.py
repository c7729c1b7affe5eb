# SPDX-License-Identifier: MIT
"""Sample rates that a module offers, and the one it takes for a request."""

import math
from dataclasses import dataclass

_ROUNDING = 1e-9  # relative, of a quotient of two clocks


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockRates:
    """Rule of the sample rates of a module.

    Attributes:
        rule: ``divided`` for a delta-sigma converter, `clock` over `factor`, a
            decimation and a divider; ``timebase`` for `clock` over any integer;
            ``any`` for a synthesised clock.
        slowest: rate offered [Hz].
        fastest: rate offered [Hz].
        clock: master clock [Hz].
        factor: fixed divider.
        decimations: of the converter.
        dividers: of the clock, from 1 to this.
    """

    rule: str
    slowest: float
    fastest: float
    clock: float = 0.0
    factor: int = 1
    decimations: tuple[int, ...] = (1,)
    dividers: int = 1

    def offered(self) -> tuple[float, ...]:
        """Return the rates of a ``divided`` clock [Hz], ascending."""
        products = {
            a * b for a in self.decimations for b in range(1, self.dividers + 1)
        }
        rates = sorted(self.clock / (self.factor * product) for product in products)
        top = self.fastest * (1 + _ROUNDING)
        return tuple(rate for rate in rates if self.slowest <= rate <= top)

    def taken(self, asked: float) -> float:
        """Return the actual rate for a request within the limits [Hz].

        A converter with a divided clock takes the next rate that is not below the
        request, also for a request below its slowest one.

        Source:
            NI-DAQmx help, Sample Clock Rate of DSA devices.
        """
        if self.rule == "divided":
            enough = (
                rate for rate in self.offered() if rate >= asked * (1 - _ROUNDING)
            )
            return next(enough, self.fastest)
        if self.rule == "timebase":
            return self.clock / max(1, math.floor(self.clock / asked + 0.5))
        return max(asked, self.slowest)


def divided_by_integers(fastest: float, dividers: int = 31) -> ClockRates:
    """Return the rates of an external clock: the fastest one over integers."""
    return ClockRates(
        rule="divided",
        slowest=fastest / dividers * (1 - _ROUNDING),
        fastest=fastest,
        clock=fastest,
        dividers=dividers,
    )
