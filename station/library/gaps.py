# SPDX-License-Identifier: MIT
"""The effect that a model lacks to explain a measurement."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, diagnosis_json
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.gap.gap_inputs import Examined, examine
from jointbench.station.gap.gap_options import gap_request
from jointbench.station.library.argument_checks import (
    one_path,
    require_lists,
    require_texts,
)
from jointbench.station.library.measurements import Files, Measurement, paths_of
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.report.gap_report import gap_report
from jointbench.station.report.gap_sentences import headline
from jointbench.station.screen.page import write_report
from jointbench.station.screen.value_text import with_sd


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class GapVerdict(Shown):
    """Verdict and evidence of a diagnosis.

    Attributes:
        examined: diagnosis, scores and remarks.
    """

    examined: Examined

    @property
    def diagnosis(self) -> Diagnosis:
        """Verdict, effects, candidates, and the gap before and after."""
        return self.examined.found

    @property
    def verdict(self) -> str:
        """One of none, named, ambiguous, mostly, unknown."""
        return self.diagnosis.verdict.value

    @property
    def effects(self) -> tuple[str, ...]:
        """Effects that were found as ``name@site``; the rivals if ambiguous."""
        return tuple(f"{one.name}@{one.site}" for one in self.diagnosis.effects)

    def to_dict(self) -> dict[str, Any]:
        """Return the diagnosis as plain data, as ``gap --json`` writes it."""
        return diagnosis_json(self.diagnosis)

    def write_report(self, path: str | Path) -> Path:
        """Write the report of the diagnosis as one HTML file."""
        target = Path(path)
        write_report(gap_report(self.diagnosis, title=self.examined.title), target)
        return target

    @property
    def view(self) -> ResultView:
        """Headline, one row a parameter of each effect, and the gap."""
        found = self.diagnosis
        rows = [
            (
                f"{one.name} at {one.site}",
                value.name,
                with_sd(value.value, value.sd),
                value.unit,
                f"{100 * one.confidence:.0f} %",
            )
            for one in found.effects
            for value in one.parameters
        ]
        columns = ("effect", "parameter", "value ± sd", "unit", "confidence")
        before, after = found.gap_before.value, found.gap_after.value
        gap_words = f"gap: {before:.3g} before, {after:.3g} after, on held-out records"
        title = f"verdict: {self.verdict}. {headline(found)}"
        said = (gap_words, found.reason, *filter(None, [found.experiment]))
        return ResultView(title, columns, tuple(rows), (*said, *self.examined.remarks))


def gap(
    source: Measurement | Files,
    *,
    model: str | Path | None = None,
    preload: str | None = None,
    without: Sequence[str] = (),
    effects: Sequence[Path | str] = (),
    progress: Callable[[str], None] | None = None,
) -> GapVerdict:
    """Find the effect that a model lacks to explain a measurement.

    Args:
        source: a recorded measurement, a campaign file, sessions, a MAT file, or the
            URL of a bench.
        model: bench model; None where the source brings its own.
        preload: on the joint with unit, where the session gives none.
        without: names of effects to leave out of the catalogue.
        effects: further ones: files of own effects, which are run as Python, and names
            of laws of real joints.
        progress: receives one line per step.

    Returns:
        Verdict, effects with intervals, and the gap before and after.

    Raises:
        UsageError: a model is missing, or a name is in no catalogue.
        BadData: a file cannot be used.
    """
    used = model
    if isinstance(source, Measurement):
        used = model or source.model
        files: Sequence[str | Path] = source.files
    else:
        paths_of(source)  # refuses what names no file; a URL stays text
        files = [source] if isinstance(source, str | Path) else source
    require_texts("'4 kN'", preload=preload)
    require_lists("['jenkins']", without=without, effects=effects)
    wanted = gap_request(
        model=None if used is None else one_path(used, "a bench model"),
        preload=preload,
        without=",".join(without),
        effects=effects,
    )
    tell = progress or (lambda _line: None)
    with side_by_side():
        return GapVerdict(examine([str(one) for one in files], wanted, progress=tell))
