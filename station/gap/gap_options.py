# SPDX-License-Identifier: MIT
"""Options of a diagnosis, as given by a command or a script, as one request."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.analysis.gap.catalogue.catalogue import with_real_joints
from jointbench.analysis.gap.catalogue.installed_effects import installed_catalogue
from jointbench.station.files.typed_values import parse_preload
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.schemas.effects_file import read_effects, with_own


def gap_request(
    *,
    model: Path | None = None,
    preload: str | None = None,
    without: str | None = None,
    effects: Sequence[Path | str] = (),
    curves: bool = False,
) -> GapRequest:
    """Return what is asked of a source.

    Args:
        model: bench model, where the source has none.
        preload: on the joint with unit, where the session gives none.
        without: names of effects to leave out of the catalogue, joined by commas.
        effects: further ones: files of the user's own effects, run as Python, and
            names of laws of real joints.
        curves: whether modes over amplitude are compared with the explanations.

    Raises:
        UsageError: a name is in no catalogue.
        UnitError: the preload has no unit.
    """
    own = [
        entry
        for path in effects
        if isinstance(path, Path)
        for entry in read_effects(path)
    ]
    laws = [one for one in effects if isinstance(one, str)]
    entries = with_real_joints(installed_catalogue(), laws)
    return GapRequest(
        model,
        names_in(without),
        parse_preload(preload) if preload else None,
        entries=with_own(entries, own),
        curves=curves,
        extended=bool(effects),
    )


def names_in(joined: str | None) -> frozenset[str]:
    """Return the names of an option that joins them by commas."""
    return frozenset(word.strip() for word in (joined or "").split(",") if word.strip())
