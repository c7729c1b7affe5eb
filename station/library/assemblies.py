# SPDX-License-Identifier: MIT
"""A joint over its assemblies: its scatter, the next assembly, and a change."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.reassembly.changed_joint import JointChange, Reassembly
from jointbench.station.library.argument_checks import require_lists
from jointbench.station.library.measurements import paths_of
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.reassembly.reassembly_json import reassembly_json
from jointbench.station.reassembly.reassembly_text import (
    headline,
    next_columns,
    next_rows,
    remedy,
)
from jointbench.station.reassembly.run_reassembly import reassembly_of


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ComparedAssemblies(Shown):
    """A joint over its assemblies.

    Attributes:
        result: scatter, prediction and verdict of each quantity.
    """

    result: Reassembly

    @property
    def changed(self) -> bool:
        """Whether the latest assembly lies beyond the scatter of the joint."""
        return self.result.change is JointChange.CHANGED

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as plain data, as ``reassembly --json`` writes it."""
        return reassembly_json(self.result)

    @property
    def view(self) -> ResultView:
        """Verdict, and the next assembly at each level."""
        found = self.result
        said = tuple(filter(None, [remedy(found)]))
        rows = tuple(next_rows(found))
        return ResultView(headline(found), next_columns(found), rows, said)


def reassembly(
    joints: str | Path | Sequence[str | Path],
    *,
    level: Sequence[str] = (),
    opened: bool = True,
) -> ComparedAssemblies:
    """Compare the assemblies of a joint, and predict the next one.

    Args:
        joints: joint over its preload (TOML) in several assemblies, and later sessions.
        level: torques or preloads of the prediction with units, ``["30 N m"]``; none
            for those measured.
        opened: whether the joint was opened before the latest assembly.

    Returns:
        Scatter, the range of the next assembly, and whether the latest has changed.

    Raises:
        BadData: a file breaks a rule, or there is one assembly only.
    """
    require_lists("['30 N m']", level=level)
    return ComparedAssemblies(reassembly_of(paths_of(joints), level, opened=opened))
