# SPDX-License-Identifier: MIT
"""A long record of one input and one output, as a MAT file and its model say it is."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData, UnitError
from jointbench.acquisition.mat_file import read_mat_rows
from jointbench.acquisition.units import to_si
from jointbench.analysis.gap.exhibit_records import Exhibit
from jointbench.analysis.gap.records import Diagnosis, Estimate, Gap
from jointbench.analysis.gap.sheet import Sheet
from jointbench.analysis.gap.single_record import SingleRecord, Stretch, StretchScore
from jointbench.station.bench_model import BenchModel
from jointbench.station.gap_model import gap_sheet
from jointbench.station.record_model import (
    RecordTable,
    StretchTable,
    _unit_text,  # noqa: PLC2701  what is printed must read as what the model says
    stands_in,
)

LINEAR_REPEATABILITY = 3e-3
"""Relative to the peak response [-], where the model states none: good electronics."""
_SIGNS = re.compile(r"[()/]|[^\s()/*\u00b7]+")
_FACTOR = re.compile(r"([^\W\d_]+|1)(?:\^?(-?\d+(?:\.\d+)?))?")
_NEWTONS = re.compile(r"(?<=\d) N\b")


@dataclass(frozen=True, slots=True)
class StandIns:
    """Units that stand in for newton, and for metre, m/s or m/s^2.

    Attributes:
        source: of the input, in newton's place.
        sink: of the output.
        order: power of s that turns displacement into the output.
    """

    source: str
    sink: str
    order: int

    def unit(self, unit: str) -> str:
        """Return a mechanical unit as the model file writes it; others as they are.

        >>> StandIns("V", "V", 0).unit("kg"), StandIns("V", "V", 2).unit("N/m")
        ('V s^2/V', 'V/(V s^2)')
        """
        powers = _powers(unit)
        if not powers.keys() & {"N", "m", "kg"}:
            return unit
        mass = powers.pop("kg", 0.0)
        force, length = powers.pop("N", 0.0) + mass, powers.pop("m", 0.0) - mass
        # A metre is the output's unit times s^order, a kilogram is N s^2/m.
        seconds = powers.pop("s", 0.0) + 2 * mass + self.order * length
        factors = [(self.source, force), (self.sink, length), *powers.items()]
        return _joined(factors, seconds)

    def words(self, text: str) -> str:
        """Return a text in which no number is of newtons."""
        return _NEWTONS.sub(lambda found: f" {self.source}", text)

    def slices(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return values by slice, with the slices' names in these units."""
        return {self.words(label): value for label, value in values.items()}


@dataclass(frozen=True, slots=True, eq=False)
class RecordToExamine:
    """A record with its sheet and its parts.

    Attributes:
        record: input and output, in SI or in the units that stand in for it.
        training: what the fits see.
        scored: what they do not.
        sheet: the model with its priors.
        unit: of the output, as the model file writes it.
        factor: from that unit to the unit of `record`.
        remarks: what was assumed.
        stand_ins: units that stand in for newton and metre; None where none do.
    """

    record: SingleRecord
    training: Stretch
    scored: tuple[Stretch, ...]
    sheet: Sheet
    unit: str
    factor: float
    remarks: tuple[str, ...]
    stand_ins: StandIns | None = None

    def in_unit(self, scores: tuple[StretchScore, ...]) -> tuple[StretchScore, ...]:
        """Return scores in the output's own unit."""
        return tuple(
            replace(
                score,
                rms=score.rms / self.factor,
                before=score.before / self.factor,
                after=score.after / self.factor,
            )
            for score in scores
        )

    def in_stand_ins(self, found: Diagnosis) -> Diagnosis:
        """Return a diagnosis in the units that stand in for newton and metre."""
        units = self.stand_ins
        if units is None:
            return found
        return replace(
            found,
            base=_estimates(found.base, units),
            effects=tuple(
                replace(effect, parameters=_estimates(effect.parameters, units))
                for effect in found.effects
            ),
            gap_before=_gap(found.gap_before, units),
            gap_after=_gap(found.gap_after, units),
            reason=units.words(found.reason),
            exhibit=None if found.exhibit is None else _exhibit(found.exhibit, units),
        )


def _estimates(given: Sequence[Estimate], units: StandIns) -> tuple[Estimate, ...]:
    return tuple(replace(one, unit=units.unit(one.unit)) for one in given)


def _gap(gap: Gap, units: StandIns) -> Gap:
    views = tuple(
        replace(
            view,
            chi2_per_dof=units.slices(view.chi2_per_dof),
            share=units.slices(view.share),
        )
        for view in gap.views
    )
    return replace(gap, views=views)


def _exhibit(exhibit: Exhibit, units: StandIns) -> Exhibit:
    curves, spectra = exhibit.curves, exhibit.spectra
    return replace(
        exhibit,
        where=units.words(exhibit.where),
        look=tuple(units.words(line) for line in exhibit.look),
        relative={name: units.slices(x) for name, x in exhibit.relative.items()},
        curves=replace(
            curves,
            condition=units.words(curves.condition),
            unit=units.unit(curves.unit),
        ),
        spectra=replace(
            spectra,
            condition=units.words(spectra.condition),
            unit=units.unit(spectra.unit),
        ),
    )


def _powers(unit: str) -> dict[str, float]:
    """Return the power of each factor of a unit; nothing where it reads otherwise."""
    powers: dict[str, float] = {}
    base, sign = 1, 1
    outer: list[tuple[int, int]] = []
    for word in _SIGNS.findall(unicodedata.normalize("NFKC", unit)):
        if word == "/":
            sign = -base
        elif word == "(":
            outer.append((base, sign))
            base = sign
        elif word == ")" and outer:
            base, sign = outer.pop()
        elif (factor := _FACTOR.fullmatch(word)) is not None:
            power = sign * float(factor[2] or 1)
            powers[factor[1]] = powers.get(factor[1], 0.0) + power
        else:
            return {}
    powers.pop("1", None)
    return powers


def _joined(factors: Sequence[tuple[str, float]], seconds: float) -> str:
    """Return a unit as text, written as in a model file wherever one has such."""
    above, below = _side(factors, 1), _side(factors, -1)
    if len(above) == len(below) == 1 and seconds.is_integer():
        return _unit_text(above[0], below[0], int(seconds))
    factors = [*factors, ("s", seconds)]
    above, below = _side(factors, 1), _side(factors, -1)
    top = above[0] if len(above) == 1 else " ".join(map(_closed, above)) or "1"
    if not below:
        return top
    bottom = " ".join(map(_closed, below))
    return f"{top}/({bottom})" if len(below) > 1 else f"{top}/{bottom}"


def _side(factors: Sequence[tuple[str, float]], sign: int) -> list[str]:
    """Return the factors above (1) or below (-1) the line."""
    return [
        unit if sign * power == 1 else f"{_closed(unit)}^{sign * power:g}"
        for unit, power in factors
        if sign * power > 0
    ]


def _closed(unit: str) -> str:
    return f"({unit})" if re.search(r"[\s/][^)]*$", unit) else unit


def read_record(path: Path, bench: BenchModel) -> RecordToExamine:
    """Read input and output of a MAT file and cut it as the model says.

    Args:
        path: of the MAT file.
        bench: model with a [record] table.

    Raises:
        BadData: the model has no such table or more than one channel; the file lacks a
            variable, or holds something else than a row of finite numbers in it.
    """
    table = bench.record
    if table is None:
        raise BadData(
            f"the model does not say what is in {path.name}; add a [record] table with "
            "input, output, their units, sample_rate and training"
        )
    sheet = gap_sheet(bench)
    if len(sheet.model.channels) != 1:
        raise BadData(
            f"the model has {len(sheet.model.channels)} channels, a record of one "
            "output wants one; leave the others out"
        )
    remarks: tuple[str, ...] = ()
    if sheet.repeatability is None:
        sheet = replace(sheet, repeatability=LINEAR_REPEATABILITY)
        remarks = (
            f"no repeatability is stated, {100 * LINEAR_REPEATABILITY:g} % of the peak "
            "is taken; state it in the [gap] table",
        )
    source, sink = _factors(table, bench.gap.output)
    force, response = read_mat_rows(path, (table.input, table.output))
    if force.shape != response.shape:
        raise BadData(
            f"'{path}': {table.input} has {force.size} samples and {table.output} "
            f"{response.size}; both must have the same"
        )
    record = SingleRecord(
        path.stem,
        source * _centred(force, table),
        sink * _centred(response, table),
        table.sample_rate,
        _driven(table, bench, sheet),
    )
    return RecordToExamine(
        record,
        _stretch("training", table.training, table),
        tuple(_stretch(part.name, part, table) for part in table.scored),
        sheet,
        table.output_unit,
        sink,
        remarks,
        _stand_ins(table, int(sheet.model.output)),
    )


def _stand_ins(table: RecordTable, order: int) -> StandIns | None:
    if not stands_in(table.input_unit):
        return None
    return StandIns(table.input_unit, table.output_unit, order)


def _factors(table: RecordTable, output: str) -> tuple[float, float]:
    """Return the factors of input and output to SI; 1 where units stand in."""
    if stands_in(table.input_unit):
        return 1.0, 1.0
    try:
        return to_si(table.input_unit, "force"), to_si(table.output_unit, output)
    except UnitError as error:
        raise UnitError(f"record.output_unit: {error}") from error


def _centred(values: FloatArray, table: RecordTable) -> FloatArray:
    return values - values.mean() if table.remove_mean else values


def _driven(table: RecordTable, bench: BenchModel, sheet: Sheet) -> int:
    if table.driven is None:
        return sheet.model.channels[0].body
    names = list(bench.bodies)
    if table.driven not in names:
        raise BadData(
            f"record.driven is {table.driven!r}; the bodies are {', '.join(names)}"
        )
    return names.index(table.driven)


def _stretch(name: str, part: StretchTable, table: RecordTable) -> Stretch:
    lead = table.lead if part.lead is None else part.lead
    return Stretch(name, part.starts, part.length, lead)
