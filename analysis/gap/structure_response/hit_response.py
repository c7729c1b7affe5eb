# SPDX-License-Identifier: MIT
"""Responses to hits: closures by torque, force columns, and forces of laws at ports."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.residuals.slopes import SlopeArray
from jointbench.analysis.gap.structure_response.acting_laws import acting_laws
from jointbench.analysis.gap.structure_response.base_layout import BaseLayout
from jointbench.analysis.gap.structure_response.closed_flexibility import (
    ClosedFlexibility,
)
from jointbench.analysis.gap.structure_response.closed_modes import closed_modes
from jointbench.analysis.gap.structure_response.closed_response import (
    close,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import HitFrame
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.landing import (
    COLUMNS,
    landing_slopes,
    landing_weights,
    point_columns,
)
from jointbench.analysis.gap.structure_response.line_forces import write_over
from jointbench.analysis.gap.structure_response.port_integration import (
    averaging,
    integrate_laws,
)
from jointbench.analysis.gap.structure_response.port_law_settings import PORT_LAWS
from jointbench.analysis.gap.structure_response.port_laws import LawForm, law_ports
from jointbench.analysis.gap.structure_response.response_slopes import (
    ClosedAt,
    HitsOnModes,
    record_slopes,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class TorqueClosure:
    """The closed response at one torque, with the records made at it.

    Attributes:
        torque: factor on stiffness and damping of the bolts [-].
        state: at that torque.
        records: made at it.
        columns: distinct force columns of these records in modes, shape
            (n_columns, n_modes).
        column_of: column of each of them, shape (n_own_records,).
        response: displacement per force [m/N] by these columns, then by the ports of
            laws, shape (n_lines, n_rows, n_columns + n_ports).
    """

    torque: float
    state: JointState
    records: IntArray
    columns: FloatArray
    column_of: IntArray
    response: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class HitModel:
    """The model of all hits at one state, in one window.

    Attributes:
        campaign: hits, modes and nominal parameters.
        state: of the model.
        frame: transforms of the window.
        ports: rows of the ports of laws in modes, shape (n_ports, n_modes).
        closures: by torque.
        forces: of the laws at the ports, transformed, shape
            (n_records, n_ports, n_lines); None without laws.
    """

    campaign: HitCampaign
    state: JointState
    frame: HitFrame
    ports: FloatArray
    closures: tuple[TorqueClosure, ...]
    forces: ComplexArray | None

    @property
    def shape(self) -> tuple[int, int]:
        """Channels and samples of a record."""
        return len(self.campaign.bodies.channels), self.frame.count

    def response(self) -> FloatArray:
        """Return the response with the forces of laws, shape (n_records, *shape)."""
        rows = np.empty((len(self.frame.force), *self.shape))
        channels = self.transfers().T
        for one in self.closures:
            own = one.response[:, :, : len(one.columns)]
            # Lines last: the transforms are along them.
            lines = np.ascontiguousarray(own.transpose(2, 1, 0))
            lines *= channels
            spectrum = lines[one.column_of]
            spectrum *= self.frame.force[one.records][:, None]
            if self.forces is not None:
                spectrum += self._pushed(one, self.forces)
            rows[one.records] = self.frame.records(spectrum)
        return rows

    def pushed(self, forces: ComplexArray) -> FloatArray:
        """Return the response to forces across the ports.

        Args:
            forces: transformed, shape (n_records, n_ports, n_lines).
        """
        rows = np.empty((len(forces), *self.shape))
        for one in self.closures:
            spectrum = self._pushed(one, forces)
            rows[one.records] = self.frame.records(spectrum)
        return rows

    def write_slopes(
        self,
        layout: BaseLayout,
        changes: Sequence[ComplexArray],
        sigma: FloatArray,
        found: SlopeArray,
    ) -> None:
        """Write the slopes of all records by each base coordinate, over their sd.

        Args:
            layout: base coordinates.
            changes: slopes of the forces of the laws by each coordinate; none without.
            sigma: of each record and channel [m/s^2], shape (n_records, n_channels).
            found: shape (n_base, n_records, *shape).
        """
        frame, bodies = self.frame, self.state.bodies_of(self.campaign.bodies)
        transfers = self.transfers()
        slopes = [
            record_slopes(
                ClosedAt(bodies, one.state, frame.s, one.torque),
                self._forces_of(one),
                transfers,
                layout,
            )
            for one in self.closures
        ]
        spectrum = frame.empty_spectrum((len(frame.force), self.shape[0]))
        for k, name in enumerate(layout.names):
            for one, own in zip(self.closures, slopes, strict=True):
                own.write(name, one.records, spectrum)
                if changes:
                    spectrum[one.records, :, : frame.s.size] += self._pushed(
                        one, changes[k]
                    )
            write_over(frame.damped(spectrum), frame.growth, sigma, found[k])

    def _forces_of(self, one: TorqueClosure) -> HitsOnModes:
        """Return the forces of the records of a closure."""
        force = self.frame.force[one.records]
        laws = None if self.forces is None else self.forces[one.records]
        return HitsOnModes(one.columns, one.column_of, force, self.ports, laws)

    def _pushed(self, one: TorqueClosure, forces: ComplexArray) -> ComplexArray:
        """Return transforms of the response to forces across the ports.

        Args:
            one: closure.
            forces: transformed, of all records, shape (n_records, n_ports, n_lines).

        Returns:
            Of its records, shape (n_own_records, n_channels, n_lines).
        """
        ports = one.response[:, :, len(one.columns) :] * self.transfers()[:, :, None]
        own = forces[one.records]
        return np.asarray(-np.einsum("lcp,rpl->rcl", ports, own, optimize=True))

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
    rows = _struck_along(model, slopes)
    if model.forces is None:
        return rows
    step, weights = STRUCTURE.landing_step, landing_weights(landing)
    for k in range(sd.size):
        moved = weights + step * slopes[:, k]
        forces = law_forces(model.campaign, model.state, model.frame, moved, fine=False)
        rows[:, k] += model.pushed((forces - model.forces) / step)
    return rows


def _struck_along(model: HitModel, weights: FloatArray) -> FloatArray:
    """Return the response to the hammer in several directions of each hit.

    Args:
        model: joints and frame.
        weights: of the columns of each record's point, shape (n_records, n, 9).

    Returns:
        Shape (n_records, n, n_channels, count).
    """
    bodies, frame = model.state.bodies_of(model.campaign.bodies), model.frame
    columns = [point_columns(p) for p in model.state.points_of(bodies)]
    channels = model.transfers().T
    found = np.empty((*weights.shape[:2], *model.shape))
    points = model.campaign.hits.point
    for one in model.closures:
        struck, place = np.unique(points[one.records], return_inverse=True)
        every = np.concatenate([columns[point] for point in struck])
        response = close(bodies, one.state, frame.s, every, one.torque)
        lines = np.ascontiguousarray(response.transpose(2, 1, 0))
        lines *= channels
        # Weights are real: two real products are half of a complex one.
        flat = lines.view(np.float64).reshape(len(struck), COLUMNS, -1)
        for record, at in zip(one.records, place, strict=True):
            moved = (weights[record] @ flat[at]).view(np.complex128)
            moved = moved.reshape(-1, *lines.shape[1:])
            moved *= frame.force[record]
            found[record] = frame.records(moved)
    return found


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
    struck = struck_columns(campaign, state, weights)
    ports = np.zeros((0, bodies.omega.size))
    if state.laws:
        rows = bodies.bolts.reshape(-1, bodies.omega.size)
        ports = rows[list(law_ports(state.laws))]
    if flexibility is not None and not flexibility.holds(state, frame.s):
        flexibility = None
    closures = []
    for torque, own, records in _torques(campaign, state):
        columns, column_of = np.unique(struck[records], axis=0, return_inverse=True)
        every = np.concatenate([columns, ports])
        if flexibility is not None:
            found = flexibility.response(bodies, own, every)
        else:
            found = close(bodies, own, frame.s, every, torque)
        at = np.asarray(column_of, dtype=np.int64).ravel()
        closures.append(TorqueClosure(torque, own, records, columns, at, found))
    forces = None
    if state.laws:
        forces = law_forces(campaign, state, frame, weights, fine=fine)
    return HitModel(campaign, state, frame, ports, tuple(closures), forces)


def struck_columns(
    campaign: HitCampaign, state: JointState, weights: FloatArray
) -> FloatArray:
    """Return the modal force of each record per force of the hammer.

    Args:
        campaign: hits and modes.
        state: of the model.
        weights: of the columns of each record's point, shape (n_records, 9).

    Returns:
        Shape (n_records, n_modes).
    """
    points = state.points_of(state.bodies_of(campaign.bodies))
    shapes = np.stack([point_columns(p) for p in points])[campaign.hits.point]
    return np.asarray(np.einsum("rc,rcn->rn", weights, shapes))


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
    columns = struck_columns(campaign, state, weights)
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
