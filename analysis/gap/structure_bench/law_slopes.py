# SPDX-License-Identifier: MIT
"""Slopes of the forces of laws at bolts, by differences of time integrations.

The forces are followed: a slider that sticks moves with the joint, one that slips holds
its force, so a small difference is their slope. Held forces make a fit to whole records
creep, since the base moves the phase of every slip.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import HitFrame
from jointbench.analysis.gap.structure_response.hit_response import law_forces
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.landing import landing_weights
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS


class _LawBench(Protocol):
    """What the slopes need of a bench of bolted bodies."""

    @property
    def campaign(self) -> HitCampaign: ...

    @property
    def landing(self) -> FloatArray: ...

    def state(self, base: FloatArray, terms: Sequence[Term]) -> JointState: ...


@dataclass(frozen=True, slots=True, eq=False)
class LawSlopes:
    """Slopes of the forces of the laws of a model.

    Attributes:
        bench: of the model.
        frame: transforms of the window.
        forces: of the laws in fits, the first of each difference, shape
            (n_records, n_ports, n_lines).
        base: coordinates of the model.
        terms: its effects.
    """

    bench: _LawBench
    frame: HitFrame
    forces: ComplexArray
    base: FloatArray
    terms: Sequence[Term]

    def by_base(self) -> list[ComplexArray]:
        """Return slopes by each base coordinate, of the shape of the forces."""
        step = PORT_LAWS.law_slope_step
        return [
            self._change(self.base + step * unit, self.terms, step)
            for unit in np.eye(self.base.size)
        ]

    def by_terms(self) -> list[ComplexArray]:
        """Return slopes by each coordinate of the effects, term by term."""
        found = []
        for k, term in enumerate(self.terms):
            for i, value in enumerate(term.coordinates):
                size = max(abs(float(value)), PORT_LAWS.least_law_value)
                step = PORT_LAWS.law_slope_step * size
                moved = term.coordinates.copy()
                moved[i] += step
                terms = list(self.terms)
                terms[k] = replace(term, coordinates=moved)
                found.append(self._change(self.base, terms, step))
        return found

    def _change(
        self, base: FloatArray, terms: Sequence[Term], step: float
    ) -> ComplexArray:
        """Return the change of the forces over a step."""
        moved = law_forces(
            self.bench.campaign,
            self.bench.state(base, terms),
            self.frame,
            landing_weights(self.bench.landing),
            fine=False,
        )
        return np.asarray((moved - self.forces) / step)
