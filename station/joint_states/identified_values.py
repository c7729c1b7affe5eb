# SPDX-License-Identifier: MIT
"""Values of a result of ``jointbench identify``, for the contact bench."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator

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


class _Result(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)

    parameters: dict[str, _Parameter]
    log_covariance: tuple[tuple[float, ...], ...] | None = None

    @model_validator(mode="after")
    def _square(self) -> "_Result":
        if self.log_covariance is None:
            return self
        count = len(self.parameters)
        rows = np.array([len(row) for row in self.log_covariance])
        if rows.size != count or np.any(rows != count):
            raise ValueError(
                f"log_covariance must have {count} rows and columns, one for each "
                "parameter; write the JSON with `jointbench identify` again"
            )
        matrix = np.array(self.log_covariance)
        if not np.isfinite(matrix).all() or np.any(np.diag(matrix) <= 0):
            raise ValueError(
                "log_covariance must hold finite numbers, positive on its diagonal; "
                "write the JSON with `jointbench identify` again"
            )
        return self


@dataclass(frozen=True, slots=True)
class IdentifiedValue:
    """A value with the sd of its logarithm, or a lower bound."""

    value: float
    sd: float
    bound: bool


@dataclass(frozen=True, slots=True)
class IdentifiedParameters:
    """Parameters of one identification, whose errors are correlated.

    Attributes:
        path: of the file.
        result: its content.
    """

    path: Path
    result: _Result

    def value(self, name: str) -> IdentifiedValue | None:
        """Return a parameter; None if it is not bounded from below.

        A parameter that is not identifiable but has a lower end of its interval is
        known from below. The sd of the logarithm follows from the interval where it
        has two ends.

        Args:
            name: of the parameter, ``"mount.stiffness"``.

        Raises:
            BadData: the file has no such parameter.
        """
        if name not in self.result.parameters:
            known = ", ".join(sorted(self.result.parameters))
            raise BadData(
                f"{named(self.path)} has no parameter {name!r}; it has {known}"
            )
        one = self.result.parameters[name]
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

    def correlation(self, one: str, other: str) -> float:
        """Return the correlation of the logarithms of two parameters.

        Zero where the file states no covariance.

        Args:
            one: name of a parameter.
            other: name of another one.
        """
        if self.result.log_covariance is None:
            return 0.0
        order = list(self.result.parameters)
        i, j = order.index(one), order.index(other)
        matrix = self.result.log_covariance
        root = math.sqrt(matrix[i][i] * matrix[j][j])
        return min(max(0.5 * (matrix[i][j] + matrix[j][i]) / root, -1.0), 1.0)


def read_identified(path: Path) -> IdentifiedParameters:
    """Read the parameters of an identification with their covariance.

    Args:
        path: JSON of ``jointbench identify --json``.

    Raises:
        BadData: the file cannot be used.
    """
    return IdentifiedParameters(path, read_json(path, _Result))
