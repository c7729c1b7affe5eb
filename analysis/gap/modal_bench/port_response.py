# SPDX-License-Identifier: MIT
"""Response of a modal base with laws at its ports, from rest, to measured forces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.modal_bench.level_records import LevelRecord, RecordSet
from jointbench.analysis.gap.modal_bench.modal_base import UnitModes, port_shapes
from jointbench.analysis.gap.modal_bench.modal_settings import MODAL
from jointbench.analysis.gap.modal_bench.port_force import force_spectra
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.excitation import Excitation, prepare_excitation
from jointbench.analysis.gap.response.port_forces import PortLaw, PortModes
from jointbench.analysis.lumped.lumped_model import GROUND


@dataclass(frozen=True, slots=True, eq=False)
class Shaken:
    """Records of one set, transformed once.

    Attributes:
        records: in the order of the rows.
        excitation: time axis and Laplace line, as long as the longest record.
        spectrum: damped spectra of the forces, shape (n_records, n_inputs, n_lines).
        measured: responses, zero beyond the end of a record, shape
            (n_records, n_sensors, n_samples).
        scored: 1 where a sample counts, else 0, same shape.
        moved: damped spectra of the measured displacement, shape
            (n_records, n_sensors, n_lines).
    """

    records: tuple[LevelRecord, ...]
    excitation: Excitation
    spectrum: ComplexArray
    measured: FloatArray
    scored: FloatArray
    moved: ComplexArray


def shaken(given: RecordSet, records: Sequence[LevelRecord], tail: int) -> Shaken:
    """Transform the forces of some records of a set.

    Args:
        given: the set.
        records: some of its records.
        tail: last samples of a record without weight.
    """
    longest = max(r.force.shape[1] for r in records)
    inputs, sensors = len(given.inputs), len(given.sensors)
    force = np.zeros((len(records), inputs, longest))
    measured = np.zeros((len(records), sensors, longest))
    scored = np.zeros_like(measured)
    for k, record in enumerate(records):
        n = record.force.shape[1]
        force[k, :, :n], measured[k, :, :n] = record.force, record.response
        scored[k, :, record.lead : n - tail] = 1.0
    still = HitConditions(np.ones(len(records)), np.zeros(len(records)))
    rows = force.reshape(-1, longest)
    made = prepare_excitation(
        rows, np.zeros(len(records), dtype=np.int64), given.sample_rate, still
    )
    spectrum = made.spectrum.reshape(len(records), inputs, -1)
    return Shaken(
        tuple(records),
        replace(made, spectrum=spectrum[:, 0]),
        spectrum,
        measured,
        scored,
        _displacement(given, made, measured),
    )


def _displacement(
    given: RecordSet, excitation: Excitation, measured: FloatArray
) -> ComplexArray:
    """Return damped spectra of the displacement of the sensors.

    A velocity or acceleration is integrated on the Laplace line; below a few periods of
    a record its noise would dominate, so these lines are left out.
    """
    n = excitation.growth.size
    rows = scipy.fft.rfft(measured / excitation.growth, excitation.padded, axis=-1)
    if not given.output:
        return np.asarray(rows)
    s = excitation.s
    least = MODAL.least_periods * 2.0 * np.pi * given.sample_rate / n
    low = np.abs(s.imag) / least
    pass_band = low**4 / (1.0 + low**4)
    return np.asarray(rows * (pass_band / s ** int(given.output)))


@dataclass(frozen=True, slots=True, eq=False)
class PortForces:
    """Forces of the laws along the measured motion, which no base changes.

    Attributes:
        ports: index of each port with a law, ascending.
        spectra: damped, up to the pass band, shape (n_ports, n_records, n_lines).
    """

    ports: tuple[int, ...]
    spectra: ComplexArray


def measured_forces(
    given: RecordSet, data: Shaken, laws: Sequence[PortLaw], oversampling: int
) -> PortForces:
    """Return the forces of laws along the measured motion of their ports.

    Args:
        given: the set, with its points and ports.
        data: the transformed records.
        laws: that act at the ports.
        oversampling: steps of the time integration per sample.
    """
    ports = sorted({x.port for x in laws})
    motion = np.stack([port_motion(given, data, q) for q in ports])
    still = UnitModes(np.ones(1), np.full(1, 0.5), np.zeros((1, 0)))
    between = port_modes(still, np.zeros((1, len(ports))), len(data.records))
    own = [PortLaw(ports.index(x.port), x.law) for x in laws]
    spectra = force_spectra(data.excitation, motion, between, own, oversampling)
    return PortForces(tuple(ports), spectra)


def respond_modes(
    given: RecordSet,
    modes: UnitModes,
    data: Shaken,
    laws: Sequence[PortLaw],
    *,
    oversampling: int,
    forces: PortForces | None = None,
) -> FloatArray:
    """Predict the sensors.

    Args:
        given: the set, with its points and ports.
        modes: of the base.
        data: the transformed records.
        laws: that act at the ports.
        oversampling: steps of the time integration per sample.
        forces: of these laws along the measured motion of their ports, instead of the
            predicted one; the response is then smooth in the parameters of the laws,
            however strong they are.

    Returns:
        Shape (n_records, n_sensors, n_samples); not finite if the motion diverges.
    """
    points, s = given.points, data.excitation.s
    receptance = modal_receptance(modes, s)
    push = modes.shapes[:, [points.index(p) for p in given.inputs]]
    modal = np.einsum("mi,ril->rml", push, data.spectrum) * receptance
    if laws:
        found = forces or _predicted(given, modes, data, modal, laws, oversampling)
        across = _port_rows(given, modes)[:, list(found.ports)]
        modal = modal - np.einsum("mp,prl->rml", across, found.spectra) * receptance
    seen = modes.shapes[:, [points.index(p) for p in given.sensors]]
    spectra = np.einsum("ms,rml->rsl", seen, modal)
    if given.output:
        spectra = spectra * s ** int(given.output)
    n = data.excitation.growth.size
    rows = scipy.fft.irfft(spectra, data.excitation.padded, axis=-1)
    return np.asarray(rows[..., :n] * data.excitation.growth)


def _predicted(
    given: RecordSet,
    modes: UnitModes,
    data: Shaken,
    modal: ComplexArray,
    laws: Sequence[PortLaw],
    oversampling: int,
) -> PortForces:
    """Return the forces of laws along the predicted motion of their ports."""
    ports = sorted({x.port for x in laws})
    across = _port_rows(given, modes)[:, ports]
    spectra = force_spectra(
        data.excitation,
        np.einsum("mp,rml->prl", across, modal),
        port_modes(modes, across, len(data.records)),
        [PortLaw(ports.index(x.port), x.law) for x in laws],
        oversampling,
    )
    return PortForces(tuple(ports), spectra)


def port_motion(given: RecordSet, data: Shaken, index: int) -> ComplexArray:
    """Return the measured motion across a port, (n_records, n_lines)."""
    first, second = given.ports[index].between
    motion = data.moved[:, given.sensors.index(second)]
    if first != GROUND:
        motion = motion - data.moved[:, given.sensors.index(first)]
    return motion


def modal_receptance(modes: UnitModes, s: ComplexArray) -> ComplexArray:
    """Return the receptance of each mode of unit mass, shape (n_modes, n_lines)."""
    omega = modes.omega[:, None]
    return np.asarray(
        1.0 / (s * s + 2.0 * modes.damping[:, None] * omega * s + omega**2)
    )


def _port_rows(given: RecordSet, modes: UnitModes) -> FloatArray:
    """Return the relative motion at every port in each mode, (n_modes, n_ports)."""
    rows = [port_shapes(modes, given.points, port) for port in given.ports]
    return np.stack(rows, axis=1)


def port_modes(modes: UnitModes, across: FloatArray, records: int) -> PortModes:
    """Return the modes between ports, for a number of records.

    Args:
        modes: of unit mass.
        across: motion of the ports, shape (n_modes, n_ports).
        records: number of records.
    """
    damped = modes.omega * np.sqrt(1.0 - np.minimum(modes.damping, 0.99) ** 2)
    poles = np.asarray(-modes.damping * modes.omega + 1j * damped)
    inputs = across / (1j * damped[:, None])
    return PortModes(
        np.tile(poles[:, None], (1, records)),
        np.tile(inputs[:, :, None], (1, 1, records)),
        np.tile(across[:, :, None] + 0j, (1, 1, records)),
    )
