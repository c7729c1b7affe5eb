# SPDX-License-Identifier: MIT
"""From blocks to hits: listen to the quiet hammer, arm the trigger, cut hits out."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.ni.stream import HardwareTrigger
from jointbench.acquisition.records.recordings import Channel, Hit, Quantity
from jointbench.signal.hits.hit_verdicts import HitLimits, noise_level
from jointbench.signal.hits.live_hits import CutHit, HitCutter, judge_cut
from jointbench.station.measure.trial_settings import (
    LONGEST,
    SHORTEST,
    Proposal,
    propose_settings,
    propose_trigger,
)
from jointbench.station.schemas.plan_model import HitsTable
from jointbench.station.session_events.command_queue import CommandRefused

LISTEN = 0.3  # [s] quiet time in which the noise of the hammer is measured
_LEAST_TRIGGER = 5.0
"""Least trigger level in standard deviations of the noise; below, noise fires [-]."""
_MOST_TRIGGER = 0.5
"""Largest trigger level over the range of the hammer [-]."""
_ROOM = 32  # samples that a device's own idea of the edge may differ from ours
TRIAL_LENGTH = 2.0  # [s] block of a trial hit where the plan names none


class TriggerWatch:
    """The software trigger of a session, with the settings it has so far."""

    def __init__(
        self, hits: HitsTable, channels: Sequence[Channel], sample_rate: float
    ) -> None:
        self._hits, self._channels, self._rate = hits, tuple(channels), sample_rate
        self._row = next(
            i for i, c in enumerate(channels) if c.quantity is Quantity.FORCE
        )
        self._quiet: list[FloatArray] = []
        self._cutter: HitCutter | None = None
        self._trigger = Proposal("trigger_n", hits.trigger or 0.0, "of the plan")
        self._changed: set[str] = set()

    @property
    def armed(self) -> bool:
        """Whether the noise is known and hits are looked for."""
        return self._cutter is not None

    @property
    def after(self) -> int:
        """Samples from the trigger on that a hit takes."""
        return 0 if self._cutter is None else self._cutter.after

    def listen(self, samples: FloatArray, *, stored: int) -> bool:
        """Measure the noise of the quiet hammer; True once the trigger is armed.

        Args:
            samples: of a block, SI units, shape (n_channels, n).
            stored: samples stored so far, this block included.
        """
        self._quiet.append(samples[self._row])
        force = np.concatenate(self._quiet)
        if force.size < round(LISTEN * self._rate):
            return False
        if self._hits.trigger is None:
            self._trigger = propose_trigger(force, self._channels[self._row])
        self._cutter = HitCutter(
            row=self._row,
            level=self._trigger.value,
            before=round(self._hits.pretrigger * self._rate),
            after=round((self._hits.length or TRIAL_LENGTH) * self._rate),
            offset=float(np.median(force)),
            origin=stored,
        )
        return True

    def feed(self, samples: FloatArray) -> CutHit | None:
        """Take a block; return a hit that it completes."""
        return None if self._cutter is None else self._cutter.feed(samples)

    def break_off(self, stored: int | None = None) -> CutHit | None:
        """Restart after a gap; return the hit that it cut short, if any.

        Args:
            stored: samples stored before the next that is fed; None for those fed.
        """
        return None if self._cutter is None else self._cutter.break_off(stored)

    def judge(self, cut: CutHit, point: str, weak_force: float | None) -> Hit:
        """Judge a hit by itself.

        Args:
            cut: the hit.
            point: that was struck.
            weak_force: least useful peak [N].
        """
        return judge_cut(
            cut,
            self._channels,
            row=self._row,
            sample_rate=self._rate,
            point=point,
            needed=self.after,
            limits=HitLimits(weak_force=weak_force),
        )

    def on_the_device(self) -> HardwareTrigger:
        """Return this trigger as a device can look for it, with some room about."""
        assert self._cutter is not None, "listen() comes first"
        cutter = self._cutter
        return HardwareTrigger(
            channel=self._channels[self._row].name,
            level=cutter.level + cutter.offset,
            before=cutter.before + _ROOM,
            samples=cutter.before + cutter.after + 2 * _ROOM,
        )

    def settle(self, trial: Sequence[CutHit]) -> tuple[Proposal, ...]:
        """Take from trial hits whatever the plan leaves open; return the proposals."""
        proposals = propose_settings(
            trial, self._channels, sample_rate=self._rate, trigger=self._trigger
        )
        values = {proposal.name: proposal.value for proposal in proposals}
        if self._cutter is not None and self._is_open("trigger_n", self._hits.trigger):
            self._cutter.level = values["trigger_n"]
        if self._cutter is not None and self._is_open("length_s", self._hits.length):
            self._cutter.after = round(values["length_s"] * self._rate)
        return proposals

    def change(self, name: str, value: float) -> Proposal:
        """Give a setting another value from now on.

        Args:
            name: ``"trigger_n"`` or ``"length_s"``.
            value: [N] or [s].

        Returns:
            The setting as it is now.

        Raises:
            CommandRefused: there is no such setting, or no such value.
        """
        cutter = self._cutter
        if cutter is None:
            raise CommandRefused("the noise of the hammer is being measured; wait")
        least, most = self._limits(name)
        if not least <= value <= most:
            raise CommandRefused(
                f"{name} is between {least:.4g} and {most:.4g}, not {value:.4g}"
            )
        if name == "trigger_n":
            cutter.level = value
        else:
            cutter.after = round(value * self._rate)
        self._changed.add(name)
        return Proposal(name, value, "set by the operator")

    def _is_open(self, name: str, planned: float | None) -> bool:
        return planned is None and name not in self._changed

    def _limits(self, name: str) -> tuple[float, float]:
        """Return the least and the largest value of a setting.

        Raises:
            CommandRefused: there is no such setting.
        """
        if name == "length_s":
            return SHORTEST, LONGEST
        if name != "trigger_n":
            raise CommandRefused(
                f"{shown(name)} cannot be set; trigger_n and length_s can"
            )
        quiet = noise_level(np.concatenate(self._quiet))
        largest = self._channels[self._row].range or np.inf
        return _LEAST_TRIGGER * quiet, _MOST_TRIGGER * largest
