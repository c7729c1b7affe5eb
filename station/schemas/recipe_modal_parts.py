# SPDX-License-Identifier: MIT
"""The parts of a recipe that lead from hits to modes."""

from typing import Annotated, Literal

from pydantic import (
    Field,
    model_validator,
)

from jointbench.station.files.toml_file import (
    AUTO,
    NONE,
    StrictTable,
    with_unit,
)
from jointbench.station.schemas.positive_quantities import Force, Frequency, Time

_Share = Annotated[float, with_unit("ratio"), Field(ge=0, le=1)]
_NotNegative = Annotated[float, Field(ge=0)]
# The limit is one of the number alone: asked of "auto" it ends in an internal error.
_WindowTime = Annotated[_NotNegative | None, with_unit("time", AUTO, NONE)]
_WindowRate = Annotated[_NotNegative | None, with_unit("frequency", AUTO, NONE)]


class HitsPart(StrictTable):
    """How hits are found and judged again; see `HitCriteria` and `HitLimits`."""

    trigger_level: Force | None = None
    pretrigger: Time | None = None
    dead_time: Time | None = None
    rearm_fraction: _Share | None = None
    noise_factor: Annotated[float, Field(gt=0)] | None = None
    peak_fraction: _Share | None = None
    minimum_length: Time | None = None
    overload_fraction: _Share | None = None
    flat_samples: Annotated[int, Field(ge=2)] | None = None
    double_ratio: _Share | None = None
    weak_ratio: _Share | None = None
    weak_force: Force | None = None
    again: bool = True
    keep_operator: bool = True


class WindowsPart(StrictTable):
    """Windows: a time or a rate, "auto" (chosen by the hits) or "none"."""

    force_width: _WindowTime = None
    exponential: _WindowRate = None
    lead: _WindowTime = None


class FrfPart(StrictTable):
    """The estimator of the FRF."""

    estimator: Literal["H1", "H2", "Hv"] = "H1"


class KalmanPart(StrictTable):
    """The Kalman stage; see `KalmanSettings`."""

    use: bool = True
    model: Literal["level_slope", "oscillator"] = "level_slope"
    cutoff: Frequency | None = None
    smooth: bool = True
    frequency: Frequency | None = None
    damping_ratio: _Share | None = None

    @model_validator(mode="after")
    def _oscillator_has_a_frequency(self) -> "KalmanPart":
        if self.model == "oscillator" and self.frequency is None:
            raise ValueError("an oscillator needs its frequency, as '310 Hz'")
        return self


class ModesPart(StrictTable):
    """Band, order and choices by hand; see `ModalSettings`."""

    band: tuple[Frequency, Frequency] | None = None
    highest_order: Annotated[int, Field(ge=2, le=200)] | None = None
    refine: bool = True
    keep: tuple[Frequency, ...] = ()
    drop: tuple[Frequency, ...] = ()

    @model_validator(mode="after")
    def _band_ascends(self) -> "ModesPart":
        if self.band is not None and not self.band[0] < self.band[1]:
            raise ValueError(f"band is {self.band} Hz; write the lower end first")
        return self
