# SPDX-License-Identifier: MIT
"""Effects of the contact bench that change stiffness, with source and rivals."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.contact_bench.contact_damping import damping_effects
from jointbench.analysis.gap.contact_bench.contact_effect import (
    ContactEffect,
    EffectPlace,
    LoadedJoint,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import (
    STIFFNESSES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.contact_bench.preload_effects import preload_effects
from jointbench.analysis.gap.contact_bench.series_effects import lever, series_effects
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter, Transform

CONTACT_NAMES = (
    "series_compliance",
    "contact_patch",
    "interaction",
    "waviness",
    "law_exponent",
    "plastic_flattening",
    "scale_cut",
    "film",
    "partial_slip",
    "prevailing_torque",
    "falling_torque",
    "relaxation",
    "radiated_damping",
    "gas_film",
    "microslip_damping",
)
_ROCKING = STIFFNESSES.index(ContactQuantity.ROCKING)


def contact_catalogue(
    data: JointData, without: frozenset[str] = frozenset()
) -> tuple[ContactEffect, ...]:
    """Return the effects that the values of a joint can show.

    Args:
        data: measured values; an effect on quantities, branches, times or torques that
            were not measured is left out.
        without: names of effects to leave out.

    Raises:
        UsageError: `without` holds an unknown name.
    """
    unknown = sorted(without - set(CONTACT_NAMES))
    if unknown:
        raise UsageError(
            f"no effect of the contact bench is called {unknown[0]!r}; its effects "
            f"are {', '.join(CONTACT_NAMES)}"
        )
    found = [
        *series_effects(data),
        *_laws(data),
        *_parallels(data),
        *preload_effects(data),
        *damping_effects(data),
    ]
    return tuple(e for e in found if e.effect.name not in without)


def _exponent(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Turn ln k about the median preload of the nominal states."""
    return np.asarray(values[0] * (joint.log_preload - joint.middle))


def _flattened(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Keep stiffness when the preload falls."""
    return np.asarray(values[0] * joint.log_overload)


def _cut(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Move the law to another cut-off of the instrument."""
    return np.asarray(values[0] * joint.law.cut_shift(joint.log_preload)[0])


def _laws(data: JointData) -> list[ContactEffect]:
    """Return the effects on the law itself."""
    found = [
        ContactEffect(
            Effect(
                "law_exponent",
                "contact",
                (Parameter("change", "-", lower=-0.95, upper=2.0, off=0.0),),
                source="k ~ P^m: Hertz 1/3; fractal by D; linear 1 (Persson 2007)",
                separates={
                    "waviness": "measure the form of both bodies",
                    "series_compliance": "add a higher torque",
                    "prevailing_torque": "measure the preload with a washer",
                },
            ),
            EffectPlace.LAW,
            _exponent,
        ),
        ContactEffect(
            Effect(
                "scale_cut",
                "surface",
                (
                    Parameter(
                        "log_ratio",
                        "-",
                        lower=-4.0,
                        upper=4.0,
                        prior=(0.0, CONTACT.cut_sd),
                        off=0.0,
                    ),
                ),
                source="slope and curvature grow as the cut-off falls, by H - 1 and "
                "H - 2: Persson et al. 2005, J. Phys. Condens. Matter 17, R1",
                separates={"law_exponent": "measure with a finer instrument"},
            ),
            EffectPlace.LAW,
            _cut,
        ),
    ]
    if np.any(data.log_overload > 0):
        found.append(
            ContactEffect(
                Effect(
                    "plastic_flattening",
                    "contact",
                    (Parameter("change", "-", lower=0.0, upper=0.95, off=0.0),),
                    source="unloading of flattened summits: Etsion, Kligerman and "
                    "Kadin 2005, Int. J. Solids Struct. 42, 3716",
                    model_error=CONTACT.flattening_error,
                    separates={
                        "falling_torque": "bolt force washer",
                        "relaxation": "wait at constant torque and repeat",
                    },
                ),
                EffectPlace.LAW,
                _flattened,
            )
        )
    return found


def _film(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put a film in parallel with the contact, normal direction."""
    found = joint.table.copy()
    found[0] = found[0] + values[0]
    found[_ROCKING] = found[_ROCKING] + values[0] * lever(joint)
    return found


def _slipping(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Let the rims of the contacts slip."""
    shear = joint.data.states.shear
    force = np.where(np.isnan(shear), 1.0, shear) * values[0]
    ratio = np.minimum(force / joint.preload, CONTACT.most_ratio)
    found = joint.table.copy()
    found[1:3] = found[1:3] * (1.0 - ratio) ** values[1]
    return found


def _parallels(data: JointData) -> list[ContactEffect]:
    """Return the effects in parallel with the contact, and slip."""
    found = [
        ContactEffect(
            Effect(
                "film",
                "stiffness",
                (
                    Parameter(
                        "stiffness",
                        "N/m",
                        "least_stiffness",
                        0.0,
                        3.0,
                        off=0.0,
                        far=(0.5,),
                    ),
                ),
                source="lubricant or grease in the gap, in parallel with the contacts",
                separates={
                    "law_exponent": "clean and repeat; or add a lower torque",
                    "prevailing_torque": "measure the preload with a washer",
                },
            ),
            EffectPlace.STIFFNESS,
            _film,
        )
    ]
    if data.measures(ContactQuantity.TANGENTIAL, ContactQuantity.TANGENTIAL_2):
        stated = bool(np.isfinite(data.states.shear).any())
        first = (
            Parameter("inverse_friction", "-", "slip", 0.0, 0.98, off=0.0, far=(0.7,))
            if stated
            else Parameter("force", "N", "slip", 0.0, 0.98, off=0.0, far=(0.7,))
        )
        exponent = Parameter(
            "exponent",
            "-",
            lower=0.2,
            upper=1.5,
            starts=(0.4, 0.9),
            transform=Transform.LOG,
        )
        found.append(
            ContactEffect(
                Effect(
                    "partial_slip",
                    "friction",
                    (first, exponent),
                    source="k_t (1 - Q/(mu P))^m: m = 1/3 for one contact, Mindlin "
                    "1949, J. Appl. Mech. 16, 259; near 1 for many of random height, "
                    "Bjorklund 1997, J. Tribol. 119, 726; without a stated force, "
                    "Q/mu is found",
                    model_error=CONTACT.slip_error,
                    separates={"film": "level series: slip falls with the level"},
                ),
                EffectPlace.STIFFNESS,
                _slipping,
            )
        )
    return found
