# SPDX-License-Identifier: MIT
"""Candidate series of torques on a joint that is put together again."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.analysis.gap.contact_bench.joint_states import (
    JointData,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.next_experiment.next_settings import NEXT


@dataclass(frozen=True, slots=True, eq=False)
class TorqueSeries:
    """States that are set one after the other, after a new assembly.

    Attributes:
        name: short.
        words: what to do.
        torque: on each bolt, or preload where no torque is known, shape (n,).
        falling: whether the joint comes from a higher one, same shape.
        wait: time since tightening [s], NaN where it does not matter, same shape.
        washer: whether the preload is measured.
        assemblies: how often the series is repeated, each time put together again.
    """

    name: str
    words: str
    torque: FloatArray
    falling: BoolArray
    wait: FloatArray
    washer: bool = False
    assemblies: int = 1

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "torque", "falling", "wait")

    @property
    def minutes(self) -> float:
        """Bench time [min]."""
        known = self.wait[np.isfinite(self.wait)]
        once = NEXT.assembly_minutes + NEXT.state_minutes * self.torque.size
        once += float(known.max()) / 60.0 if known.size else 0.0
        return self.assemblies * once + NEXT.washer_minutes * self.washer


def torque_series(states: JointStates) -> tuple[TorqueSeries, ...]:
    """Return the candidates for a joint that was measured in some states.

    Args:
        states: so far.
    """
    levels = np.unique(states.level)
    low, high = float(levels[0]), float(levels[-1])
    plain = np.geomspace(low, high, NEXT.levels)
    found = [_rising("repeat", "put the joint together again, same torques", plain)]
    for times in NEXT.higher:
        torque = np.geomspace(low, times * high, NEXT.levels)
        words = f"new assembly, torques from {low:.3g} up to {times * high:.3g}"
        found.append(_rising(f"to {times:g} x the highest", words, torque))
    for times in NEXT.lower:
        torque = np.geomspace(times * low, high, NEXT.levels)
        words = f"new assembly, torques from {times * low:.3g} up to {high:.3g}"
        found.append(_rising(f"from {times:g} x the lowest", words, torque))
    wide = np.geomspace(NEXT.lower[-1] * low, NEXT.higher[0] * high, NEXT.levels + 2)
    words = f"new assembly, torques from {wide[0]:.3g} up to {wide[-1]:.3g}"
    found.append(_rising("wider at both ends", words, wide))
    found.append(_and_back(plain))
    found.append(
        _rising("load washers", "new assembly with load washers", plain, washer=True)
    )
    found.append(
        _rising(
            "load washers, wider",
            f"new assembly with load washers, torques from {wide[0]:.3g} up to "
            f"{wide[-1]:.3g}",
            wide,
            washer=True,
        )
    )
    again = _rising(
        "wider, three assemblies",
        f"three new assemblies, torques from {wide[0]:.3g} up to {wide[-1]:.3g}",
        wide,
    )
    found.append(replace(again, assemblies=NEXT.assemblies))
    back = _and_back(wide)
    found.append(
        replace(
            back,
            name="all of it",
            words=f"three new assemblies with load washers, torques from {wide[0]:.3g} "
            f"up to {wide[-1]:.3g}, rising, then falling",
            washer=True,
            assemblies=NEXT.assemblies,
        )
    )
    if np.isfinite(states.time).any():
        found.append(_waiting(float(np.sqrt(low * high))))
    return tuple(found)


def _rising(
    name: str, words: str, torque: FloatArray, *, washer: bool = False
) -> TorqueSeries:
    none = np.zeros(torque.size, dtype=np.bool_)
    return TorqueSeries(name, words, torque, none, np.full(torque.size, np.nan), washer)


def _and_back(plain: FloatArray) -> TorqueSeries:
    torque = np.concatenate([plain, plain[-2::-1]])
    return TorqueSeries(
        "rising and falling",
        "new assembly, the same torques rising, then falling",
        torque,
        np.arange(torque.size) >= plain.size,
        np.full(torque.size, np.nan),
    )


def _waiting(torque: float) -> TorqueSeries:
    wait = np.array(NEXT.waits)
    return TorqueSeries(
        "waiting",
        f"new assembly at {torque:.3g}, measured 1, 10 and 100 minutes after "
        "tightening",
        np.full(wait.size, torque),
        np.zeros(wait.size, dtype=np.bool_),
        wait,
    )


def with_series(data: JointData, series: TorqueSeries) -> tuple[JointData, BoolArray]:
    """Return a joint with the states of a series, and which of its rows are new.

    The new values are 0 until they are measured; their errors are as those so far.

    Args:
        data: measured so far.
        series: to be measured.
    """
    old = data.states
    states = joined_states(old, new_states(data, series))
    quantities = np.unique(data.rows.quantity)
    count = series.assemblies * series.torque.size
    first = old.torque.size
    state = first + np.repeat(np.arange(count), quantities.size)
    quantity = np.tile(quantities, count)
    own = np.sqrt(np.diag(data.rows.covariance))
    seen = ~data.rows.bound
    sd = []
    for q in quantities:
        rows = seen & (data.rows.quantity == q)
        sd.append(float(np.median(own[rows])) if rows.any() else NEXT.new_sd)
    variance = np.concatenate([np.zeros(own.size), np.tile(sd, count) ** 2])
    covariance = np.diag(variance)
    covariance[: own.size, : own.size] = data.rows.covariance
    fresh = np.arange(variance.size) >= own.size
    rows = JointRows(
        np.concatenate([data.rows.state, state]),
        np.concatenate([data.rows.quantity, quantity]),
        np.concatenate([data.rows.value, np.zeros(state.size)]),
        covariance,
        np.concatenate([data.rows.bound, np.zeros(state.size, dtype=np.bool_)]),
    )
    return JointData(data.name, data.facts, states, rows), fresh


def new_states(data: JointData, series: TorqueSeries) -> JointStates:
    """Return the states of a series as the next assembly of a joint.

    Args:
        data: measured so far.
        series: to be measured.
    """
    old, facts, times = data.states, data.facts, series.assemblies
    torque, wait = np.tile(series.torque, times), np.tile(series.wait, times)
    count = torque.size
    by_torque = bool(np.isfinite(old.torque).any())
    ratio = facts.bolts / (facts.nut_factor * facts.diameter) if by_torque else 1.0
    known = old.preload / old.torque
    if np.isfinite(known).any():
        # Nominal preloads stand for those that washers will show.
        ratio = float(np.median(known[np.isfinite(known)]))
    measured = series.washer or not by_torque or bool(np.isfinite(old.preload).all())
    preload = torque * ratio if measured else np.full(count, np.nan)
    return JointStates(
        torque=torque if by_torque else np.full(count, np.nan),
        preload=preload,
        preload_sd=np.full(count, NEXT.washer_sd if measured else np.nan),
        assembly=int(old.assembly.max())
        + 1
        + np.repeat(np.arange(times), series.torque.size),
        falling=np.tile(series.falling, times),
        time=np.where(np.isfinite(wait), wait, _middle(old.time)),
        shear=np.full(count, _middle(old.shear)),
        frequency=np.full(count, _middle(old.frequency)),
    )


def _middle(values: FloatArray) -> float:
    seen = values[np.isfinite(values)]
    return float(np.median(seen)) if seen.size else np.nan


def joined_states(old: JointStates, new: JointStates) -> JointStates:
    """Return the states of two sessions, one after the other."""

    def both(name: str) -> FloatArray:
        return np.concatenate([getattr(old, name), getattr(new, name)])

    return JointStates(
        torque=both("torque"),
        preload=both("preload"),
        preload_sd=both("preload_sd"),
        assembly=np.concatenate([old.assembly, new.assembly]),
        falling=np.concatenate([old.falling, new.falling]),
        time=both("time"),
        shear=both("shear"),
        frequency=both("frequency"),
        setting=np.concatenate([old.settings, new.settings + old.settings.max() + 1]),
    )


def joined_data(one: JointData, other: JointData) -> JointData:
    """Return two sessions of a joint as one, with facts and name of the first.

    Args:
        one: first session.
        other: later session; its assemblies are new ones.
    """
    first, rows = one.states.torque.size, other.rows
    later = replace(
        other.states, assembly=other.states.assembly + one.states.assembly.max() + 1
    )
    size = one.rows.value.size
    covariance = np.zeros((size + rows.value.size,) * 2)
    covariance[:size, :size] = one.rows.covariance
    covariance[size:, size:] = rows.covariance
    both = JointRows(
        np.concatenate([one.rows.state, rows.state + first]),
        np.concatenate([one.rows.quantity, rows.quantity]),
        np.concatenate([one.rows.value, rows.value]),
        covariance,
        np.concatenate([one.rows.bound, rows.bound]),
    )
    return JointData(one.name, one.facts, joined_states(one.states, later), both)
