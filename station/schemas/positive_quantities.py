# SPDX-License-Identifier: MIT
"""Positive quantities of TOML files, in SI units once they are read ("9.02 kg")."""

from typing import Annotated

from pydantic import Field

from jointbench.station.files.toml_file import with_unit

Mass = Annotated[float, with_unit("mass"), Field(gt=0)]
Force = Annotated[float, with_unit("force"), Field(gt=0)]
Torque = Annotated[float, with_unit("torque"), Field(gt=0)]
Pressure = Annotated[float, with_unit("pressure"), Field(gt=0)]
Length = Annotated[float, with_unit("length"), Field(gt=0)]
Time = Annotated[float, with_unit("time"), Field(gt=0)]
Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
Share = Annotated[float, with_unit("ratio"), Field(gt=0, lt=1)]
