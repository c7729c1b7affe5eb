# SPDX-License-Identifier: MIT
"""States of a joint file in the form that the bench takes: loops become values."""

import math
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.quoting import named
from jointbench.analysis.contact.loops.joint_loop import JointLoop
from jointbench.analysis.contact.loops.loop_estimates import (
    LoopEstimates,
    LoopLevel,
    estimate_loop,
)
from jointbench.analysis.gap.contact_bench.joint_states import QUANTITIES
from jointbench.station.joint_states.loop_files import read_loop
from jointbench.station.schemas.joint_states_model import JointStateTable

_NO_SLIP = 1e-3
"""Tangential force right after a reversal over the least amplitude: none slips."""
_NOT_LOOPED: dict[str, object] = {
    **{quantity.value: None for quantity in QUANTITIES},
    **{"loop": None, "identified": None, "parameters": {}, "correlation": {}},
}


@dataclass(frozen=True, slots=True, eq=False)
class StateLoop:
    """A loop of a joint, and what follows from it.

    Attributes:
        name: of the file.
        table: the state that names it.
        loop: as measured.
        found: stiffness and energies.
    """

    name: str
    table: JointStateTable
    loop: JointLoop
    found: LoopEstimates

    @property
    def words(self) -> str:
        """What follows from it, in one line."""
        one = self.found
        count = sum(level.cycles for level in one.levels)
        losses = [f"{x.loss_factor:.2g}" for x in one.levels if x.dissipates]
        loss = f"loss factor {', '.join(losses)}" if losses else "no loss determined"
        left = len(one.levels) - len(losses)
        words = (
            f"{self.name}: {count} cycles at {len(one.levels)} amplitudes, tangential "
            f"stiffness {one.stiffness:.4g} N/m +- {100 * one.stiffness_sd:.1f} %, "
            f"{loss}"
        )
        if losses and left:
            words += f"; noise hides the loss of {left}"
        return words


@dataclass(frozen=True, slots=True, eq=False)
class SetState:
    """A state with values of its own, and the setting of the preload it belongs to.

    Attributes:
        table: values and facts.
        setting: index of the state in the file.
        common_sd: sd of ln that all values of a loop share: its calibration [-].
        loop: whose stiffness these values are; None for all others.
    """

    table: JointStateTable
    setting: int
    common_sd: float = 0.0
    loop: StateLoop | None = None


def _looped(state: JointStateTable, path: Path) -> StateLoop:
    loop = read_loop(path)
    try:
        return StateLoop(path.name, state, loop, estimate_loop(loop))
    except BadData as error:
        raise BadData(f"{named(path)}: {error}") from error


def set_states(
    states: tuple[JointStateTable, ...], folder: Path
) -> tuple[SetState, ...]:
    """Return states with a loop as its stiffness, then its damping by amplitude.

    All of them have the preload of one setting.

    Args:
        states: of a joint file.
        folder: that holds the files of loops.

    Raises:
        BadData: a file cannot be used, or holds no cycle that can be evaluated, or
            damping without its frequency stands beside loops, whose damping has
            another one.
    """
    found: list[SetState] = []
    for number, state in enumerate(states):
        if state.loop is None:
            found.append(SetState(state, number))
        else:
            if state.identified or any(_given(state, q.value) for q in QUANTITIES):
                plain = state.model_copy(update={"loop": None})
                found.append(SetState(plain, number))
            found += _values(_looped(state, folder / state.loop), number)
    _check_frequencies(states)
    return tuple(found)


def _given(state: JointStateTable, key: str) -> bool:
    return getattr(state, key) is not None


def _values(one: StateLoop, number: int) -> list[SetState]:
    """Return the stiffness of a loop, then its damping by rising amplitude."""
    common, found = one.table.loop_sd, one.found
    slip = _NO_SLIP * min(level.force for level in found.levels)
    stiff = {
        "kt": (found.stiffness, False),
        "kt_sd": math.hypot(found.stiffness_sd, common),
        "shear": slip,
    }
    damped = [_damped(level, one.table) for level in found.levels if level.dissipates]

    def state(row: dict[str, object]) -> JointStateTable:
        return one.table.model_copy(update=_NOT_LOOPED | row)

    first = SetState(state(stiff), number, common, one)
    return [first, *(SetState(state(row), number, common) for row in damped)]


def _damped(level: LoopLevel, state: JointStateTable) -> dict[str, object]:
    frequency = state.frequency or 1.0
    return {
        "ct": (level.damping(frequency), False),
        "ct_sd": math.hypot(level.energy_sd, state.loop_loss_sd, state.loop_sd),
        "shear": level.force,
    }


def _check_frequencies(states: tuple[JointStateTable, ...]) -> None:
    if all(state.loop is None for state in states):
        return
    for number, state in enumerate(states, 1):
        damped = _given(state, "cn") or _given(state, "ct")
        damped = damped or bool({"cn", "ct"} & set(state.parameters))
        if damped and state.frequency is None:
            raise BadData(
                f"state {number} has damping without its frequency beside loops, whose "
                "damping belongs to slow cycles; add frequency = '300 Hz'"
            )
