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

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.records.recordings import Quantity, Recording
from jointbench.signal.hits.hit_pairs import pair_up
from jointbench.signal.hits.hit_spectra import (
    HitSpectra,
    SpectraPlan,
    plan_spectra,
    transformed,
)
from jointbench.signal.hits.windows import HammerWindow


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
    def empty(cls, lines: int) -> "PairSums":
        """Return the sums of no hit."""
        force, response, scatter = np.zeros((3, lines))
        return cls(np.zeros(lines, complex), force, response, scatter)

    def add(
        self, force: ComplexArray, power: FloatArray, response: ComplexArray
    ) -> None:
        """Add one hit.

        Args:
            force: its spectrum [N s], shape (n_lines,).
            power: |force|^2, same shape.
            response: its spectrum, same shape.
        """
        before = self.force_power
        total = before + power
        safe = np.where(total > 0.0, total, 1.0)
        error = response - self.h1 * force
        self.scatter += _power(error) * (before / safe)
        self.h1 += error * (force.conj() / safe)
        # A line without force holds nothing but noise of the response.
        self.scatter += np.where(total > 0.0, 0.0, _power(response))
        self.response_power += _power(response)
        self.force_power = total
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
    """

    frequency: FloatArray
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    pairs: tuple[PairSums, ...]
    power: FloatArray
    quantity: Quantity
    block: int
    block_reason: str


@dataclass(slots=True, eq=False)
class _Adder:
    """Adds hits to the sums of their pairs."""

    power: FloatArray
    pairs: dict[tuple[str, str], PairSums] = field(default_factory=dict)
    hits: int = 0

    def add(
        self,
        force: ComplexArray,
        response: Iterable[ComplexArray],
        labels: Sequence[str],
        point: str,
    ) -> None:
        own = _power(force)
        self.power += own
        self.hits += 1
        for label, row in zip(labels, response, strict=True):
            pair = label, point
            if pair not in self.pairs:
                self.pairs[pair] = PairSums.empty(force.size)
            self.pairs[pair].add(force, own, row)


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
    adder = _Adder(np.zeros(plan.frequency.size))
    for (recording, hit), labels in zip(plan.chosen, plan.labels, strict=True):
        force, responses = transformed(recording, hit, window, plan.block)
        adder.add(force, responses, labels, hit.point)
    return _sums(adder, plan)


def sums_of_spectra(spectra: HitSpectra) -> SpectralSums:
    """Return the sums over hits whose spectra are known.

    Raises:
        ChannelMissing: a pair of output and input that was never measured together.
    """
    adder = _Adder(np.zeros(spectra.frequency.size))
    rows = zip(
        spectra.force, spectra.response, spectra.labels, spectra.points, strict=True
    )
    for force, response, labels, point in rows:
        adder.add(force, response, labels, point)
    return _sums(adder, spectra)


def _sums(adder: _Adder, common: HitSpectra | SpectraPlan) -> SpectralSums:
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
    )


def _power(values: ComplexArray) -> FloatArray:
    """Return |values|^2 without the square root that abs takes."""
    return np.asarray(values.real**2 + values.imag**2)
