# SPDX-License-Identifier: MIT
"""The preload by the force of bolts: load washers and elongations, hit by hit.

Each hit gives the mean of a washer over its samples, in which what the hit excites
averages out. The memory does not depend on the number of hits.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.station.schemas.bolt_force_table import BoltForceTable
from jointbench.station.session_events.hit_events import PreloadRead

SCATTER = 0.1
"""Relative standard deviation of the force from bolt to bolt at one torque, where some
have no sensor and fewer than three have one [-]: half the scatter of a torque wrench.

Source:
    VDI 2230 (2015), table A8: alpha_A of 1.4 to 1.6, which is +-17 to 23 %.
"""
_KNOWN_SCATTER = 3  # measured bolts from which their own scatter counts


@dataclass(frozen=True, slots=True)
class BoltForce:
    """The force of one bolt.

    Attributes:
        bolt: its number, from 1.
        force: [N].
        force_sd: its standard uncertainty, scale and scatter together [N].
        way: ``"load washer"`` or ``"elongation"``.
    """

    bolt: int
    force: float
    force_sd: float
    way: str


@dataclass(slots=True)
class _Sums:
    """Readings of one bolt at the present condition."""

    count: int = 0
    total: float = 0.0
    squares: float = 0.0

    def add(self, value: float) -> None:
        self.count += 1
        self.total += value
        self.squares += value**2

    def mean(self) -> tuple[float, float]:
        """Return mean and its standard deviation by the scatter of the readings."""
        mean = self.total / self.count
        if self.count == 1:
            return mean, 0.0
        rest = max(self.squares - self.count * mean**2, 0.0)
        return mean, float(np.sqrt(rest / (self.count - 1) / self.count))


@dataclass(slots=True)
class BoltForces:
    """What the bolts of a joint are found to carry.

    Attributes:
        tables: of the plan, one a measured bolt.
        channels: of the stream.
        bolts: of the joint; None where the plan states none, which takes those
            measured for all.
    """

    tables: tuple[BoltForceTable, ...]
    channels: tuple[Channel, ...]
    bolts: int | None = None
    _sums: dict[int, _Sums] = field(default_factory=dict)
    _typed: dict[int, float] = field(default_factory=dict)

    def hit(self, samples: FloatArray) -> None:
        """Take the samples of a hit, all channels [V], shape (n_channels, n)."""
        for bolt, force in forces_of(self.tables, self.channels, samples).items():
            self._sums.setdefault(bolt, _Sums()).add(force)

    def elongation(self, bolt: int, length: float) -> BoltForce | None:
        """Take the elongation of a bolt as its operator read it.

        Args:
            bolt: its number.
            length: that it grew by since it was loose [m].

        Returns:
            Its force; None where the plan states no stiffness for it.
        """
        for table in self.tables:
            stiffness = table.newtons_per_metre()
            if table.bolt == bolt and stiffness is not None and table.channel is None:
                force = stiffness * length
                self._typed[bolt] = force
                return BoltForce(bolt, force, table.sd * abs(force), table.way)
        return None

    def loosen(self) -> None:
        """Forget what was read: the bolts are tightened to another torque."""
        self._sums, self._typed = {}, {}

    def read(self) -> tuple[BoltForce, ...]:
        """Return the bolts that were read since the last call, and those typed in."""
        found = []
        for table in self.tables:
            if table.bolt in self._sums:
                force, scatter = self._sums[table.bolt].mean()
            elif table.bolt in self._typed:
                force, scatter = self._typed[table.bolt], 0.0
            else:
                continue
            sd = float(np.hypot(scatter, table.sd * force))
            found.append(BoltForce(table.bolt, force, sd, table.way))
        self._sums = {}
        return tuple(found)

    def preload(self, name: str, torque: float | None) -> PreloadRead | None:
        """Return the preload at a condition, None where no bolt was read.

        Args:
            name: of the condition.
            torque: on each bolt [N m].
        """
        found = self.read()
        if not found:
            return None
        preload, sd = preload_of(found, self.bolts or len(self.tables))
        if preload <= 0.0:
            return None
        rows = [
            {"bolt": b.bolt, "force": b.force, "force_sd": b.force_sd, "way": b.way}
            for b in found
        ]
        return PreloadRead(name, torque, preload, sd, rows)


def forces_of(
    tables: Sequence[BoltForceTable], channels: Sequence[Channel], samples: FloatArray
) -> dict[int, float]:
    """Return the force of each bolt that has a channel [N], by the number of the bolt.

    Args:
        tables: of the plan.
        channels: of the stream.
        samples: [V] in the rows of these bolts, shape (n_channels, n).
    """
    rows = {channel.name: row for row, channel in enumerate(channels)}
    found = {}
    for table in tables:
        scale = table.newtons_per_volt()
        if scale is not None and table.channel in rows:
            volts = float(samples[rows[table.channel]].mean())
            found[table.bolt] = scale * (volts - table.zero_volts())
    return found


def preload_of(read: Sequence[BoltForce], bolts: int) -> tuple[float, float]:
    """Return preload of all bolts together and its standard uncertainty [N].

    Bolts without a sensor have the mean of the others, with the scatter from bolt to
    bolt: of those measured where there are three, else `SCATTER`.

    Args:
        read: bolts with a sensor.
        bolts: of the joint.
    """
    forces = np.array([bolt.force for bolt in read])
    deviations = np.array([bolt.force_sd for bolt in read])
    count, mean = forces.size, float(forces.mean())
    bolts = max(bolts, count)
    own = float(np.sqrt(np.sum(deviations**2))) / count
    scatter = SCATTER * abs(mean)
    if count >= _KNOWN_SCATTER:
        scatter = float(forces.std(ddof=1))
    left = scatter * np.sqrt((1.0 - count / bolts) / count)
    return bolts * mean, bolts * float(np.hypot(own, left))


def hit_temperature(channels: Sequence[Channel], samples: FloatArray) -> float | None:
    """Return the mean temperature over a hit [degC], None without such a channel.

    Args:
        channels: of the rows; the first one of a temperature counts.
        samples: of the hit, shape (n_channels, n).
    """
    for channel, row in zip(channels, samples, strict=True):
        if channel.quantity is Quantity.TEMPERATURE:
            return float(row.mean())
    return None
