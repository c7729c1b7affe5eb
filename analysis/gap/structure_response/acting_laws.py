# SPDX-License-Identifier: MIT
"""All laws of a state at its ports, as arrays for the time integration."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_response.port_laws import LawForm, law_ports


@dataclass(frozen=True, slots=True, eq=False)
class ActingLaws:
    """All laws of a state, a row for each port.

    Attributes:
        rows: relative motion of each port, shape (n_ports, n_modes).
        kinds: of the law of each port, shape (n_ports,).
        sizes: stiffness of all sliders together [N/m], or as `LawForm` states,
            shape (n_ports,).
        gaps: clearance [m], shape (n_ports,).
        slips: slip displacement of each slider [m], shape (n_ports, n_sliders).
        weights: share of each slider in the stiffness, shape (n_ports, n_sliders).
        sharp: number of sliders that yield at once, the first ones, shape (n_ports,).
        preload: power of the slip displacements in the torque [-], shape (n_ports,).
    """

    rows: FloatArray
    kinds: IntArray
    sizes: FloatArray
    gaps: FloatArray
    slips: FloatArray
    weights: FloatArray
    sharp: IntArray
    preload: FloatArray

    @property
    def slides(self) -> bool:
        """Whether all laws are friction."""
        return bool(np.all(self.kinds == LawForm.FRICTION))

    @property
    def rests(self) -> bool:
        """Whether it ends where no slider slips again: gradual ones yield always."""
        return self.slides and bool(np.all(self.sharp == self.slips.shape[1]))


def acting_laws(bodies: JointedBodies, state: JointState, torque: float) -> ActingLaws:
    """Return the laws of a state.

    Args:
        bodies: modes and rows.
        state: with at least one law.
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    ports = np.array(law_ports(state.laws), dtype=int)
    own = np.repeat(np.arange(len(state.laws)), [len(w.ports) for w in state.laws])
    laws = [state.laws[k] for k in own]
    kinds = np.array([law.kind for law in laws], dtype=np.int64)
    spring = state.bolt[ports // 3] * torque / state.compliance[ports % 3]
    sizes = np.array([law.size for law in laws])
    count = max(law.slips.size for law in laws)
    slips, weights = np.ones((len(laws), count)), np.zeros((len(laws), count))
    for k, law in enumerate(laws):
        slips[k, : law.slips.size] = law.slips
        weights[k, : law.weights.size] = law.weights
    return ActingLaws(
        rows=bodies.bolts.reshape(-1, bodies.omega.size)[ports],
        kinds=kinds,
        sizes=np.where(kinds == LawForm.FRICTION, sizes * spring, sizes),
        gaps=np.array([law.gap for law in laws]),
        slips=slips,
        weights=weights,
        sharp=np.array([law.sharp if law.gradual else count for law in laws]),
        preload=np.array([law.preload for law in laws]),
    )
