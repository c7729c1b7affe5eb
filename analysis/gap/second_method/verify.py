# SPDX-License-Identifier: MIT
"""Verify predicted responses by a second route that shares no step with the first.

The first route (`predict_records`) works with transfer functions on a
line in the Laplace plane and a compiled time integration of the link force; the second
puts up the equations of motion and passes them to `scipy.integrate.solve_ivp`. Where
both agree to a small part of the noise, a gap between model and measurement is none of
the solver's.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.model.campaign import TAIL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.excitation import Excitation
from jointbench.analysis.gap.response.predict_records import respond
from jointbench.analysis.gap.second_method.channels import (
    anti_alias,
    through_channels,
    through_converter,
)
from jointbench.analysis.gap.second_method.motion import integrate_motion
from jointbench.analysis.gap.second_method.second_method_settings import (
    SECOND_METHOD,
)
from jointbench.analysis.gap.second_method.system import make_system
from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """How far the two routes are apart, the last samples left out.

    Attributes:
        over_peak: largest difference over the largest response of the channel in
            the record [-], shape (n_records, n_channels).
        over_noise: RMS difference over the noise [-], same shape; None where no
            noise was given.
        chi2: sum of the squared differences over the noise [-]; None likewise.
    """

    over_peak: FloatArray
    over_noise: FloatArray | None = None
    chi2: float | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "over_peak")
        if self.over_noise is not None:
            freeze(self, "over_noise")


def second_response(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action] = (),
    *,
    measured: FloatArray | None = None,
    tolerance: float = SECOND_METHOD.state_tolerance,
    points: int = SECOND_METHOD.force_points,
) -> FloatArray:
    """Predict the channels by the second route; arguments as those of `respond`.

    Args:
        model: bodies, links, channels.
        theta: base parameters [SI], shape (n_base,).
        excitation: prepared forces.
        actions: effects switched on.
        measured: from which hum takes its phase, shape as the result.
        tolerance: local error over the size of the state [-].
        points: per sample, a multiple of `force_points`; more where a force jumps.

    Returns:
        Response in the model's output, shape (n_records, n_channels, n_samples).

    Raises:
        UsageError: an effect of the catalogue has no second route.
        BadData: the integrator gave up, as it does where a law runs away.
    """
    bent = [a for a in actions if a.entry.law is not None]
    straight = [a for a in actions if a.entry.law is None]
    every = points // SECOND_METHOD.force_points
    linear = _fine(model, theta, excitation, straight, tolerance, points)
    fine = linear[..., ::every]
    if bent:
        whole = _fine(model, theta, excitation, actions, tolerance, points)
        bend = anti_alias(whole - linear, excitation, points)
        fine = fine + bend[..., ::every]
    fine = through_channels(fine, actions, excitation.sample_rate)
    step = SECOND_METHOD.force_points
    samples = fine[..., : excitation.growth.size * step : step]
    return through_converter(samples, actions, excitation.sample_rate, measured)


def _fine(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action],
    tolerance: float,
    points: int = SECOND_METHOD.force_points,
) -> FloatArray:
    """Return what the bodies under the channels do, between the samples as well."""
    system = make_system(model, theta, excitation, actions)
    motion = integrate_motion(
        system,
        excitation,
        beyond=SECOND_METHOD.samples_beyond,
        tolerance=tolerance,
        points=points,
    )
    rows = [model.index(channel.body) for channel in model.channels]
    return np.asarray(motion.derivatives[int(model.output)][:, rows])


def verify_response(
    model: LumpedModel,
    theta: FloatArray,
    excitation: Excitation,
    actions: Sequence[Action] = (),
    *,
    measured: FloatArray | None = None,
    sigma: FloatArray | None = None,
    oversampling: int = 8,
    tolerance: float = SECOND_METHOD.state_tolerance,
) -> Verification:
    """Compare the two routes.

    Args:
        model: bodies, links, channels.
        theta: base parameters [SI], shape (n_base,).
        excitation: prepared forces.
        actions: effects switched on.
        measured: from which hum takes its phase, shape as a response.
        sigma: noise of the records [unit of the channel], shape (n_records,
            n_channels); None to compare with the peak alone.
        oversampling: of the first route.
        tolerance: of the second route [-].

    Returns:
        The differences.

    Raises:
        UsageError: an effect of the catalogue has no second route.
        BadData: the integrator gave up.
    """
    first = respond(
        model, theta, excitation, actions, oversampling=oversampling, measured=measured
    )
    second = second_response(
        model, theta, excitation, actions, measured=measured, tolerance=tolerance
    )
    apart = np.abs(first - second)[..., :-TAIL]
    peak = np.abs(second).max(axis=-1)
    over_peak = apart.max(axis=-1) / np.where(peak > 0.0, peak, 1.0)
    if sigma is None:
        return Verification(over_peak)
    scaled = apart / sigma[:, :, None]
    return Verification(
        over_peak, np.sqrt(np.mean(scaled**2, axis=-1)), float(np.sum(scaled**2))
    )


def verify_fit(
    bench: LumpedBench, fit: Fit, *, tolerance: float = SECOND_METHOD.state_tolerance
) -> Verification:
    """Compare the two routes at a fit, over the noise of its bench.

    Args:
        bench: the measurement, with its noise estimated.
        fit: base and effects, for example the winner of a diagnosis.
        tolerance: of the second route [-].

    Returns:
        The differences, `over_noise` among them.

    Raises:
        UsageError: an effect of the catalogue has no second route.
        BadData: the integrator gave up.
    """
    campaign = bench.campaign
    return verify_response(
        campaign.model,
        bench.theta(fit.base),
        bench.excitation,
        bench.actions(fit.terms),
        measured=campaign.response,
        sigma=bench.noise.sigma,
        tolerance=tolerance,
    )
