# SPDX-License-Identifier: MIT
"""Sums over all hits of a measurement from which FRFs follow, one hit at a time.

The spectra of hits need not be kept: see `pair_sums`.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    IntArray,
    squared_size,
)
from jointbench.acquisition.records.recordings import Quantity, Recording
from jointbench.signal.frf.excited_band import excited_band_of
from jointbench.signal.frf.level_slope import LevelSlope, LevelUpdate
from jointbench.signal.frf.pair_sums import ForceUpdate, PairSums, force_update
from jointbench.signal.frf.record_end import RecordEnd, record_end
from jointbench.signal.hits.hit_pairs import LabelledHits, Pair, pair_up
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    SpectraPlan,
    force_spectrum,
    plan_spectra,
    response_spectra,
)
from jointbench.signal.hits.windows import HammerWindow, force_variance

# In place of a level of zero, which has no logarithm.
_SILENT = np.finfo(float).tiny


@dataclass(frozen=True, slots=True)
class LevelLines:
    """Lines of the level of a hit, and of the regression on it.

    Attributes:
        first: of them.
        past: one past the last.
    """

    first: int
    past: int

    @property
    def part(self) -> slice:
        """The lines as an index."""
        return slice(self.first, self.past)

    @classmethod
    def between(cls, frequency: FloatArray, band: tuple[float, float]) -> "LevelLines":
        """Return the lines from the lowest to the highest frequency of a band."""
        first = int(np.searchsorted(frequency, band[0]))
        return cls(first, int(np.searchsorted(frequency, band[1], side="right")))

    def level(self, force: ComplexArray) -> float:
        """Return the rms of a force spectrum on these lines [N s]."""
        return float(np.sqrt(np.mean(squared_size(force[self.part]))))


@dataclass(frozen=True, slots=True, eq=False)
class SpectralSums:
    """Sums over all hits of a measurement.

    Attributes:
        frequency: [Hz], shape (n_lines,).
        outputs: labels of the responses.
        inputs: points that were struck.
        pairs: sums of all pairs, outputs outermost; one measured the other way round
            where reciprocity completes the matrix.
        power: mean of |F|^2 over all hits [N^2 s^2], shape (n_lines,).
        quantity: what all responses measure.
        block: samples of the common block.
        block_reason: how it was chosen.
        force_variance: of the noise of the force at the hits of each pair [N^2], 0
            where it is not known, shape (n_pairs,).
        level_lines: of the regression on level, None where it is not asked for.
        level: of each hit on these lines [N s]; empty without them.
        hits: indices of the hits of each pair.
        end: of the blocks, None where hits differ in it or it is not known.
    """

    frequency: FloatArray
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    pairs: tuple[PairSums, ...]
    power: FloatArray
    quantity: Quantity
    block: int
    block_reason: str
    force_variance: FloatArray
    level_lines: LevelLines | None
    level: FloatArray
    hits: tuple[IntArray, ...]
    end: RecordEnd | None = None


@dataclass(slots=True, eq=False)
class HitAdder:
    """Adds hits to the sums of their pairs.

    Attributes:
        nothing: zeros, shape (n_lines,).
        levels: lines of the regression on level, None for no regression.
        power: sum of |F|^2 over all hits [N^2 s^2], shape (n_lines,).
        level: of each hit [N s].
        pairs: sums of each output and input.
    """

    nothing: FloatArray
    levels: LevelLines | None
    power: FloatArray
    level: list[float] = field(default_factory=list)
    pairs: dict[tuple[str, str], PairSums] = field(default_factory=dict)

    @classmethod
    def of(cls, lines: int, levels: LevelLines | None = None) -> "HitAdder":
        """Return sums of no hit on a number of lines."""
        return cls(np.zeros(lines), levels, np.zeros(lines))

    def add(
        self,
        force: ComplexArray,
        response: Iterable[ComplexArray],
        labels: Sequence[str],
        point: str,
    ) -> None:
        """Add one hit.

        Args:
            force: its spectrum [N s], shape (n_lines,).
            response: spectra, shape (n_lines,) each.
            labels: of the responses.
            point: where the hammer struck.
        """
        self.power += squared_size(force)
        if self.levels is not None:
            self.level.append(self.levels.level(force))
        # Pairs with the same earlier hits hold one array of their power.
        updates: dict[int, tuple[ForceUpdate, LevelUpdate | None]] = {}
        for label, row in zip(labels, response, strict=True):
            sums = self._pair(label, point)
            before = sums.force_power
            if id(before) not in updates:
                updates[id(before)] = self._update(force, sums)
            hit, moved = updates[id(before)]
            error = sums.add(hit, row)
            if self.levels is not None and sums.slope and moved:
                sums.slope.add(moved, error[self.levels.part])

    def of_pair(self, common: LabelledHits, pair: Pair) -> PairSums:
        """Return the sums of a pair that `pair_up` found among the hits added."""
        # All hits of a pair measured one output from one input: the first names both.
        hit, row = int(pair.hits[0]), int(pair.rows[0])
        return self.pairs[common.labels[hit][row], common.points[hit]]

    def _pair(self, label: str, point: str) -> PairSums:
        if (label, point) not in self.pairs:
            sums = self.pairs[label, point] = PairSums.empty(self.nothing)
            if self.levels is not None:
                sums.slope = LevelSlope.empty(self.nothing[self.levels.part])
        return self.pairs[label, point]

    def _update(
        self, force: ComplexArray, sums: PairSums
    ) -> tuple[ForceUpdate, LevelUpdate | None]:
        hit = force_update(force, sums.force_power)
        if self.levels is None or sums.slope is None:
            return hit, None
        part, level = self.levels.part, max(self.level[-1], _SILENT)
        moved = sums.slope.update(force[part], hit.share[part], np.log2(level))
        return hit, moved


def sum_hits(
    recordings: Sequence[Recording], window: HammerWindow, *, levels: bool = False
) -> SpectralSums:
    """Window, transform and add up the accepted hits, one at a time.

    Args:
        recordings: with hits found.
        window: applied to every hit alike.
        levels: regress on the level of the hits as well, over the excited band; forces
            are transformed once more for that.

    Returns:
        Sums of all pairs; the memory is that of one hit beside the sums.

    Raises:
        NoHitFound: no hit was accepted.
        SamplingError: the sample rates differ.
        ChannelMissing: no response, responses of different quantities or numbers, or
            a pair that was never measured together.
    """
    plan = plan_spectra(recordings)
    lines = _level_lines(plan, window) if levels else None
    adder = HitAdder.of(plan.frequency.size, lines)
    total = np.zeros(plan.frequency.size, complex)
    for (recording, hit), labels in zip(plan.chosen, plan.labels, strict=True):
        force = force_spectrum(recording, hit, window, plan.block)
        responses = response_spectra(recording, hit, window, plan.block)
        adder.add(force, responses, labels, hit.point)
        total += force
    sums = _sums(adder, plan, [force_variance(*one) for one in plan.chosen])
    return replace(sums, end=record_end(plan, window, total))


def _level_lines(plan: SpectraPlan, window: HammerWindow) -> LevelLines:
    """Return the lines of the excited band; no spectrum is kept."""
    power = np.zeros(plan.frequency.size)
    for recording, hit in plan.chosen:
        power += squared_size(force_spectrum(recording, hit, window, plan.block))
    return LevelLines.between(plan.frequency, excited_band_of(power, plan.frequency))


def sums_of_spectra(spectra: HitSpectra) -> SpectralSums:
    """Return the sums over hits whose spectra are known.

    Raises:
        ChannelMissing: a pair of output and input that was never measured together.
    """
    adder = HitAdder.of(spectra.frequency.size)
    rows = zip(
        spectra.force, spectra.response, spectra.labels, spectra.points, strict=True
    )
    for force, response, labels, point in rows:
        adder.add(force, response, labels, point)
    return _sums(adder, spectra, [0.0] * len(spectra.points))


def _sums(
    adder: HitAdder, common: HitSpectra | SpectraPlan, variance: Sequence[float]
) -> SpectralSums:
    outputs, inputs, pairs = pair_up(common)
    return SpectralSums(
        frequency=common.frequency,
        outputs=outputs,
        inputs=inputs,
        pairs=tuple(adder.of_pair(common, pair) for pair in pairs),
        power=adder.power / len(common.points),
        quantity=common.quantity,
        block=common.block,
        block_reason=common.block_reason,
        force_variance=np.array([np.mean(np.take(variance, p.hits)) for p in pairs]),
        level_lines=adder.levels,
        level=np.array(adder.level),
        hits=tuple(pair.hits for pair in pairs),
    )
