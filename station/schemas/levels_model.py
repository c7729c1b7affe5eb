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

from jointbench.station.files.toml_file import StrictTable
from jointbench.station.schemas.positive_quantities import Force, Frequency, Share

Excitation = Literal["random", "multisine", "sweep"]


class BaseTable(StrictTable):
    """The base: band and number of modes, and whether a mode beyond it is allowed."""

    band: tuple[Frequency, Frequency]
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
    so many, after a filter. With `lines` in place of `columns` every file holds complex
    lines of a periodic record, which are sampled at `rate`.
    """

    columns: str | None = None
    lines: str | None = None
    rate: Frequency | None = None
    excitation: Excitation = "random"
    period: Annotated[int, Field(ge=16)] | None = None
    lead: Annotated[int, Field(ge=0)] = 0
    decimate: Annotated[int, Field(ge=1, le=100)] = 1
    repeatability: Share | None = None
    remove_mean: bool = False

    @model_validator(mode="after")
    def _lines_stated(self) -> "RecordsTable":
        if self.lines is None:
            return self
        if self.columns is not None:
            raise ValueError("columns and lines are both given; keep the one that fits")
        if self.rate is None or self.repeatability is None:
            raise ValueError(
                "complex lines need a rate and a repeatability: they state neither "
                'their samples nor their noise; for example rate = "1 kHz" and '
                'repeatability = "0.3 %"'
            )
        return self


class PortTable(StrictTable):
    """A place where an effect may act: between two sensors, or one and ``ground``."""

    between: tuple[str, str]


class LevelTable(StrictTable):
    """Files of one level; what differs from [records] may be given here.

    `frf_force` says that the files hold an FRF, measured at that rms force; where they
    state no units, `frf_columns` does, as ``--columns`` of `modal`.
    """

    name: str = Field(min_length=1)
    files: tuple[str, ...] = Field(min_length=1)
    held_out: bool = False
    excitation: Excitation | None = None
    period: Annotated[int, Field(ge=16)] | None = None
    lead: Annotated[int, Field(ge=0)] | None = None
    frf_force: Force | None = None
    frf_columns: str | None = None


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

    @model_validator(mode="after")
    def _one_frf(self) -> "LevelsModel":
        frfs = {level.name for level in self.levels if level.frf_force is not None}
        if frfs and self.records.lines is None:
            raise ValueError("frf_force is for complex lines; give lines = ... as well")
        if len(frfs) > 1:
            raise ValueError(
                f"{len(frfs)} levels are FRFs ({', '.join(sorted(frfs))}); an FRF "
                "stands for the lowest level, as a linear one: give periodic lines or "
                "samples of the others"
            )
        return self
