# SPDX-License-Identifier: MIT
"""How a joint's parameter is written: its value, or all that is admissible."""

from jointbench.analysis.lumped.identified import JointParameter
from jointbench.station.screen.value_text import with_sd

WHAT_IS_SHOWN = "(± one standard deviation; where it is open, all that is admissible)"


def parameter_text(parameter: JointParameter) -> str:
    """Write a joint's parameter: value and sd, or the range that is admissible.

    What the measurement does not determine has no value and no standard deviation.
    """
    if parameter.identifiable:
        return with_sd(parameter.value, parameter.sd)
    return interval_text(parameter.interval)


def interval_text(interval: tuple[float | None, float | None]) -> str:
    """Write an interval of which either end may be open.

    >>> interval_text((2.2e8, None))
    'above 2.2e+08'
    >>> interval_text((None, None))
    'open'
    """
    low, high = interval
    if low is None:
        return "open" if high is None else f"below {high:.3g}"
    return f"above {low:.3g}" if high is None else f"{low:.3g} to {high:.3g}"
