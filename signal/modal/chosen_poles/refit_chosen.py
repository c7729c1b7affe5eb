# SPDX-License-Identifier: MIT
"""Modes of poles that a person chose: refined with covariance, none dropped.

The automatic selection asks many questions: which poles are needed, what stands beyond
the band, what is missing. A person who chooses has answered them. What is left is one
refinement on the weights of the automatic fit, which a second is enough for.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    freeze,
)
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.provenance import Step
from jointbench.signal.frf.frf import Frf
from jointbench.signal.modal.chosen_poles.frf_parts import (
    force_noise_of,
    missed_share,
    scatter_of,
    synthesis_of,
)
from jointbench.signal.modal.computational_modes import find_beyond
from jointbench.signal.modal.frf_lines import FrfLines, lines_of, measured_width
from jointbench.signal.modal.line_noise import line_noise, residual_around
from jointbench.signal.modal.modal_model import ModalModel, build_model
from jointbench.signal.modal.mode_selection import FittedModes
from jointbench.signal.modal.mode_significance import significance
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, refine_poles
from jointbench.signal.modal.residual_search.doubtful_neighbours import (
    DoubtfulNeighbours,
)
from jointbench.signal.modal.residual_search.local_fit import WholeFit
from jointbench.signal.modal.shared_errors import (
    ForceNoise,
    force_covariance,
    shared_covariance,
)
from jointbench.signal.modal.stabilisation import PoleCandidate

# Two poles of a model closer than this share of a half-power half-width are one root.
_ONE_ROOT = 0.02
_STEPS = 15


@dataclass(frozen=True, slots=True, eq=False)
class FitBasis:
    """What every fit of chosen poles on one FRF shares.

    Attributes:
        frf: measured.
        keep: lines of the fit, shape (n_lines,).
        lines: these lines.
        noise: noise variance of them, shape (n_frf, n_kept).
        variance: noise and model error of the automatic fit, same shape.
        beyond: computational poles beyond the band [rad/s], shape (n,).
        automatic: poles of the automatic selection [rad/s], shape (n_modes,).
        force: noise of the force at each reference.
    """

    frf: Frf
    keep: BoolArray
    lines: FrfLines
    noise: FloatArray
    variance: FloatArray
    beyond: ComplexArray
    automatic: ComplexArray
    force: ForceNoise

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "keep", "noise", "variance", "beyond", "automatic")


@dataclass(frozen=True, slots=True, eq=False)
class ChosenFit:
    """A fit of chosen poles.

    Attributes:
        model: the modes, by ascending frequency.
        synthesis: FRF of the model on the lines of the band.
        synthesis_error: rms over all pairs of measured less synthesised FRF, as a share
            of the rms of the FRF on that line [-], shape (n_kept,).
    """

    model: ModalModel
    synthesis: Frf
    synthesis_error: FloatArray


@one_thread()
def fit_basis(frf: Frf, model: ModalModel, synthesis: Frf) -> FitBasis:
    """Return what fits of chosen poles share, from the automatic fit of an FRF.

    Args:
        frf: that was fitted.
        model: the automatic modes.
        synthesis: of them, on the lines of the fit, with the variance of each.
    """
    keep = np.isin(frf.frequency, synthesis.frequency)
    lines = lines_of(frf, keep)
    assert synthesis.variance is not None
    variance = np.array(synthesis.variance).reshape(lines.response.shape)
    poles = _apart(lines, model.poles)
    found = refine_poles(lines, poles, variance, steps=_STEPS)
    noise = line_noise(lines.response, scatter_of(frf, keep), found.residual)
    whole = WholeFit(lines, found.pole, poles.size, found.fit, noise, variance)
    beyond = find_beyond(whole)
    force = force_noise_of(frf, keep)
    return FitBasis(frf, keep, lines, noise, variance, beyond, poles, force)


@one_thread()
def refit_chosen(
    basis: FitBasis,
    chosen: Sequence[PoleCandidate],
    pinned: BoolArray,
    steps: Sequence[Step] = (),
) -> ChosenFit:
    """Refine chosen poles on the FRF and fit their residues.

    A pinned pole keeps its frequency and damping; its standard uncertainty is its
    scatter over the orders.

    Args:
        basis: of the FRF.
        chosen: one a mode; may be none.
        pinned: which keep frequency and damping, shape (n_chosen,).
        steps: how they were chosen, for the provenance of the model.

    Returns:
        The model with its synthesis.
    """
    frf, provenance = basis.frf, (*basis.frf.provenance, *steps)
    if not chosen:
        return _nothing(basis, provenance)
    start = np.array([c.pole for c in chosen], complex)
    poles = refine_poles(
        basis.lines,
        start,
        basis.variance,
        beyond=basis.beyond,
        doubt=np.where(pinned, np.inf, 1.0),
        steps=_STEPS,
    )
    fitted = _fitted(basis, start, poles)
    return ChosenFit(
        build_model(frf, fitted, chosen, provenance),
        synthesis_of(frf, basis.keep, fitted),
        missed_share(basis.lines, fitted),
    )


def _fitted(basis: FitBasis, start: ComplexArray, poles: RefinedPoles) -> FittedModes:
    """Return a refinement as the modes of a fit, with all its evidence."""
    lines, count, force = basis.lines, start.size, basis.force
    variance, none = basis.variance, np.zeros((count, 2, 2))
    return FittedModes(
        chosen=np.arange(count),
        candidates=start,
        poles=poles,
        fit=poles.fit.of_modes(count),
        variance=variance,
        significance=significance(
            lines, poles.residual, poles.pole, basis.noise, poles.beyond
        ),
        model_error=0.0,
        residual_ratio=residual_around(lines, poles.pole, poles.residual, basis.noise),
        shared=shared_covariance(
            lines, poles, poles.fit, variance, force.relative.shape[0]
        ),
        forced=none
        if force.width <= 0.0
        else force_covariance(lines, poles, poles.fit, variance, force),
        doubts=DoubtfulNeighbours(np.empty(0), none, np.empty(0)),
    )


def _nothing(basis: FitBasis, provenance: tuple[Step, ...]) -> ChosenFit:
    """Return the fit of no pole: nothing is synthesised."""
    frf, empty = basis.frf, np.empty(0)
    outputs, inputs = len(frf.outputs), len(frf.inputs)
    residues = np.empty((0, outputs, inputs), complex)
    shapes, sides = np.empty((0, outputs), complex), np.empty((0, inputs), complex)
    model = ModalModel(
        natural_frequency=empty,
        frequency_sd=empty.copy(),
        damping_ratio=empty.copy(),
        damping_ratio_sd=empty.copy(),
        residues=residues,
        residues_sd=residues.copy(),
        shapes=shapes,
        shapes_sd=shapes.copy(),
        participation=sides,
        significance=empty.copy(),
        residual_ratio=empty.copy(),
        stable_orders=np.empty(0, np.int64),
        by_hand=np.empty(0, bool),
        outputs=frf.outputs,
        inputs=frf.inputs,
        provenance=provenance,
    )
    kept = frf.response[:, :, basis.keep]
    synthesis = replace(
        frf,
        frequency=frf.frequency[basis.keep],
        response=np.zeros_like(kept),
        coherence=None,
        innovation_noise=None,
        force_noise=None,
        variance=basis.variance.reshape(kept.shape),
    )
    return ChosenFit(model, synthesis, np.ones(kept.shape[2]))


def _apart(lines: FrfLines, pole: ComplexArray) -> ComplexArray:
    """Return poles with every root once: a pair of repeated roots is one here."""
    width = measured_width(lines, pole)
    kept: list[int] = []
    for number in np.argsort(np.abs(pole)):
        near = _ONE_ROOT * width[number]
        if all(abs(pole[number] - pole[one]) > near for one in kept):
            kept.append(int(number))
    return np.asarray(pole[kept])
