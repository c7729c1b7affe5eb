# SPDX-License-Identifier: MIT
"""Full analysis of a session: modes, surfaces and, with a bench model, the joint."""

from dataclasses import dataclass, replace
from functools import partial

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.analysis.lumped.identified import Identification
from jointbench.signal.amplitude.amplitude_modes import amplitude_modes
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    judge_hits,
    judged_modes,
)
from jointbench.station.pipeline.joint_comparison import ContactPrediction
from jointbench.station.pipeline.joint_stages import (
    Remarks,
    contact_stage,
    joint_stage,
    surface_stages,
)
from jointbench.station.pipeline.recordings_by_preload import at_words, by_preload
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.pipeline.surface_options import SurfaceOptions
from jointbench.station.pipeline.surface_stages import SurfaceChain, with_texture
from jointbench.station.results.results_beside import StoredResults
from jointbench.station.roughness.texture_request import TextureRequest
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.terminal import working

_STANDARD = SurfaceOptions(texture=TextureRequest())
"""A report shows the standard parameters with default settings."""


@dataclass(frozen=True, slots=True, eq=False)
class PreloadAnalysis:
    """Modes at one preload of the joint, and the links that they identify.

    Attributes:
        preload: [N], or None where it is not known.
        modal: hits, FRF and modes.
        run: run whose results hold the modes; empty if they were extracted now.
        joint: identified from the modes, if a model names the bodies.
    """

    preload: float | None
    modal: ModalChain
    run: str = ""
    joint: Identification | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SessionAnalysis:
    """Results of a session; None or empty where the session has no data for them.

    Attributes:
        session: as recorded.
        recordings: with judged hits; empty if none holds a hit.
        preloads: modes at each preload that has some.
        surfaces: from its surfaces.
        contact: predicted from the surfaces, if a model names a contact.
        remarks: stages that failed, with the reason, one line each.
    """

    session: Session
    recordings: tuple[Recording, ...] = ()
    preloads: tuple[PreloadAnalysis, ...] = ()
    surfaces: tuple[SurfaceChain, ...] = ()
    contact: ContactPrediction | None = None
    remarks: tuple[str, ...] = ()

    @property
    def modal(self) -> ModalChain | None:
        """Modes at the first preload, or None."""
        return self.preloads[0].modal if self.preloads else None

    @property
    def joint(self) -> Identification | None:
        """Links at the first preload that identifies them, or None."""
        found = (one.joint for one in self.preloads if one.joint is not None)
        return next(found, None)


def analyse_session(
    session: Session,
    model: BenchModel | None,
    stored: StoredResults | None = None,
    run: StageRun | None = None,
) -> SessionAnalysis:
    """Run every stage that the session and the model allow.

    A stage that fails becomes a remark; the other stages still run.

    Args:
        session: as recorded.
        model: of the bench, or None.
        stored: existing results; their modes are used instead of a new extraction.
        run: store and source of the stages; None to keep none.
    """
    run = run or StageRun()
    remarks = Remarks((BadData,), [] if stored is None else list(stored.remarks))
    with working("judging hits, estimating FRFs, fitting modes"):
        settings = ChainSettings()
        judged = remarks.attempt(
            "hits", lambda: judge_hits(session.recordings, settings, run)
        )
        preloads = _modes(judged or (), settings, stored, run, remarks)
    with working("fitting surfaces"):
        plain = surface_stages(session.surfaces, run)
        pairs = zip(plain, session.surfaces, strict=True)
        surfaces = tuple(with_texture(one, given, _STANDARD) for one, given in pairs)
    with working("predicting and identifying the joint"):
        contact = _contact(surfaces, model, run, remarks)
        preloads = tuple(
            replace(one, joint=_joint(one, model, run, remarks)) for one in preloads
        )
    return SessionAnalysis(
        session, judged or (), preloads, surfaces, contact, tuple(remarks.lines)
    )


def _modes(
    recordings: tuple[Recording, ...],
    settings: ChainSettings,
    stored: StoredResults | None,
    run: StageRun,
    remarks: Remarks,
) -> tuple[PreloadAnalysis, ...]:
    """Return the modes at each preload, stored ones where they exist."""
    if not recordings:
        return ()
    found = []
    for preload, group in by_preload(recordings):
        make = partial(_modes_at, preload, group, settings, stored, run)
        modes = remarks.attempt(f"modes{at_words(preload)}", make)
        found += [] if modes is None else [modes]
    return tuple(found)


def _modes_at(
    preload: float | None,
    group: tuple[Recording, ...],
    settings: ChainSettings,
    stored: StoredResults | None,
    run: StageRun,
) -> PreloadAnalysis:
    known = None if stored is None else stored.at(preload)
    if known is None:
        return PreloadAnalysis(preload, judged_modes(group, settings, run, preload))
    modes, of_run = known
    chain = modes.with_recordings(group)
    if modes.amplitude is None:
        # Files of earlier versions keep the modes; their curves are in the hits.
        curves = amplitude_modes(chain.recordings, chain.result.model)
        chain = replace(chain, amplitude=curves)
    return PreloadAnalysis(preload, chain, of_run)


def _contact(
    surfaces: tuple[SurfaceChain, ...],
    model: BenchModel | None,
    run: StageRun,
    remarks: Remarks,
) -> ContactPrediction | None:
    if model is None or model.contact is None or not surfaces:
        return None
    table = model.contact
    return remarks.attempt(
        "contact prediction", lambda: contact_stage(surfaces, table, run)
    )


def _joint(
    modes: PreloadAnalysis, model: BenchModel | None, run: StageRun, remarks: Remarks
) -> Identification | None:
    if model is None:
        return None
    return remarks.attempt(
        f"joint identification{at_words(modes.preload)}",
        lambda: joint_stage(modes.modal.result.model, model, run, modes.preload),
    )
