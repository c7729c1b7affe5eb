# SPDX-License-Identifier: MIT
"""Faults by a script, applied where the delivered samples reach them."""

from collections.abc import Callable

from jointbench.simulators.chassis.faults import Fault, FaultKind
from jointbench.simulators.chassis.protocol import Refusal
from jointbench.simulators.chassis.tasks.task import SimulatedTask


class ScriptedFaults:
    """State of a script.

    Attributes:
        delivered: samples per channel delivered over all streams.
        reached: sample up to which faults were applied.
        open: inputs whose loop is open.
        delay: of every read [s].
    """

    def __init__(
        self,
        faults: tuple[Fault, ...] = (),
        *,
        open_inputs: set[int] | None = None,
        drop: Callable[[float], None] | None = None,
    ) -> None:
        self.delivered = 0
        self.reached = -1
        self.open = set() if open_inputs is None else open_inputs
        self.delay = 0.0
        self._waiting = sorted(faults, key=lambda fault: fault.at)
        self._drop = drop

    def before_read(self, task: SimulatedTask, count: int) -> None:
        """Apply every fault up to the last sample of a read.

        Raises:
            Refusal: the script has an error there.
        """
        while self._waiting and self._waiting[0].at < self.delivered + count:
            fault = self._waiting.pop(0)
            self.reached = fault.at
            self._apply(fault, task)

    def _apply(self, fault: Fault, task: SimulatedTask) -> None:
        value, made = int(fault.value), task.acquisition
        if fault.kind is FaultKind.SLOW:
            self.delay = fault.value
        elif fault.kind is FaultKind.OPEN:
            self.open.add(value)
        elif fault.kind is FaultKind.CLOSE:
            self.open.discard(value)
        elif fault.kind is FaultKind.OVERRUN and made is not None:
            made.skip_to(made.position + made.course.buffer + value)
        elif fault.kind is FaultKind.ERROR:
            raise Refusal(-value, "An error by script.", read=0)
        elif fault.kind is FaultKind.DROP and self._drop is not None:
            self._drop(fault.value)
