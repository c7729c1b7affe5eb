# SPDX-License-Identifier: MIT
"""The [record] table of a bench model: one long record of one input and one output.

::

    [record]
    input = "V1"             # variable of the MAT file
    input_unit = "V"
    output = "V2"
    output_unit = "V"
    sample_rate = "610.35 Hz"
    lead = 1024              # samples simulated before each start, not scored
    [record.training]
    starts = [40578, 49271]  # first sample of each realisation
    length = 8560
    [[record.scored]]
    name = "arrow"
    starts = [100]
    length = 40400
    lead = 100

An electronic bench has a voltage for a force. Then the units of input and output stand
in for newton and for metre (or m/s, m/s^2): a mass is written in ``"V s^2/V"``, a
stiffness in ``"V/V"``, a damping in ``"V s/V"``.
"""

import re
from typing import Annotated, Any

from pydantic import Field, model_validator

from jointbench.acquisition.basics.units import is_unit
from jointbench.station.files.toml_file import StrictTable, with_unit

MOST_SAMPLES = 4_000_000
"""Samples of all realisations of a stretch: the engine holds a few dozen copies."""
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)
_STAND_INS = {"mass": (2, "kg"), "stiffness": (0, "N/m"), "damping": (1, "N s/m")}
"""Power of the second in input unit over displacement unit, and the SI unit."""
_ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}


Sample = Annotated[int, Field(ge=0, le=1_000_000_000)]


class StretchTable(StrictTable):
    """Realisations of one length: first samples, samples of each, lead before each."""

    starts: tuple[Sample, ...] = Field(min_length=1, max_length=1000)
    length: int = Field(ge=512, le=MOST_SAMPLES)
    lead: Sample | None = None

    @model_validator(mode="after")
    def _sane_size(self) -> "StretchTable":
        total = len(self.starts) * (self.length + (self.lead or 0))
        if total > MOST_SAMPLES:
            raise ValueError(f"{total} samples; give at most {MOST_SAMPLES}")
        return self

    def samples(self) -> list[range]:
        """Return the samples that count, a range each realisation."""
        return [range(start, start + self.length) for start in self.starts]


class ScoredTable(StretchTable):
    """A stretch that no fit sees and on which the outcome is scored."""

    name: str = Field(min_length=1)


class RecordTable(StrictTable):
    """Where input and output are, in which units, and which parts train and score.

    The input drives the body `driven`; left out, it is the one with the channel.
    """

    file: str | None = None
    input: str
    input_unit: str = Field(min_length=1)
    output: str
    output_unit: str = Field(min_length=1)
    sample_rate: Annotated[float, with_unit("frequency"), Field(gt=0)]
    driven: str | None = None
    remove_mean: bool = False
    lead: Sample = 1024
    training: StretchTable
    scored: tuple[ScoredTable, ...] = ()

    @model_validator(mode="after")
    def _apart(self) -> "RecordTable":
        if self.input == self.output:
            raise ValueError(f"input and output are both {self.input!r}")
        seen = self.training.samples()
        for scored in self.scored:
            for own in scored.samples():
                if any(own.start < s.stop and s.start < own.stop for s in seen):
                    raise ValueError(
                        f"scored {scored.name!r} shares samples with the training; a "
                        "score needs samples that no fit has seen"
                    )
        return self


def stands_in(input_unit: str) -> bool:
    """Return whether the units of a record replace newton and metre."""
    return not is_unit(input_unit, "force")


def with_mechanical_units(content: Any) -> Any:
    """Return a model file's content with stand-in units replaced by SI units.

    Args:
        content: as read from TOML; returned as it is where nothing stands in.

    Raises:
        ValueError: a mass, stiffness or damping has another unit than the record's.
    """
    record = content.get("record") if isinstance(content, dict) else None
    units = record if isinstance(record, dict) else {}
    source, sink = units.get("input_unit"), units.get("output_unit")
    if not (isinstance(source, str) and isinstance(sink, str) and stands_in(source)):
        return content
    gap = content.get("gap")
    output = gap.get("output") if isinstance(gap, dict) else None
    order = _ORDER.get(str(output), 2)
    changed = dict(content)
    for table in ("bodies", "links"):
        if isinstance(content.get(table), dict):
            changed[table] = {
                name: _mechanical(name, entry, (source, sink, order))
                for name, entry in content[table].items()
            }
    return changed


def _mechanical(name: str, entry: Any, units: tuple[str, str, int]) -> Any:
    if not isinstance(entry, dict):
        return entry
    changed = dict(entry)
    for key, value in entry.items():
        kind = key.removesuffix("_sd")
        match = _NUMBER.fullmatch(value) if isinstance(value, str) else None
        if kind not in _STAND_INS or match is None:
            continue
        power, si = _STAND_INS[kind]
        wanted = unit_text(*units[:2], power - units[2])
        if _bare(match[2]) != _bare(wanted):
            raise ValueError(
                f"{key} of {name!r} is {value!r}; the record's units make it "
                f"'{match[1]} {wanted}'"
            )
        changed[key] = f"{match[1]} {si}"
    return changed


def unit_text(source: str, sink: str, power: int) -> str:
    """Return ``V s^2/V`` and the like."""
    below = f"({sink})" if "/" in sink else sink
    if power < 0:
        second = "s" if power == -1 else f"s^{-power}"
        return f"{source}/({sink} {second})"
    second = {0: "", 1: " s"}.get(power, f" s^{power}")
    return f"{source}{second}/{below}"


def _bare(unit: str) -> str:
    return re.sub(r"[\s^*()\u00b7]", "", unit).replace("\u00b2", "2")
