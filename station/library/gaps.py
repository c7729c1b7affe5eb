# SPDX-License-Identifier: MIT
"""The effect that a model lacks to explain a measurement."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, diagnosis_json
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.station.chain.chain_json import chain_json
from jointbench.station.chain.chain_report import chain_report
from jointbench.station.chain.chain_tables import cause_rows, stiffness_rows
from jointbench.station.chain.chain_words import chain_headline
from jointbench.station.chain.examine_chain import ExaminedChain, examine_chain
from jointbench.station.gap.gap_inputs import examine
from jointbench.station.gap.gap_options import gap_request
from jointbench.station.gap.gap_request import Examined
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
        done = self.examined
        report = gap_report(done.found, title=done.title, simulated=done.simulated)
        write_report(report, target)
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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ChainVerdict(Shown):
    """Verdict on the chain of surfaces, contact law, structure and hits.

    Attributes:
        examined: verdict, causes, stiffness, modes and responses.
    """

    examined: ExaminedChain

    @property
    def verdict(self) -> str:
        """One of none, named, ambiguous, unknown."""
        return self.examined.found.finding.value

    @property
    def links(self) -> tuple[str, ...]:
        """Links at which the disagreement enters."""
        return tuple(link.value for link in self.examined.found.links)

    @property
    def effects(self) -> tuple[str, ...]:
        """Effects that were found as ``name@site``."""
        return self.examined.found.names

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict as plain data, as ``gap --json`` writes it."""
        return dict(chain_json(self.examined))

    def write_report(self, path: str | Path) -> Path:
        """Write the report of the chain as one HTML file."""
        target = Path(path)
        write_report(chain_report(self.examined), target)
        return target

    @property
    def view(self) -> ResultView:
        """Headline, the joint's stiffness in each state, and the factors of causes."""
        columns = ("preload", "law alone", "predicted", "measured", "within 95 %")
        said = [f"{n}: factor {f} ({i})" for n, f, i in cause_rows(self.examined)]
        found = self.examined.found
        title = f"verdict: {self.verdict}. {chain_headline(self.examined)}"
        rows = tuple(stiffness_rows(self.examined))
        lines = (found.reason, *said, *filter(None, [found.experiment]))
        return ResultView(title, columns, rows, lines)


def gap(
    source: Measurement | Files,
    *,
    surfaces: Files = (),
    model: str | Path | None = None,
    preload: str | None = None,
    without: Sequence[str] = (),
    effects: Sequence[Path | str] = (),
    progress: Callable[[str], None] | None = None,
) -> GapVerdict | ChainVerdict:
    """Find the effect that a model lacks to explain a measurement.

    Args:
        source: a recorded measurement, a campaign file, sessions, a MAT file, or the
            URL of a bench.
        surfaces: measured contact surfaces of the joint, one or both; then the whole
            chain is diagnosed, and the model needs a table [bolted_joint].
        model: bench model; None where the source brings its own.
        preload: on the joint with unit, where the session gives none.
        without: names of effects to leave out of the catalogue.
        effects: further ones: files of own effects, which are run as Python, and names
            of laws of real joints.
        progress: receives one line per step.

    Returns:
        Verdict, effects with intervals, and the gap before and after; with surfaces
        the link at which the chain disagrees.

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
    if surfaces:
        heights = [surfaces] if isinstance(surfaces, str | Path) else list(surfaces)
        with side_by_side():
            chain = examine_chain(
                [Path(one) for one in files],
                [Path(one) for one in heights],
                wanted,
                progress=tell,
            )
        return ChainVerdict(chain)
    with side_by_side():
        return GapVerdict(examine([str(one) for one in files], wanted, progress=tell))
