# SPDX-License-Identifier: MIT
"""NI's calls that configure start and reference triggers.

As in the driver, each is a short way to set properties; the hardware is asked when the
task is verified.
"""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

from typing import Any

from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.protocol import Daqmx, constants, number_of

_KIND = constants.TriggerType


class TriggerCalls(Calls):
    """Edges of digital lines, edges and windows of channels."""

    @answered
    def CfgDigEdgeStartTrig(self, request: Any, context: Any) -> Any:
        """Start a task by a digital line."""
        self._trigger(request, "START_TRIG", "DIG_EDGE", _digital(request))
        return Daqmx.CfgDigEdgeStartTrigResponse()

    @answered
    def CfgDigEdgeRefTrig(self, request: Any, context: Any) -> Any:
        """End a finite task some samples after an edge of a digital line."""
        self._trigger(request, "REF_TRIG", "DIG_EDGE", _digital(request))
        return Daqmx.CfgDigEdgeRefTrigResponse()

    @answered
    def CfgAnlgEdgeStartTrig(self, request: Any, context: Any) -> Any:
        """Start a task by an edge of a channel."""
        self._trigger(request, "START_TRIG", "ANLG_EDGE", _edge(request))
        return Daqmx.CfgAnlgEdgeStartTrigResponse()

    @answered
    def CfgAnlgEdgeRefTrig(self, request: Any, context: Any) -> Any:
        """End a finite task some samples after an edge of a channel."""
        self._trigger(request, "REF_TRIG", "ANLG_EDGE", _edge(request))
        return Daqmx.CfgAnlgEdgeRefTrigResponse()

    @answered
    def CfgAnlgWindowStartTrig(self, request: Any, context: Any) -> Any:
        """Start a task when a channel enters or leaves a window."""
        self._trigger(request, "START_TRIG", "ANLG_WIN", _window(request))
        return Daqmx.CfgAnlgWindowStartTrigResponse()

    @answered
    def CfgAnlgWindowRefTrig(self, request: Any, context: Any) -> Any:
        """End a finite task after a channel entered or left a window."""
        self._trigger(request, "REF_TRIG", "ANLG_WIN", _window(request))
        return Daqmx.CfgAnlgWindowRefTrigResponse()

    @answered
    def DisableStartTrig(self, request: Any, context: Any) -> Any:
        """Start at once."""
        self._set(request, {"START_TRIG_TYPE": _KIND.NONE.value})
        return Daqmx.DisableStartTrigResponse()

    @answered
    def DisableRefTrig(self, request: Any, context: Any) -> Any:
        """End after the samples of the block."""
        self._set(request, {"REF_TRIG_TYPE": _KIND.NONE.value})
        return Daqmx.DisableRefTrigResponse()

    def _trigger(
        self, request: Any, which: str, kind: str, stated: dict[str, Value]
    ) -> None:
        kinds = {
            "DIG_EDGE": _KIND.DIGITAL_EDGE,
            "ANLG_EDGE": _KIND.ANALOG_EDGE,
            "ANLG_WIN": _KIND.ANALOG_WINDOW,
        }
        values: dict[str, Value] = {f"{which}_TYPE": kinds[kind].value}
        values[f"{kind}_{which}_SRC"] = request.trigger_source
        values |= {f"{kind}_{which}_{name}": value for name, value in stated.items()}
        if which == "REF_TRIG":
            values["REF_TRIG_PRETRIG_SAMPLES"] = request.pretrigger_samples
        self._set(request, values)

    def _set(self, request: Any, values: dict[str, Value]) -> None:
        task = self.task(request)
        with task.guard:
            task.change()
            for name, value in values.items():
                task.triggers.set(name, value)


def _digital(request: Any) -> dict[str, Value]:
    return {"EDGE": number_of(request, "trigger_edge")}


def _edge(request: Any) -> dict[str, Value]:
    return {
        "SLOPE": number_of(request, "trigger_slope"),
        "LVL": request.trigger_level,
    }


def _window(request: Any) -> dict[str, Value]:
    return {
        "WHEN": number_of(request, "trigger_when"),
        "TOP": request.window_top,
        "BTM": request.window_bottom,
    }
