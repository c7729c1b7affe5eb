# SPDX-License-Identifier: MIT
"""What `gap` is asked of a source, and what became of it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.catalogue.installed_effects import installed_catalogue
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.model.stretch_score import StretchScore
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.structure_plan import StructurePlan
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.page_parts import Section

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class GapRequest:
    """What is asked of a source.

    Attributes:
        model: bench model file, or None.
        without: names of effects to leave out of the catalogue.
        preload: on the joint where the session does not say [N], or None.
        entries: the catalogue of this run.
        curves: whether modes over amplitude are compared with the explanations.
        extended: whether effects beyond the installed catalogue were asked for.
    """

    model: Path | None = None
    without: frozenset[str] = frozenset()
    preload: float | None = None
    entries: tuple[LumpedEffect, ...] = field(default_factory=installed_catalogue)
    curves: bool = False
    extended: bool = False


@dataclass(frozen=True, slots=True)
class Examined:
    """What became of a source.

    Attributes:
        title: of the source, for the report.
        found: verdict and evidence.
        scores: on parts of a long record that no fit has seen.
        unit: of the scores.
        remarks: what was left out, and why, a line each.
        plan: places of a bolted structure, or None.
        sections: further sections of the report, after the verdict.
        simulated: whether a session was.
    """

    title: str
    found: Diagnosis
    scores: tuple[StretchScore, ...] = ()
    unit: str = ""
    remarks: tuple[str, ...] = ()
    plan: StructurePlan | None = None
    sections: tuple[Section, ...] = ()
    simulated: bool = False


def refuse_on_bodies(wanted: GapRequest) -> None:
    """Raise `UsageError` for options that do not apply to bolted bodies."""
    if wanted.curves or wanted.extended:
        raise UsageError(
            "--curves, --effects and --with do not apply to bolted bodies; leave them "
            "out"
        )


def refuse_curves(wanted: GapRequest) -> None:
    """Raise `UsageError` for curves over amplitude, which need hits."""
    if wanted.curves:
        raise UsageError(
            "--curves needs the decays after hits, and driven records have none; leave "
            "it out"
        )


def bench_of(path: Path, wanted: GapRequest) -> BenchModel:
    """Return the model of the bench at which a source was recorded.

    Args:
        path: of the source.
        wanted: model and options.

    Raises:
        UsageError: none was given.
        BadData: it cannot be used as it is.
    """
    if wanted.model is None:
        raise UsageError(
            f"'{path}' holds data but no model; give the bench's with --model "
            "bench.toml"
        )
    return read_toml(wanted.model, BenchModel)
