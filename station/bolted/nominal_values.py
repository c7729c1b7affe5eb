# SPDX-License-Identifier: MIT
"""From the table [gap] of a structure model to nominal parameters of the gap engine."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.jointed_bodies import NominalBench
from jointbench.station.bolted.interface_motions import BoltedArea
from jointbench.station.joints.gap_table import RIGID, StructureGapTable


def nominal_stiffness(gap: StructureGapTable) -> FloatArray:
    """Return the stiffness of an area along x, y, z [N/m]; infinite if rigid."""
    bolt = gap.bolt
    values = (bolt.tangential_1, bolt.tangential_2, bolt.normal)
    return np.array([np.inf if k == RIGID else float(k) for k in values])


def nominal_bench(
    gap: StructureGapTable, areas: Sequence[BoltedArea], reference: float
) -> NominalBench:
    """Return nominal parameters with their standard deviations.

    Args:
        gap: table of the model.
        areas: bolted areas.
        reference: preload that the bolts' values belong to.
    """
    bolt, feet = gap.bolt, gap.feet
    damping = (bolt.tangential_damping, bolt.tangential_damping, bolt.normal_damping)
    # Without feet their values act on nothing.
    foot = (1.0, 1.0) if feet is None else (feet.stiffness, feet.damping)
    foot_sd = (1.0, 1.0) if feet is None else (feet.stiffness_sd, feet.damping_sd)
    return NominalBench(
        stiffness=nominal_stiffness(gap),
        damping=np.array(damping),
        stiffness_sd=bolt.stiffness_sd,
        damping_sd=bolt.damping_sd,
        bolt_sd=bolt.scatter,
        foot=foot,
        foot_sd=foot_sd,
        loss=(gap.damping_ratio, gap.damping_sd),
        modulus_sd=gap.modulus_sd,
        mass_sd=gap.mass_sd,
        aim_sd=gap.aim_sd,
        tilt_sd=gap.tilt_sd,
        torque_reference=reference,
        bolt_places=np.array([area.position[:2] for area in areas]),
        table_sd=(gap.frequency_sd, gap.shape_sd),
    )
