# SPDX-License-Identifier: MIT
"""The model of a band linearised: residual, normal matrix and gradient.

The lines of one mode in all channels are its shape times one row (and its turn times
another). So the normal matrix needs products of these rows alone, not one Jacobian a
channel. Derivatives of curves and starts leave out the turn, which is small.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.amplitude.band_lines import BandLines
from jointbench.signal.amplitude.mode_state import ModeState, mode_slices
from jointbench.signal.amplitude.slow_flow import decays

# Signals in units of the noise: what is larger is no decay that was measured.
_LARGEST = 1e30


@dataclass(frozen=True, slots=True, eq=False)
class LinearBand:
    """The model near given modes.

    Attributes:
        residual: shape (n_hits, n_virtual, n_lines).
        normal: J'J, shape (n, n).
        gradient: J'r, shape (n,).
        chi2: squares of the residual.
    """

    residual: ComplexArray
    normal: FloatArray
    gradient: FloatArray
    chi2: float


def linearised(lines: BandLines, modes: Sequence[ModeState], power: int) -> LinearBand:
    """Return residual, J'J and J'r; an infinite chi-squared where signals overflow.

    Args:
        lines: of the band.
        modes: where the model is linearised.
        power: derivatives of the response.
    """
    rows = [_rows(lines, mode, power) for mode in modes]
    total = mode_slices(modes)[-1].hits.stop
    normal, gradient = np.zeros((total, total)), np.zeros(total)
    # Not a number compares as False; products of larger ones overflow.
    if not all(np.abs(row).max() < _LARGEST for row in rows):
        return LinearBand(lines.data, normal, gradient, np.inf)
    residual = lines.data.copy()
    for mode, row in zip(modes, rows, strict=True):
        for number, shape in enumerate((mode.shape, mode.turn)[: mode.signals]):
            residual -= shape[:, None] * row[:, None, :, number]
    places = _places(modes)
    _add_products(modes, rows, places, normal)
    _add_gradient(modes, rows, places, residual, gradient)
    chi2 = float(np.sum(residual.real**2) + np.sum(residual.imag**2))
    return LinearBand(residual, normal, gradient, chi2)


def _rows(lines: BandLines, mode: ModeState, power: int) -> ComplexArray:
    """Return signals and derivatives on the lines, shape (n_hits, n_lines, n)."""
    first = mode.signals
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        flow = decays(mode, lines.panels, lines.centre, power)
        hits, nodes, n = flow.change.shape
        table = np.empty((nodes, hits, first + n), complex)
        table[:, :, 0] = flow.signal.T
        if first > 1:
            table[:, :, 1] = (flow.pole * flow.signal).T
        table[:, :, first:] = (flow.signal[:, :, None] * flow.change).transpose(1, 0, 2)
        rows = lines.transform @ table.reshape(nodes, -1)
    return np.asarray(rows.reshape(-1, hits, first + n).transpose(1, 0, 2))


def _places(modes: Sequence[ModeState]) -> list[IntArray]:
    """Return for each mode and hit where its columns belong among all.

    Shared parameters first, then start and phase of the hit, then the shape.
    """
    found = []
    for mode, own in zip(modes, mode_slices(modes), strict=True):
        hits = mode.start.size
        shared, shape = (
            np.tile(np.arange(part.start, part.stop), (hits, 1))
            for part in (own.shared, own.shape)
        )
        start = np.arange(own.hits.start, own.hits.stop).reshape(hits, 2)
        found.append(np.concatenate((shared, start, shape), axis=1))
    return found


def _add_products(
    modes: Sequence[ModeState],
    rows: Sequence[ComplexArray],
    places: Sequence[IntArray],
    normal: FloatArray,
) -> None:
    for k, one in enumerate(modes):
        for m, other in enumerate(modes[k:], k):
            blocks = _products(one, other, rows[k].conj().transpose(0, 2, 1) @ rows[m])
            for block, left, right in zip(blocks, places[k], places[m], strict=True):
                normal[left[:, None], right] += block
                if m > k:
                    normal[right[:, None], left] += block.T


def _products(one: ModeState, other: ModeState, rows: ComplexArray) -> FloatArray:
    """Return the blocks of J'J of two modes, hit by hit.

    Args:
        one: mode of the block's rows.
        other: mode of its columns.
        rows: products of their rows on the lines, shape (n_hits, 1 + n, 1 + m).
    """
    n, m = rows.shape[1] - one.signals, rows.shape[2] - other.signals
    free_one, free_other = one.others, other.others
    left, right = (
        np.arange(2 * mode.signals * len(mode.others)).reshape(mode.signals, -1)
        for mode in (one, other)
    )
    block = np.zeros((rows.shape[0], n + left.size, m + right.size))
    block[:, :n, :m] = (
        np.vdot(one.shape, other.shape) * rows[:, one.signals :, other.signals :]
    ).real
    for e, columns in enumerate(right + m):
        beside = rows[:, one.signals :, e, None] * one.shape[free_other].conj()
        block[:, :n, columns[::2]] = beside.real
        block[:, :n, columns[1::2]] = -beside.imag
    for e, lower in enumerate(left + n):
        below = rows[:, e, None, other.signals :] * other.shape[free_one, None]
        block[:, lower[::2], :m] = below.real
        block[:, lower[1::2], :m] = below.imag
        for f, columns in enumerate(right + m):
            _set_shapes(block, (lower, columns), (free_one, free_other), rows[:, e, f])
    return block


def _set_shapes(
    block: FloatArray,
    places: tuple[IntArray, IntArray],
    free: tuple[list[int], list[int]],
    power: ComplexArray,
) -> None:
    """Set the products of real and imaginary parts of two shapes, same channels."""
    for i, channel in enumerate(free[0]):
        if channel in free[1]:
            at, to = places[0][2 * i], places[1][2 * free[1].index(channel)]
            block[:, at, to] = block[:, at + 1, to + 1] = power.real
            block[:, at, to + 1], block[:, at + 1, to] = -power.imag, power.imag


def _add_gradient(
    modes: Sequence[ModeState],
    rows: Sequence[ComplexArray],
    places: Sequence[IntArray],
    residual: ComplexArray,
    gradient: FloatArray,
) -> None:
    for mode, row, place in zip(modes, rows, places, strict=True):
        along = np.einsum("v,hvm->hm", mode.shape.conj(), residual)
        back = row.conj().transpose(0, 2, 1)
        own = (back[:, mode.signals :] @ along[:, :, None])[:, :, 0].real
        turned = np.einsum(
            "hem,hvm->hev", back[:, : mode.signals], residual[:, mode.others]
        )
        parts = np.stack((turned.real, turned.imag), axis=3).reshape(own.shape[0], -1)
        np.add.at(gradient, place, np.concatenate((own, parts), axis=1))
