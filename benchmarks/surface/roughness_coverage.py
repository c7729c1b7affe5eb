# SPDX-License-Identifier: MIT
"""Coverage of the intervals of standard roughness parameters.

python -m benchmarks.surface.roughness_coverage --count 200 --seed 900 --log PATH
simulates measurements of surfaces that are sums of cosines: their filtered heights and
gradients are sums of the same cosines times the transmissions, so that the true values
need neither a filter nor a grid of the product. A measurement has white noise, a wrong
height scale, a wrong pitch, and is compared with a laboratory whose filters deviate
within the tolerance. Three of four are profiles, one a map. A run that was stopped
continues from its log.
"""

import argparse
import json
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface, all_valid
from jointbench.signal.roughness.setting_classes import setting_class
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import Texture, TextureSettings
from jointbench.signal.roughness.texture_uncertainty import measured_texture
from jointbench.signal.roughness.uncertain_parameters import InstrumentErrors

PITCH, SIDE, MAP_PITCH = 0.5e-6, 128, 1e-6
TOLERANCE = 0.05  # of the nesting indices [-]


@dataclass(frozen=True, slots=True)
class Waves:
    """Cosines: sizes [m], wave vectors (x, y) [1/m], phases [rad]."""

    size: FloatArray
    vector: FloatArray
    phase: FloatArray

    def passed(self, short: float, long: float | None) -> "Waves":
        """Return the waves after an S-filter and an L-filter (50 % at the index)."""
        square = (self.vector**2).sum(axis=1)
        kept = 0.5 ** (square * short**2)
        if long is not None:
            kept = kept * (1 - 0.5 ** (square * long**2))
        return Waves(self.size * kept, self.vector, self.phase)

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [m] at rows y and columns x."""
        return self._sum(x, y, np.cos, self.size)

    def slopes(self, x: FloatArray, y: FloatArray, axis: int) -> FloatArray:
        """Return gradients [-] along x (0) or y (1)."""
        size = -2 * np.pi * self.vector[:, axis] * self.size
        return self._sum(x, y, np.sin, size)

    def _sum(self, x, y, wave, size):  # type: ignore[no-untyped-def]
        total = np.zeros((y.size, x.size))
        for one, (u, v), phase in zip(size, self.vector, self.phase, strict=True):
            total += one * wave(2 * np.pi * (u * x[None, :] + v * y[:, None]) + phase)
        return total


def drawn_profile(rng: np.random.Generator) -> Waves:
    """Return a rough or a turned surface along x."""
    count = 150
    length = np.exp(rng.uniform(np.log(6e-6), np.log(200e-6), count))
    size = length ** rng.uniform(0.2, 0.9)
    size *= rng.uniform(0.15e-6, 0.5e-6) / np.sqrt(0.5 * (size**2).sum())
    phase = rng.uniform(0, 2 * np.pi, count)
    if rng.random() < 0.4:
        # Arcs of a turning tool: the Fourier series of a parabola.
        feed, depth = rng.uniform(40e-6, 90e-6), rng.uniform(1e-6, 3e-6)
        order = np.arange(1, 6)
        length = np.append(0.3 * length, feed / order)
        size = np.append(0.3 * size, depth * 4 / np.pi**2 / order**2 * (-1.0) ** order)
        phase = np.append(phase, order * rng.uniform(0, 2 * np.pi))
    return Waves(size, np.stack([1 / length, 0 * length], axis=1), phase)


def drawn_map(rng: np.random.Generator) -> Waves:
    """Return a rough surface with more or less of a lay."""
    count = 60
    length = np.exp(rng.uniform(np.log(10e-6), np.log(60e-6), count))
    angle = rng.normal(rng.uniform(0, np.pi), rng.choice([0.2, 2.0]), count)
    size = length**0.7
    size *= rng.uniform(0.3e-6, 1e-6) / np.sqrt(0.5 * (size**2).sum())
    vector = np.stack([np.cos(angle), np.sin(angle)], axis=1) / length[:, None]
    return Waves(size, vector, rng.uniform(0, 2 * np.pi, count))


def grid(points: int, pitch: float) -> FloatArray:
    """Return places about the middle [m]."""
    return pitch * (np.arange(points) - (points - 1) / 2)


def truth(
    waves: Waves, shape: tuple[int, int], pitch: float, sections: int
) -> dict[str, float | None]:
    """Return parameters of filtered waves on the true grid."""
    y, x = (grid(n, pitch) for n in shape)
    heights = waves.heights(x, y)
    if shape[0] > 1:
        design = np.stack(
            [np.ones(heights.size), *(g.ravel() for g in np.meshgrid(x, y))], axis=1
        )
        plane = np.linalg.lstsq(design, heights.ravel(), rcond=None)[0]
        heights = heights - (design @ plane).reshape(shape)
    flat = heights if shape[0] > 1 else heights[0]
    valid = all_valid(flat)
    spacing = (pitch,) * flat.ndim
    settings = TextureSettings(None, None)
    texture = Texture(flat, valid, spacing, 0 * flat, settings, sections)
    # Elements, core, volumes and decay are definitions on heights that are exact here.
    found = texture_parameters(texture).values
    letter = "R" if flat.ndim == 1 else "S"
    root = float(np.sqrt(np.mean(flat**2)))
    found[f"{letter}a"] = float(np.mean(np.abs(flat)))
    found[f"{letter}q"] = root
    found[f"{letter}sk"] = float(np.mean(flat**3)) / root**3
    found[f"{letter}ku"] = float(np.mean(flat**4)) / root**4
    steep = np.mean(waves.slopes(x, y, 0) ** 2)
    if flat.ndim == 2:
        steep = steep + np.mean(waves.slopes(x, y, 1) ** 2)
    else:
        parts = np.array_split(flat, sections)
        found["Rp"] = float(np.mean([one.max() for one in parts]))
        found["Rv"] = -float(np.mean([one.min() for one in parts]))
        found["Rz"] = float(np.mean([np.ptp(one) for one in parts]))
        found["Rt"] = float(np.ptp(flat))
    found[f"{letter}dq"] = float(np.sqrt(steep))
    return found


def simulated(seed: int) -> dict[str, object]:
    """Return which intervals of one simulated measurement hold the true value."""
    rng = np.random.default_rng(seed)
    errors = InstrumentErrors(rng.uniform(0.003, 0.02), rng.uniform(0.002, 0.01))
    noise = np.exp(rng.uniform(np.log(2e-9), np.log(30e-9)))
    high, wide = (rng.normal(0, one) for one in (errors.height, errors.pitch))
    short_off, long_off = 1 + rng.uniform(-TOLERANCE, TOLERANCE, 2)
    plane = seed % 4 == 0
    if plane:
        waves, settings = drawn_map(rng), TextureSettings(5e-6, None)
        shape, pitch, sections = (SIDE, SIDE), MAP_PITCH, 1
        inside = shape
        filtered = waves.passed(5e-6 * short_off, None)
    else:
        chosen = setting_class(rng.choice(["Sc2", "Sc3"]))
        waves, pitch, sections = drawn_profile(rng), PITCH, 5
        settings = TextureSettings(chosen.short, chosen.long)
        shape = (1, round(6.2 * chosen.long / PITCH))
        inside = (1, round(5 * chosen.long / PITCH))
        filtered = waves.passed(chosen.short * short_off, chosen.long * long_off)
    y, x = (grid(n, pitch) * (1 + wide) for n in shape)
    seen = (1 + high) * waves.heights(x, y)
    seen += noise * rng.standard_normal(shape)
    surface: Surface = (
        Areal("map", seen, (pitch, pitch), all_valid(seen))
        if plane
        else Profile("line", seen[0], pitch, all_valid(seen[0]))
    )
    true = truth(filtered, inside, pitch, sections)
    held = {}
    for one in measured_texture(surface, settings, errors).values:
        wanted, interval = true[one.name], one.interval
        if wanted is not None and interval is not None:
            off = wanted - (interval[0] + interval[1]) / 2
            if one.name == "Std":
                off = (off + np.pi / 2) % np.pi - np.pi / 2
            held[one.name] = [bool(2 * abs(off) <= interval[1] - interval[0]), off]
    return {"seed": seed, "held": held}


def table(rows: list[dict[str, dict[str, list[float]]]]) -> None:
    """Print coverage by parameter and pooled."""
    hits: dict[str, list[bool]] = defaultdict(list)
    for row in rows:
        for name, (inside, _) in row["held"].items():
            hits[name].append(bool(inside))
    print("| parameter | intervals | hold the true value [%] |\n|---|---|---|")
    for name, one in hits.items():
        print(f"| {name} | {len(one)} | {100 * np.mean(one):.1f} |")
    for letter, word in (("R", "profiles"), ("SV", "maps")):
        chosen = [h for name, one in hits.items() if name[0] in letter for h in one]
        if chosen:
            print(f"| all of {word} | {len(chosen)} | {100 * np.mean(chosen):.1f} |")
    pooled = [h for one in hits.values() for h in one]
    print(f"| **all** | {len(pooled)} | **{100 * np.mean(pooled):.1f}** |")


def main() -> None:
    """Run what the log lacks, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=900)
    parser.add_argument("--log", type=Path, required=True)
    asked = parser.parse_args()
    lines = asked.log.read_text().splitlines() if asked.log.is_file() else []
    rows = [json.loads(line) for line in lines]
    done = {row["seed"] for row in rows}
    for seed in range(asked.seed, asked.seed + asked.count):
        if seed not in done:
            rows.append(simulated(seed))
            with asked.log.open("a") as log:
                log.write(json.dumps(rows[-1]) + "\n")
    wanted = range(asked.seed, asked.seed + asked.count)
    table([row for row in rows if row["seed"] in wanted])


if __name__ == "__main__":
    main()
