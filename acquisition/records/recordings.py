# SPDX-License-Identifier: MIT
"""Records of a bench: channels, recordings, hits and their verdicts.

Frozen, read-only and in SI inside; `dataclasses.replace` derives one from another.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from jointbench.acquisition.basics.array_checks import (
    require_finite,
    require_positive,
    require_shape,
)
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import ChannelMissing, ShapeError
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.stored_samples import StoredSamples

Samples = FloatArray | StoredSamples
"""An array, or what is indexed like one and stays in its file."""


class Quantity(StrEnum):
    """Quantity of a channel; the value is the word in files and columns.

    Pressure is that of a microphone [Pa], temperature is in degrees Celsius, a tacho
    delivers pulses [V].
    """

    FORCE = "force"
    ACCELERATION = "acceleration"
    VELOCITY = "velocity"
    DISPLACEMENT = "displacement"
    PRESSURE = "pressure"
    STRAIN = "strain"
    VOLTAGE = "voltage"
    TEMPERATURE = "temperature"
    TACHO = "tacho"

    @property
    def is_motion(self) -> bool:
        """Whether it is a response of a structure, of which FRFs and modes are."""
        return self in _MOTIONS

    @classmethod
    def mechanical(cls) -> "tuple[Quantity, ...]":
        """Return force and motions: what columns of foreign files are read as."""
        return (cls.FORCE, *_MOTIONS)


_MOTIONS = (Quantity.ACCELERATION, Quantity.VELOCITY, Quantity.DISPLACEMENT)


class Verdict(StrEnum):
    """Verdict on a hit; only `OK` hits enter an average."""

    OK = "ok"
    OVERLOAD = "overload"
    DOUBLE = "double"
    WEAK = "weak"
    LATE = "late"
    POOR_COHERENCE = "poor_coherence"
    OPERATOR = "operator"


@dataclass(frozen=True, slots=True)
class Channel:
    """One measuring channel.

    Attributes:
        name: unique within a recording, for example ``"a1"``.
        quantity: measured; samples are in its SI unit.
        point: position on the structure (for a hammer: the default point).
        direction: ``"+z"`` and the like; empty if not stated.
        unit: unit the samples were recorded or imported in, for example ``"g"``.
        sensitivity: of the sensor [V per SI unit], or None if not stated.
        range: full scale of the channel [SI unit], or None if unknown.
    """

    name: str
    quantity: Quantity
    point: str = ""
    direction: str = ""
    unit: str = ""
    sensitivity: float | None = None
    range: float | None = None


@dataclass(frozen=True, slots=True)
class Hit:
    """One hammer hit found in a recording, judged.

    Attributes:
        start: index of the first sample of the hit's segment (pre-trigger included).
        trigger: index of the sample at which the force crossed the trigger level.
        stop: index one past the last sample of the segment.
        point: where the hammer struck.
        peak_force: largest force of the hit [N].
        verdict: `Verdict.OK` or the reason for rejection.
        measure: number on which the verdict is based (see `reason` for its meaning).
        reason: one line with the meaning of `measure` and the rule that it met or
            broke.
        temperature: mean over the hit of the first channel of a temperature [degC];
            None without one.
    """

    start: int
    trigger: int
    stop: int
    point: str
    peak_force: float
    verdict: Verdict
    measure: float
    reason: str
    temperature: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Simultaneous samples of several channels, and the hits found in them.

    Attributes:
        name: unique within a session.
        samples: values in SI units, shape (n_channels, n_samples), finite; those of a
            large session stay in its file, see `StoredSamples`.
        sample_rate: [Hz].
        channels: one for each row of `samples`.
        start_time: time of the first sample since the session began [s].
        hits: judged hits, in order of time; empty before detection.
        provenance: origin and processing steps.
        preload: on the joint during this recording [N]; None for that of the session,
            or not given.
        preload_sd: its standard uncertainty where it was measured [N], else None.
    """

    name: str
    samples: Samples
    sample_rate: float
    channels: tuple[Channel, ...]
    start_time: float = 0.0
    hits: tuple[Hit, ...] = ()
    provenance: Provenance = field(default=())
    preload: float | None = None
    preload_sd: float | None = None

    def __post_init__(self) -> None:
        """Check shapes once and make the samples read-only."""
        require_shape("samples", self.samples, (len(self.channels), None))
        if not isinstance(self.samples, StoredSamples):
            require_finite("samples", self.samples)
            freeze(self, "samples")
        require_positive("sample_rate", self.sample_rate)
        if self.preload is not None:
            require_positive("preload", self.preload)
        if self.preload_sd is not None:
            require_positive("preload_sd", self.preload_sd)
        names = [channel.name for channel in self.channels]
        if len(set(names)) != len(names):
            raise ShapeError(f"channel names must be unique, got {names}")

    def rows(self, quantity: Quantity) -> tuple[int, ...]:
        """Return the indices of the channels that measure `quantity`."""
        return tuple(
            i for i, channel in enumerate(self.channels) if channel.quantity == quantity
        )

    def row(self, quantity: Quantity) -> int:
        """Return the one channel that measures `quantity`.

        Raises:
            ChannelMissing: there is none, or more than one.
        """
        rows = self.rows(quantity)
        if len(rows) != 1:
            raise ChannelMissing(
                f"recording {self.name!r} has {len(rows)} channels of quantity "
                f"{quantity.value!r}, exactly one is needed; its channels are "
                + ", ".join(f"{c.name} ({c.quantity.value})" for c in self.channels)
            )
        return rows[0]


def response_rows(recording: Recording) -> tuple[int, ...]:
    """Return the indices of all channels of a motion.

    Raises:
        ChannelMissing: the recording holds none.
    """
    rows = tuple(
        i for i, channel in enumerate(recording.channels) if channel.quantity.is_motion
    )
    if not rows:
        raise ChannelMissing(
            f"recording {recording.name!r} has no response channel; "
            "give one of acceleration, velocity or displacement"
        )
    return rows


def common_response(channels: Sequence[Channel]) -> Quantity:
    """Return the common quantity of all response channels.

    Raises:
        ChannelMissing: they measure different quantities, or there is none.
    """
    quantities = {c.quantity for c in channels if c.quantity.is_motion}
    if len(quantities) != 1:
        raise ChannelMissing(
            "response channels must measure one and the same quantity, got "
            f"{sorted(q.value for q in quantities)}"
        )
    return quantities.pop()
