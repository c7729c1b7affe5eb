# SPDX-License-Identifier: MIT
"""Fits of all groups of close modes: each alone, then with the others on its joint."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.signal.amplitude.band_fit import (
    BandFit,
    curved_residual,
    fit_band,
    fit_later,
    linear_residual,
)
from jointbench.signal.amplitude.mode_groups import ModeGroup, without_companions
from jointbench.signal.amplitude.ring_downs import RingDowns
from jointbench.signal.amplitude.shared_joint import with_others
from jointbench.signal.modal.modal_model import ModalModel

# A finding must stay when the decays start later by this [s], or by this share of the
# mode's time constant where that is less.
_DELAY, _DELAY_SHARE = 0.05, 0.7
# Records must be this many delays long.
_LEAST_DELAYS = 4
# Above this residual ratio the fit from a later start is taken, where it is better.
_UNEASY = 2.0
# There the wide band is tried where all but this share of the linear excess is gone:
# the curves hold, and only the band is too narrow for hard decays.
_NEARLY = 1e-3
# Fewer curves may leave this much more power than all of them.
_FEWER = 2.0
# Rounds in which groups see the curves of the others.
_ROUNDS = 2


@dataclass(frozen=True, slots=True, eq=False)
class GroupFit:
    """Fits of one group, from two starts.

    Attributes:
        main: what is reported.
        later: the same modes from a later start; None where records are too short.
        members: poles that began the curves, indices into the modes.
        wide: whether the wide band was fitted.
    """

    main: BandFit
    later: BandFit | None
    members: tuple[int, ...]
    wide: bool = False


def fit_groups(
    decays: RingDowns,
    model: ModalModel,
    groups: Sequence[ModeGroup],
    progress: Callable[[str, float], None] | None = None,
) -> dict[ModeGroup, GroupFit | None]:
    """Fit the modes of groups to all ring-downs.

    Args:
        decays: of all hits.
        model: of the linear fit.
        groups: to be fitted, strongest first.
        progress: called with what is done and the share of it.

    Returns:
        A fit for each group, None where it is singular.
    """
    alone: dict[ModeGroup, GroupFit | None] = {}
    for number, group in enumerate(groups):
        if progress is not None:
            progress("amplitude dependence", number / len(groups))
        try:
            alone[group] = _fit_group(decays, model, group)
        except np.linalg.LinAlgError:
            alone[group] = None
    joined = alone
    for _ in range(_ROUNDS):
        joined = {
            group: None if fit is None else _together(group, fit, joined)
            for group, fit in joined.items()
        }
    return {
        group: None if fit is None else _begun_later(decays, model, group, fit)
        for group, fit in joined.items()
    }


def _fit_group(decays: RingDowns, model: ModalModel, group: ModeGroup) -> GroupFit:
    """Fit the fewest curves that explain more than all linear modes do."""
    whole = group.band(model, len(group.members))
    kept = without_companions(model, group)
    count, main = len(kept.members), None
    # Two modes taken for one leave far more than all curves, or than all poles.
    limit = linear_residual(decays, whole) if count > 1 else 0.0
    best: BandFit | None = None
    for fewer in range(1, count):
        tried = fit_band(decays, kept.band(model, fewer))
        left = curved_residual(tried, decays, whole)
        if left >= limit and best is None:
            best = fit_band(decays, kept.band(model, count))
            limit = max(limit, _FEWER * curved_residual(best, decays, whole))
        if left < limit:
            count, main = fewer, tried
            break
    main = main or best or fit_band(decays, kept.band(model, count))
    members = tuple(sorted(kept.members[:count]))
    if main.curved.residual_ratio > _UNEASY and main.share_explained > 1.0 - _NEARLY:
        wide = fit_band(decays, kept.band(model, count, wide=True))
        if wide.curved.residual_ratio < main.curved.residual_ratio:
            return GroupFit(wide, None, members, wide=True)
    return GroupFit(main, None, members)


def _together(
    group: ModeGroup, fit: GroupFit, every: Mapping[ModeGroup, GroupFit | None]
) -> GroupFit:
    """Return the fit of a group with all other modes on its joint."""
    everyone = [
        (other, one.main, number)
        for other, one in every.items()
        if one is not None
        for number in range(len(one.members))
    ]
    others = [
        [(one, k) for other, one, k in everyone if (other, k) != (group, number)]
        for number in range(len(fit.members))
    ]
    if not others[0]:
        return fit
    try:
        return replace(fit, main=with_others(fit.main, others))
    except np.linalg.LinAlgError:
        return fit


def _begun_later(
    decays: RingDowns, model: ModalModel, group: ModeGroup, fit: GroupFit
) -> GroupFit:
    """Return the fit with the same from a later start, or from two where it is poor."""
    band = group.band(model, len(fit.members), wide=fit.wide)
    delay = min(_DELAY, _DELAY_SHARE / band.slowest)
    if decays.samples.shape[2] < _LEAST_DELAYS * delay * decays.sample_rate:
        return fit
    main = fit.main.curved.residual_ratio
    try:
        later = fit_later(decays, band, fit.main, delay)
        if main > _UNEASY and later.curved.residual_ratio < main:
            last = fit_later(decays, band, fit.main, 2 * delay)
            return replace(fit, main=later, later=last)
    except np.linalg.LinAlgError:
        return fit
    return replace(fit, later=later)
