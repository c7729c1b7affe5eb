# SPDX-License-Identifier: MIT
"""Measured modes and FRFs beside those of the identified model."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.analysis.structures.agreement.compare_structure import Agreement
from jointbench.analysis.structures.agreement.suspect_coordinates import Suspect
from jointbench.station.agreement.agreement_json import agreement_json
from jointbench.station.agreement.agreement_report import write_agreement_report
from jointbench.station.agreement.agreement_text import (
    PAIR_COLUMNS,
    pair_rows,
    sentences,
)
from jointbench.station.agreement.compare_states import ComparedStates, compare_states
from jointbench.station.library.argument_checks import checked_band, one_path
from jointbench.station.library.identified_joints import IdentifiedJoints, values_of
from jointbench.station.library.measurements import Files, Measurement, paths_of
from jointbench.station.library.result_view import ResultView, Shown


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ModelAgreement(Shown):
    """A model beside what was measured of it.

    Attributes:
        model: its file.
        result: the comparison of every state.
    """

    model: Path
    result: ComparedStates

    @property
    def states(self) -> Mapping[str, Agreement]:
        """Pairs of modes, MAC, CoMAC, FRAC and FRFs of each state, by its label."""
        return self.result.states

    @property
    def suspects(self) -> tuple[Suspect, ...]:
        """Points whose sign, label or axis is in doubt, of all states."""
        return tuple(s for one in self.states.values() for s in one.suspects)

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as plain data, as ``agreement --json`` writes it."""
        return {name: agreement_json(one) for name, one in self.states.items()}

    def write_report(self, path: str | Path) -> Path:
        """Write the report of the comparison as one HTML file."""
        target = Path(path)
        write_agreement_report(
            target, self.model.name, self.states, simulated=self.result.simulated
        )
        return target

    @property
    def view(self) -> ResultView:
        """One row a pair of modes, and what is missing or suspected."""
        rows = [
            (label, *row)
            for label, one in self.states.items()
            for row in pair_rows(one)
        ]
        said = [
            f"{label}: {words}"
            for label, one in self.states.items()
            for words in sentences(one)
        ]
        title = f"{self.model.name}: measured and computed modes"
        return ResultView(title, ("state", *PAIR_COLUMNS), tuple(rows), tuple(said))


def agreement(
    model: str | Path,
    identified: IdentifiedJoints | str | Path,
    source: Measurement | Files,
    *,
    band: tuple[float, float] | None = None,
    cache: str | Path | None = None,
) -> ModelAgreement:
    """Compare measured modes and FRFs with those of the identified model.

    Args:
        model: structure model (TOML) with [sensors] and [hits].
        identified: joints that `identify` returned, or the JSON of ``identify``.
        source: recorded measurement, sessions, or files of FRFs.
        band: of the modes [Hz]; None lets the data choose.
        cache: folder that keeps reduced structures.

    Returns:
        Pairs of modes with intervals, MAC, CoMAC, FRAC, and points whose sign, label or
        axis is in doubt.

    Raises:
        BadData: the model or a session cannot be used.
        UsageError: there is no session, or it holds no state of the model.
    """
    path, band = one_path(model, "a model"), checked_band(band)
    sessions = source.files if isinstance(source, Measurement) else paths_of(source)
    done = compare_states(
        path,
        values_of(identified),
        sessions,
        band=None if band is None else f"{band[0]}:{band[1]}",
        cache=None if cache is None else one_path(cache, "a folder"),
    )
    return ModelAgreement(path, done)
