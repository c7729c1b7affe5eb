# SPDX-License-Identifier: MIT
"""A recorded session through the whole chain under a recipe, stage by stage.

Hits, modes at each preload and links from them, surfaces, the contact between them, and
the gap over all recordings: the stages of `chain` and `joint_stages`, with the settings
that the recipe names. Each is kept by content (`stage_store`): change the window, and
hits, Kalman stage, surfaces and contact are taken as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from jointbench.acquisition.basics.errors import BadData, JointbenchError, UsageError
from jointbench.acquisition.records.recordings import Recording, Verdict
from jointbench.acquisition.records.session import Session
from jointbench.analysis.gap.diagnosis.amplitude_evidence import MeasuredCurves
from jointbench.analysis.lumped.identified import identification_json
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.surface.structure_constant import DEFAULT_GAMMA
from jointbench.station.contact.measured_words import measured_json
from jointbench.station.pipeline.chain import ModalChain, hits_stage, modal_chain
from jointbench.station.pipeline.contact_prediction import contact_json
from jointbench.station.pipeline.joint_comparison import predict_measured_joint
from jointbench.station.pipeline.joint_stages import (
    Remarks,
    contact_stage,
    gap_stage,
    joint_stage,
    surface_stages,
)
from jointbench.station.pipeline.judge_again import Hits, VerdictChange, verdict_changes
from jointbench.station.pipeline.modal_notes import limit_words
from jointbench.station.pipeline.recipe_settings import (
    chain_settings,
    hit_criteria,
    stored_hits,
    surface_treatment_of,
    texture_request_of,
)
from jointbench.station.pipeline.recordings_by_preload import at_words, by_preload
from jointbench.station.pipeline.stage_store import StageRun, StageStore
from jointbench.station.pipeline.surface_options import SurfaceOptions
from jointbench.station.pipeline.surface_stages import (
    SurfaceChain,
    chain_cautions,
    with_texture,
)
from jointbench.station.schemas.bench_model import ContactTable
from jointbench.station.schemas.gap_model import nominal_parameters
from jointbench.station.schemas.recipe import Recipe

Page = dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class PreloadModes:
    """Modes at one preload of the joint.

    Attributes:
        preload: [N], None where it is not known.
        recordings: names of the recordings they come from.
        chain: hits, FRF and modes.
    """

    preload: float | None
    recordings: tuple[str, ...]
    chain: ModalChain


@dataclass(frozen=True, slots=True, eq=False)
class ProcessedSession:
    """What a recipe makes of a session.

    Attributes:
        session: as recorded.
        hits: of each recording, as judged now.
        changes: hits whose verdict is another than the stored one.
        modal: modes at each preload.
        surfaces: structure function and fractal fit of each surface.
        contact: predicted joint, plain data, or None.
        joints: identified links at each preload that has them, plain data.
        gap: verdict on the model, plain data, or None.
        remarks: what could not be done, and why, a line each.
        stages: what was run and what was taken as kept.
    """

    session: Session
    hits: tuple[Hits, ...]
    changes: tuple[VerdictChange, ...]
    modal: tuple[PreloadModes, ...]
    surfaces: tuple[SurfaceChain, ...]
    contact: dict[str, Any] | None
    joints: tuple[tuple[float | None, dict[str, Any]], ...]
    gap: dict[str, Any] | None
    remarks: tuple[str, ...]
    stages: StageStore


def process_session(
    session: Session, digest: str, recipe: Recipe, stages: StageStore
) -> ProcessedSession:
    """Run the chain; a late stage that cannot be done becomes a remark.

    Args:
        session: as recorded.
        digest: SHA-256 of its file.
        recipe: how to read it.
        stages: keeps the stages.

    Raises:
        BadData: there is nothing in it, no usable hit, or no mode.
    """
    if not session.recordings and not session.surfaces:
        raise BadData("the session holds neither recordings nor surfaces")
    run, remarks = StageRun(stages, digest), Remarks((JointbenchError,))
    hits = _hits(session, recipe, run)
    judged = tuple(
        replace(recording, hits=own)
        for recording, own in zip(session.recordings, hits, strict=True)
        if own
    )
    modal = _modal(judged, recipe, run, remarks.lines)
    surfaces = _surfaces(session, recipe, run)
    cautions = [said for one in surfaces for said in chain_cautions(one)]
    remarks.lines.extend(f"Surface {said}" for said in cautions)
    return ProcessedSession(
        session=session,
        hits=hits,
        changes=verdict_changes(session.recordings, hits, hit_criteria(recipe.hits)),
        modal=modal,
        surfaces=surfaces,
        contact=_contact(session, surfaces, recipe, run, remarks),
        joints=tuple(
            (modes.preload, page)
            for modes in modal
            if (page := _joint(modes, recipe, run, remarks)) is not None
        ),
        gap=_gap(session, judged, modal, recipe, run, remarks),
        remarks=tuple(remarks.lines),
        stages=stages,
    )


def _hits(session: Session, recipe: Recipe, run: StageRun) -> tuple[Hits, ...]:
    criteria, stored = hit_criteria(recipe.hits), stored_hits(recipe.hits)
    found = hits_stage(session.recordings, criteria, stored, run)
    hits = tuple(one.hits for one in found)
    if hits and not any(hit.verdict is Verdict.OK for own in hits for hit in own):
        raise BadData(_all_refused(hits))
    return hits


def _all_refused(hits: Sequence[Hits]) -> str:
    refused = [hit for own in hits for hit in own]
    if not refused:
        return "there is no hit in the session"
    return (
        f"none of {len(refused)} hits is accepted; the first is "
        f"{refused[0].verdict.value}: {refused[0].reason}"
    )


def _modal(
    judged: Sequence[Recording], recipe: Recipe, run: StageRun, remarks: list[str]
) -> tuple[PreloadModes, ...]:
    """Return the modes at each preload; those that fail are reported, unless all do.

    Raises:
        BadData: there is no mode at any preload.
    """
    if not judged:
        return ()
    found: list[PreloadModes] = []
    problems: list[JointbenchError] = []
    for preload, group in by_preload(judged):
        try:
            found.append(_modes_at(preload, group, recipe, run))
            words = limit_words(found[-1].chain)
            remarks += [f"Modes{at_words(preload)}: {w}" for w in words]
        except (BadData, UsageError) as error:
            problems.append(error)
            remarks.append(f"No modes{at_words(preload)}: {error}")
    if problems and not found:
        raise problems[0]
    return tuple(found)


def _modes_at(
    preload: float | None, group: Sequence[Recording], recipe: Recipe, run: StageRun
) -> PreloadModes:
    chain = modal_chain(group, chain_settings(recipe), run, preload)
    # A result speaks of the samples as recorded, not of those filled since.
    chain = replace(chain, recordings=tuple(group))
    return PreloadModes(preload, tuple(r.name for r in group), chain)


def _surfaces(
    session: Session, recipe: Recipe, run: StageRun
) -> tuple[SurfaceChain, ...]:
    """Fit every surface of a session, or none if the recipe excludes them."""
    if not recipe.surface.use:
        return ()
    gamma = recipe.surface.gamma or DEFAULT_GAMMA
    treatment = surface_treatment_of(recipe)
    chains = surface_stages(session.surfaces, run, gamma, treatment)
    asked = SurfaceOptions(treatment, texture=texture_request_of(recipe))
    pairs = zip(chains, session.surfaces, strict=True)
    return tuple(with_texture(chain, given, asked) for chain, given in pairs)


def _contact(
    session: Session,
    surfaces: Sequence[SurfaceChain],
    recipe: Recipe,
    run: StageRun,
    remarks: Remarks,
) -> Page | None:
    """Predict the joint from the session's surfaces, if the recipe has a contact."""
    part = recipe.contact
    if part is None:
        return None
    if not surfaces:
        why = "no surface in the session is fitted"
        remarks.lines.append(f"No contact prediction: {why}")
        return None
    stored = None if session.joint is None else session.joint.preload
    preload = part.preload or stored
    if preload is None:
        why = "no preload in the recipe or the session"
        remarks.lines.append(f"No contact prediction: {why}")
        return None
    given = part.model_dump(exclude={"area"}) | {"preload": preload}
    # Read as a table its numbers would need units again; they were checked there.
    table = ContactTable.model_construct(link="joint", **given)
    found = remarks.attempt(
        "contact prediction", lambda: contact_stage(surfaces, table, run)
    )
    laws = None
    if part.area is not None:
        area = part.area
        laws = remarks.attempt(
            "laws of measured surfaces",
            lambda: _measured(surfaces, table, area, run),
        )
    if found is None:
        return None if laws is None else contact_json((), None, laws)
    return contact_json([found.at], found.surface, laws)


def _measured(
    surfaces: Sequence[SurfaceChain], table: ContactTable, area: float, run: StageRun
) -> Page:
    """Predict the joint by the laws of measured surfaces, as ``contact`` does.

    Args:
        surfaces: of both sides, or one that stands for both.
        table: material and preload.
        area: apparent [m^2].
        run: store and source.
    """
    heights = tuple(one.surface for one in surfaces)
    given = [table.model_dump(mode="json", exclude={"link", "model"}), area]
    return run.stages.run(
        "measured_contact",
        run.stages.key("measured_contact", given, run.stages.digest(heights)),
        Page,
        lambda: measured_json(predict_measured_joint(heights, table, area)),
    )


def _joint(
    modes: PreloadModes, recipe: Recipe, run: StageRun, remarks: Remarks
) -> Page | None:
    """Identify the links of the recipe's model from the modes at a preload."""
    if recipe.identification is None:
        return None
    bench = recipe.models[recipe.identification.model]
    found = remarks.attempt(
        f"joint identification{at_words(modes.preload)}",
        lambda: joint_stage(modes.chain.result.model, bench, run, modes.preload),
    )
    return None if found is None else identification_json(found)


def _gap(
    session: Session,
    judged: Sequence[Recording],
    modal: Sequence[PreloadModes],
    recipe: Recipe,
    run: StageRun,
    remarks: Remarks,
) -> Page | None:
    """Ask what the recipe's model lacks."""
    if recipe.gap is None or not judged:
        return None
    bench, without = recipe.models[recipe.gap.model], recipe.gap.without
    of_session = None if session.joint is None else session.joint.preload
    recordings = [
        r if r.preload is not None else replace(r, preload=of_session) for r in judged
    ]

    def make() -> Page:
        reference = nominal_parameters(bench).preload_reference
        curves = curves_at(modal, reference)
        return gap_stage(recordings, bench, without, run, curves)

    return remarks.attempt("gap", make)


def curves_at(modal: Sequence[PreloadModes], reference: float | None) -> MeasuredCurves:
    """Return the modes over amplitude at the preload that a model belongs to.

    Args:
        modal: modes at each preload.
        reference: preload of the model [N]; None takes the first.
    """
    for modes in modal:
        if reference is None or modes.preload is None or modes.preload == reference:
            hits = sum(len(accepted_hits(r)) for r in modes.chain.recordings)
            return MeasuredCurves(modes.chain.amplitude, hits=hits)
    at = at_words(reference)
    return MeasuredCurves(reason=f"no modes{at}, the preload of the model")
