"""Small `campaign/1` files: two bolted bodies of random modes, struck by a hammer.

Responses come from the exact discrete form of the equations of motion (matrix
exponential, forces linear between fine samples), not from closures on a Laplace line.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.linalg
from bolted_bodies import random_bodies

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies

RATE, QUIET, SAMPLES = 12_800.0, 256, 1024
POINTS = ("P1", "P2")
STIFFNESS = np.array([3e6, 4e6, 8e6])
DAMPING, FOOT, LOSS = np.array([120.0, 120.0, 200.0]), (4e5, 300.0), 0.015


@dataclass(frozen=True)
class Hidden:
    """What is missing from the model of a campaign.

    Attributes:
        loose: factor on stiffness and damping of each bolt [-].
        delays: of each channel [samples].
        mark: offset at which all hits of the first point aim [m].
    """

    loose: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0)
    delays: tuple[int, ...] = (0, 0, 0)
    mark: tuple[float, float] = (0.0, 0.0)


def write_campaign(folder: Path, hidden: Hidden, seed: int = 5) -> tuple[Path, Path]:
    """Write a campaign with its nominal parameters; r001 is double, r003 overloaded.

    Returns:
        Paths of the campaign and of the nominal parameters.
    """
    rng = np.random.default_rng(seed)
    bodies = random_bodies(seed)
    bodies = replace(bodies, sensors=bodies.sensors * bodies.body)
    columns = {p: rng.standard_normal((3, bodies.omega.size)) for p in POINTS}
    on_top = np.where(bodies.body == 1, 0.3, 0.0)
    columns = {p: c * on_top for p, c in columns.items()}
    gradient = {p: 3 * rng.standard_normal((3, 3, on_top.size)) for p in POINTS}
    gradient = {p: c * on_top for p, c in gradient.items()}
    path, nominal = folder / "hits.h5", folder / "sheet.json"
    system = _System(bodies, np.array(hidden.loose))
    with h5py.File(path, "w") as file:
        _write_head(file, len(bodies.channels))
        _write_model(file, bodies, columns, gradient)
        number = 0
        for point in POINTS:
            for torque in (20.0, 50.0):
                for peak in (100.0, 1000.0):
                    aim = 1e-3 * rng.standard_normal(2)
                    aim += hidden.mark if point == POINTS[0] else 0.0
                    tilt = 0.02 * rng.standard_normal(2)
                    direction = np.array([*tilt, -1.0])
                    direction /= np.linalg.norm(direction)
                    beside = np.einsum("a,acn->cn", aim, gradient[point][:2])
                    shape = columns[point] + beside
                    force = _pulse(peak, double=number == 1)
                    moved = system.response(direction @ shape, force)
                    data = np.concatenate([force[None], moved])
                    data = np.pad(data, ((0, 0), (QUIET, 0)))
                    for k, delay in enumerate(hidden.delays, start=1):
                        data[k] = np.roll(data[k], delay)
                    data += 1e-3 * rng.standard_normal(data.shape) + 0.05
                    if number == 3:
                        data[0] = np.where(data[0] > 900, 1e5, data[0])
                    _write_record(file, number, data, (point, torque, peak))
                    number += 1
    nominal.write_text(json.dumps(nominal_content()), encoding="utf-8")
    return path, nominal


def nominal_content() -> dict[str, Any]:
    """Return the nominal parameters of the campaigns."""
    point = {"position_mm": [0, 0, 0], "direction": [0, 0, -1], "body": "top"}
    return {
        "schema": "bench-sheet/1",
        "plates": {"mass_rel_sigma": 0.001, "E_rel_sigma": 0.015},
        "torques_Nm": [20.0, 50.0],
        "hammer_points": dict.fromkeys(POINTS, point),
        "aim_sigma_mm": 1.0,
        "tilt_sigma_deg": 1.2,
        "joint_per_bolt": {
            "ktx_N_per_m": STIFFNESS[0],
            "kty_N_per_m": STIFFNESS[1],
            "kn_N_per_m": STIFFNESS[2],
            "ct_Ns_per_m": DAMPING[0],
            "cn_Ns_per_m": DAMPING[2],
            "rel_sigma": {"k": 0.1, "c": 0.3},
            "bolt_to_bolt_rel_sigma": 0.03,
        },
        "plate_damping_ratio": LOSS,
        "plate_damping_rel_sigma": 0.3,
        "feet": {
            "k_N_per_m": FOOT[0],
            "c_Ns_per_m": FOOT[1],
            "rel_sigma": {"k": 0.2, "c": 0.3},
        },
    }


class _System:
    """The equations of motion, with forces linear between fine samples."""

    fine = 8

    def __init__(self, bodies: JointedBodies, loose: FloatArray) -> None:
        n = bodies.omega.size
        rows = bodies.bolts.reshape(-1, n)
        factor = np.repeat(loose, 3)
        feet = bodies.feet.reshape(-1, n)
        k = np.diag(bodies.omega**2) + FOOT[0] * feet.T @ feet
        k += rows.T @ (rows * (factor * np.tile(STIFFNESS, loose.size))[:, None])
        c = np.diag(2 * LOSS * bodies.omega) + FOOT[1] * feet.T @ feet
        c += rows.T @ (rows * (factor * np.tile(DAMPING, loose.size))[:, None])
        self.sensors, self.k, self.c = bodies.sensors, k, c
        self.state = np.block([[np.zeros((n, n)), np.eye(n)], [-k, -c]])

    def response(self, column: FloatArray, force: FloatArray) -> FloatArray:
        """Return accelerations at the sensors, shape (n_channels, n_samples)."""
        n, h = column.size, 1 / (RATE * self.fine)
        whole = np.zeros((2 * n + 2, 2 * n + 2))
        whole[: 2 * n, : 2 * n] = self.state * h
        whole[n : 2 * n, 2 * n] = column * h
        whole[2 * n, 2 * n + 1] = 1.0
        step = scipy.linalg.expm(whole)
        a = step[: 2 * n, : 2 * n]
        second = step[: 2 * n, 2 * n + 1]
        first = step[: 2 * n, 2 * n] - second
        fine = _between(force, self.fine)
        y, found = np.zeros(2 * n), np.zeros((len(self.sensors), force.size))
        for t in range(fine.size - 1):
            if t % self.fine == 0:
                q = column * fine[t] - self.k @ y[:n] - self.c @ y[n:]
                found[:, t // self.fine] = self.sensors @ q
            y = a @ y + first * fine[t] + second * fine[t + 1]
        return found


def _between(force: FloatArray, parts: int) -> FloatArray:
    """Return a band-limited pulse on finer samples."""
    spectrum = np.fft.rfft(force)
    wide = np.zeros(force.size * parts // 2 + 1, dtype=complex)
    wide[: spectrum.size] = spectrum
    return np.fft.irfft(wide * parts, force.size * parts)


def _pulse(peak: float, *, double: bool) -> FloatArray:
    t = np.arange(SAMPLES) / RATE

    def at(start: float) -> FloatArray:
        inside = np.clip((t - start) / 1.2e-3, 0.0, 1.0)
        return np.sin(np.pi * inside) ** 3

    return peak * (at(3e-4) + (0.4 * at(9e-3) if double else 0.0))


def _write_head(file: h5py.File, channels: int) -> None:
    file.attrs["schema"] = "campaign/1"
    file.attrs["fs_hz"] = RATE
    file.attrs["pretrigger_samples"] = QUIET
    file.attrs["full_scale_V"] = 10.0
    listed = [_channel("hammer", "force", None)]
    listed += [
        _channel(f"A{k}", "acceleration", [0.1 * k, 0.0, 0.0]) for k in range(channels)
    ]
    file.attrs["channels"] = json.dumps(listed)


def _channel(name: str, quantity: str, position: list[float] | None) -> dict[str, Any]:
    return {
        "name": name,
        "quantity": quantity,
        "counts_to_V": 1e-6,
        "sensitivity_V_per_unit": 2e-3,
        "body": 1,
        "position_m": position,
        "direction": None if position is None else [0, 0, 1],
    }


def _write_model(
    file: h5py.File,
    bodies: JointedBodies,
    columns: dict[str, FloatArray],
    gradient: dict[str, FloatArray],
) -> None:
    for k, name in enumerate(bodies.bodies):
        own = bodies.body == k
        group = file.create_group(f"model/{name}")
        group["freq_hz"] = bodies.omega[own] / (2 * np.pi)
        group["phi_bolts"] = bodies.bolts[:, :, own] * (2 * k - 1)
        group["phi_feet"] = bodies.feet[:, :, own]
        for channel, row in zip(bodies.channels, bodies.sensors, strict=True):
            group[f"phi_channel/{channel}"] = row[own]
        for point, column in columns.items():
            group[f"phi_hit/{point}"] = column[:, own]
            group[f"phi_hit_gradient/{point}"] = gradient[point][:, :, own]


def _write_record(
    file: h5py.File, number: int, data: FloatArray, facts: tuple[str, float, float]
) -> None:
    counts = np.clip(data * 2e-3 / 1e-6, -1e7, 1e7)
    group = file.create_group(f"records/r{number:03d}")
    group["data"] = np.rint(counts).astype(np.int32)
    group.attrs["point"], group.attrs["torque_Nm"] = facts[0], facts[1]
    group.attrs["aimed_peak_N"] = facts[2]
