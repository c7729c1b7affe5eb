# SPDX-License-Identifier: MIT
"""Make the records of a wing with a bolted payload: seven levels, seven files.

Usage: python benchmarks/gap/wing_records.py FOLDER
       jointbench gap examples/wing.toml       (with FOLDER = examples/wing)

A clamped beam of five finite elements carries a payload on its tip. The payload is held
by a bolted mount: a spring and damper, five sliders of graded slip force (micro-slip),
and stops at both sides of a clearance. A shaker drives the middle of the beam with
random noise; accelerometers sit beside it, on the tip and on the payload.
"""

import argparse
from pathlib import Path

import numpy as np
import scipy.signal
from record_simulation import Array, Structure, finer, multisine, simulate, sweep

RATE, SAMPLES = 512.0, 4096
BAND = (3.0, 150.0)
FASTER = 4
"""Samples of the integration per sample of a record: the rest is filtered off."""
LEVELS = (1.0, 2.5, 5.0, 10.0, 15.0, 20.0, 30.0)
NOISE = 2e-3
"""Of each accelerometer, relative to its rms at the lowest level [-]."""
ELEMENTS, LENGTH, BENDING, LINE_MASS = 5, 1.2, 400.0, 1.8
"""Number of elements, length [m], bending stiffness [N m^2], mass per length [kg/m]."""
PAYLOAD, MOUNT, MOUNT_DAMPING = 0.6, 4e4, 6.0
"""[kg], [N/m], [N s/m]."""
SLIDERS, SLIP_STIFFNESS, SLIP_FORCE = 5, 3e4, 6.0
"""Number of sliders, their stiffness together [N/m], their slip force together [N]."""
STOP, CLEARANCE = 3e4, 1.2e-3
"""Stiffness of the stops [N/m], half of the clearance [m]."""
MIDDLE, TIP, LOAD = 4, 8, 10
"""Rows of the driven point, of the tip and of the payload."""


def beam() -> tuple[Array, Array]:
    """Return mass and stiffness of the clamped beam, shape (10, 10).

    Source:
        Przemieniecki 1968, Theory of Matrix Structural Analysis, eqs. (5.79), (11.31).
    """
    h = LENGTH / ELEMENTS
    bend = np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, 4 * h * h, -6 * h, 2 * h * h],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, 2 * h * h, -6 * h, 4 * h * h],
        ]
    )
    inert = np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h * h, 13 * h, -3 * h * h],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h * h, -22 * h, 4 * h * h],
        ]
    )
    size = 2 * (ELEMENTS + 1)
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        mass[at, at] += LINE_MASS * h / 420.0 * inert
        stiffness[at, at] += BENDING / h**3 * bend
    return mass[2:, 2:], stiffness[2:, 2:]


def wing(*, sliders: float = SLIP_FORCE, stop: float = STOP) -> Structure:
    """Return the structure.

    Args:
        sliders: slip force of all sliders together [N]; 0 leaves them out.
        stop: stiffness of the stops [N/m]; 0 leaves them out.
    """
    own, bend = beam()
    n = own.shape[0] + 1
    mass, stiffness = np.zeros((n, n)), np.zeros((n, n))
    mass[:-1, :-1], stiffness[:-1, :-1] = own, bend
    mass[-1, -1] = PAYLOAD
    across = np.zeros(n)
    across[[TIP, LOAD]] = -1.0, 1.0
    damping = 2e-5 * stiffness + 0.8 * mass + MOUNT_DAMPING * np.outer(across, across)
    stuck = SLIP_STIFFNESS if sliders else 0.0
    stiffness += (MOUNT + SLIP_STIFFNESS - stuck) * np.outer(across, across)
    driven = np.zeros((1, n))
    driven[0, MIDDLE] = 1.0
    return Structure(
        mass,
        damping,
        stiffness,
        driven,
        across,
        np.array([0.0, stop, CLEARANCE, 0.0]),
        _graded(sliders),
    )


def _graded(total: float) -> Array:
    """Return sliders of equal stiffness and ascending slip force, smooth corners."""
    if not total:
        return np.zeros((0, 4))
    forces = total * np.arange(1, SLIDERS + 1) / np.arange(1, SLIDERS + 1).sum()
    k, sharpness = SLIP_STIFFNESS / SLIDERS, 4.0
    half = 0.5 * k / forces**sharpness
    return np.stack([np.full(SLIDERS, k), half, half, np.full(SLIDERS, sharpness)], 1)


def record(structure: Structure, force: Array) -> Array:
    """Return force and the three accelerations, shape (4, n_samples)."""
    n = np.arange(force.size)
    ramp = np.minimum(1.0, np.minimum(n, n[::-1]) / 100)
    force = force * np.sin(0.5 * np.pi * ramp) ** 2
    quick = np.fft.irfft(np.fft.rfft(force), force.size * FASTER) * FASTER
    motion = simulate(structure, finer(quick[None]), RATE * FASTER)[2]
    rows = np.concatenate([quick[None], motion[[MIDDLE, TIP, LOAD]]])
    return np.asarray(
        scipy.signal.decimate(rows, FASTER, n=120, ftype="fir", zero_phase=True)
    )


def write(path: Path, rows: Array) -> None:
    """Write time, force and accelerations as a table."""
    time = np.arange(rows.shape[1]) / RATE
    np.savetxt(
        path,
        np.concatenate([time[None], rows]).T,
        fmt="%.8g",
        delimiter=",",
        header="t,F,a1,a2,a3",
        comments="",
    )


def make(folder: Path, structure: Structure, samples: int = SAMPLES) -> None:
    """Write the seven levels, and a sweep through the first modes."""
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(11)
    noise = np.zeros(3)
    for k, level in enumerate(LEVELS):
        rows = record(structure, multisine(samples, RATE, BAND, level, 40 + k))
        if k == 0:
            noise = NOISE * rows[1:].std(axis=1)
        rows[1:] += noise[:, None] * rng.standard_normal(rows[1:].shape)
        write(folder / f"level-{k + 1}.csv", rows)
    rows = record(structure, sweep(RATE, (4.0, 60.0), 1.0, 12.0))
    rows[1:] += noise[:, None] * rng.standard_normal(rows[1:].shape)
    write(folder / "sweep.csv", rows)


def main() -> None:
    """Write the records."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    make(parser.parse_args().folder, wing())


if __name__ == "__main__":
    main()
