# SPDX-License-Identifier: MIT
"""FRFs of records with one or more inputs, for the modes of a base."""

from collections.abc import Sequence

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.signal.frf.frf import Frf, FrfKind

_KINDS = (FrfKind.RECEPTANCE, FrfKind.MOBILITY, FrfKind.ACCELERANCE)


def record_frf(
    given: RecordSet, records: Sequence[LevelRecord], band: tuple[float, float]
) -> Frf:
    """Estimate the H1 matrix from segments of records, at lines of a band.

    Args:
        given: the set.
        records: of one level.
        band: lowest and highest frequency [Hz].

    Raises:
        BadData: the records are too short, or an input is silent in the band.

    Source:
        Bendat and Piersol, Random Data (2010), sec. 7.4 and 9.2.
    """
    rows = [_rows(r) for r in records]
    length = _length(rows)
    pieces = np.concatenate([_segments(r, length) for r in rows])
    frequency = np.asarray(scipy.fft.rfftfreq(length, 1 / given.sample_rate))
    kept = (frequency >= band[0]) & (frequency <= band[1])
    if kept.sum() < MODAL.least_lines:
        raise BadData(
            f"{int(kept.sum())} lines lie between {band[0]:g} and {band[1]:g} Hz, at "
            f"least {MODAL.least_lines} are required; give a wider band or longer "
            "records"
        )
    spectra = scipy.fft.rfft(pieces * np.hanning(length), axis=2)[:, :, kept]
    return _frf(given, frequency[kept], spectra)


def _rows(record: LevelRecord) -> FloatArray:
    rows = np.concatenate([record.force, record.response])[:, record.lead :]
    return rows - rows.mean(axis=1, keepdims=True)


def _length(rows: Sequence[FloatArray]) -> int:
    total = sum(r.shape[1] for r in rows)
    longest = max(r.shape[1] for r in rows)
    return int(min(longest, max(total // MODAL.frf_segments, MODAL.least_segment)))


def _segments(rows: FloatArray, length: int) -> FloatArray:
    """Return overlapping segments, shape (n_segments, n_rows, length)."""
    step = max(length // 3, 1)
    starts = range(0, rows.shape[1] - length + 1, step)
    if not len(starts):
        return np.zeros((0, rows.shape[0], length))
    return np.stack([rows[:, s : s + length] for s in starts])


def _frf(given: RecordSet, frequency: FloatArray, spectra: ComplexArray) -> Frf:
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
    sff, syf, y, f = sff[alive], syf[alive], y[alive], f[alive]
    floor = MODAL.silent_share * size[alive, None, None] * np.eye(n)
    h = syf @ np.linalg.inv(sff + floor)
    left = np.mean(np.abs(y - h @ f) ** 2, axis=2)
    free = max(spectra.shape[0] - n, 1)
    gain = np.diagonal(np.linalg.inv(sff + floor), axis1=1, axis2=2).real
    variance = left[:, :, None] * gain[:, None, :] * spectra.shape[0] / free
    least = MODAL.least_frf_error**2 * np.mean(np.abs(h) ** 2, axis=0)
    response = h.transpose(1, 2, 0)
    return Frf(
        frequency=frequency[alive],
        response=response,
        kind=_KINDS[int(given.output)],
        variance=np.maximum(variance, least[None]).transpose(1, 2, 0),
        outputs=tuple(f"{p}@{p}" for p in given.sensors),
        inputs=given.inputs,
        averages=spectra.shape[0],
    )
