# SPDX-License-Identifier: MIT
"""Everything a session can tell: modes, surfaces and, with a bench model, a joint."""

from dataclasses import dataclass, replace

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
from jointbench.station.process_joint import at_words
from jointbench.station.results_beside import StoredResults
from jointbench.station.surface import SurfaceChain, analyse_surface


@dataclass(frozen=True, slots=True, eq=False)
class PreloadAnalysis:
    """Modes at one preload of the joint, and the links that they identify.

    Attributes:
        preload: [N], or None where nobody said.
        modal: hits, FRF and modes.
        run: by which run the modes were found; empty where they were found now.
        joint: identified from the modes, if a model names the bodies.
    """

    preload: float | None
    modal: ModalChain
    run: str = ""
    joint: Identification | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SessionAnalysis:
    """What was found in a session; None or empty where there was nothing to find.

    Attributes:
        session: as recorded.
        recordings: with judged hits; empty if none holds a hit.
        preloads: modes at each preload that has some.
        surfaces: from its surfaces.
        contact: predicted from the surfaces, if a model names a contact.
        remarks: what could not be done, and why, a line each.
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
    session: Session, model: BenchModel | None, stored: StoredResults | None = None
) -> SessionAnalysis:
    """Run every chain that the session and the model allow.

    A stage that cannot be done becomes a remark; it does not take the others along.

    Args:
        session: as recorded.
        model: of the bench, or None.
        stored: results that exist; modes are taken from them and not looked for again.
    """
    remarks: list[str] = [] if stored is None else list(stored.remarks)
    with working("judging hits, estimating FRFs, fitting modes"):
        recordings = _judged(session, remarks)
        preloads = _modes(recordings, stored, remarks)
    with working("fitting surfaces"):
        surfaces = tuple(analyse_surface(surface) for surface in session.surfaces)
    with working("predicting and identifying the joint"):
        contact = _contact(surfaces, model, remarks)
        preloads = tuple(
            replace(one, joint=_joint(one, model, remarks)) for one in preloads
        )
    return SessionAnalysis(
        session, recordings, preloads, surfaces, contact, tuple(remarks)
    )


def _judged(session: Session, remarks: list[str]) -> tuple[Recording, ...]:
    try:
        return judge_hits(session.recordings, ChainSettings())
    except BadData as error:
        remarks.append(f"No hits: {error}")
        return ()


def _modes(
    recordings: tuple[Recording, ...],
    stored: StoredResults | None,
    remarks: list[str],
) -> tuple[PreloadAnalysis, ...]:
    """Return the modes at each preload: those that are stored, else found now."""
    if not recordings:
        return ()
    found = []
    for preload, group in by_preload(recordings):
        known = None if stored is None else stored.at(preload)
        try:
            if known is None:
                found.append(PreloadAnalysis(preload, run_chain(group)))
            else:
                modes, run = known
                chain = modes.with_recordings(group)
                found.append(PreloadAnalysis(preload, chain, run))
        except BadData as error:
            remarks.append(f"No modes{at_words(preload)}: {error}")
    return tuple(found)


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
    modes: PreloadAnalysis, model: BenchModel | None, remarks: list[str]
) -> Identification | None:
    if model is None:
        return None
    try:
        return identify_joint(model, modes.modal.result.model)
    except BadData as error:
        at = at_words(modes.preload)
        remarks.append(f"No joint identification{at}: {error}")
        return None
