# SPDX-License-Identifier: MIT
"""The installed catalogue: the built-in effects, and those of other packages.

A package adds an effect by an entry point of the group ``jointbench.effects`` that
refers to a `LumpedEffect`; the name of the entry point is that of the effect.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import wraps
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.registry import Entry, Registry
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.catalogue.effect_checks import PROBE_NAMES, fault_of
from jointbench.analysis.gap.model.effect import EFFECTS_GROUP
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect

_CALLED = ("stiffness", "poles", "law", "transfer", "mixing", "shape", "rise")
"""Hooks of an effect that the engine calls."""
_Hook = Callable[..., Any] | None


def _fault(entry: LumpedEffect) -> str:
    if entry.name in PROBE_NAMES:
        return "the engine's own probes use that name; give it another"
    return fault_of(entry)


EFFECTS = Registry(
    EFFECTS_GROUP, "effect", LumpedEffect, lambda: CATALOGUE, fault=_fault
)


def installed_catalogue() -> tuple[LumpedEffect, ...]:
    """Return all effects: the built-in ones first, then by package and name.

    Raises:
        UsageError: two packages add an effect of the same name.
    """
    return tuple(
        entry.value if entry.built_in else _guarded(entry)
        for entry in EFFECTS.entries()
    )


def _guarded(entry: Entry[LumpedEffect]) -> LumpedEffect:
    """Return an effect of another package whose hooks name it in their errors."""
    found = entry.value
    hooks: dict[str, Any] = {
        name: _guard(entry, getattr(found, name)) for name in _CALLED
    }
    effect = replace(found.effect, report=_guard(entry, found.effect.report))
    return replace(found, effect=effect, **hooks)


def _guard(entry: Entry[LumpedEffect], hook: _Hook) -> _Hook:
    if hook is None:
        return None

    @wraps(hook)
    def call(*given: Any) -> Any:
        try:
            return hook(*given)
        except np.linalg.LinAlgError:  # the search then tries a shorter step
            raise
        except Exception:
            with entry.running(UsageError):
                raise

    return call


def effect_packages(entries: Iterable[LumpedEffect]) -> dict[str, str]:
    """Return the package and version of each entry that another package adds.

    Args:
        entries: the catalogue of a run.
    """
    names = {entry.name for entry in entries}
    return {
        entry.value.name: entry.package
        for entry in EFFECTS.entries()
        if not entry.built_in and entry.value.name in names
    }


def effect_code(without: Iterable[str]) -> tuple[str, ...]:
    """Return the part of a diagnosis key for the effects of other packages.

    Args:
        without: names of effects that are left out.

    Returns:
        Name, package, version and digest of each, see `Entry.code`.
    """
    left_out = frozenset(without)
    return tuple(
        f"{entry.value.name} {entry.code}"
        for entry in EFFECTS.entries()
        if not entry.built_in and entry.value.name not in left_out
    )
