# SPDX-License-Identifier: MIT
"""A long record of one input and one output, as a MAT file and its model say it is."""

from dataclasses import dataclass, replace
from pathlib import Path

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.formats.mat_file import read_mat_rows
from jointbench.analysis.gap.diagnosis.single_record import SingleRecord, Stretch
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.gap_model import nominal_parameters
from jointbench.station.schemas.record_model import RecordTable, StretchTable, stands_in
from jointbench.station.schemas.record_units import StandIns, in_stand_ins

LINEAR_REPEATABILITY = 3e-3
"""Relative to the peak response [-], where the model states none: good electronics."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordToExamine:
    """A record with its model and its parts.

    Attributes:
        record: input and output, in SI or in the units that stand in for it.
        training: what the fits see.
        scored: what they do not.
        nominal: the model with its priors.
        unit: of the output, as the model file writes it.
        factor: from that unit to the unit of `record`.
        remarks: what was assumed.
        stand_ins: units that stand in for newton and metre; None where none do.
    """

    record: SingleRecord
    training: Stretch
    scored: tuple[Stretch, ...]
    nominal: NominalParameters
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
        return found if units is None else in_stand_ins(found, units)


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
            f"the model does not describe {path.name}; add a [record] table with "
            "input, output, their units, sample_rate and training"
        )
    nominal = nominal_parameters(bench)
    if len(nominal.model.channels) != 1:
        raise BadData(
            f"the model has {len(nominal.model.channels)} channels, a record of one "
            "output wants one; leave the others out"
        )
    remarks: tuple[str, ...] = ()
    if nominal.repeatability is None:
        nominal = replace(nominal, repeatability=LINEAR_REPEATABILITY)
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
        _driven(table, bench, nominal),
    )
    return RecordToExamine(
        record,
        _stretch("training", table.training, table),
        tuple(_stretch(part.name, part, table) for part in table.scored),
        nominal,
        table.output_unit,
        sink,
        remarks,
        _stand_ins(table, int(nominal.model.output)),
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


def _driven(table: RecordTable, bench: BenchModel, nominal: NominalParameters) -> int:
    if table.driven is None:
        return nominal.model.index(nominal.model.channels[0].body)
    names = list(bench.bodies)
    if table.driven not in names:
        raise BadData(
            f"record.driven is {table.driven!r}; the bodies are {', '.join(names)}"
        )
    return names.index(table.driven)


def _stretch(name: str, part: StretchTable, table: RecordTable) -> Stretch:
    lead = table.lead if part.lead is None else part.lead
    return Stretch(name, part.starts, part.length, lead)
