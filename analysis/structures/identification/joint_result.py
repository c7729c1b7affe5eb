# SPDX-License-Identifier: MIT
"""Result of the identification of a structure's joints."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.lumped.identified import (
    IdentificationVerdict,
    JointParameter,
    parameter_json,
)


@dataclass(frozen=True, slots=True, eq=False)
class LikelihoodProfile:
    """Best fit as a function of one fixed parameter.

    Attributes:
        value: of the parameter [SI], shape (n_points,), ascending.
        chi2: best over all others at that value [-], shape (n_points,).
        low: lower end of the 95 % interval; None where it is open.
        high: upper end of the 95 % interval; None where it is open.
    """

    value: FloatArray
    chi2: FloatArray
    low: float | None
    high: float | None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "value", "chi2")


@dataclass(frozen=True, slots=True, eq=False)
class JointSolution:
    """A locally optimal set of parameters, or one of a continuum.

    Attributes:
        parameters: value [SI] by name.
        chi2: sum of squared, whitened residuals [-].
        admissible: whether the measurement does not exclude it against the best.
    """

    parameters: Mapping[str, float]
    chi2: float
    admissible: bool


@dataclass(frozen=True, slots=True, eq=False)
class StateFit:
    """Measured and predicted modes of one state at the best solution.

    Attributes:
        label: of the state.
        measured: frequencies [Hz]; empty if the state has only FRFs.
        predicted: of the modes paired with them [Hz], or all elastic ones.
        damping_ratio: predicted [-].
        mac: between measured and predicted shapes [-], or empty.
        energy_share: in every joint and direction [-], shape (n_modes, n_parameters).
        stiffness: of every joint and direction, known ones included [N/m]; factors of
            moduli [-]; shape (n_parameters,).
    """

    label: str
    measured: FloatArray
    predicted: FloatArray
    damping_ratio: FloatArray
    mac: FloatArray
    energy_share: FloatArray
    stiffness: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "measured", "predicted", "damping_ratio", "mac", "energy_share")
        freeze(self, "stiffness")


@dataclass(frozen=True, slots=True, eq=False)
class FullCheck:
    """The optimum, solved again with the full mesh.

    Attributes:
        label: of the state.
        reduced: elastic frequencies of the reduced model [Hz].
        full: of the full mesh [Hz], same shape.
        bound: error bound of the reduced model [Hz], same shape.
        agrees: whether the difference is within the bound.
    """

    label: str
    reduced: FloatArray
    full: FloatArray
    bound: FloatArray
    agrees: bool

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "reduced", "full", "bound")


@dataclass(frozen=True, slots=True, eq=False)
class StructureIdentification:
    """Joint parameters of a structure from measurements.

    Attributes:
        verdict: how far the parameters are determined.
        reasons: one line for each basis of the verdict.
        parameters: stiffness and damping of every identified direction.
        log_covariance: of ln parameters, shape (n_parameters, n_parameters).
        solutions: distinct ones, the best first; for undetermined parameters with the
            softest and the stiffest found.
        profiles: by name of the parameter; empty if not requested.
        states: measured and predicted modes.
        full_check: of the first state's optimum; None if not requested.
        degrees_of_freedom: rows minus unknowns.
    """

    verdict: IdentificationVerdict
    reasons: tuple[str, ...]
    parameters: tuple[JointParameter, ...]
    log_covariance: FloatArray
    solutions: tuple[JointSolution, ...]
    profiles: Mapping[str, LikelihoodProfile]
    states: tuple[StateFit, ...]
    full_check: tuple[FullCheck, ...]
    degrees_of_freedom: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "log_covariance")

    def parameter(self, name: str) -> JointParameter:
        """Return the parameter called `name`.

        Raises:
            KeyError: it was not identified.
        """
        return {one.name: one for one in self.parameters}[name]


def structure_json(
    result: StructureIdentification, names: tuple[str, ...]
) -> dict[str, Any]:
    """Return an identification as plain numbers, texts, lists and mappings.

    Args:
        result: of `identify_structure`.
        names: of the joints' directions, for the energy shares.

    Returns:
        ``parameters``, ``solutions``, ``full_check`` and more.
    """
    return {
        "verdict": result.verdict.value,
        "reasons": list(result.reasons),
        "parameters": {
            one.name: parameter_json(one) | _profile_json(result.profiles.get(one.name))
            for one in result.parameters
        },
        "log_covariance": result.log_covariance.tolist(),
        "solutions": [
            {
                "parameters": dict(one.parameters),
                "chi2": one.chi2,
                "admissible": one.admissible,
            }
            for one in result.solutions
        ],
        "states": [_state_json(one, names) for one in result.states],
        "full_check": [
            {
                "state": one.label,
                "agrees": one.agrees,
                "largest_relative_difference": float(
                    (abs(one.reduced - one.full) / one.full).max(initial=0.0)
                ),
                "full_hz": one.full.tolist(),
                "reduced_hz": one.reduced.tolist(),
                "bound_hz": one.bound.tolist(),
            }
            for one in result.full_check
        ],
        "degrees_of_freedom": result.degrees_of_freedom,
    }


def _profile_json(profile: LikelihoodProfile | None) -> dict[str, Any]:
    if profile is None:
        return {}
    return {"profile": {"value": profile.value.tolist(), "chi2": profile.chi2.tolist()}}


def _state_json(state: StateFit, names: tuple[str, ...]) -> dict[str, Any]:
    return {
        "state": state.label,
        "measured_hz": state.measured.tolist(),
        "predicted_hz": state.predicted.tolist(),
        "damping_ratio": state.damping_ratio.tolist(),
        "mac": state.mac.tolist(),
        "energy_share": [
            dict(zip(names, row, strict=True)) for row in state.energy_share.tolist()
        ],
    }
