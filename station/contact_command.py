# SPDX-License-Identifier: MIT
"""The options of ``jointbench contact``; the work is done elsewhere, when it runs."""

from pathlib import Path
from typing import Annotated

import typer

Texts = list[str] | None


def contact_command(
    modulus: Annotated[str, typer.Option(help="Composite modulus E*, '29.3 GPa'.")],
    hardness: Annotated[str, typer.Option(help="Hardness, '1.5 GPa' or '231 HB'.")],
    load: Annotated[
        Texts, typer.Option(help="Preload with unit, '25 kN'; may be repeated.")
    ] = None,
    torque: Annotated[
        Texts, typer.Option(help="On each bolt instead, '20 N m'; may be repeated.")
    ] = None,
    bolt_diameter: Annotated[str | None, typer.Option(help="Nominal, '16 mm'.")] = None,
    bolts: Annotated[int, typer.Option(help="Bolts that carry the joint.")] = 1,
    nut_factor: Annotated[float, typer.Option(help="K in F = T/(K d) [-].")] = 0.2,
    nut_factor_sd: Annotated[float, typer.Option(help="How sure K is [-].")] = 0.0,
    dimension: Annotated[
        float | None, typer.Option(help="Profile fractal dimension, 1 < D < 2.")
    ] = None,
    dimension_sd: Annotated[float, typer.Option(help="How sure D is [-].")] = 0.0,
    roughness: Annotated[
        str | None, typer.Option(help="Fractal roughness G with unit, '1e-9 m'.")
    ] = None,
    roughness_sd: Annotated[str, typer.Option(help="How sure G is, '30 %'.")] = "0 %",
    surface: Annotated[
        list[Path] | None,
        typer.Option(help="Surface file of one face; give it twice for a joint."),
    ] = None,
    columns: Annotated[
        str | None, typer.Option(help="Columns of a plain table, 'x:um,z:um'.")
    ] = None,
    poisson: Annotated[float, typer.Option(help="Poisson's ratio [-].")] = 0.25,
    yield_strength: Annotated[
        str | None, typer.Option(help="Of the softer body; hardness/2.8 if not given.")
    ] = None,
    hardness_sd: Annotated[str, typer.Option(help="How sure it is, '10 %'.")] = "0 %",
    friction_factor: Annotated[
        float, typer.Option(help="k_mu of friction_3d [-].")
    ] = 1.0,
    friction_factor_sd: Annotated[float, typer.Option(help="How sure [-].")] = 0.0,
    friction: Annotated[float, typer.Option(help="Coefficient of friction [-].")] = 0.3,
    tangential_load: Annotated[
        str, typer.Option(help="On the joint, '1 kN'; contacts slip in part.")
    ] = "0 N",
    nominal_area: Annotated[
        float | None, typer.Option(help="Apparent area [m^2], which guards the real.")
    ] = None,
    model: Annotated[
        Texts, typer.Option(help="Contact model; may be repeated.")
    ] = None,
    mode: Annotated[
        str, typer.Option(help="'corrected', or 'as-printed' with the papers' faults.")
    ] = "corrected",
    without: Annotated[
        str | None,
        typer.Option(metavar="TERM,...", help="Terms to leave out: interaction, ..."),
    ] = None,
    mass: Annotated[
        str | None, typer.Option(help="On the joint, '19.5 kg', for its damping.")
    ] = None,
    frequency: Annotated[
        str | None, typer.Option(help="Instead of the mass, '200 Hz'.")
    ] = None,
    loss_form: Annotated[
        str, typer.Option(help="'kogut-etsion' or 'two-regime' energies.")
    ] = "kogut-etsion",
    loss_convention: Annotated[
        str, typer.Option(help="'energy-ratio' or 'per-radian'; 2 pi apart.")
    ] = "energy-ratio",
    sweep: Annotated[
        str | None,
        typer.Option(help="'load:1 kN:50 kN:20'; or dimension, or roughness."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="HTML page to write, with the sweep's plots.")
    ] = None,
    json: Annotated[
        str | None,
        typer.Option(metavar="PATH", help="Write results as JSON; '-' = stdout."),
    ] = None,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show the traceback of an error.")
    ] = False,
) -> None:
    """Predict a rough joint's stiffness and damping from D, G, material and preload.

    Example: jointbench contact --dimension 1.54 --roughness '1e-9 m' --modulus
    '29.3 GPa' --hardness '1.5 GPa' --load '1 kN' --load '25 kN'
    """
    from jointbench.acquisition.units import parse_value
    from jointbench.analysis.contact.material import ContactMaterial
    from jointbench.station import contact_request as ask
    from jointbench.station.contact_show import run_contact

    hard = ask.parse_hardness(hardness)
    request = ask.ContactRequest(
        models=ask.parse_models(model or ["ke_3d_modified"], mode, without),
        material=ContactMaterial(
            effective_modulus=parse_value(modulus, "pressure"),
            hardness=hard,
            poisson=poisson,
            yield_strength=None
            if yield_strength is None
            else parse_value(yield_strength, "pressure"),
            friction_factor=friction_factor,
        ),
        preloads=ask.parse_preloads(
            load or [],
            torque or [],
            diameter=bolt_diameter,
            bolts=bolts,
            nut_factor=nut_factor,
            nut_factor_sd=nut_factor_sd,
        ),
        hardness_sd=hard * parse_value(hardness_sd, "ratio"),
        friction_factor_sd=friction_factor_sd,
        damping=ask.parse_damping(mass, frequency, loss_form, loss_convention),
        tangential_load=parse_value(tangential_load, "force"),
        friction=friction,
        nominal_area=nominal_area,
    )
    run_contact(
        request,
        dimension=dimension,
        roughness=roughness,
        dimension_sd=dimension_sd,
        roughness_sd=roughness_sd,
        surfaces=surface or [],
        columns=columns,
        sweep=None if sweep is None else ask.parse_sweep(sweep),
        page=plot,
        json_target=json,
    )
