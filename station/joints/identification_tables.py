# SPDX-License-Identifier: MIT
"""Tables of a structure model file on what is identified, from what."""

from typing import Annotated, Literal

from pydantic import Field

from jointbench.station.files.toml_file import StrictTable, with_unit

_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Stiffness = Annotated[float, with_unit("stiffness"), Field(ge=0)]
_Share = Annotated[float, with_unit("ratio"), Field(gt=0, lt=1)]
_Trust = Annotated[float, with_unit("ratio"), Field(ge=0, lt=1)]


class MeasuredTable(StrictTable):
    """Frequencies as a paper prints them, where there is no session."""

    frequencies: tuple[_Frequency, ...] = Field(min_length=1)
    relative_sd: _Share = 0.002


class PriorTable(StrictTable):
    """What is known of a joint's stiffness: value [N/m] and relative sd."""

    stiffness: Annotated[float, with_unit("stiffness"), Field(gt=0)]
    sd: _Share


class IdentifyTable(StrictTable):
    """What to identify from: frequencies, modes (with shapes) or the FRFs.

    The standard deviations, relative, are those of the model (mesh, material): they
    widen those of measured frequencies and damping ratios. `modulus_sd` makes the
    modulus of a body unknown, with this relative standard deviation around its table.
    """

    data: Literal["frequencies", "modes", "frf"] = "modes"
    modes: Annotated[int, Field(gt=0, le=200)] | None = None
    sought: tuple[str, ...] | None = None
    shared: tuple[str, ...] = ()
    stiffness_box: tuple[_Stiffness, _Stiffness] = (1e6, 1e11)
    lines: Annotated[int, Field(gt=3)] = 200
    frequency_sd: _Trust = 0.0
    damping_sd: _Trust = 0.0
    modulus_sd: dict[str, _Share] = Field(default_factory=dict)
    priors: dict[str, PriorTable] = Field(default_factory=dict)
