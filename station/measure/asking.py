# SPDX-License-Identifier: MIT
"""Asking for a hit, asking again, and when to stop asking."""

from dataclasses import dataclass

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.station.measure.bench_parts import BenchParts
from jointbench.station.measure.route import Route
from jointbench.station.measure.trigger import TriggerWatch

ASK_AGAIN = 4.0  # [s] beyond one block without a hit, the operator is asked again


@dataclass(slots=True)
class Asker:
    """Asks for one hit after another.

    Attributes:
        bench: whose operator strikes, and whose desk shows the request.
        route: knows where to strike.
        trigger: knows how long a hit takes.
    """

    bench: BenchParts
    route: Route
    trigger: TriggerWatch
    _silent: int = 0
    _asked: int = 0

    def ask(self) -> None:
        """Ask for one hit under the present condition."""
        self._silent = self._asked = 0
        condition, done = self.route.condition, self.route.done
        self.bench.desk.ask(condition, done, self.route.planned)
        self.bench.operator.ask(condition)

    def wait(self, count: int) -> None:
        """Take note of samples without a hit; ask again when they are many.

        Raises:
            InstrumentError: no hit for longer than the plan waits.
        """
        rate, wait = self.bench.recorder.sample_rate, self.bench.plan.hits.wait
        self._silent += count
        if self._silent > wait * rate:
            raise InstrumentError(
                f"no hit for {wait:g} s at {self.route.condition.name!r}; what was "
                "recorded is safe: lower 'trigger', or check the hammer"
            )
        if self._silent - self._asked > ASK_AGAIN * rate + self.trigger.after:
            self._asked = self._silent
            self.bench.operator.ask(self.route.condition)
