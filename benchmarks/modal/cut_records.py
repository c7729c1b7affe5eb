# SPDX-License-Identifier: MIT
"""Records that end before the structure is quiet: what the finite record costs.

Usage: OMP_NUM_THREADS=1 python benchmarks/modal/cut_records.py [--count 20]

Three modes, displacement from one point, six hits of 60 dB, the sum of exact decays
of weighted impulses: no integrator. Records end where the slowest mode has fallen to a
share of its start. For each share: how many 95 % intervals hold the true value, and the
error over the bound that the white noise of the same samples sets (Cramer and Rao; all
poles and residues unknown, offset too). What is above 1 is all that a model of the
finite record could win.
"""

import argparse
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.signal.frf.frf import estimate_frf
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.signal.modal.modes import ModalSettings, identify_modes

Floats = npt.NDArray[np.float64]
RATE, HITS, LEAD, NOISE = 8192.0, 6, 128, 1e-3
SHARES = (0.5, 0.2, 0.05, 0.01, 1e-3)
_BAND = (50.0, 700.0)
# Median of the absolute value of a normal error, in standard deviations.
_MEDIAN = 0.6745


@dataclass(frozen=True)
class Modes:
    """Frequencies [Hz], damping ratios and residues of three modes."""

    frequency: Floats
    ratio: Floats
    size: Floats

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "Modes":
        """Return random modes between 100 and 600 Hz."""
        frequency = np.array([120.0, 280.0, 520.0]) * rng.uniform(0.9, 1.1, 3)
        ratio = rng.uniform(0.003, 0.01, 3)
        return cls(frequency, ratio, rng.uniform(0.5, 1.5, 3) / frequency)

    def decay(self, time: Floats) -> Floats:
        """Return the response to a unit impulse."""
        omega = 2 * np.pi * self.frequency[:, None]
        own = omega * np.sqrt(1 - self.ratio[:, None] ** 2)
        fall = np.exp(-self.ratio[:, None] * omega * time)
        return np.asarray(self.size @ (fall * np.sin(own * time)))

    def bounds(self, time: Floats, noise: float) -> Floats:
        """Return the least sd of frequencies [Hz] and damping ratios in white noise."""
        pole = (
            2 * np.pi * self.frequency * (-self.ratio + 1j * np.sqrt(1 - self.ratio**2))
        )
        wave = np.exp(np.outer(time, pole))
        moved = time[:, None] * wave * self.size
        # s = omega (-zeta + j root): derivatives of each decay.
        omega, root = 2 * np.pi * self.frequency, np.sqrt(1 - self.ratio**2)
        by_f = (moved * pole / self.frequency).imag
        by_z = (moved * omega * (-1 - 1j * self.ratio / root)).imag
        linear = [wave.imag, wave.real, np.ones((time.size, 1))]
        columns = np.hstack([by_f, by_z, *linear])
        scale = np.linalg.norm(columns, axis=0)
        inverse = np.linalg.inv((columns / scale).T @ (columns / scale))
        return np.asarray(noise * np.sqrt(np.diag(inverse)) / scale)[:6]


def measured(
    modes: Modes, count: int, rng: np.random.Generator
) -> tuple[ModalModel, float]:
    """Return the modes found in hits of some samples after the trigger; the noise."""
    pulse = np.sin(np.pi * np.arange(1, 8) / 8.0)
    time = np.arange(count) / RATE
    answer = np.convolve(pulse, modes.decay(time))[:count]
    noise = NOISE * float(np.abs(answer).max())
    samples = np.zeros((2, HITS * (LEAD + count)))
    hits = []
    for first in range(0, samples.shape[1], LEAD + count):
        level, start = rng.uniform(80.0, 120.0), first + LEAD
        samples[0, start : start + pulse.size] = level * pulse
        samples[1, start : start + count] = level * answer
        hits.append(
            Hit(first, start, start + count, "1", level, Verdict.OK, 0.0, "made")
        )
    samples[1] += 100.0 * noise * rng.standard_normal(samples.shape[1])
    samples[0] += 1e-3 * rng.standard_normal(samples.shape[1])
    channels = (
        Channel("force", Quantity.FORCE, point="1"),
        Channel("x", Quantity.DISPLACEMENT, point="1"),
    )
    made = Recording("cut", samples, RATE, channels, hits=tuple(hits))
    found = identify_modes(estimate_frf(made), ModalSettings(band=_BAND)).model
    return found, noise / float(pulse.sum())


def errors(seed: int, share: float) -> tuple[Floats, Floats, Floats]:
    """Return errors of f [Hz] and zeta, their stated sd, and their bounds."""
    rng = np.random.default_rng(seed)
    modes = Modes.drawn(rng)
    slowest = float(np.min(2 * np.pi * modes.frequency * modes.ratio))
    count = int(-np.log(share) / slowest * RATE)
    found, noise = measured(modes, count, rng)
    bound = modes.bounds(np.arange(count) / RATE, noise / np.sqrt(HITS))
    near = [
        int(np.argmin(np.abs(found.natural_frequency - f))) for f in modes.frequency
    ]
    frequency, ratio = found.natural_frequency[near], found.damping_ratio[near]
    error = np.concatenate((frequency - modes.frequency, ratio - modes.ratio))
    stated = np.concatenate((found.frequency_sd[near], found.damping_ratio_sd[near]))
    return error, stated, bound


def main() -> None:
    """Print one line for each share."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print(
        "| left at the end | intervals that hold | median error / bound "
        "| median sd / bound |"
    )
    print("|---|---|---|---|")
    for share in SHARES:
        rows = [errors(given.seed + i, share) for i in range(given.count)]
        error, stated, bound = (
            np.concatenate(part) for part in zip(*rows, strict=True)
        )
        held = np.abs(error) < 1.96 * stated
        usual = np.median(np.abs(error) / bound) / _MEDIAN
        print(
            f"| {100 * share:g} % | {held.sum()} of {held.size}: "
            f"{100 * held.mean():.0f} % "
            f"| {usual:.2f} | {np.median(stated / bound):.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
