# SPDX-License-Identifier: MIT
"""Nominal state and characteristic sizes of a measured joint, which scale the fits."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.contact_effect import LoadedJoint
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import QUANTITIES, JointData
from jointbench.analysis.gap.contact_bench.preload_law import LinearisedLaw
from jointbench.analysis.gap.residuals.fit_records import Blocks


def log_range(data: JointData) -> tuple[float, float]:
    """Return the smallest and largest nominal ln P [ln N]."""
    log_p = data.nominal_log_preload
    return float(log_p.min()), float(log_p.max())


def nominal_joint(data: JointData, law: LinearisedLaw) -> LoadedJoint:
    """Return the joint at its nominal preloads, without stiffness."""
    log_p = data.nominal_log_preload
    middle, table = float(np.median(log_p)), np.zeros((len(QUANTITIES), log_p.size))
    return LoadedJoint(data, law, log_p, middle, data.log_overload, _omega(data), table)


def state_blocks(data: JointData) -> Blocks:
    """Return the rows grouped by state, with torque, branch and assembly."""
    states, rows = data.states, data.rows
    unit = "N" if np.isnan(states.torque).all() else "N m"
    labels = tuple(
        {
            "torque": f"{level:.4g} {unit}",
            "branch": "falling" if falling else "rising",
            "assembly": f"{j + 1}",
        }
        for level, falling, j in zip(
            states.level, states.falling, states.assembly, strict=True
        )
    )
    seen = int((~rows.bound).sum())
    return Blocks(rows.state, labels, seen, (len(rows.value), 1, 1), white=True)


def _omega(data: JointData) -> FloatArray:
    """Return the angular frequency; where it is unknown, one that fits the median."""
    omega, rows = 2.0 * np.pi * data.states.frequency, data.rows
    damped = rows.quantity >= 4
    if not damped.any():
        return np.ones(omega.size)
    stiff = rows.quantity < 4
    if not stiff.any():
        return np.where(np.isnan(omega), 1.0, omega)
    ratio = np.median(rows.value[stiff]) - np.median(rows.value[damped])
    return np.where(np.isnan(omega), CONTACT.loss_factor * np.exp(ratio), omega)


def joint_scales(data: JointData) -> dict[str, float]:
    """Return characteristic sizes, which scale starts and bounds of effects."""
    rows, states = data.rows, data.states
    first = rows.quantity == rows.quantity.min()
    stiffness = np.exp(rows.value[first])
    preload = np.exp(data.nominal_log_preload)
    shear = np.where(np.isnan(states.shear), 1.0, states.shear)
    torque = states.torque[states.by_torque]
    found = {
        "one": 1.0,
        # A total compliance cannot exceed that of the stiffest state.
        "compliance": 1.0 / float(stiffness.max()),
        "least_stiffness": float(stiffness.min()),
        "highest": float(preload.max()),
        "least_torque": float(torque.min()) if torque.size else 1.0,
        "slip": float((preload / shear).min()),
        "loss": CONTACT.loss_factor,
    }
    for row, name in ((4, "normal"), (5, "tangential")):
        own = np.exp(rows.value[rows.quantity == row])
        found[f"damping_{name}"] = float(own.min()) if own.size else 1.0
    return found
