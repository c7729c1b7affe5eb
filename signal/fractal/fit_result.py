# SPDX-License-Identifier: MIT
"""Build the record that the station reports from a fit and its judgement."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import Step, step
from jointbench.signal.fractal.fit_judgement import Judgement
from jointbench.signal.fractal.model_choice import Choice
from jointbench.signal.fractal.self_affine import InstrumentModel
from jointbench.signal.fractal.verdict_records import (
    NORMAL_97_5,
    FittedCurve,
    FractalFit,
    InstrumentParameter,
    LocalSlope,
    Scaling,
    SurfaceVerdict,
)
from jointbench.signal.surface.structure_constant import ConstantForm, log_roughness
from jointbench.signal.surface.structure_function import StructureFunction


def rejected_fit(
    estimate: StructureFunction, judgement: Judgement, slope: LocalSlope
) -> FractalFit:
    """Return the record of a surface without a scaling range."""
    return FractalFit(
        verdict=judgement.verdict,
        reason=judgement.reason,
        scaling=None,
        fit_band=None,
        chi2_per_dof=None,
        instrument=InstrumentModel.NONE.value,
        instrument_parameters=(),
        local_slope=slope,
        curve=None,
        provenance=(*estimate.provenance, _note(judgement)),
    )


def accepted_fit(
    choice: Choice,
    judgement: Judgement,
    slope: LocalSlope,
    *,
    gamma: float,
    constant: ConstantForm,
) -> FractalFit:
    """Return the record of an accepted fit.

    A surface that the instrument masks keeps curve and instrument, but has no
    dimension.
    """
    fit, problem = choice.fit, choice.problem
    spacing = problem.estimate.spacing
    plain = rejected_fit(problem.estimate, judgement, slope)
    described = replace(
        plain,
        chi2_per_dof=fit.chi2 / fit.dof,
        instrument=fit.model.instrument.value,
        instrument_parameters=_instrument(choice),
        curve=FittedCurve(
            lag=problem.estimate.lag,
            value=fit.predicted,
            surface=fit.seen.surface(fit.lag),
        ),
    )
    band = choice.band
    if judgement.verdict is SurfaceVerdict.INSTRUMENT or band is None:
        return described
    return replace(
        described,
        scaling=_scaling(choice, gamma, constant),
        fit_band=(band[0] * spacing, band[1] * spacing),
    )


def _note(judgement: Judgement) -> Step:
    """Return the provenance of a judgement."""
    return step("fit_fractal", verdict=judgement.verdict.value, reason=judgement.reason)


def _instrument(choice: Choice) -> tuple[InstrumentParameter, ...]:
    """Return the instrument's fitted numbers in metres."""
    fit, problem = choice.fit, choice.problem
    deviation = np.sqrt(np.diag(fit.covariance))[2:].tolist()
    found = []
    if fit.model.instrument.has_noise:
        # The fit gives the variance; the relative sd of a standard deviation is half of
        # that. Without noise only the size that would have been detected is known.
        scale = float(np.sqrt(0.5 * problem.estimate.value.min()))
        share, share_sd = float(fit.parameters[2]), float(deviation.pop(0))
        size = np.sqrt(max(share, share_sd))
        noise = scale * float(np.sqrt(share))
        found.append(InstrumentParameter("noise", noise, scale * share_sd / (2 * size)))
    if fit.model.instrument.has_psf:
        spacing = problem.estimate.spacing
        width, width_sd = spacing * fit.seen.psf_width, spacing * deviation.pop(0)
        found.append(InstrumentParameter("point_spread", width, width_sd))
    return tuple(found)


def _scaling(choice: Choice, gamma: float, constant: ConstantForm) -> Scaling:
    """Return D and S at the best pivot of the fit, and the resulting G."""
    fit, problem = choice.fit, choice.problem
    # (s, ln S at pivot) -> (D, ln S at pivot): D = 2 - s / 2.
    turn = np.diag([-0.5, 1.0])
    covariance = turn @ choice.covariance @ turn
    dimension, level = choice.dimension, float(choice.law[1])
    shift = _shift(covariance, fit.pivot, fit.lag)
    move = np.array([[1.0, 0.0], [-2 * shift, 1.0]])
    covariance = move @ covariance @ move.T
    level += (4 - 2 * dimension) * shift
    pivot = fit.pivot * float(np.exp(shift)) * problem.estimate.spacing

    def log_g(d: float, value: float) -> float:
        """Return ln G."""
        return log_roughness(d, value, pivot, gamma=gamma, constant=constant)

    step_d = 1e-5 * min(dimension - 1, 2 - dimension)
    slope = log_g(dimension + step_d, level) - log_g(dimension - step_d, level)
    gradient = np.array([slope / (2 * step_d), 1 / (2 * (dimension - 1))])
    centre = log_g(dimension, level)
    reach = NORMAL_97_5 * float(np.sqrt(gradient @ covariance @ gradient))
    return Scaling(
        dimension=dimension,
        dimension_sd=float(np.sqrt(covariance[0, 0])),
        pivot=pivot,
        pivot_value=float(np.exp(level)),
        covariance=covariance,
        roughness=float(np.exp(centre)),
        roughness_interval=(
            float(np.exp(centre - reach)),
            float(np.exp(centre + reach)),
        ),
    )


def _shift(covariance: FloatArray, pivot: float, lag: FloatArray) -> float:
    """Return the shift of ln pivot, within the fit, that decouples D and S."""
    best = covariance[0, 1] / (2 * covariance[0, 0])
    return float(np.clip(best, np.log(lag[0] / pivot), np.log(lag[-1] / pivot)))
