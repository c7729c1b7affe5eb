# SPDX-License-Identifier: MIT
"""Result of a joint identification, for a file or a report."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.lumped.lumped_model import LumpedModel


class IdentificationVerdict(StrEnum):
    """How far the joint is determined; "cannot be determined" is a result."""

    DETERMINED = "determined"
    PARTLY = "partly determined"
    AMBIGUOUS = "several solutions"
    UNDETERMINED = "cannot be determined"
    INCONSISTENT = "does not fit"


@dataclass(frozen=True, slots=True)
class JointParameter:
    """One stiffness or damping of a link.

    Attributes:
        name: ``"<link>.stiffness"`` or ``"<link>.damping"``.
        value: of the best solution [unit]; one of many where it is not identifiable.
        sd: its standard deviation [unit]; None where it is not identifiable.
        interval: of 95 % [unit]; where it is not identifiable, the union over all
            admissible solutions. An end is None where it is open.
        unit: ``"N/m"`` or ``"N s/m"``.
        identifiable: whether the measurement determines it.
        reason: reason for none, and what to measure; empty if identifiable.
    """

    name: str
    value: float
    sd: float | None
    unit: str
    identifiable: bool
    reason: str = ""
    interval: tuple[float | None, float | None] = (None, None)


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """One distinct set of parameters that is at least locally optimal.

    Attributes:
        parameters: value [SI] by name.
        chi2: sum of squared residuals over their variances [-].
        admissible: whether the measurement does not exclude it against the best.
        natural_frequency: predicted [Hz], shape (n_modes,).
        damping_ratio: predicted [-], shape (n_modes,).
    """

    parameters: Mapping[str, float]
    chi2: float
    admissible: bool
    natural_frequency: FloatArray
    damping_ratio: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "natural_frequency", "damping_ratio")


@dataclass(frozen=True, slots=True, eq=False)
class Identification:
    """Joint parameters from measured modes.

    Attributes:
        verdict: how far the parameters are determined.
        reasons: one line for each basis of the verdict.
        parameters: stiffness and damping of every identified link.
        log_covariance: of ln parameters in their order, enlarged like their sd; large
            where undetermined; shape (n_parameters, n_parameters).
        solutions: all distinct solutions, the best first.
        measured_frequency: [Hz], shape (n_modes,).
        energy_share: part of each mode's strain energy in each link of the best
            solution [-], shape (n_modes, n_links); a small share means that the mode
            hardly determines the link.
        degrees_of_freedom: measurements minus unknowns; known masses count in both.
        model: the lumped model with the best solution's values.
    """

    verdict: IdentificationVerdict
    reasons: tuple[str, ...]
    parameters: tuple[JointParameter, ...]
    log_covariance: FloatArray
    solutions: tuple[Solution, ...]
    measured_frequency: FloatArray
    energy_share: FloatArray
    degrees_of_freedom: int
    model: LumpedModel

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "log_covariance", "measured_frequency", "energy_share")

    def parameter(self, name: str) -> JointParameter:
        """Return the parameter called `name`.

        Raises:
            KeyError: it was not identified.
        """
        return {one.name: one for one in self.parameters}[name]


def parameter_json(parameter: JointParameter) -> dict[str, Any]:
    """Return one parameter: value, sd, interval_95, unit, identifiable, reason."""
    return {
        "value": parameter.value,
        "sd": parameter.sd,
        "interval_95": list(parameter.interval),
        "unit": parameter.unit,
        "identifiable": parameter.identifiable,
        "reason": parameter.reason,
    }


def identification_json(result: Identification) -> dict[str, Any]:
    """Return an identification as plain numbers, texts, lists and mappings.

    Args:
        result: of `identify_links`.

    Returns:
        ``parameters`` {name: {value, sd, interval_95, unit, identifiable, reason}},
        ``log_covariance`` of their logarithms in the same order, ``solutions``,
        ``verdict``, ``reasons``, ``modes``; nothing in it is NaN or infinite.
    """
    best = result.solutions[0]
    return {
        "verdict": result.verdict.value,
        "reasons": list(result.reasons),
        "parameters": {one.name: parameter_json(one) for one in result.parameters},
        "log_covariance": result.log_covariance.tolist(),
        "solutions": [
            {
                "parameters": dict(one.parameters),
                "chi2": one.chi2,
                "admissible": one.admissible,
                "natural_frequency_hz": one.natural_frequency.tolist(),
                "damping_ratio": one.damping_ratio.tolist(),
            }
            for one in result.solutions
        ],
        "modes": [
            {
                "measured_hz": float(measured),
                "predicted_hz": float(predicted),
                "energy_share": dict(
                    zip((link.name for link in result.model.links), row, strict=True)
                ),
            }
            for measured, predicted, row in zip(
                result.measured_frequency,
                best.natural_frequency,
                result.energy_share.tolist(),
                strict=True,
            )
        ],
        "degrees_of_freedom": result.degrees_of_freedom,
    }
