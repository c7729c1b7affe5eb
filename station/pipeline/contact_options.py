# SPDX-License-Identifier: MIT
"""The options of ``jointbench contact``, as one record."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

_Texts = list[str] | None
_Modulus = Annotated[str, typer.Option(help="Composite modulus E*, '29.3 GPa'.")]
_Hardness = Annotated[str, typer.Option(help="Hardness, '1.5 GPa' or '231 HB'.")]
_Load = Annotated[
    _Texts, typer.Option(help="Preload with unit, '25 kN'; may be repeated.")
]
_Torque = Annotated[
    _Texts, typer.Option(help="On each bolt instead, '20 N m'; may be repeated.")
]
_Stiffness = Annotated[
    str | None, typer.Option(help="Find the preload that gives it, '3e7 N/m'.")
]
_RealArea = Annotated[
    float | None, typer.Option(help="Find the preload that gives it [m^2].")
]
_BoltDiameter = Annotated[str | None, typer.Option(help="Nominal, '16 mm'.")]
_Bolts = Annotated[int, typer.Option(help="Bolts that carry the joint.")]
_NutFactor = Annotated[float, typer.Option(help="K in F = T/(K d) [-].")]
_NutFactorSd = Annotated[float, typer.Option(help="Standard deviation of K [-].")]
_Dimension = Annotated[
    float | None, typer.Option(help="Profile fractal dimension, 1 < D < 2.")
]
_DimensionSd = Annotated[float, typer.Option(help="Standard deviation of D [-].")]
_Roughness = Annotated[
    str | None, typer.Option(help="Fractal roughness G with unit, '1e-9 m'.")
]
_RoughnessSd = Annotated[str, typer.Option(help="Standard deviation of G, '30 %'.")]
_Surfaces = Annotated[
    list[Path] | None,
    typer.Option(help="Surface file; repeat it for the second surface of a joint."),
]
_Columns = Annotated[
    str | None, typer.Option(help="Columns of a plain table, 'x:um,z:um'.")
]
_Poisson = Annotated[float, typer.Option(help="Poisson's ratio [-].")]
_YieldStrength = Annotated[
    str | None, typer.Option(help="Of the softer body; hardness/2.8 if not given.")
]
_HardnessSd = Annotated[str, typer.Option(help="Its standard deviation, '10 %'.")]
_FrictionFactor = Annotated[float, typer.Option(help="k_mu of friction_3d [-].")]
_FrictionFactorSd = Annotated[float, typer.Option(help="Its standard deviation [-].")]
_Friction = Annotated[float, typer.Option(help="Coefficient of friction [-].")]
_TangentialLoad = Annotated[
    str, typer.Option(help="On the joint, '1 kN'; contacts slip in part.")
]
_NominalArea = Annotated[
    float | None, typer.Option(help="Apparent area [m^2], which guards the real.")
]
_Model = Annotated[_Texts, typer.Option(help="Contact model; may be repeated.")]
_Mode = Annotated[
    str, typer.Option(help="'corrected', or 'as-printed' with the papers' faults.")
]
_Without = Annotated[
    str | None,
    typer.Option(metavar="TERM,...", help="Terms to leave out: interaction, ..."),
]
_Mass = Annotated[
    str | None, typer.Option(help="On the joint, '19.5 kg', for its damping.")
]
_Frequency = Annotated[str | None, typer.Option(help="Instead of the mass, '200 Hz'.")]
_LossForm = Annotated[
    str, typer.Option(help="'kogut-etsion' or 'two-regime' energies.")
]
_LossConvention = Annotated[
    str, typer.Option(help="'energy-ratio' or 'per-radian'; 2 pi apart.")
]
_Sweep = Annotated[
    str | None,
    typer.Option(help="'load:1 kN:50 kN:20'; or dimension, or roughness."),
]
_Plot = Annotated[
    Path | None, typer.Option(help="HTML report to write, with plots of the sweep.")
]
_Json = Annotated[
    str | None,
    typer.Option(metavar="PATH", help="Write results as JSON; '-' = stdout."),
]
_Debug = Annotated[
    bool, typer.Option("--debug", help="Show the traceback of an error.")
]


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactOptions:
    """The options of the command line, by name, as they are typed."""

    modulus: _Modulus
    hardness: _Hardness
    load: _Load = None
    torque: _Torque = None
    stiffness: _Stiffness = None
    real_area: _RealArea = None
    bolt_diameter: _BoltDiameter = None
    bolts: _Bolts = 1
    nut_factor: _NutFactor = 0.2
    nut_factor_sd: _NutFactorSd = 0.0
    dimension: _Dimension = None
    dimension_sd: _DimensionSd = 0.0
    roughness: _Roughness = None
    roughness_sd: _RoughnessSd = "0 %"
    surface: _Surfaces = None
    columns: _Columns = None
    poisson: _Poisson = 0.25
    yield_strength: _YieldStrength = None
    hardness_sd: _HardnessSd = "0 %"
    friction_factor: _FrictionFactor = 1.0
    friction_factor_sd: _FrictionFactorSd = 0.0
    friction: _Friction = 0.3
    tangential_load: _TangentialLoad = "0 N"
    nominal_area: _NominalArea = None
    model: _Model = None
    mode: _Mode = "corrected"
    without: _Without = None
    mass: _Mass = None
    frequency: _Frequency = None
    loss_form: _LossForm = "kogut-etsion"
    loss_convention: _LossConvention = "energy-ratio"
    sweep: _Sweep = None
    plot: _Plot = None
    json: _Json = None
    debug: _Debug = False
