# SPDX-License-Identifier: MIT
"""One effect of the contact bench: a change of preload, law, stiffness or damping."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.contact_bench.preload_law import LinearisedLaw
from jointbench.analysis.gap.model.effect import Effect, Site

SITE = Site("link", "joint")


class EffectPlace(IntEnum):
    """Place of an effect on the way from the torque to a measured value."""

    PRELOAD = 0
    """Adds to ln P, shape (n_states,)."""
    LAW = 1
    """Adds to ln k of the contact, shape (n_states,)."""
    STIFFNESS = 2
    """Replaces stiffnesses, shape (6, n_states); damping rows are still zero."""
    DAMPING = 3
    """Replaces damping, same shape."""
    VALUE = 4
    """Adds to ln of each value, same shape: shapes that no physics explains."""


@dataclass(frozen=True, slots=True, eq=False)
class LoadedJoint:
    """A joint in all its states, as far as it is computed.

    Attributes:
        data: states and facts.
        law: the base.
        log_preload: [ln N], shape (n_states,).
        middle: median of the nominal ln P [ln N].
        log_overload: ln of the highest earlier preload over the present one, shape
            (n_states,).
        omega: angular frequency of the vibration [rad/s], same shape.
        table: stiffness and damping in the order of `QUANTITIES` [SI], (6, n_states).
    """

    data: JointData
    law: LinearisedLaw
    log_preload: FloatArray
    middle: float
    log_overload: FloatArray
    omega: FloatArray
    table: FloatArray

    @property
    def preload(self) -> FloatArray:
        """Preload [N], shape (n_states,)."""
        return np.asarray(np.exp(self.log_preload))


Act = Callable[[FloatArray, LoadedJoint], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class ContactEffect:
    """An entry of the catalogue of the contact bench.

    Attributes:
        effect: name, parameters, source and rivals.
        place: at which it acts.
        act: its physics, from values [SI] and joint to the result at this place.
        site: where it is reported.
    """

    effect: Effect
    place: EffectPlace
    act: Act
    site: Site = SITE
