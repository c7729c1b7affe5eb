# SPDX-License-Identifier: MIT
"""Units that replace newton and metre in the results of a record."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Estimate, Gap
from jointbench.analysis.gap.model.evidence_records import GapEvidence
from jointbench.station.schemas.record_model import unit_text

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


def in_stand_ins(found: Diagnosis, units: StandIns) -> Diagnosis:
    """Return a diagnosis in the units that stand in for newton and metre."""
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
        evidence=None if found.evidence is None else _evidence(found.evidence, units),
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
        if view.name != "preload"  # a record has none
    )
    return replace(gap, views=views)


def _evidence(evidence: GapEvidence, units: StandIns) -> GapEvidence:
    curves, spectra = evidence.curves, evidence.spectra
    return replace(
        evidence,
        force_unit=units.source,
        where=units.words(evidence.where),
        look=tuple(units.words(line) for line in evidence.look),
        relative={name: units.slices(x) for name, x in evidence.relative.items()},
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
        return unit_text(above[0], below[0], int(seconds))
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
