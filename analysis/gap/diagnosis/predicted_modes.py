# SPDX-License-Identifier: MIT
"""Frequency and damping of modes at measured amplitudes, as a fit predicts them.

The force laws of an explanation are replaced by their first harmonics at the amplitude
of each link (Krylov and Bogoliubov 1947). All laws act together; the motion across each
link follows from the mode shape at that amplitude.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.law_curves_of_fit import fit_draws
from jointbench.analysis.gap.model.curve_records import PredictedCurve
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.law_loops import harmonic_loops
from jointbench.analysis.gap.response.link_modes import modes_across
from jointbench.analysis.lumped.lumped_matrices import incidence
from jointbench.analysis.lumped.lumped_model import LumpedModel


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPlace:
    """Where a mode was measured.

    Attributes:
        mode: its index in the model.
        body: index of the body of the channel.
        amplitude: of the response there, in the model's output, shape (n,).
    """

    mode: int
    body: int
    amplitude: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Bent:
    """A law at a link, by its first harmonic over amplitude.

    Attributes:
        link: index of the link.
        log_amplitude: of the motion across it, shape (n,).
        stiffness: [N/m], shape (n,).
        damping: [N s/m], shape (n,).
    """

    link: int
    log_amplitude: FloatArray
    stiffness: FloatArray
    damping: FloatArray

    def at(self, amplitude: float) -> tuple[int, float, float]:
        """Return the link, and stiffness and damping at an amplitude [m]."""
        wanted = np.log(max(amplitude, np.finfo(float).tiny))
        return (
            self.link,
            float(np.interp(wanted, self.log_amplitude, self.stiffness)),
            float(np.interp(wanted, self.log_amplitude, self.damping)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Model:
    """A model with the effects of a fit; ports: a body, and the links of its laws."""

    lumped: LumpedModel
    theta: FloatArray
    actions: list[Action]
    across: FloatArray

    def modes(
        self, added: Sequence[tuple[int, float, float]] = ()
    ) -> tuple[ComplexArray, FloatArray]:
        """Return upper poles, ascending, and the size of their shapes at the ports.

        Args:
            added: links, with the stiffness and damping that their laws add.
        """
        moved = self.theta.copy()
        for link, stiffness, damping in added:
            moved[len(self.lumped.bodies) + link] += stiffness
            moved[len(self.lumped.bodies) + len(self.lumped.links) + link] += damping
        conditions = HitConditions(np.ones(1), np.zeros(1))
        found = modes_across(self.lumped, moved, conditions, self.across, self.actions)
        poles = found.poles[..., 0].ravel()
        upper = np.flatnonzero(poles.imag > 0)
        upper = upper[np.argsort(np.abs(poles[upper]))]
        shapes = np.abs(found.shapes[..., 0])
        return poles[upper], shapes[upper]


def base_frequencies(bench: LumpedBench, fit: Fit) -> FloatArray:
    """Return the natural frequencies of a fit without force laws [Hz], ascending."""
    poles, _ = _model(bench, fit, fit.x, 0).modes()
    return np.asarray(np.abs(poles) / (2.0 * np.pi))


def predicted_curve(
    bench: LumpedBench, fit: Fit, place: MeasuredPlace
) -> PredictedCurve:
    """Return what a fit predicts for a mode over the amplitude at a channel.

    Args:
        bench: measurement and model.
        fit: an explanation, or the base.
        place: mode, channel and amplitudes.

    Returns:
        Curves at the amplitudes; the uncertainty is that of their change about their
        mean, since a constant offset does not depend on a law.

    Source:
        Krylov and Bogoliubov 1947, Introduction to Non-Linear Mechanics.
    """
    motion, frequency, damping = _at(bench, fit, fit.x, place)
    others = [_at(bench, fit, x, place) for x in fit_draws(bench, fit)]
    changes = [[_about_mean(one[k]) for one in others] for k in (1, 2)]
    sd = np.std(changes, axis=1, ddof=1)
    return PredictedCurve(motion, frequency, sd[0], damping, sd[1])


def _about_mean(values: FloatArray) -> FloatArray:
    return np.asarray(values - values.mean())


def _model(bench: LumpedBench, fit: Fit, x: FloatArray, body: int) -> _Model:
    lumped = bench.campaign.model
    actions = bench.actions(split(x, fit.n_base, fit.candidates))
    links = [a.index for a in actions if a.entry.law is not None]
    at_body = np.eye(len(lumped.bodies))[[body]]
    across = np.concatenate([at_body, incidence(lumped)[links]])
    return _Model(lumped, bench.theta(x[: fit.n_base]), actions, across)


def _at(
    bench: LumpedBench, fit: Fit, x: FloatArray, place: MeasuredPlace
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return motion across the first law's link, frequencies and damping ratios."""
    model = _model(bench, fit, x, place.body)
    poles, shapes = model.modes()
    pole, shape = poles[place.mode], shapes[place.mode]
    size = np.ones(place.amplitude.size)
    if shape.size == 1:  # no law
        return np.zeros(0), size * abs(pole) / (2 * np.pi), size * _ratio(pole)
    laws = _bent(model, pole, shape, place)
    wide = place.amplitude[[0, -1]] * np.array(
        [1.0 / DIAGNOSIS.curve_margin, DIAGNOSIS.curve_margin]
    )
    reach = _motion(model, pole, shape, wide)[1]
    motions = np.geomspace(reach[0], reach[1], DIAGNOSIS.curve_steps)
    rows = []
    for motion in motions:
        pole, shape = _pole_at(model, laws, motion, (pole, shape))
        order = int(model.lumped.output)
        response = motion * shape[0] / shape[1] * abs(pole) ** order
        rows.append((response, abs(pole) / (2 * np.pi), _ratio(pole)))
    table = np.array(rows).T
    rising = np.argsort(table[0])
    wanted, known = np.log(place.amplitude), np.log(table[0][rising])
    found = [
        PchipInterpolator(known, values[rising])(wanted)
        for values in (np.log(motions), table[1], table[2])
    ]
    return np.exp(found[0]), found[1], found[2]


def _pole_at(
    model: _Model,
    laws: Sequence[_Bent],
    motion: float,
    last: tuple[complex, FloatArray],
) -> tuple[complex, FloatArray]:
    """Return pole and shape at a motion across the first law's link [m].

    The mode is the one nearest to that at the amplitude before.
    """
    pole, shape = last
    for _ in range(DIAGNOSIS.curve_rounds if len(laws) > 1 else 1):
        motions = motion * shape[1:] / shape[1]
        added = [law.at(float(a)) for law, a in zip(laws, motions, strict=True)]
        poles, shapes = model.modes(added)
        near = int(np.argmin(np.abs(poles - pole)))
        pole, shape = complex(poles[near]), shapes[near]
    return pole, shape


def _bent(
    model: _Model, pole: complex, shape: FloatArray, place: MeasuredPlace
) -> list[_Bent]:
    """Return the laws by their first harmonics, over the range of amplitudes."""
    edges = place.amplitude[[0, -1]] * np.array(
        [1.0 / DIAGNOSIS.curve_margin, DIAGNOSIS.curve_margin]
    )
    found = []
    bent = [a for a in model.actions if a.entry.law is not None]
    for action, reach in zip(bent, _motion(model, pole, shape, edges)[1:], strict=True):
        if action.entry.law is None:
            continue
        law = action.entry.law(action.values)
        motions = np.geomspace(reach[0], reach[1], DIAGNOSIS.curve_steps)
        loops = harmonic_loops(law, motions, abs(pole))
        found.append(
            _Bent(action.index, np.log(motions), loops.stiffness, loops.damping)
        )
    return found


def _motion(
    model: _Model, pole: complex, shape: FloatArray, response: FloatArray
) -> FloatArray:
    """Return the motions at the ports of a response at the body [m].

    Shape (n_ports, n_responses).
    """
    unit = response / (shape[0] * abs(pole) ** int(model.lumped.output))
    return np.asarray(np.maximum(np.outer(shape, unit), np.finfo(float).tiny))


def _ratio(pole: complex) -> float:
    return -pole.real / abs(pole)
