# SPDX-License-Identifier: MIT
"""The uncertainty budget of a result: what each standard deviation is made of."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.file_access.netcdf_read import read_array
from jointbench.station.results.results_read import StoredResult, open_result

SCATTER = "scatter of the hits and noise"
MODEL = "model error around the mode"
WHOLE = "all contributions together"
LEFT_OUT = (
    "sensitivities: natural frequencies and damping ratios do not depend on them; "
    "residues, and masses and stiffnesses that follow from residues, have the relative "
    "uncertainty of the ratio of the sensitivities in addition",
    "sample clock: frequencies have its relative error in addition (a converter of "
    "50 ppm: 0.005 %)",
    "mounting, mass of sensors and temperature: not in the result; repeat the "
    "measurement to see them",
)
"""What no standard deviation of a result includes."""


@dataclass(frozen=True, slots=True)
class BudgetRow:
    """One contribution to the uncertainty of a quantity.

    Attributes:
        of: the quantity, in words.
        unit: of value and sd.
        value: of the quantity [unit].
        contribution: where the uncertainty comes from.
        sd: standard uncertainty from there [unit].
        share: of the variance of the quantity [-].
    """

    of: str
    unit: str
    value: float
    contribution: str
    sd: float
    share: float


def uncertainty_budget(result: StoredResult) -> tuple[BudgetRow, ...]:
    """Return the contributions to every standard deviation of a result.

    Frequencies and damping ratios have two: the scatter of hits and noise, and the
    systematic part from model error, where the file holds it. Others have one row.
    """
    parts = _systematic_parts(result.path)
    return tuple(row for one in _rows(result, parts) for row in one)


def _rows(
    result: StoredResult, parts: Sequence[float]
) -> Iterator[tuple[BudgetRow, ...]]:
    left = list(parts)
    for one in result.quantities:
        modal = one.part == "modes" and one.name in {
            "natural_frequency",
            "damping_ratio",
        }
        systematic = left.pop(0) if modal and left else math.nan
        if math.isnan(one.sd):
            continue
        at = "" if math.isnan(one.preload) else f" at {one.preload:g} N"
        of = f"{one.part} {one.item}".strip() + f", {one.name.replace('_', ' ')}{at}"
        if math.isnan(systematic):
            yield (BudgetRow(of, one.unit, one.value, WHOLE, one.sd, 1.0),)
        else:
            yield _two(of, one.unit, one.value, one.sd, systematic)


def _two(
    of: str, unit: str, value: float, sd: float, systematic: float
) -> tuple[BudgetRow, ...]:
    """Part a variance in that of the scatter and that of the model error."""
    share = min(1.0, (systematic / sd) ** 2) if sd > 0 else 0.0
    scatter = sd * math.sqrt(1.0 - share)
    return (
        BudgetRow(of, unit, value, SCATTER, scatter, 1.0 - share),
        BudgetRow(of, unit, value, MODEL, sd * math.sqrt(share), share),
    )


def _systematic_parts(path: Path) -> tuple[float, ...]:
    """Return the systematic parts, frequency and damping by turns, mode by mode."""
    with open_result(path) as file:
        found = [part for group in _mode_groups(file) for part in _of_modes(group)]
    return tuple(found)


def _mode_groups(file: h5py.File) -> list[h5py.Group]:
    if "modes" in file:
        return [file["modes"]]
    modal = file.get("modal", {})
    return [modal[name]["modes"] for name in sorted(modal, key=int)]


def _of_modes(group: h5py.Group) -> list[float]:
    names = ("natural_frequency_systematic", "damping_ratio_systematic")
    count = int(group["natural_frequency"].size)
    # Results of earlier versions do not hold them.
    columns = [
        read_array(group[n]) if n in group else np.full(count, np.nan) for n in names
    ]
    return [float(value) for row in zip(*columns, strict=True) for value in row]
