# SPDX-License-Identifier: MIT
"""Effects in series with the contact: bodies, cones of bolts, long waves."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
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
    JointFacts,
)
from jointbench.analysis.gap.contact_bench.preload_laws import mindlin_ratio
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter, Transform

_ROCKING = STIFFNESSES.index(ContactQuantity.ROCKING)


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


def lever(joint: LoadedJoint) -> float:
    """Return the square of the radius of gyration of the contact surface [m^2]."""
    return (joint.data.facts.rocking_radius or 1.0) ** 2


def _in_bodies(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put bodies and bolts in series with the contact."""
    normal = values[0]
    ratio = values[1] if values.size > 1 else 1.0
    return series(
        (normal, ratio * normal, ratio * normal, normal / lever(joint)), joint.table
    )


def _at_cones(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Limit the contact to the pressure cones of the bolts."""
    facts, share = joint.data.facts, values[0]
    radius, circle = facts.cone_radius or 1.0, facts.bolt_radius or 0.0
    alone = 1.0 / (2.0 * facts.modulus * radius)
    normal = share * (alone + _neighbours(facts)) / facts.bolts
    tangential = normal * _tangential_ratio(values[1:], facts)
    whole = lever(joint)
    table = joint.table * np.exp(min(share, 1.0) * _on_patches(joint))
    # Each cone adds the lever of its own circle, r^2/4.
    patch = circle**2 + 0.25 * radius**2
    left = 1.0 + min(share, 1.0) * (patch / whole - 1.0)
    table[_ROCKING] *= left
    # Neighbours tilt against each other, so that only the own constriction counts.
    rocking = share * alone / facts.bolts / (left * whole)
    return series((normal, tangential, tangential, rocking), table)


def _neighbours(facts: JointFacts) -> float:
    """Return how far one cone sinks under unit load on each other one [m/N].

    The bolts are on a ring, whose radius of gyration about a diameter is known.
    """
    ring = np.sqrt(2.0) * (facts.bolt_radius or 1.0)
    steps = np.arange(1, facts.bolts) / facts.bolts
    apart = np.maximum(
        2.0 * ring * np.sin(np.pi * steps), 2.0 * (facts.cone_radius or 1.0)
    )
    return float(np.sum(1.0 / (np.pi * facts.modulus * apart)))


def _tangential_ratio(given: FloatArray, facts: JointFacts) -> float:
    """Return tangential over normal compliance; Mindlin's where it is not fitted."""
    return float(given[0]) if given.size else 1.0 / mindlin_ratio(facts.poisson)


def _on_patches(joint: LoadedJoint) -> FloatArray:
    """Return the change of ln k where the load is on the cones only, (n_states,).

    A law per unit area gives k = s k_law(P/s) on the share s of the area.
    """
    facts = joint.data.facts
    cones = facts.bolts * np.pi * (facts.cone_radius or 1.0) ** 2
    log_share = min(float(np.log(cones / facts.area)), 0.0)
    about, law = joint.law.about, joint.law
    on_cones = law.log_stiffness(joint.log_preload - log_share, about)[0]
    whole = law.log_stiffness(joint.log_preload, about)[0]
    return np.asarray(on_cones + log_share - whole)


def _between_asperities(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Let the mean plane sink under the load of all asperities."""
    facts = joint.data.facts
    normal = values[0] / (facts.modulus * np.sqrt(facts.area))
    tangential = normal * _tangential_ratio(values[1:], facts)
    return series((normal, tangential, tangential, normal / lever(joint)), joint.table)


def _waves(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Put the long waves in series until their contact closes."""
    depth, closing = values[:2]
    open_share = np.maximum(np.log(closing) - joint.log_preload, 0.0)
    normal = depth * open_share
    tangential = normal * _tangential_ratio(values[2:], joint.data.facts)
    return series((normal, tangential, tangential, normal / lever(joint)), joint.table)


def series_effects(data: JointData) -> list[ContactEffect]:
    """Return the effects in series with the contact that a joint can show."""
    shear = data.measures(ContactQuantity.TANGENTIAL, ContactQuantity.TANGENTIAL_2)
    wide = (_ratio(1.3, CONTACT.free_ratio_sd),) if shear else ()
    near = 1.0 / mindlin_ratio(data.facts.poisson)
    known = (_ratio(near, CONTACT.known_ratio_sd),) if shear else ()
    amplitude = Parameter(
        "compliance",
        "m/N",
        "compliance",
        0.0,
        1.5,
        off=0.0,
        far=(0.1, 0.6, 0.95),
    )
    found = [
        ContactEffect(
            Effect(
                "series_compliance",
                "stiffness",
                (amplitude, *wide),
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
            EffectPlace.STIFFNESS,
            _in_bodies,
        ),
        ContactEffect(
            Effect(
                "interaction",
                "stiffness",
                (_known_size("size"), *known),
                source="mean plane sinks by F/(E* sqrt(A)): Zhao and Chang 2001, J. "
                "Tribol. 123, 857; do not add it to a meshed body, which has it",
                separates={"series_compliance": "its size is known"},
            ),
            EffectPlace.STIFFNESS,
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
                        far=(0.3,),
                    ),
                    Parameter(
                        "closing_preload",
                        "N",
                        "highest",
                        0.02,
                        3.0,
                        starts=(0.07, 0.13, 0.22, 0.4, 0.7, 1.2),
                        transform=Transform.LOG,
                    ),
                    *known,
                ),
                source="Westergaard 1939, J. Appl. Mech. 6, A49: compliance lambda/(pi "
                "E* A) ln(P_c/P) below the preload P_c that closes the waves",
                separates={
                    "law_exponent": "measure the form: below P_c over all torques the "
                    "two look alike",
                    "series_compliance": "add a higher torque: waves close",
                },
            ),
            EffectPlace.STIFFNESS,
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
                    (_known_size("share"), *known),
                    source="pressure cones: VDI 2230, sec. 5.1; constriction 1/(2 E* "
                    "a) of each: Johnson, Contact Mechanics, sec. 3.6",
                    separates={
                        "series_compliance": "pressure film, or rocking modes: cones "
                        "lower the rocking stiffness more than the normal one"
                    },
                ),
                EffectPlace.STIFFNESS,
                _at_cones,
            )
        )
    return found


def _ratio(median: float, sd: float) -> Parameter:
    """Return the ratio of tangential to normal compliance."""
    return Parameter(
        "tangential_ratio",
        "-",
        lower=0.2,
        upper=10.0,
        starts=(median,),
        transform=Transform.LOG,
        prior=(median, sd),
    )


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
