# SPDX-License-Identifier: MIT
"""The options of ``jointbench contact``, as one record."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

Texts = list[str] | None
Modulus = Annotated[str, typer.Option(help="Composite modulus E*, '29.3 GPa'.")]
Hardness = Annotated[str, typer.Option(help="Hardness, '1.5 GPa' or '231 HB'.")]
Load = Annotated[
    Texts, typer.Option(help="Preload with unit, '25 kN'; may be repeated.")
]
Torque = Annotated[
    Texts, typer.Option(help="On each bolt instead, '20 N m'; may be repeated.")
]
Stiffness = Annotated[
    str | None, typer.Option(help="Find the preload that gives it, '3e7 N/m'.")
]
RealArea = Annotated[
    float | None, typer.Option(help="Find the preload that gives it [m^2].")
]
BoltDiameter = Annotated[str | None, typer.Option(help="Nominal, '16 mm'.")]
Bolts = Annotated[int, typer.Option(help="Bolts that carry the joint.")]
NutFactor = Annotated[float, typer.Option(help="K in F = T/(K d) [-].")]
NutFactorSd = Annotated[float, typer.Option(help="How sure K is [-].")]
Dimension = Annotated[
    float | None, typer.Option(help="Profile fractal dimension, 1 < D < 2.")
]
DimensionSd = Annotated[float, typer.Option(help="How sure D is [-].")]
Roughness = Annotated[
    str | None, typer.Option(help="Fractal roughness G with unit, '1e-9 m'.")
]
RoughnessSd = Annotated[str, typer.Option(help="How sure G is, '30 %'.")]
Surfaces = Annotated[
    list[Path] | None,
    typer.Option(help="Surface file of one face; give it twice for a joint."),
]
Columns = Annotated[
    str | None, typer.Option(help="Columns of a plain table, 'x:um,z:um'.")
]
Poisson = Annotated[float, typer.Option(help="Poisson's ratio [-].")]
YieldStrength = Annotated[
    str | None, typer.Option(help="Of the softer body; hardness/2.8 if not given.")
]
HardnessSd = Annotated[str, typer.Option(help="How sure it is, '10 %'.")]
FrictionFactor = Annotated[float, typer.Option(help="k_mu of friction_3d [-].")]
FrictionFactorSd = Annotated[float, typer.Option(help="How sure [-].")]
Friction = Annotated[float, typer.Option(help="Coefficient of friction [-].")]
TangentialLoad = Annotated[
    str, typer.Option(help="On the joint, '1 kN'; contacts slip in part.")
]
NominalArea = Annotated[
    float | None, typer.Option(help="Apparent area [m^2], which guards the real.")
]
Model = Annotated[Texts, typer.Option(help="Contact model; may be repeated.")]
Mode = Annotated[
    str, typer.Option(help="'corrected', or 'as-printed' with the papers' faults.")
]
Without = Annotated[
    str | None,
    typer.Option(metavar="TERM,...", help="Terms to leave out: interaction, ..."),
]
Mass = Annotated[
    str | None, typer.Option(help="On the joint, '19.5 kg', for its damping.")
]
Frequency = Annotated[str | None, typer.Option(help="Instead of the mass, '200 Hz'.")]
LossForm = Annotated[str, typer.Option(help="'kogut-etsion' or 'two-regime' energies.")]
LossConvention = Annotated[
    str, typer.Option(help="'energy-ratio' or 'per-radian'; 2 pi apart.")
]
Sweep = Annotated[
    str | None,
    typer.Option(help="'load:1 kN:50 kN:20'; or dimension, or roughness."),
]
Plot = Annotated[
    Path | None, typer.Option(help="HTML page to write, with the sweep's plots.")
]
Json = Annotated[
    str | None,
    typer.Option(metavar="PATH", help="Write results as JSON; '-' = stdout."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactOptions:
    """The options of the command line, by name, as they are typed."""

    modulus: Modulus
    hardness: Hardness
    load: Load = None
    torque: Torque = None
    stiffness: Stiffness = None
    real_area: RealArea = None
    bolt_diameter: BoltDiameter = None
    bolts: Bolts = 1
    nut_factor: NutFactor = 0.2
    nut_factor_sd: NutFactorSd = 0.0
    dimension: Dimension = None
    dimension_sd: DimensionSd = 0.0
    roughness: Roughness = None
    roughness_sd: RoughnessSd = "0 %"
    surface: Surfaces = None
    columns: Columns = None
    poisson: Poisson = 0.25
    yield_strength: YieldStrength = None
    hardness_sd: HardnessSd = "0 %"
    friction_factor: FrictionFactor = 1.0
    friction_factor_sd: FrictionFactorSd = 0.0
    friction: Friction = 0.3
    tangential_load: TangentialLoad = "0 N"
    nominal_area: NominalArea = None
    model: Model = None
    mode: Mode = "corrected"
    without: Without = None
    mass: Mass = None
    frequency: Frequency = None
    loss_form: LossForm = "kogut-etsion"
    loss_convention: LossConvention = "energy-ratio"
    sweep: Sweep = None
    plot: Plot = None
    json: Json = None
    debug: Debug = False
