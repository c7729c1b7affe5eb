# SPDX-License-Identifier: MIT
"""Everything a session can tell: modes, surfaces and, with a bench model, a joint."""

from dataclasses import dataclass

from jointbench.acquisition.errors import BadData
from jointbench.acquisition.records import Recording
from jointbench.acquisition.session import Session
from jointbench.analysis.identification import Identification
from jointbench.station.bench_model import BenchModel
from jointbench.station.chain import ChainSettings, ModalChain, judge_hits, run_chain
from jointbench.station.identify import identify_joint
from jointbench.station.joint import ContactPrediction, predict_joint
from jointbench.station.output import working
from jointbench.station.preloads import by_preload
from jointbench.station.surface import SurfaceChain, analyse_surface


@dataclass(frozen=True, slots=True, eq=False)
class SessionAnalysis:
    """What was found in a session; None or empty where there was nothing to find.

    Attributes:
        session: as recorded.
        recordings: with judged hits; empty if none holds a hit.
        modal: from its recordings.
        surfaces: from its surfaces.
        contact: predicted from the surfaces, if a model names a contact.
        joint: identified from the modes, if a model names the bodies.
        remarks: what could not be done, and why, a line each.
    """

    session: Session
    recordings: tuple[Recording, ...] = ()
    modal: ModalChain | None = None
    surfaces: tuple[SurfaceChain, ...] = ()
    contact: ContactPrediction | None = None
    joint: Identification | None = None
    remarks: tuple[str, ...] = ()


def analyse_session(session: Session, model: BenchModel | None) -> SessionAnalysis:
    """Run every chain that the session and the model allow.

    A stage that cannot be done becomes a remark; it does not take the others along.
    """
    remarks: list[str] = []
    with working("judging hits, estimating FRFs, fitting modes"):
        recordings = _judged(session, remarks)
        modal = _modal(recordings, remarks)
    with working("fitting surfaces"):
        surfaces = tuple(analyse_surface(surface) for surface in session.surfaces)
    with working("predicting and identifying the joint"):
        contact = _contact(surfaces, model, remarks)
        joint = _joint(modal, model, remarks)
    return SessionAnalysis(
        session, recordings, modal, surfaces, contact, joint, tuple(remarks)
    )


def _judged(session: Session, remarks: list[str]) -> tuple[Recording, ...]:
    try:
        return judge_hits(session.recordings, ChainSettings())
    except BadData as error:
        remarks.append(f"No hits: {error}")
        return ()


def _modal(recordings: tuple[Recording, ...], remarks: list[str]) -> ModalChain | None:
    if not recordings:
        return None
    groups = by_preload(recordings)
    if len(groups) > 1:
        remarks.append(
            f"The recordings have {len(groups)} preloads; shown are the modes at "
            f"{groups[0][0]:g} N. `jointbench modal` shows those at each."
            if groups[0][0] is not None
            else "Shown are the modes of the recordings that state no preload."
        )
    try:
        return run_chain(groups[0][1])
    except BadData as error:
        remarks.append(f"No modes: {error}")
        return None


def _contact(
    surfaces: tuple[SurfaceChain, ...], model: BenchModel | None, remarks: list[str]
) -> ContactPrediction | None:
    if model is None or model.contact is None or not surfaces:
        return None
    try:
        return predict_joint([s.structure for s in surfaces], model.contact)
    except BadData as error:
        remarks.append(f"No contact prediction: {error}")
        return None


def _joint(
    modal: ModalChain | None, model: BenchModel | None, remarks: list[str]
) -> Identification | None:
    if model is None or modal is None:
        return None
    try:
        return identify_joint(model, modal.result.model)
    except BadData as error:
        remarks.append(f"No joint identification: {error}")
        return None
