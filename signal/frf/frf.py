# SPDX-License-Identifier: MIT
"""Frequency response functions: the record, and the average over hammer hits."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from jointbench.acquisition.basics.array_checks import (
    require_ascending,
    require_finite,
    require_shape,
)
from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import ShapeError
from jointbench.acquisition.records.provenance import Provenance, Step, step
from jointbench.acquisition.records.recordings import Quantity, Recording
from jointbench.signal.frf.estimators import Estimator, bias_bound, pair_of_sums
from jointbench.signal.frf.excited_band import excited_band_of
from jointbench.signal.frf.innovation_noise import force_noise, innovation_noise
from jointbench.signal.frf.record_end import RecordEnd
from jointbench.signal.frf.spectral_sums import (
    SpectralSums,
    sum_hits,
    sums_of_spectra,
)
from jointbench.signal.hits.campaign_level import compare_levels
from jointbench.signal.hits.find_hits import accepted_hits, find_hits
from jointbench.signal.hits.hit_spectra import HitSpectra, require_alive
from jointbench.signal.hits.hit_verdicts import HitLimits
from jointbench.signal.hits.windows import HammerWindow, choose_window, join_windows


class FrfKind(StrEnum):
    """Response quantity per unit force."""

    RECEPTANCE = "receptance"
    MOBILITY = "mobility"
    ACCELERANCE = "accelerance"

    @property
    def derivatives(self) -> int:
        """How many times the displacement is differentiated: 0, 1 or 2."""
        return {"receptance": 0, "mobility": 1, "accelerance": 2}[self.value]

    @property
    def unit(self) -> str:
        """Response over force in SI units."""
        return ("m/N", "m/(N s)", "m/(N s²)")[self.derivatives]


KIND_OF_RESPONSE = {
    Quantity.DISPLACEMENT: FrfKind.RECEPTANCE,
    Quantity.VELOCITY: FrfKind.MOBILITY,
    Quantity.ACCELERATION: FrfKind.ACCELERANCE,
}


@dataclass(frozen=True, slots=True, eq=False)
class Frf:
    """Frequency response functions of one structure.

    Attributes:
        frequency: line frequencies [Hz], shape (n_lines,), ascending.
        response: complex FRF [m/N, m/(N s) or m/(N s^2)], shape
            (n_outputs, n_inputs, n_lines).
        kind: receptance, mobility or accelerance.
        coherence: ordinary coherence [-], same shape, or None for single hits.
        variance: E|error|^2 of the average [unit of response squared], same shape, or
            None if unknown.
        added_decay_rate: of the exponential window [1/s]: the FRF was measured at
            s = j omega + added_decay_rate.
        outputs: labels ``"channel@point"``, one per row.
        inputs: hit points, one per column.
        averages: smallest number of hits of a column; 0 if unknown.
        provenance: origin and processing steps.
        usable_band: (lowest, highest) excited frequency [Hz], or None.
        innovation_noise: variance due to the noise estimated by the Kalman stage [unit
            of response squared], same shape, or None; for weights only.
        force_noise: variance due to the noise of the windowed force [unit of response
            squared], same shape, or None. All outputs of an input share it.
        force_width: time after the trigger in which the force was kept [s], so that its
            noise is correlated from line to line; 0 for the whole block.
        end: of the records, None where it is not known or not that of all hits.
    """

    frequency: FloatArray
    response: ComplexArray
    kind: FrfKind
    coherence: FloatArray | None = None
    variance: FloatArray | None = None
    added_decay_rate: float = 0.0
    outputs: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()
    averages: int = 0
    provenance: Provenance = field(default=())
    usable_band: tuple[float, float] | None = None
    innovation_noise: FloatArray | None = None
    force_noise: FloatArray | None = None
    force_width: float = 0.0
    end: RecordEnd | None = None

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_ascending("frequency", self.frequency)
        require_finite("frequency", self.frequency)
        require_shape("response", self.response, (None, None, self.frequency.size))
        require_finite("response", self.response)
        for name in ("coherence", "variance", "innovation_noise", "force_noise"):
            array = getattr(self, name)
            if array is not None:
                require_shape(name, array, self.response.shape)
        n_outputs, n_inputs, _ = self.response.shape
        for name, labels, size in (
            ("outputs", self.outputs, n_outputs),
            ("inputs", self.inputs, n_inputs),
        ):
            if not labels:
                numbered = tuple(str(i + 1) for i in range(size))
                object.__setattr__(self, name, numbered)
            elif len(labels) != size:
                raise ShapeError(f"{len(labels)} labels for {size} {name}")
        freeze(
            self,
            "frequency",
            "response",
            "coherence",
            "variance",
            "innovation_noise",
            "force_noise",
        )


def estimate_frf(
    recordings: Sequence[Recording] | Recording,
    *,
    window: HammerWindow | None = None,
    estimator: Estimator = Estimator.H1,
) -> Frf:
    """Estimate the FRF from hammer hits.

    Recordings may hold one or many hits; hits at different points become different
    inputs. Recordings without hits are searched with default criteria.

    Args:
        recordings: force and responses, all at one sample rate.
        window: windows for all hits, or None to choose them (see `choose_window`).
        estimator: H1 trusts the force and is low where it is noisy; H2 trusts the
            response and is high where that is noisy; Hv lies between them.

    Returns:
        The average over the accepted hits, with coherence and variance from the scatter
        between hits where there are at least two for every column. The provenance holds
        the estimator, its bias as text and the difference of H1 and H2.

    Raises:
        NoHitFound: no accepted hit.
        SamplingError: the sample rates differ.
        ChannelMissing: a dead response, responses of different quantities, or a pair
            of output and input that was never measured together, either way round.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 6.1 and 9.2 (H1, its variance).
    """
    if isinstance(recordings, Recording):
        recordings = (recordings,)
    return frf_of_sums(sum_recordings(recordings, window), estimator)


@dataclass(frozen=True, slots=True, eq=False)
class SummedHits:
    """Sums over the accepted hits of recordings.

    Attributes:
        sums: of all pairs.
        window: applied to each hit.
        provenance: steps that the recordings went through.
    """

    sums: SpectralSums
    window: HammerWindow
    provenance: Provenance = ()


def sum_recordings(
    recordings: Sequence[Recording],
    window: HammerWindow | None,
    *,
    levels: bool = False,
) -> SummedHits:
    """Judge hits where that was not done, and add their spectra up.

    Args:
        recordings: as for `estimate_frf`, which names the errors.
        window: for all hits, or None to choose it.
        levels: regress on the level of the hits as well.
    """
    judged = compare_levels(
        [r if r.hits else find_hits(r) for r in recordings],
        HitLimits(),
        [not r.hits for r in recordings],
    )
    for recording in judged:
        for hit in accepted_hits(recording):
            require_alive(recording, hit)
    if window is None:
        window = join_windows([choose_window(r) for r in judged if accepted_hits(r)])
    sums = sum_hits(judged, window, levels=levels)
    return SummedHits(sums, window, _inherited(judged))


def average_spectra(
    spectra: HitSpectra,
    window: HammerWindow,
    *,
    estimator: Estimator = Estimator.H1,
    inherited: Provenance = (),
) -> Frf:
    """Estimate the FRF from spectra of hits; see `estimate_frf`.

    Args:
        spectra: of the accepted hits.
        window: applied to each of them.
        estimator: H1, H2 or Hv.
        inherited: steps that the recordings went through.

    Raises:
        ChannelMissing: a pair of output and input that was never measured together.
    """
    return frf_of_sums(
        SummedHits(sums_of_spectra(spectra), window, inherited), estimator
    )


def frf_of_sums(summed: SummedHits, estimator: Estimator = Estimator.H1) -> Frf:
    """Return the FRF that sums over hits give.

    Args:
        summed: over the accepted hits.
        estimator: H1, H2 or Hv.
    """
    sums, window = summed.sums, summed.window
    shape = (len(sums.outputs), len(sums.inputs), sums.frequency.size)
    averages = min(row.hits for row in sums.pairs)
    response, coherence, variance = _averaged(sums, estimator)
    seen = coherence if averages > 1 else None
    done = _record(sums, window, averages, estimator, seen)
    decay = window.decay_rate or 0.0
    noise = innovation_noise(sums, summed.provenance, decay)
    forced = force_noise(sums, window)
    return Frf(
        frequency=sums.frequency,
        response=_whole(response, shape),
        kind=KIND_OF_RESPONSE[sums.quantity],
        coherence=_whole(seen, shape),
        variance=_whole(variance if averages > 1 else None, shape),
        added_decay_rate=decay,
        outputs=sums.outputs,
        inputs=sums.inputs,
        averages=averages,
        provenance=(*summed.provenance, done),
        usable_band=excited_band_of(sums.power, sums.frequency),
        innovation_noise=_whole(noise, shape),
        force_noise=_whole(forced, shape),
        force_width=window.force_width or 0.0,
        end=sums.end,
    )


def _averaged(
    sums: SpectralSums, estimator: Estimator
) -> tuple[ComplexArray, FloatArray, FloatArray]:
    """Return response, coherence and variance, shape (n_pairs, n_lines) each."""
    size = len(sums.pairs), sums.frequency.size
    response = np.empty(size, complex)
    coherence, variance = np.empty(size), np.empty(size)
    for place, row in enumerate(sums.pairs):
        powers = row.force_power, row.response_power, row.scatter
        one = pair_of_sums(row.h1, powers, row.hits, estimator)
        response[place], coherence[place] = one.response, one.coherence
        variance[place] = one.variance
    return response, coherence, variance


def _whole(rows: Any, shape: tuple[int, int, int]) -> Any:
    """Return rows of pairs in the shape of an FRF, read-only so as not to be copied."""
    if rows is None:
        return None
    whole = rows.reshape(shape)
    whole.flags.writeable = False
    return whole


def _inherited(recordings: Sequence[Recording]) -> Provenance:
    """Return the steps of all recordings, each once."""
    return tuple(dict.fromkeys(s for r in recordings for s in r.provenance))


def _record(
    sums: SpectralSums,
    window: HammerWindow,
    averages: int,
    estimator: Estimator,
    coherence: FloatArray | None,
) -> Step:
    bound: dict[str, float] = {}
    if coherence is not None:
        low, high = excited_band_of(sums.power, sums.frequency)
        inside = (sums.frequency >= low) & (sums.frequency <= high)
        apart = bias_bound(coherence[:, inside], averages)
        bound["h1_below_h2_median"] = float(np.median(apart))
    return step(
        "estimate_frf",
        estimator=estimator.value,
        bias=estimator.bias,
        block=sums.block,
        block_reason=sums.block_reason,
        averages=averages,
        force_width=window.force_width or 0.0,
        decay_rate=window.decay_rate or 0.0,
        window_reason=window.reason,
        **bound,
    )
