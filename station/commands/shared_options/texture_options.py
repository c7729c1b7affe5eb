# SPDX-License-Identifier: MIT
"""Options of standard roughness parameters: settings, filter, errors of scales."""

from typing import Annotated

import typer

Iso = Annotated[
    bool,
    typer.Option(
        "--iso",
        help="Roughness parameters of ISO 21920 (profiles) and ISO 25178 (maps) as "
        "well, with nesting indices and uncertainties.",
    ),
]
SettingClassName = Annotated[
    str | None,
    typer.Option(
        "--setting-class",
        metavar="NAME",
        help="With --iso: default settings of profiles, Sc1 to Sc5; chosen by Rz if "
        "not given. --filter states nesting indices instead.",
    ),
]
Robust = Annotated[
    bool,
    typer.Option(
        "--robust", help="With --iso: robust Gaussian regression as L-filter."
    ),
]
ScaleErrors = Annotated[
    str | None,
    typer.Option(
        "--scale-errors",
        metavar="HEIGHT:PITCH",
        help="With --iso: standard uncertainties of the height scale and of the pitch, "
        "for example '1 %:0.5 %'.",
    ),
]
