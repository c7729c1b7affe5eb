# SPDX-License-Identifier: MIT
"""The options of ``jointbench contact``, as one record."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

_Texts = list[str] | None
_QUANTITY = "QUANTITY"
_MATERIAL = "Material"
_PRELOAD = "Preload (one of --load, --torque, --stiffness, --real-area)"
_SURFACE = "Surface (--dimension and --roughness, or --surface)"
_FRICTION = "Friction"
_LAW = "Contact law"
_DAMPING = "Damping"


def _option(group: str, metavar: str, text: str) -> Any:
    return typer.Option(metavar=metavar, help=text, rich_help_panel=group)


_Modulus = Annotated[
    str,
    _option(_MATERIAL, _QUANTITY, "Composite elastic modulus E*, as '29.3 GPa'."),
]
_ModulusSd = Annotated[
    str,
    _option(
        _MATERIAL,
        _QUANTITY,
        "Standard deviation of E*, as '3 %', for the laws of measured surfaces.",
    ),
]
_Hardness = Annotated[
    str,
    _option(
        _MATERIAL, _QUANTITY, "Hardness of the softer body, as '1.5 GPa' or '231 HB'."
    ),
]
_HardnessSd = Annotated[
    str,
    _option(_MATERIAL, _QUANTITY, "Standard deviation of the hardness, as '10 %'."),
]
_Poisson = Annotated[float, _option(_MATERIAL, "NUMBER", "Poisson's ratio [-].")]
_YieldStrength = Annotated[
    str | None,
    _option(
        _MATERIAL,
        _QUANTITY,
        "Yield strength of the softer body, as '350 MPa'; hardness / 2.8 by default.",
    ),
]
_Load = Annotated[_Texts, _option(_PRELOAD, _QUANTITY, "Preload, as '25 kN'.")]
_Torque = Annotated[
    _Texts, _option(_PRELOAD, _QUANTITY, "Tightening torque of each bolt, as '20 N m'.")
]
_Stiffness = Annotated[
    str | None,
    _option(
        _PRELOAD, _QUANTITY, "Find the preload of this normal stiffness, as '3e7 N/m'."
    ),
]
_RealArea = Annotated[
    float | None,
    _option(
        _PRELOAD,
        "NUMBER",
        "Find the preload of this real contact area [m^2], for example 1e-6.",
    ),
]
_BoltDiameter = Annotated[
    str | None, _option(_PRELOAD, _QUANTITY, "Nominal bolt diameter, as '16 mm'.")
]
_Bolts = Annotated[int, _option(_PRELOAD, "N", "Number of bolts of the joint.")]
_NutFactor = Annotated[
    float, _option(_PRELOAD, "NUMBER", "Nut factor K in F = T/(K d) [-].")
]
_NutFactorSd = Annotated[
    float, _option(_PRELOAD, "NUMBER", "Standard deviation of the nut factor [-].")
]
_Dimension = Annotated[
    float | None,
    _option(
        _SURFACE, "NUMBER", "Fractal dimension D of the profile [-], for example 1.54."
    ),
]
_DimensionSd = Annotated[
    float, _option(_SURFACE, "NUMBER", "Standard deviation of D [-].")
]
_Roughness = Annotated[
    str | None, _option(_SURFACE, _QUANTITY, "Fractal roughness G, as '1e-9 m'.")
]
_RoughnessSd = Annotated[
    str, _option(_SURFACE, _QUANTITY, "Standard deviation of G, as '30 %'.")
]
_Surfaces = Annotated[
    list[Path] | None,
    _option(_SURFACE, "PATH", "Measured contact surface; give one or both."),
]
_Columns = Annotated[
    str | None,
    _option(
        _SURFACE,
        "ROLE:UNIT,...",
        "Columns of a plain table of heights, for example 'x:um,z:um'.",
    ),
]
_NominalArea = Annotated[
    float | None,
    _option(
        _SURFACE,
        "NUMBER",
        "Nominal contact area [m^2], for example 0.01: upper limit of the real area "
        "and reference of the laws of measured surfaces.",
    ),
]
_FrictionFactor = Annotated[
    float, _option(_FRICTION, "NUMBER", "Friction factor k_mu of friction_3d [-].")
]
_FrictionFactorSd = Annotated[
    float, _option(_FRICTION, "NUMBER", "Standard deviation of k_mu [-].")
]
_Friction = Annotated[
    float, _option(_FRICTION, "NUMBER", "Coefficient of friction [-].")
]
_TangentialLoad = Annotated[
    str,
    _option(
        _FRICTION,
        _QUANTITY,
        "Tangential load on the joint, as '1 kN', for partial slip.",
    ),
]
_Model = Annotated[
    _Texts,
    _option(
        _LAW,
        "NAME",
        "Contact law; ke_3d_modified by default.",
    ),
]
_Mode = Annotated[
    str,
    _option(
        _LAW,
        "corrected|as-printed",
        "Formulas with corrections, or as printed in the papers.",
    ),
]
_Without = Annotated[
    str | None,
    _option(_LAW, "TERM,...", "Terms to leave out, for example interaction,friction."),
]
_Sweep = Annotated[
    str | None,
    _option(
        _LAW,
        "NAME:FROM:TO:N",
        "Vary load [N], dimension [-] or roughness [m], for example "
        "'load:1 kN:50 kN:20'.",
    ),
]
_Plot = Annotated[
    Path | None, _option(_LAW, "PATH", "HTML report to write, with plots of the sweep.")
]
_Mass = Annotated[
    str | None,
    _option(_DAMPING, _QUANTITY, "Mass on the joint, as '19.5 kg'."),
]
_Frequency = Annotated[
    str | None,
    _option(
        _DAMPING, _QUANTITY, "Vibration frequency, as '200 Hz', in place of --mass."
    ),
]
_LossForm = Annotated[
    str,
    _option(_DAMPING, "kogut-etsion|two-regime", "Form of the contact energies."),
]
_LossConvention = Annotated[
    str,
    _option(
        _DAMPING,
        "energy-ratio|per-radian",
        "Definition of the loss factor; the two differ by about 2 pi.",
    ),
]
_Json = Annotated[
    str | None,
    typer.Option(
        metavar="PATH", help="Write the results as JSON; '-' for standard output."
    ),
]
_Debug = Annotated[
    bool, typer.Option("--debug", help="Show the traceback of an error.")
]


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactOptions:
    """The options of the command line by name, as typed, in the order of the help."""

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
    modulus_sd: _ModulusSd = "0 %"
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
