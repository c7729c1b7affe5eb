# SPDX-License-Identifier: MIT
"""Coherence with each hit left out in turn, to find the hit that lowers it.

Coherence is |S_xf|^2 / (S_ff S_xx); the sums without a hit are the total less its own
terms. No hit is transformed again: leaving out each of n hits costs as much as one
average.

Source:
    Bendat and Piersol, Random Data (2010), sec. 5.2 (ordinary coherence).
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    squared_size,
)
from jointbench.signal.frf.excited_band import excited_band_of
from jointbench.signal.hits.hit_spectra import HitSpectra

_LEAST = 1e-24  # share of the largest power; lines below it count as empty


def typical_coherence(
    coherence: FloatArray, frequency: FloatArray, band: tuple[float, float]
) -> float | None:
    """Return the coherence over a band, each output with equal weight [-].

    The median over the lines of each output is insensitive to the dips at
    antiresonances, where the response is only noise.

    Args:
        coherence: shape (n_outputs, n_lines).
        frequency: of the lines [Hz].
        band: lowest and highest frequency [Hz].

    Returns:
        None where no line is inside.
    """
    inside = (frequency >= band[0]) & (frequency <= band[1])
    lines = coherence[:, inside]
    return float(np.median(lines, axis=1).mean()) if lines.size else None


@dataclass(frozen=True, slots=True, eq=False)
class HitSums:
    """Sums over hits at one point.

    Attributes:
        force: |F|^2, shape (n_lines,).
        response: |X|^2, shape (n_responses, n_lines).
        cross: X F*, shape (n_responses, n_lines).
    """

    force: FloatArray
    response: FloatArray
    cross: ComplexArray


def coherence_without(spectra: HitSpectra) -> FloatArray:
    """Return the coherence of the remaining hits, with each hit left out in turn.

    Args:
        spectra: of at least three hits at one point, their responses in one order.

    Returns:
        Typical coherence over the band that the others excite [-], shape (n_hits,); 0
        where they excite none.
    """
    force, response = spectra.force, spectra.response
    sums = HitSums(
        np.sum(np.abs(force) ** 2, axis=0),
        np.sum(np.abs(response) ** 2, axis=0),
        np.sum(response * force[:, None, :].conj(), axis=0),
    )
    return np.array(
        [
            coherence_of_others(sums, f, x, spectra.frequency)
            for f, x in zip(force, response, strict=True)
        ]
    )


def coherence_of_others(
    sums: HitSums, force: ComplexArray, response: ComplexArray, frequency: FloatArray
) -> float:
    """Return the coherence of hits without one of them, see `coherence_without`.

    Args:
        sums: over all of the hits.
        force: spectrum of the one hit, shape (n_lines,).
        response: its responses, shape (n_responses, n_lines).
        frequency: of the lines [Hz].
    """
    others = np.maximum(sums.force - np.abs(force) ** 2, 0.0)
    answers = np.maximum(sums.response - np.abs(response) ** 2, 0.0)
    cross = sums.cross - response * force.conj()
    product = answers * np.maximum(others, _LEAST * others.max())
    safe = np.where(product > 0.0, product, 1.0)
    coherence = np.minimum(np.abs(cross) ** 2 / safe, 1.0)
    band = excited_band_of(others, frequency)
    return typical_coherence(coherence, frequency, band) or 0.0


def coherence_of_each(
    sums: HitSums, force: ComplexArray, response: ComplexArray, inside: BoolArray
) -> FloatArray:
    """Return the coherence without each hit, on some lines only: where to look.

    Args:
        sums: over all hits, on these lines.
        force: of each hit, shape (n_hits, n_lines).
        response: shape (n_hits, n_responses, n_lines).
        inside: lines that count, shape (n_lines,).

    Returns:
        Shape (n_hits,) [-]; 0 where no line counts.
    """
    if not inside.any():
        return np.zeros(len(force))
    force = force[:, inside].astype(complex)
    response = response[:, :, inside].astype(complex)
    others = np.maximum(sums.force[inside] - squared_size(force), 0.0)
    answers = np.maximum(sums.response[:, inside] - squared_size(response), 0.0)
    cross = sums.cross[:, inside] - response * force[:, None].conj()
    product = answers * others[:, None]
    coherence = squared_size(cross) / np.where(product > 0.0, product, 1.0)
    typical = np.median(np.minimum(coherence, 1.0), axis=2)
    return np.asarray(typical.mean(axis=1))
