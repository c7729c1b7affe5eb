# SPDX-License-Identifier: MIT
"""Who strikes and tightens: a person, or a simulated operator."""

from typing import Protocol

from jointbench.station.measure.plan import Condition


class Operator(Protocol):
    """The operator: a person who reads the screen, or a simulated one."""

    def ask(self, condition: Condition) -> None:
        """Request one hit; a person needs only the screen."""
        ...


class BenchOperator:
    """A person."""

    def ask(self, condition: Condition) -> None:
        """Do nothing: the screen says it."""
