# SPDX-License-Identifier: MIT
"""Modes that depend on amplitude: from a linear modal model and all ring-downs.

Each group of close poles is fitted without and with dependence on amplitude; the fewest
curves that explain the decays better than all linear modes of the group are kept.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    SoftLimit,
)
from jointbench.signal.amplitude.curve_laws import (
    family_by_law,
    family_of,
    fit_laws,
)
from jointbench.signal.amplitude.curve_of_fit import (
    LevelCurve,
    amplitude_curve,
    clear_turns,
    level_curve,
    shift_between,
)
from jointbench.signal.amplitude.dependence_test import (
    CHANCE,
    LARGEST_RESIDUAL_RATIO,
    Change,
    DependenceEvidence,
    change_of,
    curve_holds,
    decide,
    score_chance,
)
from jointbench.signal.amplitude.doubts_between_modes import with_doubts
from jointbench.signal.amplitude.group_fits import GroupFit, fit_groups
from jointbench.signal.amplitude.level_comparison import (
    compare_levels,
    spectra_near_modes,
)
from jointbench.signal.amplitude.mode_groups import ModeGroup, mode_groups
from jointbench.signal.amplitude.ring_downs import RingDowns, ring_downs
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.hit_spectra import ForcesOfHits
from jointbench.signal.modal.modal_model import ModalModel

Talk = Callable[[str, float], None]
_Levels = Mapping[int, tuple[float | None, str]]


@one_thread()
def amplitude_modes(
    recordings: Sequence[Recording],
    model: ModalModel,
    *,
    progress: Talk | None = None,
) -> tuple[AmplitudeMode, ...]:
    """Resolve the modes of a linear fit over their amplitude.

    Args:
        recordings: with judged hits, as recorded.
        model: of the linear fit to the same hits.
        progress: called with what is done and the share of it; None for no calls.

    Returns:
        One record a physical mode, by ascending frequency. Those that stand for
        several linear poles name them all in `replaces`.

    Raises:
        BadData: no hit was accepted.
    """
    judged = [r for r in recordings if accepted_hits(r)]
    spectra = spectra_near_modes(judged, model)
    levels = {
        i: _levels_at(spectra, model, i) for i in range(model.natural_frequency.size)
    }
    asked, found = [], []
    for group in mode_groups(model):
        head = levels[group.members[0]][0]
        if head is None or head > CHANCE:
            found += [_not_fitted(model, i, *levels[i]) for i in group.members]
        else:
            asked.append(group)
    if asked:  # few sessions need their decays
        found += _fitted_modes(ring_downs(judged), model, asked, levels, progress)
    return with_doubts(sorted(found, key=lambda mode: mode.replaces[0]))


def _fitted_modes(
    decays: RingDowns,
    model: ModalModel,
    asked: Sequence[ModeGroup],
    levels: _Levels,
    progress: Talk | None,
) -> list[AmplitudeMode]:
    """Return the modes of the groups whose decays are fitted."""
    found = []
    for group, fitted in fit_groups(decays, model, asked, progress).items():
        if fitted is None:
            words = "the joint fit is singular"
            found += [_undecided(model, i, words) for i in group.members]
        else:
            found += _resolved(decays, model, group, fitted, levels)
    return found


def _resolved(
    decays: RingDowns,
    model: ModalModel,
    group: ModeGroup,
    fitted: GroupFit,
    levels: _Levels,
) -> list[AmplitudeMode]:
    """Return the modes of one group, merged where curves explain more than poles."""
    modes, holds = [], []
    for number, member in enumerate(fitted.members):
        others = [i for i in group.members if i not in fitted.members]
        own = (member, *others) if member == group.members[0] else (member,)
        evidence = _evidence(fitted, number, levels[member])
        modes.append(_judged(decays, model, fitted, number, own, evidence))
        holds.append(curve_holds(evidence))
    if any(_merged_blindly(mode) for mode in modes):
        words = "the decays do not stand out of the noise"
        return [_undecided(model, i, words) for i in group.members]
    return [
        mode if held or mode.dependence is not Dependence.NOT_DECIDED else _bare(mode)
        for mode, held in zip(modes, holds, strict=True)
    ]


def _bare(mode: AmplitudeMode) -> AmplitudeMode:
    """Return a mode without its curve, whose band does not know what is missing."""
    return replace(mode, curve=None)


def _merged_blindly(mode: AmplitudeMode) -> bool:
    """Return whether poles were merged although no part of a curve is known."""
    white = mode.residual_ratio <= LARGEST_RESIDUAL_RATIO
    return len(mode.replaces) > 1 and mode.curve is None and white


def _levels_at(
    spectra: ForcesOfHits, model: ModalModel, member: int
) -> tuple[float | None, str]:
    frequency, ratio = model.natural_frequency[member], model.damping_ratio[member]
    return compare_levels(spectra, float(frequency), float(ratio))


def _evidence(
    fitted: GroupFit, number: int, levels: tuple[float | None, str]
) -> DependenceEvidence:
    """Return what speaks for and against the dependence of one mode."""
    main = fitted.main
    curve = level_curve(main, number)
    after = None if fitted.later is None else level_curve(fitted.later, number)
    change = change_of(curve)
    return DependenceEvidence(
        chance=score_chance(main, number),
        explained=main.share_explained,
        linear_residual_ratio=main.linear.residual_ratio,
        residual_ratio=main.curved.residual_ratio,
        change=change,
        later=_later_change(curve, after, change),
        levels=levels[0],
        levels_words=levels[1],
        turns=clear_turns(curve),
    )


def _judged(
    decays: RingDowns,
    model: ModalModel,
    fitted: GroupFit,
    number: int,
    members: tuple[int, ...],
    evidence: DependenceEvidence,
) -> AmplitudeMode:
    """Return one mode with curve, outcome and laws."""
    main, change = fitted.main, evidence.change
    curve = level_curve(main, number)
    after = None if fitted.later is None else level_curve(fitted.later, number)
    outcome, reason = decide(evidence)
    nothing = np.zeros(curve.level.size)
    shift = (nothing, nothing) if after is None else shift_between(curve, after)
    fitted_curve = amplitude_curve(curve, decays, shift)
    white = main.curved.residual_ratio <= LARGEST_RESIDUAL_RATIO
    shown = fitted_curve if white else None
    depends = outcome is Dependence.DEPENDS and shown is not None
    family, ratio = family_of(change) if depends and change else ("", float("nan"))
    laws = fit_laws(curve, change, decays.derivatives) if depends else ()
    soft = _linear_limit(model, members)
    if shown is not None and (depends or len(members) > 1):
        soft = SoftLimit(
            float(shown.frequency[0]),
            float(shown.frequency_sd[0]),
            float(shown.damping_ratio[0]),
            float(shown.damping_sd[0]),
        )
    elif fitted_curve is not None and change is not None and change.clear:
        soft = _reaching(soft, fitted_curve)
    return AmplitudeMode(
        dependence=outcome,
        reason=reason,
        curve=shown,
        soft=soft,
        significance=evidence.chance,
        residual_ratio=main.curved.residual_ratio,
        linear_residual_ratio=main.linear.residual_ratio,
        frequency_change=change.frequency if change else 0.0,
        frequency_change_sd=change.frequency_sd if change else 0.0,
        damping_change=change.damping if change else 0.0,
        damping_change_sd=change.damping_sd if change else 0.0,
        family=family_by_law(family, laws),
        ratio=ratio,
        laws=laws,
        replaces=tuple(float(model.natural_frequency[i]) for i in members),
    )


def _reaching(soft: SoftLimit, curve: AmplitudeCurve) -> SoftLimit:
    """Return a limit whose interval reaches the soft end of a curve.

    The change is clear and too small to be reported, or not decided: the pole of all
    levels is not the one at small amplitude.
    """
    away = soft.frequency - float(curve.frequency[0])
    spread = soft.damping_ratio - float(curve.damping_ratio[0])
    return replace(
        soft,
        frequency_sd=float(np.hypot(soft.frequency_sd, away)),
        damping_sd=float(np.hypot(soft.damping_sd, spread)),
    )


def _later_change(
    curve: LevelCurve, after: LevelCurve | None, change: Change | None
) -> Change | None:
    """Return the change that a later start gives, for the levels both have.

    The first finding is scaled to those levels, so that the two are of one kind.
    """
    if after is None or change is None:
        return None
    late = change_of(after)
    if late is None:
        return None
    same = change_of(curve, late.levels)
    if same is None:
        return None
    return Change(
        frequency=change.frequency + late.frequency - same.frequency,
        frequency_sd=late.frequency_sd,
        damping=change.damping + late.damping - same.damping,
        damping_sd=late.damping_sd,
        zeta=late.zeta,
        levels=late.levels,
    )


def _linear_limit(model: ModalModel, members: tuple[int, ...]) -> SoftLimit:
    """Return the strongest pole; poles that were merged into it widen its interval."""
    head, others = members[0], list(members[1:])
    frequency, ratio = model.natural_frequency, model.damping_ratio
    apart = np.abs(frequency[others] - frequency[head]).min(initial=np.inf)
    spread = np.abs(ratio[others] - ratio[head]).min(initial=np.inf)
    wide = (0.5 * apart, 0.5 * spread) if others else (0.0, 0.0)
    return SoftLimit(
        float(frequency[head]),
        float(np.hypot(model.frequency_sd[head], wide[0])),
        float(ratio[head]),
        float(np.hypot(model.damping_ratio_sd[head], wide[1])),
    )


def _not_fitted(
    model: ModalModel, member: int, chance: float | None, words: str
) -> AmplitudeMode:
    """Return a mode whose levels agree, or cannot be compared."""
    if chance is None:
        return _undecided(model, member, words)
    return _plain(
        model,
        member,
        Dependence.NONE,
        f"hard and soft hits give the same FRF around it (chance {chance:.2g})",
    )


def _undecided(model: ModalModel, member: int, why: str) -> AmplitudeMode:
    return _plain(model, member, Dependence.NOT_DECIDED, why)


def _plain(
    model: ModalModel, member: int, outcome: Dependence, why: str
) -> AmplitudeMode:
    """Return a mode without a curve."""
    unknown = float("nan")
    return AmplitudeMode(
        dependence=outcome,
        reason=why,
        curve=None,
        soft=_linear_limit(model, (member,)),
        significance=unknown,
        residual_ratio=unknown,
        linear_residual_ratio=unknown,
        replaces=(float(model.natural_frequency[member]),),
    )
