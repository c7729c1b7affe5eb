# SPDX-License-Identifier: MIT
"""Evidence for one more pole at given places, to first order.

Whether the FRF holds one more mode is asked at many places. A refinement at each would
cost too much, and the best of them alone is no answer where several are admissible. To
first order the answer has a closed form: residues of the trial pole are normal with the
size of those found, the modes around move linearly, and the marginal likelihood with
the trial over that without is a Bayes factor. It weighs what the trial explains against
what its residues could have explained by chance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.local_fit import WholeFit
from jointbench.signal.modal.lsfd import modal_basis, modal_columns, modal_size
from jointbench.signal.modal.normal_equations import (
    correlations,
    gram_matrices,
    inverses,
)
from jointbench.signal.modal.refined_pole_covariance import pole_slopes, slope_turns

# Sd of (Re p, Im p) without data, in half-power half-widths, as in a refinement.
_LEASH = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Trials:
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
    own = whole.fit.coefficients[:, : 2 * whole.n_modes]
    size = np.hypot(own[:, ::2], own[:, 1::2]) * np.abs(whole.pole[: whole.n_modes])
    return np.asarray(np.sqrt(np.mean(size**2, axis=1)))


def try_poles(
    lines: FrfLines,
    variance: FloatArray,
    pole: ComplexArray,
    trials: ComplexArray,
    scale: FloatArray,
    shares: Sequence[float] = (1.0,),
) -> Trials:
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
    gram += np.diag(1.0 / leash**2)
    force = np.einsum("fij,fi->j", turn, right[:, :n_own])
    inverse = inverses(gram)
    still = inverse @ force
    volume = np.linalg.slogdet(inverse)[1]
    found = []
    for share in shares:
        sums = _Sums(trials.size, n_own)
        for number in range(variance.shape[0]):
            size = share * np.maximum(scale[number], 1e-300) / np.abs(trials)
            sums.add(
                across[number] @ products[number, :n_own, n_own:],
                products[number, n_own:, n_own:],
                right[number, n_own:],
                2.0 / size**2,
            )
        later = inverses(gram - sums.gram)
        pull = force - sums.force
        moved = np.einsum("tij,tj->ti", later, pull)
        gain = sums.gain + np.einsum("ti,ti->t", pull, moved) - force @ still
        factor = gain + sums.log_volume + np.linalg.slogdet(later)[1] - volume
        spread = np.diagonal(later, axis1=1, axis2=2)
        found.append((*_checked(0.5 * factor, moved - still, spread, leash), gain))
    log_factor, change, spread, gain = (
        np.concatenate(part) for part in zip(*found, strict=True)
    )
    shape = (log_factor.size, -1, 2)
    return Trials(
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


class _Sums:
    """Sums over FRFs of what their residues at the trial poles explain."""

    __slots__ = ("force", "gain", "gram", "log_volume")

    def __init__(self, n_trials: int, n_own: int) -> None:
        self.gram = np.zeros((n_trials, n_own, n_own))
        self.force = np.zeros((n_trials, n_own))
        self.gain = np.zeros(n_trials)
        self.log_volume = np.zeros(n_trials)

    def add(
        self,
        across: FloatArray,
        products: FloatArray,
        right: FloatArray,
        precision: FloatArray,
    ) -> None:
        """Add one FRF: products with the slopes and among the trial's own columns."""
        n = precision.size
        two = np.arange(2 * n).reshape(n, 2)
        own = products[two[:, :, None], two[:, None, :]]
        own = own + precision[:, None, None] * np.eye(2)
        inverse = np.linalg.inv(own)
        shared = across[:, two].transpose(1, 0, 2)
        explained = np.einsum("tij,tj->ti", inverse, right[two])
        self.gram += shared @ inverse @ shared.transpose(0, 2, 1)
        self.force += np.einsum("tij,tj->ti", shared, explained)
        self.gain += np.einsum("ti,ti->t", right[two], explained)
        self.log_volume += 2.0 * np.log(precision) - np.linalg.slogdet(own)[1]


def _projected(
    lines: FrfLines, pole: ComplexArray, trials: ComplexArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Project residues and residual terms out of slopes and trial columns.

    Returns:
        Residues, shape (n_frf, 2 n_poles); products of the other columns with the
        response, shape (n_frf, n), and among each other, shape (n_frf, n, n).
    """
    n_linear = modal_size(pole)
    columns = np.hstack(
        (
            modal_basis(lines, pole),
            pole_slopes(lines, pole),
            modal_columns(lines, trials),
        )
    )
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
