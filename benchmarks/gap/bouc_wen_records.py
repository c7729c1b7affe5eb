# SPDX-License-Identifier: MIT
"""Make the records of the Bouc-Wen benchmark from its published equations.

Usage: python benchmarks/gap/bouc_wen_records.py FOLDER
       jointbench gap examples/bouc_wen.toml       (with FOLDER = examples/bouc_wen)

m y'' + c y' + k y + z = u,  z' = a y' - b (g |y'| |z|^(n-1) z + d y' |z|^n), with m = 2
kg, c = 10 N s/m, k = a = 5e4 N/m, b = 1e3, g = 0.8, d = -1.1, n = 1. The force is a
multisine of 5 to 150 Hz at four levels up to 50 N rms, and the noise of the output is
8 um rms, that of the benchmark. Without noise, for validation: another multisine of
50 N rms, and a sweep of 40 N from 20 to 50 Hz at 10 Hz per minute.

Source:
    Noel and Schoukens 2016, Hysteretic benchmark with a dynamic nonlinearity, Workshop
    on Nonlinear System Identification Benchmarks, Brussels, sec. 2 and 5.
"""

import argparse
from pathlib import Path

import numpy as np
from record_simulation import Array, Structure, finer, multisine, simulate, sweep

RATE, SAMPLES = 750.0, 8192
BAND = (5.0, 150.0)
LEVELS = (5.0, 15.0, 30.0, 50.0)
NOISE = 8e-6
RAMP = 100
ONE = np.ones((1, 1))
BOUC_WEN = Structure(
    mass=2.0 * ONE,
    damping=10.0 * ONE,
    stiffness=5e4 * ONE,
    driven=ONE,
    across=np.ones(1),
    springs=np.zeros(4),
    sliders=np.array([[5e4, 1e3 * 0.8, 1e3 * -1.1, 1.0]]),
)


def from_rest(force: Array) -> Array:
    """Let a force begin and end at zero, so that its spectrum has no jump."""
    n = np.arange(force.size)
    ramp = np.minimum(1.0, np.minimum(n, n[::-1]) / RAMP)
    return np.asarray(force * np.sin(0.5 * np.pi * ramp) ** 2)


def write_record(path: Path, force: Array, noise: float, seed: int) -> None:
    """Integrate one record from rest and write time, force and displacement."""
    motion = simulate(BOUC_WEN, finer(force[None]), RATE)[0, 0]
    motion = motion + noise * np.random.default_rng(seed).standard_normal(motion.size)
    time = np.arange(force.size) / RATE
    np.savetxt(
        path,
        np.stack([time, force, motion], axis=1),
        fmt=("%.8f", "%.9g", "%.9g"),
        delimiter=",",
        header="t,F,y",
        comments="",
    )


def make(folder: Path, samples: int = SAMPLES) -> None:
    """Write all records into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for seed, level in enumerate(LEVELS):
        force = from_rest(multisine(samples, RATE, BAND, level, seed))
        write_record(folder / f"multisine-{level:g}N.csv", force, NOISE, 100 + seed)
    held_out = from_rest(multisine(SAMPLES, RATE, BAND, 50.0, 77))
    write_record(folder / "validation-multisine.csv", held_out, 0.0, 0)
    force = from_rest(sweep(RATE, (20.0, 50.0), 10.0 / 60.0, 40.0))
    write_record(folder / "validation-sweep.csv", force, 0.0, 0)


def main() -> None:
    """Write the records."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    make(parser.parse_args().folder)


if __name__ == "__main__":
    main()
