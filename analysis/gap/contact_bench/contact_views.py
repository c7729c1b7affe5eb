# SPDX-License-Identifier: MIT
"""Views of the residual of a joint: by torque, branch, assembly and quantity."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.joint_states import QUANTITIES, JointData
from jointbench.analysis.gap.model.diagnosis_record import View


def contact_views(data: JointData, residual: FloatArray) -> tuple[View, ...]:
    """Divide a whitened residual by every view.

    Args:
        data: states and rows.
        residual: shape (n_rows,).
    """
    states, rows = data.states, data.rows
    unit = "N" if np.isnan(states.torque).all() else "N m"
    words = {
        "torque": [f"{v:.4g} {unit}" for v in states.level[rows.state]],
        "branch": [
            "falling" if falls else "rising" for falls in states.falling[rows.state]
        ],
        "assembly": [f"{j + 1}" for j in states.assembly[rows.state]],
        "quantity": [QUANTITIES[q].value for q in rows.quantity],
    }
    return tuple(_view(name, residual**2, labels) for name, labels in words.items())


def _view(name: str, power: FloatArray, labels: Sequence[str]) -> View:
    own = np.array(labels)
    slices = {x: power[own == x] for x in dict.fromkeys(labels)}
    excess = {x: max(float(np.sum(p - 1.0)), 0.0) for x, p in slices.items()}
    total = sum(excess.values()) or 1.0
    return View(
        name,
        {x: float(np.mean(p)) for x, p in slices.items()},
        {x: e / total for x, e in excess.items()},
    )
