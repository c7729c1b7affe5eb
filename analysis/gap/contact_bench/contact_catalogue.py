# SPDX-License-Identifier: MIT
"""Effects of the contact bench that change stiffness, with source and rivals."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.contact_bench.contact_damping import damping_effects
from jointbench.analysis.gap.contact_bench.contact_effect import (
    ContactEffect,
    LoadedJoint,
    Stage,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import (
    STIFFNESSES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.contact_bench.preload_effects import preload_effects
from jointbench.analysis.gap.contact_bench.preload_laws import mindlin_ratio
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
        *_compliances(data),
        *_laws(data),
        *_parallels(data),
        *preload_effects(data),
        *damping_effects(data),
    ]
    return tuple(e for e in found if e.effect.name not in without)


def series(compliances: Sequence[float | FloatArray], table: FloatArray) -> FloatArray:
    """Return stiffnesses with compliances in series, shape (6, n_states).

    Args:
        compliances: of kn, kt, kt2 and kr, each a number or shape (n_states,).
        table: stiffness without them, shape (6, n_states).
    """
    found = table.copy()
    for row, compliance in enumerate(compliances):
        found[row] = table[row] / (1.0 + compliance * table[row])
    return found


def _lever(joint: LoadedJoint) -> float:
    """Return the square of the radius of gyration of the contact surface [m^2]."""
    return (joint.data.facts.rocking_radius or 1.0) ** 2


def _in_bodies(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put bodies and bolts in series with the contact."""
    normal = values[0]
    ratio = values[1] if values.size > 1 else 1.0
    return series(
        (normal, ratio * normal, ratio * normal, normal / _lever(joint)), joint.table
    )


def _at_cones(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Limit the contact to the pressure cones of the bolts."""
    facts, share = joint.data.facts, values[0]
    radius, circle = facts.cone_radius or 1.0, facts.bolt_radius or 0.0
    normal = share / (2.0 * facts.bolts * facts.modulus * radius)
    tangential = normal / mindlin_ratio(facts.poisson)
    whole = _lever(joint)
    # Each cone adds the lever of its own circle, r^2/4.
    patch = circle**2 + 0.25 * radius**2
    left = 1.0 + min(share, 1.0) * (patch / whole - 1.0)
    rocking = normal / whole
    found = series((normal, tangential, tangential, rocking), joint.table)
    found[_ROCKING] *= left
    return found


def _between_asperities(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Let the mean plane sink under the load of all asperities."""
    facts = joint.data.facts
    normal = values[0] / (facts.modulus * np.sqrt(facts.area))
    tangential = normal / mindlin_ratio(facts.poisson)
    return series((normal, tangential, tangential, normal / _lever(joint)), joint.table)


def _waves(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put the long waves in series until their contact closes."""
    depth, closing = values
    open_share = np.maximum(np.log(closing) - joint.log_preload, 0.0)
    normal = depth * open_share
    tangential = normal / mindlin_ratio(joint.data.facts.poisson)
    return series((normal, tangential, tangential, normal / _lever(joint)), joint.table)


def _compliances(data: JointData) -> list[ContactEffect]:
    """Return the effects in series with the contact."""
    shear = data.measures(ContactQuantity.TANGENTIAL, ContactQuantity.TANGENTIAL_2)
    tangential = Parameter(
        "tangential_ratio",
        "-",
        lower=0.2,
        upper=10.0,
        starts=(1.3,),
        transform=Transform.LOG,
        prior=(1.3, 0.5),
    )
    amplitude = Parameter(
        "compliance",
        "m/N",
        "compliance",
        0.0,
        1.5,
        off=0.0,
        far=(0.02, 0.1, 0.4, 0.8, 0.98),
    )
    found = [
        ContactEffect(
            Effect(
                "series_compliance",
                "stiffness",
                (amplitude, tangential) if shear else (amplitude,),
                source="1/k = 1/k_contact + c of bodies and bolts; VDI 2230, sec. 5.1",
                separates={
                    "law_exponent": "add a higher torque: a compliance limits the "
                    "stiffness, an exponent does not",
                    "waviness": "add a higher torque: waves close",
                    "contact_patch": "pressure film, or rocking modes",
                    "interaction": "its size is known: 1/(E* sqrt(A))",
                },
                generalises=("contact_patch", "interaction"),
            ),
            Stage.STIFFNESS,
            _in_bodies,
        ),
        ContactEffect(
            Effect(
                "interaction",
                "stiffness",
                (_known_size("size"),),
                source="mean plane sinks by F/(E* sqrt(A)): Zhao and Chang 2001, J. "
                "Tribol. 123, 857; do not add it to a meshed body, which has it",
                separates={"series_compliance": "its size is known"},
            ),
            Stage.STIFFNESS,
            _between_asperities,
        ),
        ContactEffect(
            Effect(
                "waviness",
                "contact",
                (
                    Parameter(
                        "depth",
                        "m/N",
                        "compliance",
                        0.0,
                        5.0,
                        off=0.0,
                        far=(0.05, 0.3, 1.0),
                    ),
                    Parameter(
                        "closing_preload",
                        "N",
                        "highest",
                        0.02,
                        3.0,
                        starts=(0.1, 0.25, 0.5, 1.0),
                        transform=Transform.LOG,
                    ),
                ),
                source="Westergaard 1939, J. Appl. Mech. 6, A49: compliance lambda/(pi "
                "E* A) ln(P_c/P) below the preload P_c that closes the waves",
                separates={
                    "law_exponent": "measure the form: below P_c over all torques the "
                    "two look alike",
                    "series_compliance": "add a higher torque: waves close",
                },
            ),
            Stage.STIFFNESS,
            _waves,
        ),
    ]
    facts = data.facts
    if facts.cone_radius is not None and facts.bolt_radius is not None:
        found.append(
            ContactEffect(
                Effect(
                    "contact_patch",
                    "contact",
                    (_known_size("share"),),
                    source="pressure cones: VDI 2230, sec. 5.1; constriction 1/(2 E* "
                    "a) of each: Johnson, Contact Mechanics, sec. 3.6",
                    separates={
                        "series_compliance": "pressure film, or rocking modes: cones "
                        "lower the rocking stiffness more than the normal one"
                    },
                ),
                Stage.STIFFNESS,
                _at_cones,
            )
        )
    return found


def _known_size(name: str) -> Parameter:
    """Return the amplitude of an effect whose size follows from the facts."""
    return Parameter(
        name,
        "-",
        lower=0.1,
        upper=10.0,
        starts=(1.0,),
        transform=Transform.LOG,
        prior=(1.0, CONTACT.known_size_sd),
    )


def _exponent(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Turn ln k about the median preload of the nominal states."""
    middle = np.median(joint.data.nominal_log_preload)
    return np.asarray(values[0] * (joint.log_preload - middle))


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
            Stage.LAW,
            _exponent,
        ),
        ContactEffect(
            Effect(
                "scale_cut",
                "surface",
                (Parameter("log_ratio", "-", lower=-6.0, upper=6.0, off=0.0),),
                source="slope and curvature grow as the cut-off falls, by H - 1 and "
                "H - 2: Persson et al. 2005, J. Phys. Condens. Matter 17, R1",
                separates={"law_exponent": "measure with a finer instrument"},
            ),
            Stage.LAW,
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
                    separates={
                        "falling_torque": "bolt force washer",
                        "relaxation": "wait at constant torque and repeat",
                    },
                ),
                Stage.LAW,
                _flattened,
            )
        )
    return found


def _film(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put a film in parallel with the contact, normal direction."""
    found = joint.table.copy()
    found[0] = found[0] + values[0]
    found[_ROCKING] = found[_ROCKING] + values[0] * _lever(joint)
    return found


def _slipping(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Let the rims of the contacts slip."""
    shear = joint.data.states.shear
    force = np.where(np.isnan(shear), 1.0, shear) * values[0]
    ratio = np.minimum(force / joint.preload, CONTACT.most_ratio)
    found = joint.table.copy()
    found[1:3] = found[1:3] * np.cbrt(1.0 - ratio)
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
                        far=(0.1, 0.5, 0.9),
                    ),
                ),
                source="lubricant or grease in the gap, in parallel with the contacts",
                separates={
                    "law_exponent": "clean and repeat; or add a lower torque",
                    "prevailing_torque": "measure the preload with a washer",
                },
            ),
            Stage.STIFFNESS,
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
        found.append(
            ContactEffect(
                Effect(
                    "partial_slip",
                    "friction",
                    (first,),
                    source="k_t (1 - Q/(mu P))^(1/3): Mindlin 1949, J. Appl. Mech. 16, "
                    "259; without a stated force, Q/mu is found",
                    separates={"film": "level series: slip falls with the level"},
                ),
                Stage.STIFFNESS,
                _slipping,
            )
        )
    return found
