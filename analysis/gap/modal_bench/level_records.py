# SPDX-License-Identifier: MIT
"""Records of a structure at several levels of one or more shakers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, SamplingError, UsageError
from jointbench.analysis.lumped.lumped_model import GROUND, Output


@dataclass(frozen=True, slots=True)
class Port:
    """A place where a nonlinear effect may act.

    Attributes:
        name: chosen by the user, for example ``"bolt"``.
        between: the two points whose relative motion counts; the first may be
            ``"ground"``. The motion is that of the second less that of the first.
    """

    name: str
    between: tuple[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class LevelRecord:
    """One record at one level.

    Attributes:
        name: of the record, for example that of its file.
        level: word of the level; records with the same word are one condition.
        force: of each input [N], shape (n_inputs, n_samples).
        response: of each sensor, same length, shape (n_sensors, n_samples).
        lead: first samples that are simulated and not scored, since the motion before
            the record is unknown.
        noise: of each sensor, shape (n_sensors,), if periods or a statement give it.
        held_out: whether the record is used for validation alone.
        excitation: random, multisine or sweep; empty if not stated.
        period: of a steady state [samples], which the record ends with; None for any
            other record.
        linear: whether the record is made from an FRF: the response to a force that was
            never applied, which a law would distort in another way.
        offset: whether the mean of the response is not in the record: a law may shift
            a structure, so that an offset is free then.
    """

    name: str
    level: str
    force: FloatArray
    response: FloatArray
    lead: int = 0
    noise: FloatArray | None = None
    held_out: bool = False
    excitation: str = ""
    period: int | None = None
    linear: bool = False
    offset: bool = False

    def __post_init__(self) -> None:
        """Check the rows once and make them read-only."""
        require_shape("force", self.force, (None, None))
        require_shape("response", self.response, (None, self.force.shape[1]))
        if not np.all(np.isfinite(self.force)) or not np.all(
            np.isfinite(self.response)
        ):
            raise BadData(
                f"record {self.name!r} holds NaN or infinite samples; cut them out"
            )
        if not 0 <= self.lead < self.force.shape[1]:
            raise SamplingError(
                f"record {self.name!r} has {self.force.shape[1]} samples and a lead of "
                f"{self.lead}; shorten the lead"
            )
        freeze(self, "force", "response", "noise")

    @property
    def rms(self) -> float:
        """Of the force after the lead, over all inputs [N]."""
        return float(np.sqrt(np.mean(self.force[:, self.lead :] ** 2)))


@dataclass(frozen=True, slots=True, eq=False)
class RecordSet:
    """Records of one structure, with its sensors, inputs and suspected ports.

    Attributes:
        name: of the structure.
        sample_rate: of all records [Hz].
        sensors: point of each response row.
        inputs: point of each force row; a sensor at the same point in the same
            direction gives the scale of the mode shapes.
        ports: where effects may act.
        records: at any level, in any order.
        output: quantity of all responses.
        repeatability: relative to the peak of the response [-], as stated; None if the
            noise alone separates model and records.
    """

    name: str
    sample_rate: float
    sensors: tuple[str, ...]
    inputs: tuple[str, ...]
    ports: tuple[Port, ...]
    records: tuple[LevelRecord, ...]
    output: Output = Output.ACCELERATION
    repeatability: float | None = None

    def __post_init__(self) -> None:
        """Check names, shapes and ports."""
        if len(set(self.sensors)) != len(self.sensors):
            raise UsageError(
                f"two sensors have one name: {', '.join(self.sensors)}; rename one"
            )
        for port in self.ports:
            _require_known(port, self.sensors)
        for record in self.records:
            rows = (record.force.shape[0], record.response.shape[0])
            if rows != (len(self.inputs), len(self.sensors)):
                raise BadData(
                    f"record {record.name!r} has {rows[0]} forces and {rows[1]} "
                    f"responses; the set has {len(self.inputs)} and "
                    f"{len(self.sensors)}: give the same columns for each"
                )
        if not self.training:
            raise UsageError("every record is held out; keep two levels for the fits")

    @property
    def points(self) -> tuple[str, ...]:
        """Sensors, then inputs without a sensor."""
        rest = [p for p in dict.fromkeys(self.inputs) if p not in self.sensors]
        return (*self.sensors, *rest)

    @property
    def training(self) -> tuple[LevelRecord, ...]:
        """Records that are not for validation: base and laws come from them."""
        return tuple(r for r in self.records if not r.held_out)

    @property
    def fitted(self) -> tuple[LevelRecord, ...]:
        """Records that laws are fitted to: those of FRFs only for want of levels."""
        measured = tuple(r for r in self.training if not r.linear)
        return measured if len({r.level for r in measured}) > 1 else self.training

    @property
    def lowest(self) -> tuple[LevelRecord, ...]:
        """Records of the level with the smallest force."""
        level = min(self.training, key=lambda r: r.rms).level
        return tuple(r for r in self.training if r.level == level)


def _require_known(port: Port, sensors: Sequence[str]) -> None:
    """Raise unless a port lies between two sensors, or a sensor and the ground."""
    known = (GROUND, *sensors)
    first, second = port.between
    if first not in known or second not in known or first == second or second == GROUND:
        raise UsageError(
            f"port {port.name!r} is between {first!r} and {second!r}; give two sensors "
            f"of {', '.join(sensors)}, or {GROUND!r} and one of them"
        )
