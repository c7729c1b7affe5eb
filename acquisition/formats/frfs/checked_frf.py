# SPDX-License-Identifier: MIT
"""One FRF of a foreign file, checked: whole, finite, ascending, in SI units."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    SamplingError,
    UnitError,
)
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.formats.frfs.frf_columns import FrfColumn
from jointbench.acquisition.formats.frfs.frf_units import is_frf_unit, parse_frf_unit
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.acquisition.records.provenance import Provenance, step
from jointbench.acquisition.records.recordings import Quantity

MOST_FUNCTIONS = 10_000
MOST_VALUES = 50_000_000
_LARGEST_VALUE = 1e30
Noise = dict[str, FloatArray | None]


@dataclass(frozen=True, slots=True, eq=False)
class RawFrf:
    """One FRF as a file holds it.

    Attributes:
        where: names it in messages, ``"data set 3"``.
        frequency: [Hz], shape (n_lines,).
        response: in the unit of the file, shape (n_lines,).
        output: label of the response; empty if not stated.
        input: label of the reference; empty if not stated.
        noise: coherence [-], variance and innovation noise [unit of the file squared],
            by the names of `FrfFunction`.
    """

    where: str
    frequency: FloatArray
    response: NDArray[Any]
    output: str = ""
    input: str = ""
    noise: Noise | None = None


def unit_of(
    path: Path, where: str, stated: str, given: FrfColumn | None
) -> tuple[Quantity, float]:
    """Return quantity and factor of an FRF, from the file or from the user.

    Args:
        path: of the file.
        where: names the FRF.
        stated: unit by the file; empty where it states none.
        given: unit by the user, or None.

    Raises:
        UnitError: neither states one, or they contradict each other.
    """
    if not is_frf_unit(stated):
        if given is not None and given.quantity is not None:
            return given.quantity, given.factor
        what = f"states the unit {shown(stated)}" if stated else "states no unit"
        raise UnitError(
            f"{named(path)}: {where} {what}, and an FRF is a motion over a force; "
            "state it, for example --columns 'frf:m/s^2/N' or 'frf:g/N'"
        )
    quantity, factor = parse_frf_unit(stated)
    if given is not None and (
        given.quantity is not quantity or not np.isclose(given.factor, factor)
    ):
        raise UnitError(
            f"{named(path)}: {where} is in {shown(stated)} by its file, --columns says "
            f"{given.unit!r}; leave --columns out, or correct the file"
        )
    return quantity, factor


def checked_frf(
    path: Path,
    raw: RawFrf,
    unit: tuple[Quantity, float],
    *,
    averages: int = 0,
    decay_rate: float = 0.0,
    usable_band: tuple[float, float] | None = None,
    provenance: Provenance = (),
) -> FrfFunction:
    """Return an FRF in SI units once it is known to be one.

    A line at 0 Hz without a number is left out: programs that derive accelerance from
    receptance, or divide by the frequency, have none there, and no mode needs it.

    Args:
        path: of the file.
        raw: as read.
        unit: quantity and factor to SI.
        averages: number of averages, 0 if not stated.
        decay_rate: of an exponential window [1/s].
        usable_band: that was excited [Hz], or None.
        provenance: of the file.

    Raises:
        FormatError: values are missing or beyond any measurement.
        SamplingError: the frequencies do not ascend, or are negative.
        BadData: a value is not finite, or an FRF has no imaginary part.
    """
    _require_lines(path, raw)
    raw, provenance = _without_zero(raw, provenance)
    quantity, factor = unit
    response: ComplexArray = np.asarray(raw.response, np.complex128) * factor
    noise = {} if raw.noise is None else raw.noise
    scaled = {
        name: values if values is None or name == "coherence" else values * factor**2
        for name, values in noise.items()
    }
    for name, values in {"the FRF": response, **scaled}.items():
        if values is not None:
            _require_values(path, raw, name, values)
    return FrfFunction(
        frequency=np.asarray(raw.frequency, np.float64),
        response=response,
        quantity=quantity,
        output=raw.output,
        input=raw.input,
        averages=averages,
        added_decay_rate=decay_rate,
        usable_band=usable_band,
        provenance=provenance,
        **scaled,
    )


def origin(path: Path, layout: str, columns: str | None) -> Provenance:
    """Return the first step of provenance of FRFs that come from a file.

    Args:
        path: of the file.
        layout: name of the format.
        columns: what the user stated, or None.
    """
    done = step(
        "read_frf",
        file=path.name,
        sha256=file_digest(path),
        layout=layout,
        columns=columns or "as the file states",
    )
    return (done,)


def require_count(path: Path, functions: int, values: int) -> None:
    """Raise `HostileFile` where a file has more FRFs than any measurement."""
    if functions > MOST_FUNCTIONS or values > MOST_VALUES:
        raise HostileFile(
            f"{named(path)} claims {functions} FRFs with {values} values, at most "
            f"{MOST_FUNCTIONS} and {MOST_VALUES} are read; split it"
        )


def _require_lines(path: Path, raw: RawFrf) -> None:
    if np.shape(raw.response) != np.shape(raw.frequency) or not raw.frequency.size:
        raise FormatError(
            f"{named(path)}: {raw.where} has {np.size(raw.response)} values for "
            f"{raw.frequency.size} frequencies; it is cut short: use another copy"
        )
    if not np.iscomplexobj(raw.response):
        raise BadData(
            f"{named(path)}: {raw.where} has no imaginary part; modes need the phase: "
            "export complex FRFs"
        )
    frequency = raw.frequency
    fallen = np.flatnonzero(~(np.diff(frequency) > 0.0))
    if not np.isfinite(frequency).all() or frequency[0] < 0.0 or fallen.size:
        at = int(fallen[0]) + 1 if fallen.size else 0
        raise SamplingError(
            f"{named(path)}: {raw.where}: frequency is {frequency[at]:g} Hz at line "
            f"{at + 1}; frequencies must be numbers from 0 on that ascend: export one "
            "record each"
        )


def _without_zero(raw: RawFrf, provenance: Provenance) -> tuple[RawFrf, Provenance]:
    """Return an FRF without its line at 0 Hz where that is no number."""
    at_zero = raw.frequency[0] == 0.0 and raw.frequency.size > 1
    if not at_zero or np.isfinite(raw.response[0]):
        return raw, provenance
    noise = {
        name: None if values is None else values[1:]
        for name, values in (raw.noise or {}).items()
    }
    whole = replace(
        raw, frequency=raw.frequency[1:], response=raw.response[1:], noise=noise
    )
    return whole, (*provenance, step("leave_out_line", frequency=0.0))


def _require_values(path: Path, raw: RawFrf, name: str, values: NDArray[Any]) -> None:
    if values.shape != raw.frequency.shape:
        raise FormatError(
            f"{named(path)}: {raw.where}: {name} has {values.size} values, the FRF "
            f"{raw.frequency.size}; export them on the same lines"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        bad = np.flatnonzero(~(np.abs(values) <= _LARGEST_VALUE))
    if bad.size:
        raise BadData(
            f"{named(path)}: {raw.where}: {name} has {bad.size} values that are not "
            f"finite or beyond {_LARGEST_VALUE:g}, the first at "
            f"{raw.frequency[bad[0]]:g} Hz; leave these lines out, or export it again"
        )
