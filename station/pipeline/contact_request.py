# SPDX-License-Identifier: MIT
"""What ``jointbench contact`` is asked: options as text, turned into SI and checked."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from jointbench.acquisition.basics.errors import BadData, UnitError, UsageError
from jointbench.acquisition.basics.units import STANDARD_GRAVITY, parse_value
from jointbench.analysis.contact.contact_case import ContactConditions
from jointbench.analysis.contact.damping import (
    DampingChoice,
    EnergyForm,
    LossConvention,
)
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.model_terms import ContactTerm, with_term
from jointbench.analysis.contact.models import ContactModel, Mode
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload, preload_from_torque
from jointbench.station.pipeline.contact_options import ContactOptions

_DEFAULT_MODEL = "ke_3d_modified"
_HARDNESS_NUMBER = re.compile(r"\s*(\d+\.?\d*)\s*(HB|HBW|HV)\s*", re.IGNORECASE)
_SWEEPS = {"load": "force", "dimension": "", "roughness": "length"}
_MOST_POINTS = 400
_USUAL_POINTS = 25


@dataclass(frozen=True, slots=True)
class Sweep:
    """One input that runs over a range.

    Attributes:
        name: ``"load"``, ``"dimension"`` or ``"roughness"``.
        values: [N], [-] or [m]; dimensions are those of a line.
    """

    name: str
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ContactRequest:
    """Everything about the joint but its surface.

    Attributes:
        models: in the mode asked for, terms taken out.
        preloads: [N], each with its standard deviation.
        conditions: what holds for every model and preload.
        stiffness: normal stiffness to reach [N/m], in place of preloads, or None.
        real_area: real area to reach [m^2], in place of preloads, or None.
    """

    models: tuple[ContactModel, ...]
    preloads: tuple[Preload, ...]
    conditions: ContactConditions
    stiffness: float | None = None
    real_area: float | None = None


def parse_request(given: ContactOptions) -> ContactRequest:
    """Turn options into SI quantities, and refuse what makes no sense.

    Args:
        given: as typed.

    Raises:
        UsageError: options that exclude each other or name nothing known.
        BadData: a number no joint can have, or without its unit.
    """
    hard = parse_hardness(given.hardness)
    models = parse_models(given.model or [_DEFAULT_MODEL], given.mode, given.without)
    material = _material(given, hard)
    preloads = _parse_preloads(
        given.load or [],
        given.torque or [],
        diameter=given.bolt_diameter,
        bolts=given.bolts,
        nut_factor=given.nut_factor,
        nut_factor_sd=given.nut_factor_sd,
        targets=(given.stiffness is not None) + (given.real_area is not None),
    )
    conditions = ContactConditions(
        material,
        hardness_sd=hard * _spread("--hardness-sd", given.hardness_sd),
        friction_factor_sd=given.friction_factor_sd,
        damping=_parse_damping(
            given.mass, given.frequency, given.loss_form, given.loss_convention
        ),
        tangential_load=parse_value(given.tangential_load, "force"),
        friction=given.friction,
        nominal_area=given.nominal_area,
        modulus_sd=material.effective_modulus
        * _spread("--modulus-sd", given.modulus_sd),
    )
    return ContactRequest(
        models,
        preloads,
        conditions,
        stiffness=None
        if given.stiffness is None
        else parse_value(given.stiffness, "stiffness"),
        real_area=given.real_area,
    )


def _material(given: ContactOptions, hardness: float) -> ContactMaterial:
    strength = given.yield_strength
    return ContactMaterial(
        effective_modulus=parse_value(given.modulus, "pressure"),
        hardness=hardness,
        poisson=given.poisson,
        yield_strength=None if strength is None else parse_value(strength, "pressure"),
        friction_factor=given.friction_factor,
    )


def parse_hardness(text: str) -> float:
    """Read a hardness: a pressure with its unit, or a Brinell or Vickers number [Pa].

    Args:
        text: ``"2.3 GPa"``, ``"231 HB"``, ``"240 HV"``.

    Returns:
        The hardness; the numbers are kgf/mm^2.

    Raises:
        UnitError: there is no number or no unit.
    """
    number = _HARDNESS_NUMBER.fullmatch(text)
    if number is not None:
        return float(number[1]) * STANDARD_GRAVITY * 1e6
    try:
        return parse_value(text, "pressure")
    except UnitError as error:
        raise UnitError(
            f"hardness {text.strip()!r}: {error}; or name the scale, '231 HB'"
        ) from error


def parse_models(
    names: Sequence[str], mode: str, without: str | None
) -> tuple[ContactModel, ...]:
    """Return the models by name, in one mode, with terms taken out.

    Args:
        names: of models.
        mode: ``corrected`` or ``as-printed``.
        without: names of terms, separated by commas, or None.

    Raises:
        UsageError: an unknown name, or terms taken out of a model as printed.
    """
    models = [contact_model(name, mode) for name in names]
    if without is None:
        return tuple(models)
    if mode == Mode.AS_PRINTED:
        raise UsageError("--without takes terms out of 'corrected' models only")
    for name in without.split(","):
        known = [str(term) for term in ContactTerm]
        if name.strip() not in known:
            raise UsageError(f"no term {name.strip()!r}; known: {', '.join(known)}")
        term = ContactTerm(name.strip())
        models = [with_term(model, term, present=False) for model in models]
    return tuple(models)


def _parse_preloads(
    loads: Sequence[str],
    torques: Sequence[str],
    *,
    diameter: str | None,
    bolts: int,
    nut_factor: float,
    nut_factor_sd: float,
    targets: int = 0,
) -> tuple[Preload, ...]:
    """Return preloads from loads or from torques on bolts [N]; none for targets.

    Args:
        loads: with unit; or
        torques: on each bolt, with unit, ``"20 N m"``, ``"15 lbf ft"``.
        diameter: nominal, of the bolts, with unit; needed for torques.
        bolts: how many carry the joint.
        nut_factor: K in F = T/(K d) [-].
        nut_factor_sd: how well it is known [-].
        targets: how many of stiffness and real area are given in their place.

    Raises:
        UsageError: not one way is given, or torques without a diameter.
    """
    if bool(loads) + bool(torques) + targets != 1:
        raise UsageError(
            "give one of --load and --torque, which may be repeated, --stiffness and "
            "--real-area"
        )
    if targets:
        return ()
    if loads:
        return tuple(Preload(_load(text), 0.0) for text in loads)
    if diameter is None:
        raise UsageError("--torque needs --bolt-diameter, for example '16 mm'")
    return tuple(
        preload_from_torque(
            parse_value(text, "torque"),
            diameter=parse_value(diameter, "length"),
            bolts=bolts,
            nut_factor=nut_factor,
            nut_factor_sd=nut_factor_sd,
        )
        for text in torques
    )


def _load(text: str) -> float:
    value = parse_value(text, "force")
    if not value > 0:
        raise BadData(f"preload is {value:g} N, it must be positive; give e.g. '4 kN'")
    return value


def _spread(option: str, text: str) -> float:
    value = parse_value(text, "ratio")
    if value < 0:
        raise BadData(f"{option} is {text!r}; a standard deviation cannot be negative")
    return value


def _parse_damping(
    mass: str | None, frequency: str | None, form: str, convention: str
) -> DampingChoice | None:
    """Return what damping is to be made of; None without mass and frequency.

    Args:
        mass: with unit, ``"19.5 kg"``.
        frequency: with unit, ``"200 Hz"``.
        form: of the energies.
        convention: of the loss factor.

    Raises:
        UsageError: an unknown form or convention.
    """
    forms, conventions = [str(f) for f in EnergyForm], [str(c) for c in LossConvention]
    if form not in forms:
        raise UsageError(f"no loss form {form!r}; known: {', '.join(forms)}")
    if convention not in conventions:
        raise UsageError(
            f"no loss convention {convention!r}; known: {', '.join(conventions)}"
        )
    if mass is None and frequency is None:
        return None
    return DampingChoice(
        mass=None if mass is None else parse_value(mass, "mass"),
        frequency=None if frequency is None else parse_value(frequency, "frequency"),
        form=EnergyForm(form),
        convention=LossConvention(convention),
    )


def parse_sweep(text: str) -> Sweep:
    """Read ``NAME:FROM:TO[:POINTS]``, for example ``"load:1 kN:50 kN:20"``.

    Args:
        text: as typed; load and roughness need units and run in equal ratios, the
            dimension in equal steps.

    Returns:
        The values in SI.

    Raises:
        UsageError: it does not read so.
    """
    parts = [part.strip() for part in text.split(":")]
    if len(parts) not in {3, 4} or parts[0] not in _SWEEPS:
        raise UsageError(
            f"--sweep {text!r} must read NAME:FROM:TO[:POINTS] with NAME one of "
            f"{', '.join(_SWEEPS)}, for example 'load:1 kN:50 kN:20'"
        )
    name, kind = parts[0], _SWEEPS[parts[0]]
    points = _points(parts[3]) if len(parts) == 4 else _USUAL_POINTS
    low, high = (
        parse_value(part, kind) if kind else _number(part) for part in parts[1:3]
    )
    if not 0 < low < high < math.inf:
        raise UsageError(f"--sweep {text!r}: FROM must be above 0 and below TO")
    steps = [i / (points - 1) for i in range(points)]
    if kind:
        return Sweep(name, tuple(low * (high / low) ** step for step in steps))
    of_surface = 1.0 if low > 2 else 0.0  # a surface's D_s is one higher than a line's
    return Sweep(name, tuple(low + (high - low) * s - of_surface for s in steps))


def swept(
    request: ContactRequest, surface: ContactSurface, name: str, value: float
) -> tuple[ContactRequest, ContactSurface]:
    """Return request and surface with one swept input at `value`, spreads left out."""
    plain = ContactSurface(surface.dimension, surface.roughness)
    conditions = replace(request.conditions, hardness_sd=0.0, friction_factor_sd=0.0)
    bare = replace(request, conditions=conditions)
    if name == "load":
        return replace(bare, preloads=(Preload(value, 0.0),)), plain
    if bare.preloads:
        bare = replace(bare, preloads=(Preload(bare.preloads[0].value, 0.0),))
    if name == "dimension":
        return bare, replace(plain, dimension=value)
    return bare, replace(plain, roughness=value)


def _points(text: str) -> int:
    if not text.isdigit() or not 2 <= int(text) <= _MOST_POINTS:
        raise UsageError(f"--sweep points {text!r}: give 2 to {_MOST_POINTS}")
    return int(text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise UsageError(f"--sweep: {text!r} is no number; give e.g. 1.2") from None
