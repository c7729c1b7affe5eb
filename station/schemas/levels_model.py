# SPDX-License-Identifier: MIT
"""The TOML file of records at several levels: base, columns, ports and levels.

::

    [base]
    band = ["5 Hz", "150 Hz"]      # with the modes of the base
    modes = 2                      # left out: those that the modal chain finds

    [records]
    columns = "time:s,force.shaker@tip:N,acceleration.a1@tip:m/s^2"
    excitation = "random"          # or multisine, sweep

    [ports.bolt]
    between = ["a1", "a2"]         # or ["ground", "a1"]

    [[levels]]
    name = "10 N"
    files = ["level-1.csv"]
    [[levels]]
    name = "80 N"
    files = ["level-7.csv"]
    held_out = true                # no fit sees it
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from jointbench.station.files.toml_file import StrictTable, with_unit

_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Share = Annotated[float, with_unit("ratio"), Field(gt=0, lt=1)]
Excitation = Literal["random", "multisine", "sweep"]


class BaseTable(StrictTable):
    """The base: band and number of modes, and whether a mode beyond it is allowed."""

    band: tuple[_Frequency, _Frequency]
    modes: Annotated[int, Field(ge=1, le=20)] | None = None
    beyond: bool = True

    @model_validator(mode="after")
    def _ascending(self) -> "BaseTable":
        if self.band[0] >= self.band[1]:
            raise ValueError(
                f"the band runs from {self.band[0]:g} to {self.band[1]:g} Hz; give the "
                "lower frequency first"
            )
        return self


class RecordsTable(StrictTable):
    """What the columns of every file hold, and how the structure was excited.

    `period` is that of a multisine in samples: its periods after the lead are averaged,
    and their scatter is the noise. `lead` counts the first samples that are simulated
    and not scored; 0 for a record that begins at rest. `decimate` keeps one sample in
    so many, after a filter.
    """

    columns: str | None = None
    excitation: Excitation = "random"
    period: Annotated[int, Field(ge=16)] | None = None
    lead: Annotated[int, Field(ge=0)] = 0
    decimate: Annotated[int, Field(ge=1, le=100)] = 1
    repeatability: _Share | None = None
    remove_mean: bool = False


class PortTable(StrictTable):
    """A place where an effect may act: between two sensors, or one and ``ground``."""

    between: tuple[str, str]


class LevelTable(StrictTable):
    """Files of one level; what differs from [records] may be given here."""

    name: str = Field(min_length=1)
    files: tuple[str, ...] = Field(min_length=1)
    held_out: bool = False
    excitation: Excitation | None = None
    period: Annotated[int, Field(ge=16)] | None = None
    lead: Annotated[int, Field(ge=0)] | None = None


class LevelsModel(StrictTable):
    """Records of one structure at several levels."""

    base: BaseTable
    records: RecordsTable = RecordsTable()
    ports: dict[str, PortTable] = Field(min_length=1)
    levels: tuple[LevelTable, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _enough_levels(self) -> "LevelsModel":
        kept = {level.name for level in self.levels if not level.held_out}
        if len(kept) < 2:
            raise ValueError(
                f"{len(kept)} level is left for the fits; give two or more that are "
                "not held out: the base comes from the lowest one"
            )
        return self
