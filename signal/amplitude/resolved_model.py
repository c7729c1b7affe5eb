# SPDX-License-Identifier: MIT
"""The modal model after merging: one mode per curve, at its small-amplitude limit."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.records.provenance import step
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, Dependence
from jointbench.signal.modal.modal_model import ModalModel

_PER_MODE = (
    "residues",
    "residues_sd",
    "shapes",
    "shapes_sd",
    "participation",
    "significance",
    "residual_ratio",
    "stable_orders",
    "by_hand",
)


def resolved_model(model: ModalModel, found: Sequence[AmplitudeMode]) -> ModalModel:
    """Return a modal model in which each curve is one mode.

    A mode that stands for several poles, or that depends on amplitude, gets frequency
    and damping at small amplitude; shape and residues are those of its strongest pole.
    One that changes too little to be reported has a wider interval. Where none of that
    is so, the model comes back as it is.

    Args:
        model: of the linear fit.
        found: one record a physical mode, from `amplitude_modes`.
    """
    soft = [mode.soft for mode in found]
    known = model.natural_frequency
    rows = np.array(
        [np.argmin(np.abs(known - mode.replaces[0])) for mode in found], int
    )
    wider = np.array([one.frequency_sd for one in soft]) > model.frequency_sd[rows]
    changed = [
        len(mode.replaces) > 1 or mode.dependence is Dependence.DEPENDS or wide
        for mode, wide in zip(found, wider, strict=True)
    ]
    if not any(changed):
        return model
    order = np.argsort([one.frequency for one in soft])
    rows = rows[order]
    done = step(
        "resolve_amplitude",
        merged=sum(len(mode.replaces) - 1 for mode in found),
        dependent=sum(mode.dependence is Dependence.DEPENDS for mode in found),
    )
    return replace(
        model,
        natural_frequency=np.array([soft[i].frequency for i in order]),
        frequency_sd=np.array([soft[i].frequency_sd for i in order]),
        damping_ratio=np.array([soft[i].damping_ratio for i in order]),
        damping_ratio_sd=np.array([soft[i].damping_sd for i in order]),
        **{name: getattr(model, name)[rows] for name in _PER_MODE},
        provenance=(*model.provenance, done),
    )
