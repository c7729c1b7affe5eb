# SPDX-License-Identifier: MIT
"""A million joints by closed form, beside plain quadrature of the same laws, one core.

OMP_NUM_THREADS=1 python benchmarks/contact/speed.py
"""

import math
import time
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import ContactMaterial

MANY, FEW = 1_000_000, 40
E, H, NU = 69.3e9, 2.265e9, 0.25
KAPPA = math.pi * (0.454 + 0.41 * NU) * H / (2 * E)
BLOCK = 50_000


def plain(dimension: float, roughness: float, preload: float) -> tuple[float, float]:
    """Return a_l and K of the model ke_3d: brentq over quadrature, in plain floats."""
    D, e, q = dimension, dimension - 2, (dimension - 1) / 2
    scale = 2 ** ((11 - 3 * D) / 2) * math.log(1.5) ** 0.5
    scale *= math.pi ** ((D - 3) / 2) * roughness**e
    critical = (2 * math.log(scale) + math.log(math.pi) - 2 * math.log(KAPPA)) / e
    unit = 4 / 3 * E * KAPPA / math.pi

    def load(log_area: float) -> float:
        s, area = math.exp(e * (critical - log_area)), math.exp(log_area)
        if s > 110:
            return 2 * H * area
        c, p = (1.40, 1.263) if s > 6 else (1.03, 1.425) if s > 1 else (1.0, 1.5)
        return unit * area * c * s ** (p - 1)

    def slope(log_area: float) -> float:
        s = math.exp(e * (critical - log_area))
        if s > 110:
            return 0.0
        p = 1.263 if s > 6 else 1.425 if s > 1 else 1.5
        depth = scale * math.exp((1 - e) / 2 * log_area)
        return p * load(log_area) / depth

    def total(law: object, log_largest: float) -> float:
        edges = [critical - math.log(b) / e for b in (110, 6, 1)]
        edges = [min(edge, log_largest) for edge in edges]
        limits = [edges[0] - 60 / (1 - e), *edges, log_largest]
        return sum(
            quad(
                lambda t: law(t) * q * math.exp(q * (log_largest - t)),
                low,
                high,
                epsabs=0,
                epsrel=1e-9,
                limit=200,
            )[0]
            for low, high in pairwise(limits)
            if high > low
        )

    start = math.log(preload / (2 * H))
    solved = brentq(lambda t: total(load, t) - preload, start - 30, start + 15)
    return math.exp(solved), total(slope, solved)


def main() -> None:
    """Time both on the same joints, and report their agreement."""
    random = np.random.default_rng(1)
    dimension = 2 + random.uniform(0.2, 0.85, MANY)
    roughness = 10 ** random.uniform(-12, -8, MANY)
    preload = 10 ** random.uniform(1, 5, MANY)
    material = ContactMaterial(E, H, NU)
    area, stiffness = np.empty(MANY), np.empty(MANY)
    begin = time.perf_counter()
    for start in range(0, MANY, BLOCK):
        part = slice(start, start + BLOCK)
        sums = contact_curve(
            "ke_3d",
            dimension=dimension[part],
            roughness=roughness[part],
            material=material,
            preload=preload[part],
        )
        area[part], stiffness[part] = sums.largest_area, sums.stiffness.sum(axis=0)
    closed = (time.perf_counter() - begin) / MANY
    begin = time.perf_counter()
    found = [plain(dimension[i], roughness[i], preload[i]) for i in range(FEW)]
    by_quadrature = (time.perf_counter() - begin) / FEW
    apart = np.array(found) / np.stack([area[:FEW], stiffness[:FEW]], axis=1) - 1
    print(
        f"closed form: {closed * MANY:.2f} s for {MANY} joints, {closed * 1e6:.2f} us"
    )
    print(f"quadrature:  {by_quadrature * 1e3:.2f} ms a joint, {FEW} joints")
    print(f"ratio: {by_quadrature / closed:.0f}")
    print(f"largest difference of a_l and K: {np.abs(apart).max():.1e}")


if __name__ == "__main__":
    main()
