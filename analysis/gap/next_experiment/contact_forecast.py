# SPDX-License-Identifier: MIT
"""What the explanations of a joint expect of a series of torques, and the best one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.design.expected_gain import Forecast, expected_gain
from jointbench.analysis.design.information import forecast_covariance, information_of
from jointbench.analysis.gap.contact_bench.contact_bench import (
    ContactBench,
    make_contact_bench,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.next_experiment.contact_series import (
    TorqueSeries,
    torque_series,
    with_series,
)
from jointbench.analysis.gap.next_experiment.next_settings import NEXT
from jointbench.analysis.gap.next_experiment.ranked_experiment import (
    RankedExperiment,
    ranked,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.search.jacobian import jacobian_of
from jointbench.analysis.gap.search.selection_round import score


def rank_series(
    bench: ContactBench, fits: Sequence[Fit], *, accepted: bool
) -> tuple[RankedExperiment, ...]:
    """Return candidate series by expected gain of probability per hour.

    Args:
        bench: of the fits.
        fits: explanations that survive; of an unknown verdict the best refused ones.
        accepted: False for refused ones, whose forecasts have a free discrepancy.
    """
    kept = list(fits)[: NEXT.most_explanations]
    if len(kept) < 2:
        return ()
    found = []
    for index, series in enumerate(torque_series(bench.data.states)):
        forecasts = forecasts_of(bench, kept, series, accepted=accepted)
        if len(forecasts) < 2:
            continue
        gain = expected_gain(forecasts, bench.policy.rival_score, draws=NEXT.draws)
        found.append(
            RankedExperiment(series.name, series.words, series.minutes, gain, index)
        )
    return ranked(found)


def forecasts_of(
    bench: ContactBench, fits: Sequence[Fit], series: TorqueSeries, *, accepted: bool
) -> list[Forecast]:
    """Return what every explanation expects of a series.

    One by which the series leaves the joint open (a prevailing torque above those of
    the series) has no stiffness to forecast and is left out.

    Args:
        bench: of the fits.
        fits: explanations.
        series: to be measured.
        accepted: False to add a free offset and slope over ln P to each.
    """
    data, fresh = with_series(bench.data, series)
    wider = _extended(bench, data)
    found = [_forecast(bench, wider, fit, fresh, accepted=accepted) for fit in fits]
    return [f for f in found if np.all(np.isfinite(f.covariance))]


def _extended(bench: ContactBench, data: JointData) -> ContactBench:
    """Return the bench with further states, in the coordinates of the old one."""
    made = make_contact_bench(data, bench.law.law, policy=bench.policy)
    return replace(
        made,
        entries={**made.entries, **bench.entries},
        law=bench.law,
        scales=bench.scales,
        nominal=replace(made.nominal, law=bench.law, middle=bench.nominal.middle),
    )


def _forecast(
    bench: ContactBench,
    wider: ContactBench,
    fit: Fit,
    fresh: BoolArray,
    *,
    accepted: bool,
) -> Forecast:
    """Return mean and covariance of the new logarithms."""
    base = np.zeros(len(wider.layout.names))
    place = {name: k for k, name in enumerate(wider.layout.names)}
    for name, value in zip(bench.layout.names, fit.base, strict=True):
        base[place[name]] = value
    x = np.concatenate([base, fit.x[fit.n_base :]])
    old = make_problem(wider.chosen(~fresh), fit.candidates)
    slopes = _slopes(old, x)
    known = information_of(slopes) + np.diag(old.prior)
    ahead = wider.plain(fresh)
    new = make_problem(ahead, fit.candidates)
    slopes = _slopes(new, x)
    spread = forecast_covariance(slopes, known)
    spread += CONTACT.model_sd**2 * np.eye(len(spread))
    mean = ahead.predict(x[: base.size], split(x, base.size, fit.candidates))
    rows = wider.data.rows
    spread += rows.covariance[np.ix_(fresh, fresh)]
    if not accepted:
        spread += _discrepancy(bench, wider, fit, fresh)
    return Forecast(score(bench, fit), mean, spread)


def _slopes(problem: FitProblem, x: FloatArray) -> FloatArray:
    """Return the Jacobian at x, shape (n_rows, n)."""
    found = jacobian_of(problem, x, problem.residual(x, FULL), FULL)
    return np.asarray(found, dtype=np.float64)


def _discrepancy(
    bench: ContactBench, wider: ContactBench, fit: Fit, fresh: BoolArray
) -> FloatArray:
    """Return the covariance of what a refused fit leaves: offset and slope over ln P.

    Its size is that of the residual beyond the scatter.
    """
    excess = max(fit.chi2 / max(bench.blocks.dof, 1) - 1.0, 0.0)
    own = float(np.median(np.diag(bench.data.rows.covariance)))
    log_p = wider.nominal.log_preload
    wide = max(float(np.ptp(bench.nominal.log_preload)), 1e-6)
    x = (log_p - bench.nominal.middle) / (0.5 * wide)
    place = x[wider.data.rows.state[fresh]]
    found: FloatArray = excess * own * (1.0 + np.multiply.outer(place, place))
    return found
