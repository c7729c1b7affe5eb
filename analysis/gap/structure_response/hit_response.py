# SPDX-License-Identifier: MIT
"""Responses to hits: closures by torque, force columns, and forces of laws at ports."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.acting_laws import acting_laws
from jointbench.analysis.gap.structure_response.base_layout import BaseLayout
from jointbench.analysis.gap.structure_response.closed_flexibility import (
    ClosedFlexibility,
)
from jointbench.analysis.gap.structure_response.closed_modes import closed_modes
from jointbench.analysis.gap.structure_response.closed_response import (
    Closure,
    close,
    response_slopes,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import HitFrame
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_response.landing import (
    COLUMNS,
    landing_slopes,
    landing_weights,
    point_columns,
)
from jointbench.analysis.gap.structure_response.port_integration import (
    averaging,
    integrate_laws,
)
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS
from jointbench.analysis.gap.structure_response.port_laws import LawForm, law_ports
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class TorqueClosure:
    """The closed response at one torque, with its state and the records made at it.

    Attributes:
        torque: factor on stiffness and damping of the bolts [-].
        state: at that torque.
        records: made at it.
        response: displacement per force [m/N], shape (n_lines, n_rows, n_columns).
        closure: of which it is; None where it is that of a closed flexibility.
    """

    torque: float
    state: JointState
    records: IntArray
    response: ComplexArray
    closure: Closure | None


@dataclass(frozen=True, slots=True, eq=False)
class HitModel:
    """The model of all hits at one state, in one window.

    Attributes:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
        columns: force rows in modes, shape (n_columns, n_modes).
        closures: by torque.
        forces: of the laws at the ports, transformed, shape
            (n_records, n_ports, n_lines); None without laws.
    """

    campaign: HitCampaign
    state: JointState
    frame: HitFrame
    columns: FloatArray
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
            rows[one.records] = self._struck(one.response, one.records, weights)
        return rows

    def response(self, weights: FloatArray) -> FloatArray:
        """Return the response with the forces of the laws at the ports."""
        rows = self.struck(weights)
        if self.forces is not None:
            rows += self.pushed(self.forces)
        return rows

    def pushed(self, forces: ComplexArray) -> FloatArray:
        """Return the response to forces across the ports.

        Args:
            forces: transformed, shape (n_records, n_ports, n_lines).
        """
        rows = np.empty((len(forces), *self.shape))
        for one in self.closures:
            own = forces[one.records]
            rows[one.records] = self._pushed(one.response, own)
        return rows

    def slopes(
        self,
        weights: FloatArray,
        layout: BaseLayout,
        changes: Sequence[ComplexArray] = (),
    ) -> Iterator[FloatArray]:
        """Yield the slopes by each base coordinate, shape (n_records, *shape).

        Args:
            weights: of the columns of each record's point, shape (n_records, 9).
            layout: base coordinates.
            changes: slopes of the forces of the laws by each coordinate.
        """
        bodies = self.state.bodies_of(self.campaign.bodies)
        slopes = [
            response_slopes(self._closed(one), bodies, one.state, layout)
            for one in self.closures
        ]
        for k, name in enumerate(layout.names):
            rows = np.empty((len(weights), *self.shape))
            for one, own in zip(self.closures, slopes, strict=True):
                slope = own[name]()
                found = self._struck(slope, one.records, weights)
                if self.forces is not None:
                    found += self._pushed(slope, self.forces[one.records])
                if changes:
                    moved = changes[k][one.records]
                    found += self._pushed(one.response, moved)
                rows[one.records] = found
            yield rows

    def _closed(self, one: TorqueClosure) -> Closure:
        """Return the closure at a torque, which slopes need."""
        if one.closure is not None:
            return one.closure
        bodies = self.state.bodies_of(self.campaign.bodies)
        return close(bodies, one.state, self.frame.s, self.columns, one.torque)

    def _struck(
        self, response: ComplexArray, records: IntArray, weights: FloatArray
    ) -> FloatArray:
        """Return records of a response between sensors and columns."""
        points = self.campaign.hits.point[records]
        found = np.empty((len(records), *self.shape))
        channels = self.transfers().T[:, None]
        for point in np.unique(points):
            own = np.flatnonzero(points == point)
            columns = response[:, :, point * COLUMNS : (point + 1) * COLUMNS]
            # Lines last: the transforms are along them.
            lines = np.ascontiguousarray(columns.transpose(1, 2, 0))
            lines *= channels
            # Weights are real: two real products are half of a complex one.
            moved = (weights[records[own]] @ lines.view(np.float64)).view(np.complex128)
            moved *= self.frame.force[records[own]]
            found[own] = self.frame.records(moved).transpose(1, 0, 2)
        return found

    def _pushed(self, response: ComplexArray, forces: ComplexArray) -> FloatArray:
        """Return records of forces across the ports, whose columns are the last."""
        ports = response[:, :, -forces.shape[1] :] * self.transfers()[:, :, None]
        spectrum = -np.einsum("lcp,rpl->rcl", ports, forces, optimize=True)
        return self.frame.records(spectrum)

    def transfers(self) -> ComplexArray:
        """Return the transfers from displacement to channels, (n_lines, n_channels)."""
        s = self.frame.s[:, None]
        found = s**2 * (1.0 + self.state.gain) * np.exp(-s * self.state.lag)
        for one in self.state.cables:
            p = one.period * s[:, 0]
            found[:, one.channel] /= 1.0 + 2.0 * one.damping * p + p**2
        return np.asarray(found)


def direction_rows(model: HitModel, landing: FloatArray, sd: FloatArray) -> FloatArray:
    """Return derivatives of the response by tilts, offsets and gain of each hit.

    A hit beside its point slips other sliders, so the forces of laws are followed.

    Args:
        model: at the landing points, as in fits.
        landing: tilts [rad] and offsets [m] of each hit, shape (n_records, 4).
        sd: of the five directions, shape (5,).

    Returns:
        For directions of unit sd, shape (n_records, 5, n_channels, count).
    """
    slopes = landing_slopes(landing) * sd[:, None]
    rows = np.stack([model.struck(slopes[:, k]) for k in range(sd.size)], axis=1)
    if model.forces is None:
        return rows
    step, weights = STRUCTURE.landing_step, landing_weights(landing)
    for k in range(sd.size):
        moved = weights + step * slopes[:, k]
        forces = law_forces(model.campaign, model.state, model.frame, moved, fine=False)
        rows[:, k] += model.pushed((forces - model.forces) / step)
    return rows


def hit_model(
    campaign: HitCampaign,
    state: JointState,
    frame: HitFrame,
    weights: FloatArray,
    *,
    fine: bool = True,
    flexibility: ClosedFlexibility | None = None,
) -> HitModel:
    """Close the model at a state, and integrate its laws.

    Args:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
        weights: force columns of each record, shape (n_records, 9).
        fine: True for the time integration of what is judged, not of fits.
        flexibility: from which the response follows where the joints are those of the
            state.
    """
    bodies = state.bodies_of(campaign.bodies)
    columns = [point_columns(p) for p in state.points_of(bodies)]
    if state.laws:
        rows = bodies.bolts.reshape(-1, bodies.omega.size)
        columns.append(rows[list(law_ports(state.laws))])
    stacked = np.concatenate(columns)
    if flexibility is not None and flexibility.holds(state, frame.s):
        every = np.arange(campaign.hits.torque.size)
        found = flexibility.response(bodies, state, stacked)
        closures: tuple[TorqueClosure, ...] = (
            TorqueClosure(1.0, state, every, found, None),
        )
    else:
        closures = tuple(
            _closed_at(bodies, own, frame, stacked, torque, records)
            for torque, own, records in _torques(campaign, state)
        )
    forces = None
    if state.laws:
        forces = law_forces(campaign, state, frame, weights, fine=fine)
    return HitModel(campaign, state, frame, stacked, closures, forces)


def _closed_at(
    bodies: JointedBodies,
    state: JointState,
    frame: HitFrame,
    columns: FloatArray,
    torque: float,
    records: IntArray,
) -> TorqueClosure:
    """Return the closed response at one torque."""
    closure = close(bodies, state, frame.s, columns, torque)
    return TorqueClosure(torque, state, records, closure.response, closure)


def _torques(
    campaign: HitCampaign, state: JointState
) -> list[tuple[float, JointState, IntArray]]:
    """Return factors of the torque, each with the state at it and its records."""
    torque = campaign.hits.torque
    if state.exponent == 0.0 and state.damping_exponent == 0.0:
        return [(1.0, state, np.arange(torque.size))]
    found = []
    for one in np.unique(torque):
        ratio = float(one / campaign.nominal.torque_reference)
        own = ratio**state.exponent, state.at_torque(ratio)
        found.append((*own, np.flatnonzero(torque == one)))
    return found


def law_forces(
    campaign: HitCampaign,
    state: JointState,
    frame: HitFrame,
    weights: FloatArray,
    *,
    fine: bool,
) -> ComplexArray:
    """Integrate the laws at the ports of a state.

    Args:
        campaign: hits, modes and nominal parameters.
        state: with laws.
        frame: transforms of the window.
        weights: force columns of each record, shape (n_records, 9).
        fine: True for the steps of what is judged, not of fits.

    Returns:
        Transformed forces across the ports, shape (n_records, n_ports, n_lines).
    """
    hits, bodies = campaign.hits, state.bodies_of(campaign.bodies)
    step = hits.filter.step
    friction = all(law.kind == LawForm.FRICTION for law in state.laws)
    parts = (PORT_LAWS.slider_steps if friction else PORT_LAWS.law_steps)[fine]
    # Beyond the window: an end of the forces within it would ring back into it. They
    # are held from there on, so that they end where the transform has damped them.
    half = hits.filter.half
    kept = min(frame.count + -(-2 * half // step), frame.size)
    length = kept * step + half
    raw = np.zeros((len(hits.raw_force), length))
    known = min(length, hits.raw_force.shape[1])
    raw[:, :known] = hits.raw_force[:, :known]
    struck = [point_columns(p) for p in state.points_of(bodies)]
    shapes = np.stack(struck)[hits.point]
    columns = np.einsum("rc,rcn->rn", weights, shapes)
    ports = len(law_ports(state.laws))
    preload = hits.torque / campaign.nominal.torque_reference
    found = np.empty((len(raw), ports, len(frame.s)), dtype=np.complex128)
    for torque, own, records in _torques(campaign, state):
        forces = integrate_laws(
            closed_modes(bodies, own, torque),
            acting_laws(bodies, own, torque),
            columns[records],
            raw[records],
            (parts, hits.filter, hits.sample_rate * step),
            preload[records],
        )
        held = np.pad(
            forces[..., :kept], ((0, 0), (0, 0), (0, frame.size - kept)), mode="edge"
        )
        found[records] = frame.transform(held)
    found /= averaging(frame.s, hits.sample_rate * step, parts)
    return found
