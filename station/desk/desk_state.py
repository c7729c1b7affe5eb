# SPDX-License-Identifier: MIT
"""The state of the modal desk: a record that every choice replaces by another.

The state is a function of the files and of the log of choices alone: after a reload or
a kill the log gives it again.
"""

from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.amplitude.amplitude_modes import amplitude_modes
from jointbench.signal.kalman.stage_provenance import stage_gain_of
from jointbench.signal.modal.chosen_poles.pole_evidence import (
    PoleEvidence,
    examine_pole,
)
from jointbench.signal.modal.chosen_poles.refit_chosen import (
    FitBasis,
    fit_basis,
    refit_chosen,
)
from jointbench.station.desk.chosen_set import (
    ChosenSet,
    automatic_set,
    located,
    pins_of,
    with_pole_choice,
)
from jointbench.station.desk.desk_choice import (
    FRF_ACTIONS,
    ChoiceAction,
    DeskChoice,
    choice_steps,
    effective,
)
from jointbench.station.desk.desk_subject import DeskSubject, automatic_chain
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.pipeline.stage_store import StageRun


@dataclass(frozen=True, slots=True, eq=False)
class DeskState:
    """A subject with the choices made of it.

    Attributes:
        subject: what lies on the desk.
        log: every choice, those taken back included.
        automatic: FRF and modes that the program chose.
        basis: what all fits on that FRF share.
        chosen: the poles as they are chosen now.
        chain: FRF and modes as chosen.
        remarks: choices that could not be repeated, a sentence each.
    """

    subject: DeskSubject
    log: tuple[DeskChoice, ...]
    automatic: ModalChain
    basis: FitBasis
    chosen: ChosenSet
    chain: ModalChain
    remarks: tuple[str, ...] = ()


def desk_state(
    subject: DeskSubject, log: tuple[DeskChoice, ...] = (), run: StageRun | None = None
) -> DeskState:
    """Return the state of a subject after a log of choices.

    A choice of a pole that is no longer there, as after another band was asked for, is
    left out and named.

    Raises:
        BadData: there is no FRF, or no mode rises above the noise.
    """
    held = [one for one in effective(log) if one.action in FRF_ACTIONS]
    automatic = automatic_chain(subject, held, run or StageRun())
    result = automatic.result
    basis = fit_basis(automatic.frf, result.model, result.synthesis)
    blank = DeskState(subject, log, automatic, basis, (), automatic)
    return _chosen(blank)


def decided(state: DeskState, choice: DeskChoice) -> DeskState:
    """Return the state after one more choice.

    Raises:
        UsageError: there is nothing at the place of the choice, or nothing to undo.
        BadData: no hit would be left.
    """
    before = effective(state.log)
    if choice.action is ChoiceAction.UNDO and not before:
        raise UsageError("there is no choice to take back")
    table = state.automatic.result.stabilisation
    choice = located(choice, table)
    log = (*state.log, choice)
    changed = before[-1] if choice.action is ChoiceAction.UNDO else choice
    if changed.action in FRF_ACTIONS:
        _require_hits(state, choice)
        return desk_state(state.subject, log)
    if choice.action is not ChoiceAction.UNDO:
        # What cannot be done is refused here, and never comes into the log.
        with_pole_choice(state.chosen, table, choice)
    return _chosen(replace(state, log=log))


def made_choice(
    action: ChoiceAction, who: str, **what: float | int | str
) -> DeskChoice:
    """Return a choice made now.

    Args:
        action: what is done.
        who: does it.
        what: frequency, damping ratio, order and so on, see `DeskChoice`.
    """
    now = datetime.now(UTC).isoformat(timespec="seconds")
    return DeskChoice(action, who, now, **what)  # type: ignore[arg-type]


def evidence(state: DeskState, row: int) -> PoleEvidence:
    """Return what speaks for one pole of the diagram.

    Raises:
        UsageError: the diagram has no such row.
    """
    table, basis = state.automatic.result.stabilisation, state.basis
    if not 0 <= row < table.order.size:
        raise UsageError(f"the diagram has {table.order.size} poles and none of {row}")
    shape = (*basis.frf.response.shape[:2], -1)
    return examine_pole(
        basis.frf, basis.keep, basis.variance.reshape(shape), table, row
    )


def with_curves(state: DeskState) -> DeskState:
    """Return the state with the chosen modes resolved over their amplitude.

    Raises:
        UsageError: FRFs from files hold no hits at different levels.
    """
    chain = state.chain
    if not chain.recordings:
        raise UsageError("FRFs from files have no hits at different levels")
    found = amplitude_modes(chain.recordings, chain.result.model)
    return replace(state, chain=replace(chain, amplitude=found))


def _require_hits(state: DeskState, choice: DeskChoice) -> None:
    if not state.subject.recordings:
        raise UsageError("FRFs from files have no hits to drop, and no estimator")
    names = {r.name for r in state.subject.recordings}
    hit = choice.action in {ChoiceAction.DROP_HIT, ChoiceAction.KEEP_HIT}
    if hit and choice.name not in names:
        raise UsageError(f"there is no recording {choice.name!r} on the desk")


def _chosen(state: DeskState) -> DeskState:
    """Apply the choices of poles that hold, and fit."""
    automatic, basis = state.automatic, state.basis
    table = automatic.result.stabilisation
    held = effective(state.log)
    poles = automatic_set(basis.automatic, table)
    remarks: list[str] = []
    for one in held:
        try:
            poles = with_pole_choice(poles, table, one)
        except UsageError as error:
            remarks.append(f"{one.who} {one.words()}: left out, {error}")
    if all(one.action in FRF_ACTIONS for one in held):
        chain = automatic
        if state.log:
            steps = (*chain.provenance, *choice_steps(state.log))
            model = replace(chain.result.model, provenance=steps)
            result = replace(chain.result, model=model)
            chain = replace(chain, result=result, provenance=steps)
        return replace(state, chosen=poles, chain=chain, remarks=())
    own = automatic.provenance[len(basis.frf.provenance) :]
    fit = refit_chosen(
        basis,
        [one.candidate for one in poles],
        pins_of(poles),
        (*own, *choice_steps(state.log)),
    )
    result = replace(
        automatic.result,
        model=fit.model,
        synthesis=fit.synthesis,
        synthesis_error=fit.synthesis_error,
        stage_gain=stage_gain_of(basis.frf.provenance, fit.model.natural_frequency),
    )
    chain = replace(automatic, result=result, provenance=fit.model.provenance)
    return replace(state, chosen=poles, chain=chain, remarks=tuple(remarks))


def chosen_rows(state: DeskState) -> tuple[int, ...]:
    """Return the row of the diagram nearest to each chosen pole, -1 for none."""
    table = state.automatic.result.stabilisation
    if table.order.size == 0:
        return (-1,) * len(state.chosen)
    return tuple(
        int(np.argmin(np.abs(table.pole - one.candidate.pole))) for one in state.chosen
    )
