# SPDX-License-Identifier: MIT
"""Responses to hits: closures by torque, force columns, and forces of laws at ports."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_bench.base_layout import (
    BaseLayout,
    bolt_name,
    stiffness_name,
)
from jointbench.analysis.gap.structure_bench.closed_response import (
    Closure,
    close,
    response_slopes,
)
from jointbench.analysis.gap.structure_bench.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_bench.hit_frames import HitFrame
from jointbench.analysis.gap.structure_bench.joint_state import JointState
from jointbench.analysis.gap.structure_bench.landing import COLUMNS, point_columns
from jointbench.analysis.gap.structure_bench.port_integration import (
    closed_modes,
    integrate_sliders,
    port_sliders,
)


@dataclass(frozen=True, slots=True, eq=False)
class TorqueClosure:
    """The closed response at one torque, with the records made at it."""

    closure: Closure
    records: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class HitModel:
    """The model of all hits at one state, in one window.

    Attributes:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
        closures: by torque.
        forces: of the laws at the ports, transformed, shape
            (n_records, n_ports, n_lines); None without laws.
    """

    campaign: HitCampaign
    state: JointState
    frame: HitFrame
    closures: tuple[TorqueClosure, ...]
    forces: ComplexArray | None

    @property
    def shape(self) -> tuple[int, int]:
        """Channels and samples of a record."""
        return len(self.campaign.bodies.channels), self.frame.count

    def struck(self, weights: FloatArray) -> FloatArray:
        """Return the linear response to weights of the force columns.

        Args:
            weights: of the columns of each record's point, shape (n_records, 9).
        """
        rows = np.empty((len(weights), *self.shape))
        for one in self.closures:
            rows[one.records] = self._struck(one.closure.response, one.records, weights)
        return rows

    def response(self, weights: FloatArray) -> FloatArray:
        """Return the response with the forces of the laws at the ports."""
        rows = self.struck(weights)
        if self.forces is not None:
            for one in self.closures:
                forces = self.forces[one.records]
                rows[one.records] += self._pushed(one.closure.response, forces)
        return rows

    def slopes(
        self,
        weights: FloatArray,
        layout: BaseLayout,
        changes: Sequence[ComplexArray] = (),
    ) -> FloatArray:
        """Return the slopes by the base, shape (n_records, n_base, *shape).

        Args:
            weights: of the columns of each record's point, shape (n_records, 9).
            layout: base coordinates.
            changes: slopes of the forces of the laws by each coordinate; if there are
                none, those forces change with the stiffness of their ports only.
        """
        names = layout.names
        rows = np.empty((len(weights), len(names), *self.shape))
        for one in self.closures:
            bodies = self.campaign.bodies
            slopes = response_slopes(one.closure, bodies, self.state, layout)
            for k, name in enumerate(names):
                found = self._struck(slopes[name], one.records, weights)
                if self.forces is not None:
                    forces = self.forces[one.records]
                    found += self._pushed(slopes[name], forces)
                    scaled = forces * self._scaling(name, layout)[:, None]
                    if changes:
                        scaled = changes[k][one.records]
                    if np.any(scaled):
                        found += self._pushed(one.closure.response, scaled)
                rows[one.records, k] = found
        return rows

    def _scaling(self, name: str, layout: BaseLayout) -> FloatArray:
        """Return the slope of the log stiffness of each port, shape (n_ports,)."""
        laws = self.state.laws
        ports = np.array(() if laws is None else laws.ports, dtype=int)
        slope = np.zeros(ports.size)
        for direction in layout.compliant:
            if name == stiffness_name(direction):
                slope[ports % 3 == direction] = 1.0
        for k in range(layout.contrasts.shape[1]):
            if name == bolt_name(k + 1):
                slope = layout.contrasts[ports // 3, k]
        return slope

    def _struck(
        self, response: ComplexArray, records: IntArray, weights: FloatArray
    ) -> FloatArray:
        """Return records of a response between sensors and columns."""
        scaled = response * self._channels()[:, :, None]
        points = self.campaign.hits.point[records]
        spectrum = np.empty(
            (len(records), response.shape[1], response.shape[0]), dtype=complex
        )
        for point in np.unique(points):
            own = np.flatnonzero(points == point)
            columns = scaled[:, :, point * COLUMNS : (point + 1) * COLUMNS]
            moved = columns @ weights[records[own]].T
            spectrum[own] = moved.transpose(2, 1, 0)
        spectrum *= self.frame.force[records][:, None]
        return self.frame.records(spectrum)

    def _pushed(self, response: ComplexArray, forces: ComplexArray) -> FloatArray:
        """Return records of forces across the ports, whose columns are the last."""
        ports = response[:, :, -forces.shape[1] :] * self._channels()[:, :, None]
        spectrum = -np.einsum("lcp,rpl->rcl", ports, forces, optimize=True)
        return self.frame.records(spectrum)

    def _channels(self) -> ComplexArray:
        """Return the transfer from displacement to each channel."""
        s = self.frame.s[:, None]
        return np.asarray(s**2 * (1.0 + self.state.gain) * np.exp(-s * self.state.lag))


def hit_model(
    campaign: HitCampaign, state: JointState, frame: HitFrame, weights: FloatArray
) -> HitModel:
    """Close the model at a state, and integrate its laws.

    Args:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
        weights: force columns of each record, shape (n_records, 9).
    """
    bodies = campaign.bodies
    columns = [point_columns(p) for p in bodies.points]
    if state.laws is not None:
        rows = bodies.bolts.reshape(-1, bodies.omega.size)
        columns.append(rows[list(state.laws.ports)])
    stacked = np.concatenate(columns)
    torques = _torques(campaign, state)
    closures = tuple(
        TorqueClosure(close(bodies, state, frame.s, stacked, torque), records)
        for torque, records in torques
    )
    forces = None
    if state.laws is not None:
        forces = law_forces(campaign, state, frame, weights)
    return HitModel(campaign, state, frame, closures, forces)


def _torques(campaign: HitCampaign, state: JointState) -> list[tuple[float, IntArray]]:
    """Return factors of the torque, each with its records."""
    torque = campaign.hits.torque
    if state.exponent == 0.0:
        return [(1.0, np.arange(torque.size))]
    reference = campaign.nominal.torque_reference
    return [
        (float((one / reference) ** state.exponent), np.flatnonzero(torque == one))
        for one in np.unique(torque)
    ]


def law_forces(
    campaign: HitCampaign, state: JointState, frame: HitFrame, weights: FloatArray
) -> ComplexArray:
    """Integrate the laws at the ports of a state.

    Args:
        campaign: hits, modes and nominal parameters.
        state: with laws.
        frame: transforms of the window.
        weights: force columns of each record, shape (n_records, 9).

    Returns:
        Transformed forces across the ports, shape (n_records, n_ports, n_lines).
    """
    hits, bodies = campaign.hits, campaign.bodies
    step = hits.filter.step
    # Beyond the window: an end of the forces within it would ring back into it.
    length = frame.size * step
    raw = np.zeros((len(hits.raw_force), length))
    known = min(length, hits.raw_force.shape[1])
    raw[:, :known] = hits.raw_force[:, :known]
    shapes = np.stack([point_columns(p) for p in bodies.points])[hits.point]
    columns = np.einsum("rc,rcn->rn", weights, shapes)
    ports = 0 if state.laws is None else len(state.laws.ports)
    found = np.empty((len(raw), ports, len(frame.s)), dtype=np.complex128)
    for torque, records in _torques(campaign, state):
        forces = integrate_sliders(
            closed_modes(bodies, state, torque),
            port_sliders(bodies, state, torque),
            columns[records],
            raw[records],
            hits.sample_rate * step,
        )
        found[records] = frame.transform(hits.filter(forces))
    return found
