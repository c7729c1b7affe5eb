# SPDX-License-Identifier: MIT
"""Effects between torque and preload: prevailing torque, loosening, relaxation."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.contact_effect import (
    ContactEffect,
    EffectPlace,
    LoadedJoint,
)
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import JointData
from jointbench.analysis.gap.model.effect import Effect
from jointbench.analysis.gap.model.effect_parameter import Parameter

_WASHER = "measure the preload with a washer"


def _prevailing(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Subtract the torque that loads no bolt; NaN where no torque is left."""
    states = joint.data.states
    torque = np.where(states.by_torque, states.torque, np.inf)
    share = values[0] / torque
    open_joint = np.full(torque.shape, np.nan)
    return np.asarray(np.log1p(-share, out=open_joint, where=share < 1.0))


def _falling(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Change the preload of states that were reached by loosening."""
    states = joint.data.states
    return np.where(states.by_torque & states.falling, values[0], 0.0)


def _relaxed(values: FloatArray, joint: LoadedJoint) -> FloatArray:
    """Let the preload relax with the logarithm of time."""
    states = joint.data.states
    time = np.where(states.by_torque & np.isfinite(states.time), states.time, 0.0)
    decades = np.log10(1.0 + time / CONTACT.relaxation_start)
    return np.asarray(np.log1p(-np.minimum(values[0] * decades, CONTACT.most_ratio)))


def preload_effects(data: JointData) -> list[ContactEffect]:
    """Return the effects on preloads that follow from a torque."""
    states, found = data.states, list[ContactEffect]()
    if not states.by_torque.any():
        return found
    found.append(
        ContactEffect(
            Effect(
                "prevailing_torque",
                "preload",
                (
                    Parameter(
                        "torque",
                        "N m",
                        "least_torque",
                        0.0,
                        0.95,
                        off=0.0,
                        far=(0.7,),
                    ),
                ),
                source="P = n (T - T_0)/(K d) with a locking or damaged thread; ISO "
                "2320",
                separates={"law_exponent": _WASHER, "film": _WASHER},
            ),
            EffectPlace.PRELOAD,
            _prevailing,
        )
    )
    if np.any(states.falling & states.by_torque):
        found.append(
            ContactEffect(
                Effect(
                    "falling_torque",
                    "preload",
                    (Parameter("log_ratio", "-", lower=-0.9, upper=0.9, off=0.0),),
                    source="friction of the thread reverses when a bolt is loosened: "
                    "VDI 2230, sec. 5.4",
                    separates={"plastic_flattening": "bolt force washer"},
                ),
                EffectPlace.PRELOAD,
                _falling,
            )
        )
    times = np.unique(states.time[states.by_torque & np.isfinite(states.time)])
    if times.size > 1:
        found.append(
            ContactEffect(
                Effect(
                    "relaxation",
                    "preload",
                    (Parameter("per_decade", "-", lower=0.0, upper=0.2, off=0.0),),
                    source="P (1 - rho log10(1 + t/t_0)), rho of 1 to 5 % a decade: "
                    "embedding and creep, VDI 2230, sec. 5.4.2",
                    separates={
                        "plastic_flattening": "wait at constant torque and repeat"
                    },
                ),
                EffectPlace.PRELOAD,
                _relaxed,
            )
        )
    return found
