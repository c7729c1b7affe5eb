# SPDX-License-Identifier: MIT
"""Base coordinates of the contact bench: law, ratios, nut factor, assemblies, states.

Every coordinate is a logarithm over its nominal value with a prior, so that the cost at
the minimum is chi2 distributed with as many degrees of freedom as there are rows.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.contact_bench.preload_law import PreloadLaw

_RATIOS = (
    (ContactQuantity.TANGENTIAL, "tangential_ratio"),
    (ContactQuantity.TANGENTIAL_2, "tangential_ratio_2"),
    (ContactQuantity.ROCKING, "rocking_ratio"),
)
_LOSSES = (
    (ContactQuantity.NORMAL_DAMPING, "loss_factor_normal"),
    (ContactQuantity.TANGENTIAL_DAMPING, "loss_factor_tangential"),
)


@dataclass(frozen=True, slots=True, eq=False)
class ContactLayout:
    """Names and priors of the base coordinates, and where each group begins.

    Attributes:
        names: of the coordinates.
        units: of their values.
        nominal: values at 0, shape (n_base,).
        sd: prior sd of the logarithms, shape (n_base,).
        law: number of parameters of the law, which come first.
        ratio: coordinate of each quantity's ratio to the law, -1 for none, (6,).
        nut: coordinate of the nut factor, -1 for none.
        factor: coordinate of the factor of the law, followed by its exponent.
        bolts: coordinate of the stiffness of the bolts, -1 for none.
        waves: coordinate of the height of waves that were not measured, -1 for none.
        assembly: first coordinate of the assemblies.
        own: first coordinate of each quantity's deviation by assembly, -1 for none,
            shape (6,).
        state: first coordinate of the settings of the preload.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    nominal: FloatArray
    sd: FloatArray
    law: int
    ratio: IntArray
    nut: int
    factor: int
    bolts: int
    waves: int
    assembly: int
    own: IntArray
    state: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "nominal", "sd", "ratio", "own")


@dataclass(slots=True)
class _Coordinates:
    """Coordinates while they are collected."""

    names: list[str]
    units: list[str]
    nominal: list[float]
    sd: list[float]

    def add(self, name: str, unit: str, value: float, sd: float) -> int:
        self.names.append(name)
        self.units.append(unit)
        self.nominal.append(value)
        self.sd.append(max(sd, 1e-6))  # what is exactly known stays in the fit
        return len(self.names) - 1


def contact_layout(data: JointData, law: PreloadLaw) -> ContactLayout:
    """Return the base coordinates of a joint.

    Args:
        data: its measured quantities and states decide what is there.
        law: its inputs and accuracy; inputs known exactly get a very small sd.
    """
    parameters = law.parameters
    rows, facts = _Coordinates([], [], [], []), data.facts
    for p in parameters:
        rows.add(p.name, p.unit, p.value, p.log_sd)
    factor = rows.add("law_factor", "-", 1.0, law.factor_sd)
    rows.add("law_power", "-", 1.0, CONTACT.law_power_sd)
    ratio = np.full(len(QUANTITIES), -1)
    for quantity, name in _RATIOS:
        if data.measures(quantity):
            at = rows.add(name, "-", 1.0, CONTACT.ratio_sd)
            ratio[QUANTITIES.index(quantity)] = at
    for quantity, name in _LOSSES:
        if data.measures(quantity):
            at = rows.add(name, "-", CONTACT.loss_factor, CONTACT.loss_sd)
            ratio[QUANTITIES.index(quantity)] = at
    nut = -1
    if data.states.by_torque.any():
        nut = rows.add("nut_factor", "-", facts.nut_factor, facts.nut_factor_sd)
    bolts = -1
    if facts.bolt_stiffness is not None:
        bolts = rows.add("bolts", "N/m", facts.bolt_stiffness, CONTACT.bolts_sd)
    waves = -1
    if law.roughness_alone is not None:
        waves = rows.add("wave_height", "m", CONTACT.wave_height, CONTACT.wave_sd)
    assembly, own = _assemblies(rows, data)
    state = len(rows.names)
    firsts = np.unique(data.states.settings, return_index=True)[1]
    for number, k in enumerate(firsts.tolist(), 1):
        measured = not data.states.by_torque[k]
        sd = data.states.preload_sd[k] if measured else facts.torque_scatter
        rows.add(f"preload_{number}", "-", 1.0, max(float(sd), 1e-6))
    return ContactLayout(
        tuple(rows.names),
        tuple(rows.units),
        np.array(rows.nominal),
        np.array(rows.sd),
        len(parameters),
        ratio,
        nut,
        factor,
        bolts,
        waves,
        assembly,
        own,
        state,
    )


def _assemblies(rows: _Coordinates, data: JointData) -> tuple[int, IntArray]:
    """Add the deviation of each assembly, then of each quantity in it."""
    count = int(data.states.assembly.max()) + 1
    sd = max(data.facts.reassembly, 1e-6)
    first = len(rows.names)
    for j in range(count):
        rows.add(f"assembly_{j + 1}", "-", 1.0, sd)
    own = np.full(len(QUANTITIES), -1)
    for q, quantity in enumerate(QUANTITIES):
        if data.measures(quantity):
            own[q] = len(rows.names)
            for j in range(count):
                name = f"assembly_{j + 1}_{quantity.value}"
                rows.add(name, "-", 1.0, CONTACT.assembly_share * sd)
    return first, own
