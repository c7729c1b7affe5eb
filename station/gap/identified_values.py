# SPDX-License-Identifier: MIT
"""One value of a result of ``jointbench identify``, for the contact bench."""

import math
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.station.files.json_file import read_json

_Z95 = 1.959964
_BOUND_SD = 0.05
"""sd of the logarithm of a value that is only known from below."""


class _Parameter(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)

    value: float
    sd: float | None = None
    interval_95: tuple[float | None, float | None] = (None, None)
    identifiable: bool = True


class _Identification(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)

    parameters: dict[str, _Parameter]


@dataclass(frozen=True, slots=True)
class IdentifiedValue:
    """A value with the sd of its logarithm, or a lower bound."""

    value: float
    sd: float
    bound: bool


def identified_value(path: Path, name: str) -> IdentifiedValue | None:
    """Return a parameter of an identification; None if it is not bounded from below.

    A parameter that is not identifiable but has a lower end of its interval is known
    from below. The sd of the logarithm follows from the interval where it has two ends.

    Args:
        path: JSON of ``jointbench identify --json``.
        name: of the parameter, ``"mount.stiffness"``.

    Raises:
        BadData: the file cannot be used, or has no such parameter.
    """
    result = read_json(path, _Identification)
    if name not in result.parameters:
        known = ", ".join(sorted(result.parameters))
        raise BadData(f"{named(path)} has no parameter {name!r}; it has {known}")
    one = result.parameters[name]
    low, high = one.interval_95
    if one.identifiable and one.value > 0:
        if low is not None and high is not None and 0 < low < high:
            return IdentifiedValue(
                one.value, math.log(high / low) / (2.0 * _Z95), bound=False
            )
        if one.sd is not None and one.sd > 0:
            return IdentifiedValue(one.value, one.sd / one.value, bound=False)
    if low is not None and low > 0:
        return IdentifiedValue(low, _BOUND_SD, bound=True)
    return None
