# SPDX-License-Identifier: MIT
"""What else could explain the modes or FRFs of one state of a structure."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.stiffness_problem import Prior
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    bodies_on_springs,
    modulus_name,
    with_moduli,
    with_support_factor,
)
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

# A mode that is none of the structure: damping ratios over this range, evenly in ln.
_CHANCE_DAMPING = (1e-4, 0.2)
# Frequencies of such modes at least over this range in ln: an octave.
_LEAST_RANGE = float(np.log(2.0))


class HypothesisKind(StrEnum):
    """What a hypothesis changes in the measurement or in the model."""

    AS_MEASURED = "as measured"
    MISSING = "one mode missing"
    SPURIOUS = "one mode spurious"
    SWAPPED = "two modes swapped"
    MODULUS = "modulus off"
    SUPPORT = "support off"


@dataclass(frozen=True, slots=True)
class HypothesisSettings:
    """How hypotheses are tried and priced.

    Attributes:
        starts: points where the search of each begins, beside the solution as measured:
            those of the survey that fit it best.
        surveyed: points of the box whose frequencies are computed once for all.
        seed: of these points.
        prior: probability of each kind before the measurement, shared among its cases;
            the rest is that of the modes as measured.
        modulus_sd: of ln of a modulus that is off [-].
        support_sd: of ln of the stiffness of a support that is off [-].
        survives: least probability of a hypothesis that survives [-].
        largest_noise: the stated standard deviations may be too small by up to this
            factor [-].
    """

    starts: int = 4
    surveyed: int = 200
    seed: int = 0
    prior: Mapping[HypothesisKind, float] | None = None
    modulus_sd: float = 0.1
    support_sd: float = 1.0
    survives: float = 0.01
    largest_noise: float = 5.0

    def of_kind(self, kind: HypothesisKind) -> float:
        """Return the probability of a kind before the measurement [-]."""
        return (self.prior or _PRIOR)[kind]


_PRIOR = {
    HypothesisKind.AS_MEASURED: 0.60,
    HypothesisKind.MISSING: 0.12,
    HypothesisKind.SPURIOUS: 0.06,
    HypothesisKind.SWAPPED: 0.04,
    HypothesisKind.MODULUS: 0.09,
    HypothesisKind.SUPPORT: 0.09,
}


@dataclass(frozen=True, slots=True, eq=False)
class StructureHypothesis:
    """One way to read a measurement.

    Attributes:
        kind: what it changes.
        prior: probability before the measurement [-].
        model: the reduced structure, with the parameter that is freed.
        evidence: the measurement, with its pairing or without a mode.
        priors: of the freed parameters.
        chance: ln density of the mode left out as one that is none of the structure,
            over that of its own noise [-]; 0 where none is left out.
        modes: numbers of the measured or, for a missing one, of the predicted mode that
            it is about, from 0.
        freed: name of the parameter that is freed; empty if none is.
        left_out: frequency of the measured mode that is left out [Hz]; 0 if none is.
    """

    kind: HypothesisKind
    prior: float
    model: ReducedModel
    evidence: StructureEvidence
    priors: Mapping[str, Prior]
    chance: float = 0.0
    modes: tuple[int, ...] = ()
    freed: str = ""
    left_out: float = 0.0


def hypotheses_of(
    model: ReducedModel,
    evidence: StructureEvidence,
    paired: IntArray,
    priors: Mapping[str, Prior],
    settings: HypothesisSettings,
    structure: Structure | None = None,
    predicted: int | None = None,
) -> tuple[StructureHypothesis, ...]:
    """List the hypotheses about one state, the modes as measured first.

    Args:
        model: the reduced structure.
        evidence: of the state.
        paired: elastic predicted mode of each measured one in the solution as
            measured, from 0, shape (n_modes,); empty without modes.
        priors: of the identification.
        settings: prior probabilities and ranges.
        structure: on its meshes, for its supports; None leaves those out.
        predicted: number of elastic modes of the model; None for one more than measured
            at least.

    Returns:
        One mode missing below each measured one, each one spurious, each two
        neighbours swapped (where damping or shapes were measured: with frequencies
        alone, ascending order is the best pairing), the modulus of each body and the
        springs of each body's supports off, unless they are unknown already.
    """
    base = StructureHypothesis(
        HypothesisKind.AS_MEASURED,
        settings.of_kind(HypothesisKind.AS_MEASURED),
        model,
        evidence,
        priors,
    )
    cases = [
        *_missing(base, paired, predicted),
        *_spurious(base),
        *_swapped(base, paired),
        *_moduli(base, settings),
        *_supports(base, settings, structure),
    ]
    count: dict[HypothesisKind, int] = {}
    for one in cases:
        count[one.kind] = count.get(one.kind, 0) + 1
    shared = [
        replace(one, prior=settings.of_kind(one.kind) / count[one.kind])
        for one in cases
    ]
    return (base, *shared)


def _missing(
    base: StructureHypothesis, paired: IntArray, predicted: int | None
) -> list[StructureHypothesis]:
    """Leave out one predicted mode below the highest one, in order of frequency.

    Where the model predicts no more modes than were measured, none can be missing.
    """
    if predicted is not None and predicted <= paired.size:
        return []
    found = []
    for skipped in range(paired.size):
        order = np.arange(paired.size) + (np.arange(paired.size) >= skipped)
        if not np.array_equal(order, paired):
            found.append(_paired(base, HypothesisKind.MISSING, order, (skipped,)))
    return found


def _swapped(base: StructureHypothesis, paired: IntArray) -> list[StructureHypothesis]:
    modes = base.evidence.modes
    if modes is None or (modes.damping_ratio is None and modes.shapes is None):
        return []
    found = []
    for at in range(paired.size - 1):
        order = paired.copy()
        order[[at, at + 1]] = order[[at + 1, at]]
        found.append(_paired(base, HypothesisKind.SWAPPED, order, (at, at + 1)))
    return found


def _paired(
    base: StructureHypothesis,
    kind: HypothesisKind,
    order: IntArray,
    modes: tuple[int, ...],
) -> StructureHypothesis:
    evidence = replace(base.evidence, pairing=order)
    return replace(base, kind=kind, evidence=evidence, modes=modes)


def _spurious(base: StructureHypothesis) -> list[StructureHypothesis]:
    modes = base.evidence.modes
    if modes is None or modes.natural_frequency.size < 2:
        return []
    return [
        replace(
            base,
            kind=HypothesisKind.SPURIOUS,
            evidence=replace(base.evidence, modes=_without(modes, at)),
            chance=_chance(modes, at),
            modes=(at,),
            left_out=float(modes.natural_frequency[at]),
        )
        for at in range(modes.natural_frequency.size)
    ]


def _without(modes: MeasuredModes, at: int) -> MeasuredModes:
    """Return the modes without one of them."""

    def rest(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else np.delete(values, at, axis=0)

    return replace(
        modes,
        natural_frequency=np.delete(modes.natural_frequency, at),
        frequency_sd=np.delete(modes.frequency_sd, at),
        damping_ratio=rest(modes.damping_ratio),
        damping_ratio_sd=rest(modes.damping_ratio_sd),
        shapes=None if modes.shapes is None else np.delete(modes.shapes, at, axis=0),
        shape_sd=rest(modes.shape_sd),
    )


def _chance(modes: MeasuredModes, at: int) -> float:
    """Return ln density of a mode anywhere, over the peak of that of its own noise."""
    frequency = modes.natural_frequency
    gap = np.log(frequency[-1] / frequency[0])
    whole = max(_LEAST_RANGE, gap * (1.0 + 1.0 / frequency.size))
    normal = np.sqrt(2.0 * np.pi)
    density = np.log(modes.frequency_sd[at] / frequency[at] * normal / whole)
    if modes.damping_ratio is not None and modes.damping_ratio_sd is not None:
        decades = np.log(_CHANCE_DAMPING[1] / _CHANCE_DAMPING[0])
        relative = modes.damping_ratio_sd[at] / max(modes.damping_ratio[at], 1e-12)
        density += np.log(relative * normal / decades)
    if modes.shapes is not None and modes.shape_sd is not None:
        # One complex scale is free, the other outputs are as large as the mode itself.
        size = np.sqrt(0.5 * np.mean(np.abs(modes.shapes[at]) ** 2))
        rows = 2 * (modes.shapes.shape[1] - 1)
        noise = float(np.exp(np.mean(np.log(modes.shape_sd[at]))))
        density += rows * (np.log(noise / np.hypot(size, noise)) - 0.5)
    return float(density)


def _moduli(
    base: StructureHypothesis, settings: HypothesisSettings
) -> list[StructureHypothesis]:
    bodies = [one.name for one in base.model.residual.components]
    found = []
    for body in bodies:
        name = modulus_name(body)
        if name in base.model.names:
            continue
        model = with_moduli(base.model, [body])
        priors = {**base.priors, name: Prior(1.0, settings.modulus_sd)}
        found.append(
            replace(
                base,
                kind=HypothesisKind.MODULUS,
                model=model,
                priors=priors,
                freed=name,
            )
        )
    return found


def _supports(
    base: StructureHypothesis, settings: HypothesisSettings, structure: Structure | None
) -> list[StructureHypothesis]:
    if structure is None:
        return []
    found = []
    for body in bodies_on_springs(structure):
        model = with_support_factor(base.model, structure, body)
        name = model.names[-1]
        priors = {**base.priors, name: Prior(1.0, settings.support_sd)}
        found.append(
            replace(
                base,
                kind=HypothesisKind.SUPPORT,
                model=model,
                priors=priors,
                freed=name,
            )
        )
    return found
