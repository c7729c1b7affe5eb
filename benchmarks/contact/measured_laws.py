# SPDX-License-Identifier: MIT
"""Laws of measured surfaces compared with boundary elements, over 4 decades of load.

Needs the extra `oracle` (tamaas). Each surface is made by tamaas's own generator,
measured as a map, fitted and predicted as `jointbench contact` does, and solved by
tamaas as a periodic half-space. Results are appended to a file of JSON lines, so that a
run can be continued; the page is made from it.

    python benchmarks/contact/measured_laws.py --count 30 --seed 7000 --store FILE
    python benchmarks/contact/measured_laws.py --store FILE --page
"""

import argparse
import json
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.analysis.contact.spectral.height_distribution import height_facts
from jointbench.analysis.contact.spectral.isotropic_spectrum import isotropic_spectrum
from jointbench.analysis.contact.spectral.measured_laws import (
    MeasuredCase,
    predict_measured,
)
from jointbench.signal.band_limited.band_limited_fit import fit_lines

POINTS = 256
LOADS = np.geomspace(1e-4, 1, 9)  # mean pressure over E* times rms gradient
STEP = 0.04
TOLERANCE = 1e-6
HARD = 1e6  # hardness over E*: nothing yields
PREFERRED = ("persson", "bush_gibson_thomas", "greenwood_williamson")
PAGE = Path(__file__).parents[2] / "docs" / "contact-measured-surfaces.md"


def draw_surface(seed: int) -> tuple[dict[str, float], np.ndarray]:
    """Return the parameters of a surface and its heights on a unit square."""
    import tamaas as tm

    random = np.random.default_rng(seed)
    hurst = float(random.uniform(0.3, 0.9))
    roll_off = int(random.integers(4, 17))  # waves a side
    longest = int(random.integers(1, roll_off + 1))
    shortest = int(random.choice([16, 32]))  # points of the shortest wave: 16 or 8
    gradient = float(10 ** random.uniform(-2, -0.5))
    generator = tm.SurfaceGeneratorFilter2D([POINTS, POINTS])
    spectrum = tm.Isopowerlaw2D()
    spectrum.q0, spectrum.q1, spectrum.q2 = (
        longest,
        roll_off,
        max(shortest, 2 * roll_off),
    )
    spectrum.hurst = hurst
    generator.spectrum = spectrum
    generator.random_seed = seed
    heights = np.array(generator.buildSurface())
    facts = {"hurst": hurst, "longest": longest, "roll_off": roll_off}
    facts |= {"shortest": spectrum.q2}
    return facts, heights * gradient / rms_gradient(heights)


def rms_gradient(heights: np.ndarray) -> float:
    """Return the root mean square gradient by Fourier derivative."""
    q = 2 * np.pi * np.fft.fftfreq(POINTS, 1 / POINTS)
    power = np.abs(np.fft.fft2(heights)) ** 2 / POINTS**4
    return float(np.sqrt((power * (q[:, None] ** 2 + q[None, :] ** 2)).sum()))


def solved(heights: np.ndarray, pressure: float) -> tuple[float, float]:
    """Return mean gap and real area by boundary elements, E* = 1."""
    import tamaas as tm

    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], list(heights.shape))
    model.E, model.nu = 1.0, 0.0
    solver = tm.PolonskyKeerRey(model, heights, TOLERANCE)
    solver.setDumpFrequency(100_000)
    solver.solve(pressure)
    gap = model.displacement - heights
    return float(gap.mean() - gap.min()), float((model.traction > 0).mean())


def judged(seed: int) -> dict[str, object]:
    """Return what boundary elements and laws give for one surface at all loads."""
    facts, heights = draw_surface(seed)
    pressure = LOADS * rms_gradient(heights)
    states = []
    for p in pressure:
        low, high = (solved(heights, p * (1 + s)) for s in (-STEP, STEP))
        states.append(
            {
                "stiffness": float(2 * STEP * p / (low[0] - high[0])),
                "gap": 0.5 * (low[0] + high[0]),
                "area": 0.5 * (low[1] + high[1]),
            }
        )
    surface = Areal(f"made {seed}", heights, (1 / POINTS,) * 2, all_valid(heights))
    fit = fit_lines([surface])
    spectrum = isotropic_spectrum(fit)
    case = MeasuredCase(
        spectrum,
        height_facts(surface, float(spectrum.mean_wave()[0])),
        area=1.0,
        modulus=1.0,
        hardness=HARD,
    )
    laws = {
        curve.law: {
            "stiffness": curve.stiffness.tolist(),
            "low": curve.low.tolist(),
            "high": curve.high.tolist(),
            "outside": [list(said) for said in curve.outside],
        }
        for curve in predict_measured(case, pressure)
    }
    return {
        "seed": seed,
        **facts,
        "verdict": fit.verdict.value,
        "height": float(heights.std()),
        "height_fit": case.height,
        "gradient": rms_gradient(heights),
        "gradient_fit": case.gradient,
        "hills": case.hills,
        "states": states,
        "laws": laws,
    }


def rows_of(store: Path) -> list[dict]:
    """Return the surfaces of a store."""
    if not store.exists():
        return []
    lines = store.read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def main() -> None:
    """Judge surfaces that are not in the store yet, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--seed", type=int, default=7000)
    parser.add_argument("--store", type=Path, required=True)
    parser.add_argument("--page", action="store_true")
    given = parser.parse_args()
    if given.page:
        from measured_laws_page import page

        PAGE.write_text(page(rows_of(given.store)), encoding="utf-8")
        return
    known = {row["seed"] for row in rows_of(given.store)}
    for seed in range(given.seed, given.seed + given.count):
        if seed not in known:
            with given.store.open("a", encoding="utf-8") as file:
                file.write(json.dumps(judged(seed)) + "\n")


if __name__ == "__main__":
    main()
