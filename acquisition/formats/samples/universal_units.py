# SPDX-License-Identifier: MIT
"""Units of a universal file by its data set 164: factors that lead out of SI.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data set 164: a value of the file is divided by the factor to get SI.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.records.recordings import Quantity

_LENGTHS = ("m", "mm", "cm", "um", "in", "ft")
_FORCES = ("N", "mN", "kN", "lbf", "kgf")
_SECONDS = {
    Quantity.DISPLACEMENT: "",
    Quantity.VELOCITY: "/s",
    Quantity.ACCELERATION: "/s^2",
}
_AGREES = 1e-4
"""Relative difference of printed factors that is rounding."""


def length_factor(path: Path, units: Mapping[str, Any]) -> float:
    """Return the factor from a length of the file to metres; 1 without data set 164.

    Raises:
        FormatError: the factor of data set 164 is none.
    """
    if not units:
        return 1.0
    return 1.0 / _factor(path, units, "length")


def unit_of_system(
    path: Path, quantity: Quantity | None, units: Mapping[str, Any]
) -> str:
    """Return the unit that data set 164 gives a quantity; empty where it gives none.

    Args:
        path: of the file.
        quantity: of a channel, None where it is not stated.
        units: data set 164 as pyuff reads it; empty where the file has none.

    Raises:
        FormatError: its factors are none.
    """
    if not units or quantity is None:
        return ""
    if quantity is Quantity.FORCE:
        return _named_unit(_FORCES, "force", _factor(path, units, "force"))
    unit = _named_unit(_LENGTHS, "length", _factor(path, units, "length"))
    return unit + _SECONDS[quantity] if unit else ""


def _named_unit(known: tuple[str, ...], kind: str, factor: float) -> str:
    for unit in known:
        if math.isclose(factor * to_si(unit, kind), 1.0, rel_tol=_AGREES):
            return unit
    return ""


def _factor(path: Path, units: Mapping[str, Any], name: str) -> float:
    factor = float(units.get(name, math.nan))
    if not 0.0 < factor < math.inf:
        raise FormatError(
            f"{named(path)}: data set 164 has the {name} factor {factor:g}; factors "
            "are above zero: correct the file, or remove the data set"
        )
    return factor
