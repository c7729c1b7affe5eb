# SPDX-License-Identifier: MIT
"""Sums over hits from which FRFs follow, one hit at a time.

The spectra of hits need not be kept: power of the force, H1 and what H1 leaves of the
response are updated with each hit. The update of the residual is that of recursive
least squares, so that a small residual is not the difference of two large sums.

Source:
    Bendat and Piersol, Random Data (2010), sec. 6.1.4 (H1); Ljung, System
    Identification (1999), sec. 11.2 (recursive least squares).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Quantity, Recording
from jointbench.signal.hits.hit_pairs import pair_up
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    SpectraPlan,
    force_spectrum,
    plan_spectra,
    response_spectra,
)
from jointbench.signal.hits.windows import HammerWindow, force_variance


@dataclass(frozen=True, slots=True, eq=False)
class ForceUpdate:
    """What a hit changes in all pairs whose earlier hits had the same force.

    Attributes:
        force: its spectrum [N s], shape (n_lines,).
        total: sum of |F|^2 with this hit, same shape.
        share: sum of |F|^2 without it over that with it [-], same shape.
        gain: conj(F) over the sum with it [1/(N s)], same shape.
        silent: lines on which no hit had a force, or None where there is none.
    """

    force: ComplexArray
    total: FloatArray
    share: FloatArray
    gain: ComplexArray
    silent: BoolArray | None


def force_update(force: ComplexArray, before: FloatArray) -> ForceUpdate:
    """Return what a hit changes.

    Args:
        force: its spectrum [N s], shape (n_lines,).
        before: sum of |F|^2 of the earlier hits, same shape.
    """
    total = before + _power(force)
    silent = total <= 0.0
    safe = np.where(silent, 1.0, total)
    return ForceUpdate(
        force,
        total,
        before / safe,
        force.conj() / safe,
        silent if silent.any() else None,
    )


@dataclass(slots=True, eq=False)
class PairSums:
    """Sums of the hits that measured one output from one input.

    Attributes:
        h1: response over force [response unit/N], shape (n_lines,).
        force_power: sum of |F|^2 [N^2 s^2], same shape.
        response_power: sum of |X|^2, same shape.
        scatter: sum of |X - H1 F|^2, same shape.
        hits: number of hits.
    """

    h1: ComplexArray
    force_power: FloatArray
    response_power: FloatArray
    scatter: FloatArray
    hits: int = 0

    @classmethod
    def empty(cls, nothing: FloatArray) -> "PairSums":
        """Return the sums of no hit; `nothing` is zeros, shape (n_lines,)."""
        response, scatter = np.zeros((2, nothing.size))
        return cls(np.zeros(nothing.size, complex), nothing, response, scatter)

    def add(self, hit: ForceUpdate, response: ComplexArray) -> None:
        """Add one hit.

        Args:
            hit: from its force and `force_power`.
            response: its spectrum, shape (n_lines,).
        """
        power = _power(response)
        error = response - self.h1 * hit.force
        self.scatter += _power(error) * hit.share
        self.h1 += error * hit.gain
        if hit.silent is not None:
            # A line without force holds nothing but noise of the response.
            self.scatter += np.where(hit.silent, power, 0.0)
        self.response_power += power
        self.force_power = hit.total
        self.hits += 1


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


@dataclass(slots=True, eq=False)
class _Adder:
    """Adds hits to the sums of their pairs."""

    power: FloatArray
    nothing: FloatArray
    pairs: dict[tuple[str, str], PairSums] = field(default_factory=dict)
    hits: int = 0

    @classmethod
    def of(cls, lines: int) -> "_Adder":
        return cls(np.zeros(lines), np.zeros(lines))

    def add(
        self,
        force: ComplexArray,
        response: Iterable[ComplexArray],
        labels: Sequence[str],
        point: str,
    ) -> None:
        self.power += _power(force)
        self.hits += 1
        # Pairs with the same earlier hits hold one array of their power.
        updates: dict[int, ForceUpdate] = {}
        for label, row in zip(labels, response, strict=True):
            if (label, point) not in self.pairs:
                self.pairs[label, point] = PairSums.empty(self.nothing)
            sums = self.pairs[label, point]
            before = sums.force_power
            if id(before) not in updates:
                updates[id(before)] = force_update(force, before)
            sums.add(updates[id(before)], row)


def sum_hits(recordings: Sequence[Recording], window: HammerWindow) -> SpectralSums:
    """Window, transform and add up the accepted hits, one at a time.

    Args:
        recordings: with hits found.
        window: applied to every hit alike.

    Returns:
        Sums of all pairs; the memory is that of one hit beside the sums.

    Raises:
        NoHitFound: no hit was accepted.
        SamplingError: the sample rates differ.
        ChannelMissing: no response, responses of different quantities or numbers, or
            a pair that was never measured together.
    """
    plan = plan_spectra(recordings)
    adder = _Adder.of(plan.frequency.size)
    for (recording, hit), labels in zip(plan.chosen, plan.labels, strict=True):
        force = force_spectrum(recording, hit, window, plan.block)
        responses = response_spectra(recording, hit, window, plan.block)
        adder.add(force, responses, labels, hit.point)
    return _sums(adder, plan, [force_variance(*one) for one in plan.chosen])


def sums_of_spectra(spectra: HitSpectra) -> SpectralSums:
    """Return the sums over hits whose spectra are known.

    Raises:
        ChannelMissing: a pair of output and input that was never measured together.
    """
    adder = _Adder.of(spectra.frequency.size)
    rows = zip(
        spectra.force, spectra.response, spectra.labels, spectra.points, strict=True
    )
    for force, response, labels, point in rows:
        adder.add(force, response, labels, point)
    return _sums(adder, spectra, [0.0] * len(spectra.points))


def _sums(
    adder: _Adder, common: HitSpectra | SpectraPlan, variance: Sequence[float]
) -> SpectralSums:
    outputs, inputs, pairs = pair_up(common)
    # All hits of a pair measured one output from one input: the first names both.
    first = [(int(pair.hits[0]), int(pair.rows[0])) for pair in pairs]
    return SpectralSums(
        frequency=common.frequency,
        outputs=outputs,
        inputs=inputs,
        pairs=tuple(
            adder.pairs[common.labels[hit][row], common.points[hit]]
            for hit, row in first
        ),
        power=adder.power / adder.hits,
        quantity=common.quantity,
        block=common.block,
        block_reason=common.block_reason,
        force_variance=np.array([np.mean(np.take(variance, p.hits)) for p in pairs]),
    )


def _power(values: ComplexArray) -> FloatArray:
    """Return |values|^2 without the square root that abs takes."""
    return np.asarray(values.real**2 + values.imag**2)
