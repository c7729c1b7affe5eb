# SPDX-License-Identifier: MIT
"""A recorded session through the whole chain under a recipe, stage by stage.

::

    hits    <- samples, [hits]              surface <- heights, [surface]
    kalman  <- samples, [kalman]            contact <- surfaces, [contact]
    frf     <- hits, kalman, [windows], [frf]
    modes   <- frf, [modes]                 fill    <- modes, samples (lost ones)
    joint   <- modes or fill, the model     gap     <- hits, samples, the model

Modes, and links from them, at each preload; the gap over all of them.

Each stage is kept by content (`stage_store`): change the window, and hits, Kalman
stage, surfaces and contact are taken as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from jointbench.acquisition.errors import BadData, JointbenchError, UsageError
from jointbench.acquisition.records import Recording, Verdict
from jointbench.acquisition.session import Session
from jointbench.signal.frf import Frf
from jointbench.signal.modes import ModalResult, identify_modes
from jointbench.station.chain import (
    ChainSettings,
    ModalChain,
    chain_frf,
    fill_and_repeat,
    smoothed,
)
from jointbench.station.judge_again import (
    Hits,
    VerdictChange,
    judge_again,
    verdict_changes,
)
from jointbench.station.modal_notes import limit_words
from jointbench.station.preloads import by_preload
from jointbench.station.process_joint import (
    PreloadModes,
    at_words,
    contact_stage,
    gap_stage,
    joint_stage,
    surface_stage,
)
from jointbench.station.recipe import Recipe
from jointbench.station.recipe_settings import chain_settings
from jointbench.station.stage_store import StageStore, stage_key
from jointbench.station.surface import SurfaceChain, chain_cautions


@dataclass(frozen=True, slots=True, eq=False)
class Refit:
    """FRF and modes once lost samples were filled."""

    frf: Frf
    result: ModalResult


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
    remarks: list[str] = []
    hits = _hits(session, digest, recipe, stages)
    judged = tuple(
        replace(recording, hits=own)
        for recording, own in zip(session.recordings, hits, strict=True)
        if own
    )
    modal = _modal(judged, digest, recipe, stages, remarks)
    surfaces = surface_stage(session, digest, recipe, stages)
    remarks += [f"Surface {said}" for one in surfaces for said in chain_cautions(one)]
    return ProcessedSession(
        session=session,
        hits=hits,
        changes=verdict_changes(session.recordings, hits, recipe.hits),
        modal=modal,
        surfaces=surfaces,
        contact=contact_stage(session, surfaces, recipe, stages, remarks),
        joints=tuple(
            (modes.preload, page)
            for modes in modal
            if (page := joint_stage(modes, recipe, stages, remarks)) is not None
        ),
        gap=gap_stage(session, judged, recipe, stages, remarks),
        remarks=tuple(remarks),
        stages=stages,
    )


def _hits(
    session: Session, digest: str, recipe: Recipe, stages: StageStore
) -> tuple[Hits, ...]:
    if not session.recordings:
        return ()
    hits = stages.run(
        "hits",
        stage_key("hits", recipe.hits.model_dump(), digest),
        tuple[Hits, ...],
        lambda: judge_again(session.recordings, recipe.hits),
    )
    if not any(hit.verdict is Verdict.OK for own in hits for hit in own):
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
    judged: Sequence[Recording],
    digest: str,
    recipe: Recipe,
    stages: StageStore,
    remarks: list[str],
) -> tuple[PreloadModes, ...]:
    """Return the modes at each preload; those that fail are told, unless all do.

    Raises:
        BadData: there is no mode at any preload.
    """
    if not judged:
        return ()
    found: list[PreloadModes] = []
    problems: list[JointbenchError] = []
    for preload, group in by_preload(judged):
        try:
            found.append(_modes_at(preload, group, digest, recipe, stages))
            words = limit_words(found[-1].chain)
            remarks += [f"Modes{at_words(preload)}: {w}" for w in words]
        except (BadData, UsageError) as error:
            problems.append(error)
            remarks.append(f"No modes{at_words(preload)}: {error}")
    if problems and not found:
        raise problems[0]
    return tuple(found)


def _modes_at(
    preload: float | None,
    group: Sequence[Recording],
    digest: str,
    recipe: Recipe,
    stages: StageStore,
) -> PreloadModes:
    settings = chain_settings(recipe)
    at = at_words(preload)
    keys = [_kalman_key(r, digest, settings) for r in group]
    frf_key = stage_key(
        "frf",
        [settings.window, settings.estimator.value, [r.name for r in group]],
        stages.keys["hits"],
        *keys,
    )
    frf = stages.run(
        f"frf{at}",
        frf_key,
        Frf,
        lambda: chain_frf(_smoothed(group, keys, settings, stages), settings),
    )
    modes_key = stage_key("modes", settings.modal, frf_key)
    result = stages.run(
        f"modes{at}",
        modes_key,
        ModalResult,
        lambda: identify_modes(frf, settings.modal),
    )
    fill_key = stage_key("fill", settings, modes_key, digest)
    refits = stages.run(
        f"fill{at}",
        fill_key,
        tuple[Refit, ...],
        lambda: _refits(group, result, settings),
    )
    for refit in refits:
        frf, result = refit.frf, refit.result
    chain = ModalChain(tuple(group), frf, result, result.model.provenance)
    return PreloadModes(preload, tuple(r.name for r in group), chain, fill_key)


def _kalman_key(recording: Recording, digest: str, settings: ChainSettings) -> str:
    return stage_key("kalman", settings.kalman, digest, recording.name)


def _smoothed(
    group: Sequence[Recording],
    keys: Sequence[str],
    settings: ChainSettings,
    stages: StageStore,
) -> list[Recording]:
    """Return recordings after the Kalman stage, with their hits; asked for late."""
    if settings.kalman is None:
        return list(group)
    found = []
    for recording, key in zip(group, keys, strict=True):
        bare = replace(recording, hits=())
        kept = stages.run(
            f"kalman of {recording.name}",
            key,
            Recording,
            lambda bare=bare: smoothed(bare, settings),  # type: ignore[misc]
        )
        found.append(replace(kept, hits=recording.hits))
    return found


def _refits(
    group: Sequence[Recording], result: ModalResult, settings: ChainSettings
) -> tuple[Refit, ...]:
    """Return the fit with lost samples filled; none where nothing was lost."""
    chain = fill_and_repeat(group, result, settings)
    return () if chain is None else (Refit(chain.frf, chain.result),)
