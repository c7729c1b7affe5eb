# SPDX-License-Identifier: MIT
"""Text of a joint parameter: its value, or its admissible range."""

from collections.abc import Iterable

from rich.console import RenderableType

from jointbench.analysis.lumped.identified import JointParameter
from jointbench.station.screen.terminal import table
from jointbench.station.screen.value_text import with_sd

VALUE_LEGEND = "(± one standard deviation; admissible range if not identifiable)"


def parameter_table(title: str, parameters: Iterable[JointParameter]) -> RenderableType:
    """Return the table of identified parameters, with the legend of their values."""
    rows = [
        (one.name, parameter_text(one), one.unit, "yes" if one.identifiable else "no")
        for one in parameters
    ]
    columns = ("parameter", "value", "unit", "identifiable")
    return table(f"{title} {VALUE_LEGEND}", columns, rows)


def parameter_text(parameter: JointParameter) -> str:
    """Write a joint parameter: value and sd, or the admissible range.

    A parameter that is not identifiable has no value and no standard deviation.
    """
    if parameter.identifiable:
        return with_sd(parameter.value, parameter.sd)
    return interval_text(parameter.interval)


def interval_text(interval: tuple[float | None, float | None]) -> str:
    """Write an interval; either end may be open.

    >>> interval_text((2.2e8, None))
    'above 2.2e+08'
    >>> interval_text((None, None))
    'open'
    """
    low, high = interval
    if low is None:
        return "open" if high is None else f"below {high:.3g}"
    return f"above {low:.3g}" if high is None else f"{low:.3g} to {high:.3g}"
