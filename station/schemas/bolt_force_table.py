# SPDX-License-Identifier: MIT
"""How the force of a bolt is measured: the tables ``[[preload]]`` of a plan.

::

    [[preload]]                 # load washer with an amplifier
    bolt = 1
    channel = "w1"              # a sensor of the plan, quantity = "voltage"
    scale = "20 kN/V"
    sd = 0.02

    [[preload]]                 # load washer as a bridge
    bolt = 2
    channel = "w2"
    scale = "2 mV/V"            # at its rated force
    rated = "100 kN"
    supply = "5 V"

    [[preload]]                 # elongation, read by the operator and typed in
    bolt = 3
    stiffness = "350 N/um"
    sd = 0.05

An elongation on a channel has ``channel``, ``scale = "50 um/V"`` and ``stiffness``.
"""

import re

from pydantic import Field, model_validator

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.station.files.toml_file import StrictTable
from jointbench.station.schemas.positive_quantities import Force

_RATIO = re.compile(r"\s*([-+.\deE]+\s*[^\W\d_]*)\s*/\s*([^\W\d_]+)\s*")


class BoltForceTable(StrictTable):
    """One bolt whose force is measured; `sd` is relative, of scale and stiffness."""

    bolt: int = Field(ge=1, le=1000)
    channel: str | None = None
    scale: str | None = None
    rated: Force | None = None
    supply: str | None = None
    zero: str = "0 V"
    stiffness: str | None = None
    sd: float = Field(default=0.02, gt=0, lt=1)

    @model_validator(mode="after")
    def _one_way(self) -> "BoltForceTable":
        if (self.channel is None) != (self.scale is None):
            raise ValueError("a channel needs its scale, such as scale = '20 kN/V'")
        if self.channel is None and self.stiffness is None:
            raise ValueError(
                "give channel and scale of a load washer, or the stiffness of the bolt "
                "for an elongation, stiffness = '350 N/um'"
            )
        if (self.rated is None) != (self.supply is None):
            raise ValueError("a bridge needs both, rated = '100 kN' and supply = '5 V'")
        try:
            self.newtons_per_volt()
            self.newtons_per_metre()
            self.zero_volts()
        except UnitError as error:
            raise ValueError(str(error)) from error
        return self

    @property
    def way(self) -> str:
        """How the force is measured, in words."""
        return "load washer" if self.stiffness is None else "elongation"

    def newtons_per_volt(self) -> float | None:
        """Return the force per volt of the channel [N/V]; None without a channel.

        Raises:
            UnitError: a value has no unit, or a wrong one.
        """
        if self.scale is None:
            return None
        if self.rated is not None and self.supply is not None:
            share = _ratio("scale", self.scale, "voltage", "voltage", "2 mV/V")
            return self.rated / (share * _volts("supply", self.supply))
        stiffness = self.newtons_per_metre()
        if stiffness is None:
            return _ratio("scale", self.scale, "force", "voltage", "20 kN/V")
        return stiffness * _ratio("scale", self.scale, "length", "voltage", "50 um/V")

    def newtons_per_metre(self) -> float | None:
        """Return the stiffness of the bolt [N/m]; None where none is stated.

        Raises:
            UnitError: it has no unit, or a wrong one.
        """
        if self.stiffness is None:
            return None
        return _ratio("stiffness", self.stiffness, "force", "length", "350 N/um")

    def zero_volts(self) -> float:
        """Return the output of the channel without a force [V].

        Raises:
            UnitError: it has no unit, or a wrong one.
        """
        return parse_value(self.zero, "voltage")


def _ratio(key: str, text: str, above: str, below: str, example: str) -> float:
    """Return a quantity over another, above zero."""
    match = _RATIO.fullmatch(text)
    if match is None:
        raise UnitError(f"{key} is {text!r}; write it as {example!r}")
    try:
        found = parse_value(match[1], above) / parse_value(f"1 {match[2]}", below)
    except UnitError as error:
        words = f"{key} is {text!r}: {error}; write it as {example!r}"
        raise UnitError(words) from error
    if not found > 0:
        raise UnitError(f"{key} is {text!r}; it is above zero")
    return found


def _volts(key: str, text: str) -> float:
    found = parse_value(text, "voltage")
    if not found > 0:
        raise UnitError(f"{key} is {text!r}; it is above zero")
    return found
