# SPDX-License-Identifier: MIT
"""FRFs under continuous excitation: a shaker with a random signal or a sweep.

The record is cut into blocks without a window. In each, the responses to what happened
before the block and after its end have the poles of the structure. They are fitted
together with the FRF over a few neighbouring lines, as rational functions of frequency
with one pole, and removed. What is left is averaged as hits are. A window would widen
every resonance instead, and raise its damping.

Source:
    Pintelon and Schoukens, System Identification (2012), sec. 7.2 (local modelling);
    McKelvey and Guerin, IFAC Proc. 45-16 (2012) 424 (local rational functions).
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData, SamplingError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import (
    Channel,
    Quantity,
    Recording,
    common_response,
    response_rows,
)
from jointbench.signal.frf.estimators import (
    EstimatedPair,
    Estimator,
    floored_power,
    pair_of_sums,
)
from jointbench.signal.frf.excited_band import excited_band_of
from jointbench.signal.frf.frf import KIND_OF_RESPONSE, Frf

BLOCKS = 8
"""Blocks of a record, unless they would be longer than `LONGEST` [-]."""
LONGEST, SHORTEST = 20.0, 1.0
"""Of a block [s]: longer ones have more lines than modes need."""
REACH = 5
"""Neighbours on each side of a line that a local function is fitted to [-]."""
_DEGREE = 2


def estimate_continuous_frf(
    recordings: Sequence[Recording],
    *,
    estimator: Estimator = Estimator.H1,
    block: float | None = None,
) -> Frf:
    """Estimate the FRF from one measured force that acts without a pause.

    Args:
        recordings: one force and responses, all at one sample rate.
        estimator: H1 trusts the force, H2 the response.
        block: length of a block [s]; None to choose it.

    Returns:
        The average over the blocks, with coherence from their scatter; the variance
        includes what local functions do not explain.

    Raises:
        BadData: a record is shorter than two blocks, or has no force.
        SamplingError: the sample rates differ.
        ChannelMissing: not exactly one force, or responses of different quantities.
    """
    first = recordings[0]
    rate = first.sample_rate
    if any(recording.sample_rate != rate for recording in recordings):
        raise SamplingError("the runs have different sample rates; give them apart")
    row, rows = first.row(Quantity.FORCE), response_rows(first)
    count = round(rate * (block or _block_length(recordings)))
    force = np.concatenate([_spectra(r, (row,), count) for r in recordings])[:, 0]
    responses = np.concatenate([_spectra(r, rows, count) for r in recordings])
    if not np.any(np.abs(force) > 0):
        raise BadData(f"the force of run {first.name!r} is zero; check the load cell")
    lines = slice(REACH, force.shape[1] - REACH)
    frequency = np.asarray(np.fft.rfftfreq(count, 1 / rate)[lines], dtype=float)
    local = _LocalFit(force)
    left = [local.without_transient(responses[:, n]) for n in range(len(rows))]
    pairs = [_pair(force[:, lines], response, estimator) for response, _ in left]
    shape = (len(rows), 1, frequency.size)
    power = np.sum(np.abs(force[:, lines]) ** 2, axis=0)
    done = step(
        "frf",
        estimator=estimator.value,
        bias=estimator.bias,
        blocks=force.shape[0],
        block_s=count / rate,
        window="none; transients removed by local rational functions",
    )
    return Frf(
        frequency=frequency,
        response=np.array([pair.response for pair in pairs]).reshape(shape),
        kind=KIND_OF_RESPONSE[common_response(first.channels)],
        coherence=np.array([pair.coherence for pair in pairs]).reshape(shape),
        variance=np.array([noise for _, noise in left]).reshape(shape)
        / floored_power(power),
        outputs=tuple(
            f"{channel.name}@{channel.point}" for channel in _channels(first, rows)
        ),
        inputs=(first.channels[row].point or "shaker",),
        averages=force.shape[0],
        provenance=(*first.provenance, done),
        usable_band=excited_band_of(power, frequency),
    )


def _channels(recording: Recording, rows: Sequence[int]) -> tuple[Channel, ...]:
    return tuple(recording.channels[row] for row in rows)


def _block_length(recordings: Sequence[Recording]) -> float:
    """Return a length of which the records hold enough blocks [s]."""
    seconds = [r.samples.shape[1] / r.sample_rate for r in recordings]
    length = float(min(LONGEST, sum(seconds) / BLOCKS, *seconds))
    if length < SHORTEST:
        raise BadData(
            f"a shaker run of {sum(seconds):.3g} s is too short for FRFs; record at "
            f"least {BLOCKS * SHORTEST:g} s, better a minute"
        )
    return length


def _spectra(recording: Recording, rows: Sequence[int], count: int) -> ComplexArray:
    """Return the spectra of blocks, shape (n_blocks, n_rows, n_lines)."""
    blocks = recording.samples.shape[1] // count
    parts = (recording.samples[:, n * count : (n + 1) * count] for n in range(blocks))
    spectra = [np.fft.rfft(part[list(rows)]) for part in parts]
    found: ComplexArray = np.asarray(spectra, dtype=complex) / np.sqrt(count)
    return found


def _pair(
    force: ComplexArray, response: ComplexArray, estimator: Estimator
) -> EstimatedPair:
    power = np.sum(np.abs(force) ** 2, axis=0)
    h1 = np.sum(response * force.conj(), axis=0) / np.where(power > 0.0, power, 1.0)
    own = np.sum(np.abs(response) ** 2, axis=0)
    scatter = np.sum(np.abs(response - h1 * force) ** 2, axis=0)
    return pair_of_sums(h1, (power, own, scatter), force.shape[0], estimator)


class _LocalFit:
    """Local rational functions: numerators of FRF and transients over one pole.

    The pole is shared, as FRF and transients are of one structure; each block has a
    transient of its own.
    """

    def __init__(self, force: ComplexArray) -> None:
        """Prepare the fit around every line that has neighbours enough.

        Args:
            force: spectra, shape (n_blocks, n_lines).
        """
        self._steps = np.arange(-REACH, REACH + 1) / REACH
        powers = self._steps[:, None] ** np.arange(_DEGREE + 1)
        hat = powers @ np.linalg.pinv(powers)
        self._without, self._centre = np.eye(self._steps.size) - hat, hat[REACH]
        # Terms of the FRF over the neighbours, (n_terms, n_blocks, n_lines, n_near).
        self._terms = powers.T[:, None, None, :] * _near(force)

    def without_transient(
        self, response: ComplexArray
    ) -> tuple[ComplexArray, FloatArray]:
        """Return spectra of a response without transients, and its noise.

        The noise is what the local functions do not explain.

        Args:
            response: spectra, shape (n_blocks, n_lines).

        Returns:
            Spectra, shape (n_blocks, n_lines), and power of the noise, (n_lines,).
        """
        near = _near(response)
        terms = np.concatenate((self._terms, (-self._steps * near)[None]))
        free = terms @ self._without
        normal = np.einsum("sbkr,tbkr->kst", free.conj(), free)
        right = np.einsum("sbkr,bkr->ks", free.conj(), near)
        # Terms of force and of response have different units.
        scale = np.sqrt(np.einsum("kss->ks", normal).real) + 1e-300
        normal /= scale[:, :, None] * scale[:, None, :]
        normal += 1e-12 * np.eye(len(terms))
        found = np.linalg.solve(normal, (right / scale)[..., None])[..., 0] / scale
        rest = near - np.einsum("ks,sbkr->bkr", found, terms)
        unexplained = np.sum(np.abs(rest @ self._without) ** 2, axis=(0, 2))
        freedom = len(response) * (2 * REACH - _DEGREE) - len(terms)
        return near[..., REACH] - rest @ self._centre, unexplained / freedom


def _near(spectra: ComplexArray) -> ComplexArray:
    """Return the lines around each line, shape (n_blocks, n_lines, n_near)."""
    views = np.lib.stride_tricks.sliding_window_view(spectra, 2 * REACH + 1, axis=-1)
    return np.asarray(views)
