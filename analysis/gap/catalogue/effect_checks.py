# SPDX-License-Identifier: MIT
"""Check whether the engine can use an effect of a user or of another package.

The checks need no campaign and precede the reading of records.
"""

import re

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.probes import PROBES
from jointbench.analysis.gap.model.effect import PROBE_FAMILY
from jointbench.analysis.gap.model.effect_parameter import Parameter
from jointbench.analysis.gap.response.effect_hooks import (
    ElementState,
    HitConditions,
    LumpedEffect,
)
from jointbench.analysis.gap.response.law_forces import CURVES

PROBE_NAMES = frozenset(probe.effect.name for probe in PROBES)
"""Names that no effect may have, because the engine's probes use them."""
_SITES = ("link", "body", "channel")
_HOOKS = ("stiffness", "law", "transfer", "mixing", "shape")
"""Hooks of an effect; `rise` only complements a stiffness."""
_HOOK_SITES = {
    "stiffness": ("link", "body"),
    "law": ("link",),
    "transfer": ("channel",),
    "mixing": ("channel",),
    "shape": ("channel",),
    "rise": ("link",),
}
"""Kinds of site at which the engine calls a hook. Elements are indexed regardless of
their kind, so a hook at another site would act on an element with the same index."""
_TRIED_PRELOADS = (0.5, 1.0, 2.0)
"""Over the reference [-]; at 1 alone no power of the preload has any influence."""
_TRIED_PROGRESS = (0.0, 0.5, 1.0)
_TRIED_SAMPLES = 256
_TRIED_RATE = 4096.0
"""Sample rate of the signal for the trial of a `shape` [Hz]."""
_TRIED_LINES = 16
_TRIED_DAMPING = 100.0
"""Real part of the Laplace variable for the trial of a linear effect [1/s]."""
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


def fault_of(entry: LumpedEffect) -> str:
    """Return the fault of an effect, or an empty text.

    Raises:
        UsageError: a hook fails at amplitude 0.
    """
    parameters = entry.effect.parameters
    if not _NAME.fullmatch(entry.effect.name):
        return "the name must be words in small letters joined by _"
    if not parameters:
        return "it has no parameter; the first is its amplitude"
    if entry.effect.family == PROBE_FAMILY:
        return f"its family {PROBE_FAMILY!r} is reserved for probes; give it another"
    if parameters[0].off != 0.0:
        return "its first parameter must be an amplitude with off=0.0"
    if not entry.sites or not set(entry.sites) <= set(_SITES):
        return f"its sites must be among {', '.join(_SITES)}"
    if all(getattr(entry, hook) is None for hook in _HOOKS):
        return f"it acts through no hook; give one of {', '.join(_HOOKS)}"
    return _misplaced(entry) or _acts_at_zero(entry)


def _misplaced(entry: LumpedEffect) -> str:
    """Return the fault of a hook at the wrong kind of site, or an empty text."""
    for hook, right in _HOOK_SITES.items():
        wrong = [site for site in entry.sites if site not in right]
        if wrong and getattr(entry, hook) is not None:
            return (
                f"its hook {hook} acts on a {' or a '.join(right)}, not on a {wrong[0]}"
            )
    if entry.mixing is not None and entry.every_channel:
        # Its index is -1, so a mixing would act on the last channel only.
        return "its hook mixing acts on one channel; leave every_channel out"
    return ""


def _acts_at_zero(entry: LumpedEffect) -> str:
    """Return the fault of an effect at amplitude 0, or an empty text."""
    try:
        inactive = _inactive(entry)
    except UsageError:
        raise
    except Exception as error:
        raise UsageError(
            f"effect {entry.effect.name!r} fails at amplitude 0 "
            f"({type(error).__name__}: {error}); call its hook separately"
        ) from error
    return "" if inactive else "at amplitude 0 it must vanish to the last bit"


def _inactive(entry: LumpedEffect) -> bool:
    """Return whether an effect of amplitude 0 leaves the base unchanged.

    Only laws given as curves are evaluated; the amplitude of other laws is in their own
    parameters.
    """
    values = np.array([p.starts[0] if p.starts else 1.0 for p in _shapes(entry)])
    values = np.concatenate([[0.0], values])
    s = np.asarray(
        _TRIED_DAMPING + 2j * np.pi * np.geomspace(1.0, 1e4, _TRIED_LINES),
        dtype=np.complex128,
    )
    conditions = HitConditions(np.array(_TRIED_PRELOADS), np.array(_TRIED_PROGRESS))
    state = ElementState(s, 1.0, 1.0, 1.0, conditions)
    return not (_moves(entry, state, values) or _bends(entry, s, values))


def _moves(entry: LumpedEffect, state: ElementState, values: FloatArray) -> bool:
    """Return whether an effect changes a link or a body."""
    left: list[object] = []
    if entry.stiffness is not None:
        left.append(np.any(entry.stiffness(state, values)))
    if entry.rise is not None:
        left.append(np.any(entry.rise(state.conditions, values)))
    if entry.law is not None and (law := entry.law(values)).kind == CURVES:
        left.append(np.any(law.tables))
    return any(left)


def _bends(entry: LumpedEffect, s: ComplexArray, values: FloatArray) -> bool:
    """Return whether an effect changes a channel."""
    left: list[object] = []
    if entry.transfer is not None:
        left.append(np.any(entry.transfer(s, values) != 1.0))
    if entry.mixing is not None:
        left.append(entry.mixing(values) != 0.0)
    if entry.shape is not None:
        model = _signal()
        shaped = entry.shape(model.copy(), 1.01 * model, values, _TRIED_RATE)
        left.append(np.any(shaped != model))
    return any(left)


def _signal() -> FloatArray:
    """Return a decaying tone in three records, shape (3, 1, TRIED_SAMPLES)."""
    turn = np.arange(_TRIED_SAMPLES) / _TRIED_SAMPLES
    tone = np.exp(-3.0 * turn) * np.sin(2 * np.pi * 10.0 * turn)
    return np.asarray(np.array([0.5, 1.0, 2.0])[:, None, None] * tone)


def _shapes(entry: LumpedEffect) -> tuple[Parameter, ...]:
    return entry.effect.parameters[1:]
