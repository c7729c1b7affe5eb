# SPDX-License-Identifier: MIT
"""Effects of the user's own, from a Python file named on the command line.

Such a file is run, with all that the user may do. So it is taken from nowhere but the
command line: no campaign, session, plan or environment can name one, and nothing is
looked for in any folder.
"""

import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.effect_checks import PROBE_NAMES, fault_of
from jointbench.analysis.gap.response.effect_hooks import (
    LumpedEffect,
)

_ATTRIBUTE = "EFFECTS"


def read_effects(path: Path) -> tuple[LumpedEffect, ...]:
    """Run a file and return the effects that it holds.

    Args:
        path: Python file with a tuple called ``EFFECTS``.

    Returns:
        Its effects, each checked as far as can be without a campaign.

    Raises:
        UsageError: the file cannot be run, or holds no sound effects.
    """
    found = getattr(_run(path), _ATTRIBUTE, None)
    if not isinstance(found, tuple | list) or not found:
        raise UsageError(
            f"'{path}' has no tuple called {_ATTRIBUTE}; end it with "
            f"{_ATTRIBUTE} = (MY_EFFECT,)"
        )
    for entry in found:
        _check(path, entry)
    return tuple(found)


def with_own(
    catalogue: tuple[LumpedEffect, ...], own: Sequence[LumpedEffect]
) -> tuple[LumpedEffect, ...]:
    """Return a catalogue with effects of the user's own.

    Args:
        catalogue: what the engine knows.
        own: to be added.

    Raises:
        UsageError: two effects have one name, or one has that of a probe.
    """
    taken = sorted(PROBE_NAMES & {entry.effect.name for entry in own})
    if taken:
        raise UsageError(
            f"an effect may not be called {taken[0]!r}: the engine's own probes use "
            "that name; give yours another"
        )
    names = [entry.effect.name for entry in (*catalogue, *own)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise UsageError(
            f"two effects are called {twice[0]!r}; give your own another name"
        )
    return (*catalogue, *own)


def _run(path: Path) -> ModuleType:
    if not path.is_file():
        raise UsageError(f"there is no effects file '{path}'; give a Python file")
    spec = importlib.util.spec_from_file_location(f"own_effects_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise UsageError(f"'{path}' is no Python file; its name must end in .py")
    module = importlib.util.module_from_spec(spec)
    kept, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise UsageError(
            f"'{path}' cannot be run ({type(error).__name__}: {error}); "
            f"try 'python {path}'"
        ) from error
    finally:
        sys.dont_write_bytecode = kept
    return module


def _check(path: Path, entry: object) -> None:
    """Refuse what the engine would stumble over long after."""
    if not isinstance(entry, LumpedEffect):
        raise UsageError(
            f"'{path}': {_ATTRIBUTE} holds a {type(entry).__name__}; "
            "each must be a LumpedEffect"
        )
    fault = fault_of(entry)
    if fault:
        raise UsageError(f"'{path}', effect {entry.effect.name!r}: {fault}")
