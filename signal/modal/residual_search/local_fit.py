# SPDX-License-Identifier: MIT
"""A group of neighbouring modes refitted on the lines around them.

What a further pole would change is settled by the lines around it. So the modes far
away are taken from the FRF as they are, the smooth rest is left to the residual terms,
and only the group is fitted: a trial costs a small share of a fit of the whole band.

Whether the FRF holds one more mode is asked at many places. A refinement at each would
cost too much, and the best of them alone is no answer where several are admissible. To
first order the answer has a closed form: residues of the trial pole are normal with the
size of those found, the modes around move linearly, and the marginal likelihood with
the trial over that without is a Bayes factor. It weighs what the trial explains against
what its residues could have explained by chance.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
)
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.lsfd import LinearFit
from jointbench.signal.modal.normal_equations import (
    combined,
    correlations,
    gram_matrices,
    inverses,
)
from jointbench.signal.modal.pole_columns import (
    basis_and_slopes,
    beside,
    modal_columns,
    modal_size,
)
from jointbench.signal.modal.refined_pole_covariance import slope_turns

# Lines for each pole of a group, and for the residual terms, at least.
_LINES_A_POLE, _LINES_REST = 6, 24
# Sd of (Re p, Im p) without data, in half-power half-widths, as in a refinement.
_LEASH = 1.0
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class WholeFit:
    """A fit of all lines from which groups are taken.

    Attributes:
        lines: what was fitted.
        pole: modes, then computational poles [rad/s], shape (n_poles,).
        n_modes: how many of them are modes.
        fit: residues and synthesis with all of them.
        noise: noise variance of the lines, shape (n_frf, n_lines).
        variance: noise and model error, same shape.
        residual: measured less fitted FRF, same shape.
    """

    lines: FrfLines
    pole: ComplexArray
    n_modes: int
    fit: LinearFit
    noise: FloatArray
    variance: FloatArray
    residual: ComplexArray = field(init=False)

    def __post_init__(self) -> None:
        """Subtract the fit once."""
        residual = self.lines.response - self.fit.synthesis
        object.__setattr__(self, "residual", residual)


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Neighbouring poles with their lines.

    Attributes:
        lines: around them, without all other poles.
        noise: noise variance of these lines, shape (n_frf, n_lines).
        variance: noise and model error, same shape.
        residual: of the whole fit on these lines, same shape.
        modes: indices of the modes of the group.
        beyond: indices of its computational poles.
    """

    lines: FrfLines
    noise: FloatArray
    variance: FloatArray
    residual: ComplexArray
    modes: IntArray
    beyond: IntArray


def group_around(
    whole: WholeFit, omega: float, reach: float, *, with_beyond: bool = False
) -> Group:
    """Return the poles within reach of a frequency, and the lines around it.

    Args:
        whole: fit of all lines.
        omega: middle of the group [rad/s].
        reach: lines on each side [rad/s]; more where the group has many poles.
        with_beyond: whether computational poles belong to it.
    """
    places = whole.lines.laplace.imag
    keep = _enough_lines(whole, omega, reach)
    low, high = places[keep][[0, -1]]
    width = measured_width(whole.lines, whole.pole)
    near = (whole.pole.imag > low - width) & (whole.pole.imag < high + width)
    outer = np.arange(whole.pole.size) >= whole.n_modes
    # Beyond an edge of the band all poles belong to the modes at that edge.
    near |= outer & bool(keep[-1]) & (whole.pole.imag > places[-1])
    near |= outer & bool(keep[0]) & (whole.pole.imag < places[0])
    near &= ~outer | with_beyond
    index = np.flatnonzero(near)
    kept = np.flatnonzero(keep)
    if kept[-1] - kept[0] == kept.size - 1:  # without a gap nothing is copied
        part: slice | IntArray = slice(int(kept[0]), int(kept[-1]) + 1)
    else:
        part = kept
    residual = whole.residual[:, part]
    end = whole.lines.end
    lines = replace(
        whole.lines,
        laplace=whole.lines.laplace[part],
        response=residual,
        end=None if end is None else end.at(part),
    )
    own = _contribution(whole, index, lines)
    return Group(
        replace(lines, response=residual + own),
        whole.noise[:, part],
        whole.variance[:, part],
        residual,
        index[index < whole.n_modes],
        index[index >= whole.n_modes],
    )


def _enough_lines(whole: WholeFit, omega: float, reach: float) -> BoolArray:
    """Return the lines within reach; the reach grows until they carry the poles."""
    places = whole.lines.laplace.imag
    away = np.abs(places - omega)
    while True:
        keep = away < reach
        inside = np.count_nonzero(np.abs(whole.pole.imag - omega) < reach)
        if keep.sum() >= _LINES_A_POLE * (inside + 1) + _LINES_REST or keep.all():
            return np.asarray(keep)
        reach *= 1.3


def _contribution(whole: WholeFit, index: IntArray, lines: FrfLines) -> ComplexArray:
    """Return what some poles add to the FRFs on lines, shape (n_frf, n_lines)."""
    columns = (2 * index[:, None] + np.arange(2)).ravel()
    shapes = modal_columns(lines, whole.pole[index])
    return combined(whole.fit.coefficients[:, columns], shapes)


@dataclass(frozen=True, slots=True, eq=False)
class TrialPoles:
    """What one more pole at each place would change.

    Attributes:
        log_factor: log Bayes factor of the model with it over that without, shape
            (n_shares n_places,).
        gain: chi-squared that it explains [-], same shape.
        shift: change of (Re p, Im p) of each pole of the group [rad/s], shape
            (n_shares n_places, n_poles, 2).
        variance: of (Re p, Im p) with it [rad^2/s^2], same shape.
        before: the same without it, shape (n_poles, 2).
    """

    log_factor: FloatArray
    gain: FloatArray
    shift: FloatArray
    variance: FloatArray
    before: FloatArray


def residue_scale(whole: WholeFit) -> FloatArray:
    """Return the rms of residue times frequency over the modes, shape (n_frf,).

    The receptance residue of a mode is the product of two shapes over 2 j omega.
    """
    return np.asarray(np.sqrt(np.mean(_residue_sizes(whole) ** 2, axis=1)))


def residue_shares(whole: WholeFit) -> FloatArray:
    """Return the size of each mode over the usual one [-], shape (n_modes,)."""
    scale = np.maximum(residue_scale(whole), 1e-300)[:, None]
    share = np.sqrt(np.mean((_residue_sizes(whole) / scale) ** 2, axis=0))
    return np.asarray(np.maximum(share, 1e-300))


def _residue_sizes(whole: WholeFit) -> FloatArray:
    """Return residue times frequency of each mode, shape (n_frf, n_modes)."""
    own = whole.fit.coefficients[:, : 2 * whole.n_modes]
    size = np.hypot(own[:, ::2], own[:, 1::2])
    return np.asarray(size * np.abs(whole.pole[: whole.n_modes]))


def try_poles(
    lines: FrfLines,
    variance: FloatArray,
    pole: ComplexArray,
    trials: ComplexArray,
    scale: FloatArray,
    shares: Sequence[float] = (1.0,),
) -> TrialPoles:
    """Return the evidence for one more pole at each place.

    Args:
        lines: around the places.
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        pole: that may move, at the optimum of a fit [rad/s], shape (n_poles,).
        trials: places [rad/s], shape (n_trials,).
        scale: usual size of residue times frequency, shape (n_frf,).
        shares: sizes of the residues of the trials over the usual one, one after the
            other.

    Returns:
        Log Bayes factors and changes of the poles: all places with the first share,
        then with the next.

    Source:
        Gelman et al., Bayesian Data Analysis (2013), sec. 7.4 and 14.2 (marginal
        likelihood of a linear model with a normal prior).
    """
    own, right, products = _projected(lines, pole, trials, 2.0 / variance)
    n_own = 2 * pole.size
    turn = slope_turns(own)
    across = np.swapaxes(turn, 1, 2)
    leash = _LEASH * np.repeat(measured_width(lines, pole), 2)
    gram = np.sum(across @ products[:, :n_own, :n_own] @ turn, axis=0)
    # Rounding can leave the information of a line-narrow pole below zero.
    np.fill_diagonal(gram, np.maximum(np.diag(gram), 0.0) + 1.0 / leash**2)
    force = np.einsum("fij,fi->j", turn, right[:, :n_own])
    inverse, scaling = inverses(gram), 1.0 / np.sqrt(np.diag(gram))
    unit = np.outer(scaling, scaling)
    still = inverse @ force
    volume = np.linalg.slogdet(inverse)[1]
    found = []
    for share in shares:
        size = share * np.maximum(scale, 1e-300)[:, None] / np.abs(trials)
        sums = _explained(
            across @ products[:, :n_own, n_own:],
            products[:, n_own:, n_own:],
            right[:, n_own:],
            2.0 / size**2,
        )
        rest = (gram - sums.gram) * unit + _ROUNDING * np.eye(n_own)
        # Exact data can leave nothing but rounding: such a trial is ruled out.
        sound = np.linalg.slogdet(rest)[0] > 0.0
        rest[~sound] = np.eye(n_own)
        later = np.linalg.inv(rest) * unit
        drive = force - sums.force
        moved = np.einsum("tij,tj->ti", later, drive)
        gain = sums.gain + np.einsum("ti,ti->t", drive, moved) - force @ still
        factor = gain + sums.log_volume + np.linalg.slogdet(later)[1] - volume
        factor = np.where(sound, factor, -np.inf)
        spread = np.diagonal(later, axis1=1, axis2=2)
        found.append((*_checked(0.5 * factor, moved - still, spread, leash), gain))
    log_factor, change, spread, gain = (
        np.concatenate(part) for part in zip(*found, strict=True)
    )
    shape = (log_factor.size, -1, 2)
    return TrialPoles(
        log_factor,
        np.where(np.isfinite(log_factor), gain, 0.0),
        change.reshape(shape),
        spread.reshape(shape),
        np.clip(np.diag(inverse), 0.0, leash**2).reshape(-1, 2),
    )


def _checked(
    log_factor: FloatArray, change: FloatArray, spread: FloatArray, leash: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rule out trials beyond first order, or beyond the precision of the inverse."""
    lost = np.any((spread <= 0.0) | (np.abs(change) > leash), axis=1)
    return (
        np.where(lost | ~np.isfinite(log_factor), -np.inf, log_factor),
        np.clip(change, -leash, leash),
        np.clip(spread, 0.0, leash**2),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Explained:
    """Sums over FRFs of what their residues at the trial poles explain."""

    gram: FloatArray
    force: FloatArray
    gain: FloatArray
    log_volume: FloatArray


def _explained(
    across: FloatArray, products: FloatArray, right: FloatArray, precision: FloatArray
) -> _Explained:
    """Solve for the residues of each trial in each FRF.

    Args:
        across: products of slopes and trial columns, shape (n_frf, n, 2 n_trials).
        products: among the trial columns, shape (n_frf, 2 n_trials, 2 n_trials).
        right: of the trial columns with the response, shape (n_frf, 2 n_trials).
        precision: prior of a residue, shape (n_frf, n_trials).
    """
    n_frf, n = precision.shape
    two = np.arange(2 * n).reshape(n, 2)
    own = products[:, two[:, :, None], two[:, None, :]]
    # Rounding can leave the square of a column that is explained below zero.
    first = np.maximum(own[..., 0, 0], 0.0) + precision
    second = np.maximum(own[..., 1, 1], 0.0) + precision
    mixed = own[..., 0, 1]
    volume = np.maximum(first * second - mixed**2, _ROUNDING * first * second)
    inverse = np.empty_like(own)
    inverse[..., 0, 0], inverse[..., 1, 1] = second / volume, first / volume
    inverse[..., 0, 1] = inverse[..., 1, 0] = -mixed / volume
    shared = across.reshape(n_frf, -1, n, 2).transpose(0, 2, 1, 3)
    matched = right.reshape(n_frf, n, 2)
    solved = np.einsum("ftij,ftj->fti", inverse, matched)
    return _Explained(
        np.einsum("ftab,ftbc,ftdc->tad", shared, inverse, shared, optimize=True),
        np.einsum("ftab,ftb->ta", shared, solved),
        np.einsum("fti,fti->t", matched, solved),
        np.sum(2.0 * np.log(precision) - np.log(volume), axis=0),
    )


def _projected(
    lines: FrfLines, pole: ComplexArray, trials: ComplexArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Project residues and residual terms out of slopes and trial columns.

    Returns:
        Residues, shape (n_frf, 2 n_poles); products of the other columns with the
        response, shape (n_frf, n), and among each other, shape (n_frf, n, n).
    """
    n_linear = modal_size(lines, pole)
    columns = beside(basis_and_slopes(lines, pole), modal_columns(lines, trials))
    products = gram_matrices(columns, weight)
    right = correlations(columns, weight * lines.response)
    inverse = inverses(products[:, :n_linear, :n_linear])
    part = inverse @ products[:, :n_linear, n_linear:]
    linear = right[:, :n_linear]
    solved = np.einsum("fij,fj->fi", inverse, linear)
    rest = right[:, n_linear:] - np.einsum("fij,fi->fj", part, linear)
    across = products[:, n_linear:, :n_linear]
    own = products[:, n_linear:, n_linear:] - across @ part
    return solved[:, : 2 * pole.size], rest, own
