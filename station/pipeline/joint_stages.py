# SPDX-License-Identifier: MIT
"""The stages from surfaces and modes to the joint, each put in once.

::

    structure <- heights                surface <- structure
    contact   <- structures, material   joint   <- modes, the model
    gap       <- hits, samples, the model
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass, field, replace
from typing import Any, TypeVar

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.surfaces import Areal, Surface
from jointbench.analysis.contact.model_catalogue import contact_law_code
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.catalogue.installed_effects import (
    effect_code,
    effect_packages,
    installed_catalogue,
)
from jointbench.analysis.gap.diagnosis.amplitude_evidence import MeasuredCurves
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.session_campaign import session_campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, diagnosis_json
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.lumped.identified import Identification
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import FractalFit
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.surface.structure_constant import DEFAULT_GAMMA
from jointbench.signal.surface.structure_function import StructureFunction
from jointbench.signal.surface.surface_treatment import (
    UNTREATED,
    SurfaceTreatment,
    outside_filters,
    treated,
    treated_structure,
)
from jointbench.station.pipeline.joint_comparison import (
    ContactPrediction,
    predict_joint,
)
from jointbench.station.pipeline.link_stage import identify_joint
from jointbench.station.pipeline.recordings_by_preload import at_words
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.pipeline.surface_stages import SurfaceChain
from jointbench.station.schemas.bench_model import BenchModel, ContactTable
from jointbench.station.schemas.gap_model import nominal_parameters

Page = dict[str, Any]
Found = TypeVar("Found")


@dataclass(slots=True)
class Remarks:
    """What could not be done, and why, a line each.

    Attributes:
        lines: so far, in the order of the stages.
        refusals: errors that become a remark; all others end the run.
    """

    refusals: tuple[type[JointbenchError], ...]
    lines: list[str] = field(default_factory=list)

    def attempt(self, words: str, make: Callable[[], Found]) -> Found | None:
        """Return what a stage gives, or None and a remark on why it cannot be done."""
        try:
            return make()
        except self.refusals as error:
            self.lines.append(f"No {words}: {error}")
            return None


def surface_stages(
    surfaces: Iterable[Surface],
    run: StageRun,
    gamma: float = DEFAULT_GAMMA,
    treatment: SurfaceTreatment = UNTREATED,
) -> tuple[SurfaceChain, ...]:
    """Return the structure function and the fractal fit of each surface.

    Args:
        surfaces: heights.
        run: store and source.
        gamma: frequency ratio of the profile that D and G belong to [-].
        treatment: of each surface before its fit; a direction is for maps only.
    """
    return tuple(_surface(one, run, gamma, treatment) for one in surfaces)


def _surface(
    given: Surface, run: StageRun, gamma: float, asked: SurfaceTreatment
) -> SurfaceChain:
    stages = run.stages
    treatment = asked if isinstance(given, Areal) else replace(asked, direction=None)
    surface = treated(given, treatment)
    settings = None if treatment == UNTREATED else astuple(treatment)
    first = stages.key("structure", settings, *run.source(given.name, given))
    structure = stages.run(
        f"structure of {surface.name}",
        first,
        StructureFunction,
        lambda: treated_structure(given, treatment)[1],
    )
    name = f"surface {surface.name}"
    key = stages.key("surface", gamma, first)
    shown = outside_filters(structure, surface)
    fit = stages.run(name, key, FractalFit, lambda: fit_fractal(shown, gamma=gamma))
    return SurfaceChain(surface, structure, fit)


def contact_stage(
    surfaces: Sequence[SurfaceChain], table: ContactTable, run: StageRun
) -> ContactPrediction:
    """Predict the joint between surfaces, see `predict_joint`."""
    structures = tuple(one.structure for one in surfaces)
    given = [
        table.model_dump(mode="json", exclude={"link"}),
        *contact_law_code(table.model),
    ]
    return run.stages.run(
        "contact",
        run.stages.key("contact", given, run.stages.digest(structures)),
        ContactPrediction,
        lambda: predict_joint(structures, table),
    )


def joint_stage(
    modes: ModalModel, bench: BenchModel, run: StageRun, preload: float | None = None
) -> Identification:
    """Identify the links of a bench from its modes, see `identify_joint`."""
    given = bench.model_dump(mode="json")
    return run.stages.run(
        f"joint{at_words(preload)}",
        run.stages.key("joint", given, run.stages.digest(modes)),
        Identification,
        lambda: identify_joint(bench, modes),
    )


def gap_stage(
    judged: Sequence[Recording],
    bench: BenchModel,
    without: Sequence[str],
    run: StageRun,
    curves: MeasuredCurves | None = None,
) -> Page:
    """Ask what a model lacks, as `jointbench gap` does; verdict and evidence as JSON.

    Args:
        judged: with hits and preloads.
        bench: the model.
        without: names of effects to leave out of the catalogue.
        run: store and source.
        curves: modes over amplitude at the model's preload, compared with what the
            explanations predict; None for no comparison.
    """
    left, entries = frozenset(without), installed_catalogue()

    def make() -> Page:
        found, left_out = gap_of(
            "session",
            judged,
            nominal_parameters(bench),
            without=left,
            entries=entries,
            curves=curves,
        )
        packages = effect_packages(entries)
        page = diagnosis_json(found) | {"left_out": list(left_out)}
        return page | {"packages": packages}

    given = [bench.model_dump(mode="json"), sorted(left), *effect_code(left)]
    known = run.digest or run.stages.digest(tuple(judged))
    facts = run.stages.digest(
        tuple((r.name, r.hits, r.preload, r.provenance) for r in judged)
    )
    compared = run.stages.digest(curves)
    key = run.stages.key("gap", given, known, facts, compared)
    return run.stages.run("gap", key, Page, make)


def gap_of(
    name: str,
    judged: Sequence[Recording],
    nominal: NominalParameters,
    *,
    without: frozenset[str],
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    curves: MeasuredCurves | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Diagnosis, tuple[str, ...]]:
    """Diagnose the campaign that recordings make.

    Args:
        name: of the campaign.
        judged: recordings with hits and preloads, in the order recorded.
        nominal: the model that should explain them.
        without: names of effects to leave out.
        entries: the catalogue.
        curves: modes over amplitude, to be shown next to the explanations.
        progress: receives one line per step; None for no report.

    Returns:
        Verdict and evidence, and why accepted hits were left out, a line each.
    """
    campaign, left_out = session_campaign(name, judged, nominal)
    found = diagnose(
        campaign, without=without, entries=entries, curves=curves, progress=progress
    )
    return found, left_out
