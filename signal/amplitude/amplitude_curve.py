# SPDX-License-Identifier: MIT
"""Records: frequency and damping of a mode as functions of its amplitude."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.array_checks import (
    require_ascending,
    require_shape,
)
from jointbench.acquisition.basics.arrays import FloatArray, freeze

# Errors of the model itself that no residual shows (harmonics of the joint's force,
# shapes that turn a little), fixed before the benchmark ran: docs/decisions/0086.
FREQUENCY_FLOOR = 50e-6
DAMPING_FLOOR = 5e-3


CURVE_ARRAYS = (
    "frequency",
    "frequency_sd",
    "damping_ratio",
    "damping_sd",
    "frequency_noise_sd",
    "damping_noise_sd",
)
"""Arrays of an `AmplitudeCurve` beside its amplitude."""


class Dependence(StrEnum):
    """Whether a mode depends on its amplitude."""

    DEPENDS = "depends"
    NONE = "does not depend"
    NOT_DECIDED = "not decided"


@dataclass(frozen=True, slots=True, eq=False)
class AmplitudeCurve:
    """Frequency and damping of one mode over its amplitude.

    Attributes:
        amplitude: of the response at `channel` [`unit`], ascending, shape (n,).
        frequency: natural frequency [Hz], shape (n,).
        frequency_sd: standard uncertainty [Hz], shape (n,).
        damping_ratio: [-], shape (n,).
        damping_sd: standard uncertainty [-], shape (n,).
        channel: label of the channel in which the mode is largest.
        unit: of the amplitude.
        frequency_noise_sd: part of `frequency_sd` that white noise causes, without
            model errors: the bound of an unbiased estimator [Hz], shape (n,).
        damping_noise_sd: likewise of `damping_sd` [-], shape (n,).
    """

    amplitude: FloatArray
    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray
    channel: str
    unit: str
    frequency_noise_sd: FloatArray
    damping_noise_sd: FloatArray

    def __post_init__(self) -> None:
        """Check shapes once and make the arrays read-only."""
        require_ascending("amplitude", self.amplitude)
        for name in CURVE_ARRAYS:
            require_shape(name, getattr(self, name), self.amplitude.shape)
            freeze(self, name)
        freeze(self, "amplitude")

    def at(self, amplitude: float) -> tuple[float, float]:
        """Return frequency [Hz] and damping ratio; constant beyond the ends."""
        known, wanted = np.log(self.amplitude), np.log(amplitude)
        return (
            float(np.interp(wanted, known, self.frequency)),
            float(np.interp(wanted, known, self.damping_ratio)),
        )


@dataclass(frozen=True, slots=True)
class SoftLimit:
    """What a mode tends to at small amplitude.

    Attributes:
        frequency: [Hz].
        frequency_sd: [Hz].
        damping_ratio: [-].
        damping_sd: [-].
    """

    frequency: float
    frequency_sd: float
    damping_ratio: float
    damping_sd: float


@dataclass(frozen=True, slots=True)
class LawFit:
    """A law fitted to a curve.

    Attributes:
        name: of the law.
        exponent: of amplitude in the change of frequency and damping [-].
        exponent_sd: standard uncertainty; 0 where the law fixes it.
        chi2: squares of what the law leaves of the curve, over its covariance.
        criterion: chi2 + ln(points) x parameters; the least is the best.
    """

    name: str
    exponent: float
    exponent_sd: float
    chi2: float
    criterion: float


@dataclass(frozen=True, slots=True, eq=False)
class AmplitudeMode:
    """One mode and what its amplitude does to it.

    Attributes:
        dependence: the outcome of the test.
        reason: of the outcome, one line.
        curve: f(a) and zeta(a); None where the fit does not carry one.
        soft: the limit at small amplitude.
        significance: chance that a linear mode shows as much in white noise [-].
        residual_ratio: rms residual over noise with the curve [-].
        linear_residual_ratio: the same without dependence on amplitude [-].
        frequency_change: from soft to hard, over the frequency [-].
        frequency_change_sd: its standard uncertainty [-].
        damping_change: of the damping ratio from soft to hard [-].
        damping_change_sd: its standard uncertainty [-].
        family: of laws, by the ratio of the two changes; empty where not decided.
        ratio: d zeta / (-df / f) [-], nan where df is not resolved.
        laws: fitted to the curve, best first.
        replaces: frequencies of the linear poles that this mode stands for [Hz].
    """

    dependence: Dependence
    reason: str
    curve: AmplitudeCurve | None
    soft: SoftLimit
    significance: float
    residual_ratio: float
    linear_residual_ratio: float
    frequency_change: float = 0.0
    frequency_change_sd: float = 0.0
    damping_change: float = 0.0
    damping_change_sd: float = 0.0
    family: str = ""
    ratio: float = float("nan")
    laws: tuple[LawFit, ...] = ()
    replaces: tuple[float, ...] = ()

    def words(self) -> str:
        """Return one line: the outcome, and what changes by how much."""
        if self.dependence is not Dependence.DEPENDS or self.curve is None:
            return f"{self.dependence.value}: {self.reason}"
        low, high = self.curve.amplitude[[0, -1]]
        first, last = self.curve.damping_ratio[[0, -1]]
        law = f", {self.family}" if self.family else ""
        return (
            f"depends on amplitude: frequency {100 * self.frequency_change:+.2g} % "
            f"from {low:.2g} to {high:.2g} {self.curve.unit}, damping ratio "
            f"{100 * first:.3g} to {100 * last:.3g} %{law}"
        )
