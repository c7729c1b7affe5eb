# SPDX-License-Identifier: MIT
"""FRFs of records with one or more inputs, for the modes of a base.

A record from rest is transformed whole, on a line to the right of the imaginary axis,
and a period of a steady state over its length: both without leakage. Any other record
is cut into segments under a Hann window.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.residuals.noise_models import high_band_sigma
from jointbench.signal.frf.frf import Frf, FrfKind

_KINDS = (FrfKind.RECEPTANCE, FrfKind.MOBILITY, FrfKind.ACCELERANCE)


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Segments of one length and their window.

    Attributes:
        rows: forces, then responses, shape (n_pieces, n_rows, length).
        window: shape (length,).
        decay: rate of an exponential window [1/s]; 0 for others.
    """

    rows: FloatArray
    window: FloatArray
    decay: float = 0.0


def record_frf(
    given: RecordSet, records: Sequence[LevelRecord], band: tuple[float, float]
) -> Frf:
    """Estimate the H1 matrix of some records, at lines of a band.

    Args:
        given: the set.
        records: of one level.
        band: lowest and highest frequency [Hz].

    Raises:
        BadData: the records are too short, or an input is silent in the band.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 7.4 and 9.2.
    """
    pieces = _pieces(given, records)
    length = pieces.window.size
    frequency = np.asarray(scipy.fft.rfftfreq(length, 1 / given.sample_rate))
    kept = (frequency >= band[0]) & (frequency <= band[1])
    if kept.sum() < MODAL.least_lines:
        raise BadData(
            f"{int(kept.sum())} lines lie between {band[0]:g} and {band[1]:g} Hz, at "
            f"least {MODAL.least_lines} are required; give a wider band or longer "
            "records"
        )
    spectra = scipy.fft.rfft(pieces.rows * pieces.window, axis=2)[:, :, kept]
    responses = pieces.rows[:, len(given.inputs) :]
    noise = np.median(high_band_sigma(responses), axis=0) ** 2 * np.sum(
        pieces.window**2
    )
    return _frf(given, frequency[kept], spectra, noise, pieces.decay)


def _pieces(given: RecordSet, records: Sequence[LevelRecord]) -> _Pieces:
    rows = [np.concatenate([r.force, r.response]) for r in records]
    lengths = {r.shape[1] for r in rows}
    alike = len(lengths) == 1 and len(rows) >= len(given.inputs)
    if alike and all(r.lead == 0 for r in records):
        length = lengths.pop()
        decay = MODAL.frf_decay * given.sample_rate / length
        window = np.exp(-decay / given.sample_rate * np.arange(length))
        return _Pieces(np.stack(rows), window, decay)
    periods = {r.period for r in records}
    if len(periods) == 1 and None not in periods and len(rows) >= len(given.inputs):
        length = int(records[0].period or 0)
        return _Pieces(np.stack([r[:, -length:] for r in rows]), np.ones(length))
    cut = [r[:, k.lead :] for r, k in zip(rows, records, strict=True)]
    cut = [r - r.mean(axis=1, keepdims=True) for r in cut]
    length = _segment_length(cut)
    return _Pieces(
        np.concatenate([_segments(r, length) for r in cut]), np.hanning(length)
    )


def _segment_length(rows: Sequence[FloatArray]) -> int:
    total = sum(r.shape[1] for r in rows)
    longest = max(r.shape[1] for r in rows)
    return int(min(longest, max(total // MODAL.frf_segments, MODAL.least_segment)))


def _segments(rows: FloatArray, length: int) -> FloatArray:
    """Return overlapping segments, shape (n_segments, n_rows, length)."""
    starts = range(0, rows.shape[1] - length + 1, max(length // 3, 1))
    if not len(starts):
        return np.zeros((0, rows.shape[0], length))
    return np.stack([rows[:, s : s + length] for s in starts])


def _frf(
    given: RecordSet,
    frequency: FloatArray,
    spectra: ComplexArray,
    noise: FloatArray,
    decay: float,
) -> Frf:
    """Return H1 with the variance that the noise of the responses gives it."""
    n = len(given.inputs)
    f, y = spectra[:, :n].transpose(2, 1, 0), spectra[:, n:].transpose(2, 1, 0)
    sff, syf = f @ f.conj().transpose(0, 2, 1), y @ f.conj().transpose(0, 2, 1)
    size = np.trace(sff, axis1=1, axis2=2).real / n
    alive = size > MODAL.silent_share * size.max()
    if alive.sum() < MODAL.least_lines:
        raise BadData(
            "the force of the lowest level has power on "
            f"{int(alive.sum())} lines of the band; give a narrower band"
        )
    floor = MODAL.silent_share * size[alive, None, None] * np.eye(n)
    inverse = np.linalg.inv(sff[alive] + floor)
    h = syf[alive] @ inverse
    gain = np.diagonal(inverse, axis1=1, axis2=2).real
    variance = noise[None, :, None] * gain[:, None, :]
    least = MODAL.least_frf_error**2 * np.mean(np.abs(h) ** 2, axis=0)
    return Frf(
        frequency=frequency[alive],
        response=h.transpose(1, 2, 0),
        kind=_KINDS[int(given.output)],
        variance=np.maximum(variance, least[None]).transpose(1, 2, 0),
        added_decay_rate=decay,
        outputs=tuple(f"{p}@{p}" for p in given.sensors),
        inputs=given.inputs,
        averages=spectra.shape[0],
    )
