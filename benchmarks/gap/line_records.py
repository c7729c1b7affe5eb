# SPDX-License-Identifier: MIT
"""Make a shaker test that is published as complex lines, with an FRF as lowest level.

Usage: python benchmarks/gap/line_records.py FOLDER [--law cubic] [--frf]
       jointbench gap FOLDER/lines.toml

Three bodies on a line, a shaker at the first, an accelerometer on each, and a law at
the joint of the last two. A random-phase multisine is repeated until the response is
periodic; one period is transformed, and the lines up to 400 Hz are written, harmonics
included, with noise of the lines. With --frf the lowest level is an FRF at the excited
lines alone.
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from record_simulation import Array, Structure, finer, multisine, simulate

Lines = NDArray[np.complex128]
RATE, SAMPLES, FASTER = 1024.0, 2048, 2
"""Rate of the samples [Hz], of a period; samples of the integration per sample."""
BAND, HIGHEST = (4.0, 140.0), 400.0
LEVELS = (1.0, 5.0, 10.0, 20.0, 30.0)
"""Of the force [N], rms; the last one is held out, with another multisine."""
PERIODS = 6
NOISE = 1e-3
"""Of each line of a response, relative to the rms of its lines [-]."""
MASSES = (3.0, 2.0, 1.0)
SPRINGS = (1.2e5, 2.5e5, 8e4)
LOSS = 1.5e-4
"""Damping over stiffness [s]."""
LAWS: dict[str, tuple[Array, Array]] = {
    "linear": (np.zeros(4), np.zeros((0, 4))),
    "cubic": (np.array([1e10, 0.0, 0.0, 0.0]), np.zeros((0, 4))),
    "clearance": (np.array([0.0, 4e4, 3e-4, 0.0]), np.zeros((0, 4))),
    "slip": (np.zeros(4), np.array([[2e4, 2e3, 2e3, 1.0]])),
}
MODEL = """[base]
band = ["4 Hz", "140 Hz"]
modes = 3

[records]
lines = "force.shaker@b1:N,acceleration.b1@b1:m/s^2,acceleration.b2@b2:m/s^2,\
acceleration.b3@b3:m/s^2"
rate = "1024 Hz"
excitation = "multisine"
repeatability = "0.1 %"

[ports.joint]
between = ["b2", "b3"]
"""


def chain(law: str) -> Structure:
    """Return three bodies in a row, the last two joined by a spring and a law."""
    across = np.array([0.0, -1.0, 1.0])
    rows = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], across])
    springs, sliders = LAWS[law]
    stuck = np.array([0.0, 0.0, sliders[:, 0].sum()])
    stiffness = rows.T @ np.diag(np.array(SPRINGS)) @ rows
    own = rows.T @ np.diag(np.array(SPRINGS) - stuck) @ rows
    driven = np.array([[1.0, 0.0, 0.0]])
    mass = np.diag(MASSES)
    return Structure(mass, LOSS * stiffness, own, driven, across, springs, sliders)


def spectra(law: str, level: float, seed: int) -> tuple[Array, Lines]:
    """Return frequencies [Hz] and the lines of force and responses, (4, n_lines)."""
    force = multisine(SAMPLES, RATE, BAND, level, seed)
    quick = np.fft.irfft(np.fft.rfft(force), SAMPLES * FASTER) * FASTER
    motion = simulate(chain(law), finer(quick[None]), RATE * FASTER, PERIODS)[2]
    rows = np.concatenate([quick[None], motion[:, -SAMPLES * FASTER :]])
    values = np.fft.rfft(rows, axis=1) * 2.0 / rows.shape[1]
    frequency = np.fft.rfftfreq(rows.shape[1], 1.0 / (RATE * FASTER))
    kept = (frequency > 0) & (frequency <= HIGHEST)
    values = values[:, kept]
    rng = np.random.default_rng([seed, 3])
    size = NOISE * np.sqrt(np.mean(np.abs(values[1:]) ** 2, axis=1, keepdims=True))
    noise = rng.standard_normal((2, *values[1:].shape)) / np.sqrt(2.0)
    values[1:] += size * (noise[0] + 1j * noise[1])
    return frequency[kept], values


def write(path: Path, frequency: Array, values: Lines) -> None:
    """Write frequency, then real and imaginary part of each row."""
    parts = [part for row in values for part in (row.real, row.imag)]
    np.savetxt(path, np.stack([frequency, *parts], axis=1), "%.9g", ",")


def make(folder: Path, law: str, *, frf: bool) -> None:
    """Write all levels and the model of the command beside them."""
    folder.mkdir(parents=True, exist_ok=True)
    text = MODEL
    for k, level in enumerate(LEVELS):
        frequency, values = spectra(law, level, 60 + k)
        name = f"level-{level:g}N.csv"
        stated = frf and k == 0
        if stated:
            own = (frequency >= BAND[0]) & (frequency <= BAND[1])
            frequency, values = frequency[own], values[1:, own] / values[0, own]
        write(folder / name, frequency, values)
        text += f'\n[[levels]]\nname = "{level:g} N"\nfiles = ["{name}"]\n'
        text += f'frf_force = "{level:g} N"\n' if stated else ""
        text += "held_out = true\n" if level == LEVELS[-1] else ""
    (folder / "lines.toml").write_text(text, encoding="utf-8")


def main() -> None:
    """Write the records."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--law", choices=sorted(LAWS), default="cubic")
    parser.add_argument("--frf", action="store_true")
    arguments = parser.parse_args()
    make(arguments.folder, arguments.law, frf=arguments.frf)


if __name__ == "__main__":
    main()
