# SPDX-License-Identifier: MIT
"""Every closed form against quadrature of the asperity laws, written independently."""

import math
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS, contact_model

DRAWS = 2000
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
PANELS = 60
BOUNDS = (math.inf, 110.0, 6.0, 1.0, 0.0)
STAGES = {1: (1.40, 1.263), 2: (1.03, 1.425)}


class Draw:
    """One random joint, its asperity laws in terms of radius and interference."""

    def __init__(self, random, name):
        self.name, self.plane = name, "2d" in name
        self.low = 1 if self.plane else 2
        e = random.uniform(0.05, 0.95)
        if random.random() < 0.2:  # on and beside a removable singularity
            e = random.choice([0.5, 20 / 37, 0.65531]) + random.choice(
                [0.0, 1e-9, 1e-5]
            )
        self.e, self.D = e, self.low + e
        self.G = 10 ** random.uniform(-13, -6)
        self.E = 10 ** random.uniform(9.5, 12)
        self.H = self.E * 10 ** random.uniform(-3, -1)
        self.factor, self.nu = random.uniform(0.5, 1.0), random.uniform(0.1, 0.45)
        self.g = math.pi**2 if self.plane else math.pi
        mean = {"mb_2d": 1.0, "modified_2d": 1.0}.get(name, 0.454 + 0.41 * self.nu)
        self.kappa = math.pi * mean * self.H / (2 * self.E)
        if name == "friction_3d":
            self.kappa = 33 * math.pi * self.factor * self.H / 2.8 / (40 * self.E)
        # The largest contact from far inside elastic to far inside plastic.
        self.ratio = 10 ** random.uniform(-3.5, 3.0)

    def depth(self, log_area):
        """Interference, eqs. (15) and (38)."""
        D = self.D
        if self.plane:
            return self.G ** (D - 1) * np.exp((2 - D) / 2 * log_area)
        constant = 2 ** ((11 - 3 * D) / 2) * math.log(1.5) ** 0.5
        constant *= math.pi ** ((D - 3) / 2) * self.G ** (D - 2)
        return constant * np.exp((3 - D) / 2 * log_area)

    def log_critical(self):
        """Return ln of the area whose interference is kappa^2 R, with a = g R delta."""
        unit = 2 * float(np.log(self.depth(0.0))) + math.log(self.g)
        return (unit - 2 * math.log(self.kappa)) / self.e

    def law(self, regime, log_area):
        """Return load and stiffness of contacts in one regime over their area."""
        area, depth = np.exp(log_area), self.depth(log_area)
        if regime == 0 or (self.name == "mb_2d" and regime < 3):
            pressure = (1 if self.plane else 2) * self.H
            return pressure + 0.0 * log_area, 0.0 * log_area
        radius = area / (self.g * depth)
        if regime == 3:
            share = (
                self.share() if "modified" in self.name or "fric" in self.name else 1
            )
            load = 4 / 3 * self.E * radius**0.5 * (share * depth) ** 1.5
            return load / area, 1.5 * load / depth / area
        coefficient, exponent = STAGES[regime]
        critical = self.kappa**2 * radius
        load = coefficient * 4 / 3 * self.E * radius**0.5 * critical**1.5
        load = load * (depth / critical) ** exponent
        return load / area, exponent * load / depth / area

    def share(self):
        """Root of (16/(9 g)) x^3 = (1 - x)^2 between 0 and 1."""
        roots = np.roots([16 / (9 * self.g), -1.0, 2.0, -1.0])
        real = roots[np.abs(roots.imag) < 1e-9].real
        return float(real[(real > 0) & (real < 1)][0])

    def summed(self, which, log_largest):
        """Integrate load (0) or stiffness (1) over the distribution, by regime."""
        q = (1 + self.e) / 2
        critical = self.log_critical()
        edges = [critical - math.log(b) / self.e for b in BOUNDS[1:4]]
        tail = min(edges[0], log_largest) - 76 / (1 - self.e)
        limits = [tail, *(min(x, log_largest) for x in edges), log_largest]

        def integrand(regime, log_area):
            # a n(a) d(ln a) a, in one exponential: the smallest areas underflow.
            number = q * np.exp(q * (log_largest - log_area) + log_area)
            return self.law(regime, log_area)[which] * number

        return [
            panels(partial(integrand, regime), limits[regime], limits[regime + 1])
            for regime in range(4)
        ]

    def closed(self):
        """Return model, surface, material and ln of the largest area for our code."""
        surface = FractalSurface(np.array(self.D), np.array(self.G), np.array(self.H))
        material = ContactMaterial(self.E, self.H, self.nu, friction_factor=self.factor)
        log_largest = self.log_critical() - math.log(self.ratio) / self.e
        return contact_model(self.name), surface, material, np.array(log_largest)


def panels(function, low, high):
    """Integrate by Gauss's rule on many panels."""
    if high <= low:
        return 0.0
    step = (high - low) / PANELS
    start = low + step * np.arange(PANELS)[:, None]
    points = start + step * (NODES + 1) / 2
    return float((function(points) * WEIGHTS).sum() * step / 2)


def reachable(draw):
    """Return whether areas are within the range of doubles."""
    return abs(draw.log_critical()) + abs(math.log(draw.ratio)) / draw.e < 500


@pytest.fixture(scope="module")
def draws():
    """Random joints of all models, the same every time."""
    random = np.random.default_rng(20)
    found = []
    names = list(CONTACT_MODELS)
    while len(found) < DRAWS:
        draw = Draw(random, names[len(found) % len(names)])
        if reachable(draw):
            found.append(draw)
    return found


def test_load_and_stiffness_equal_quadrature_in_two_thousand_joints(draws):
    """All models, dimensions, both sides of every bound: each regime to 1e-9."""
    for draw in draws:
        model, surface, material, log_largest = draw.closed()
        sums = joint_sums(model, surface, material, log_largest)
        loads = draw.summed(0, float(log_largest))
        slopes = draw.summed(1, float(log_largest))
        assert_allclose(sums.load, loads, rtol=1e-9, err_msg=draw.name)
        assert_allclose(sums.stiffness, slopes, rtol=1e-9, err_msg=draw.name)


def test_draws_lie_on_both_sides_of_every_bound(draws):
    """Hundreds of largest contacts in each regime."""
    ratios = np.array([draw.ratio for draw in draws])
    counts = np.histogram(ratios, [0, 1, 6, 110, np.inf])[0]
    assert counts.min() > 100
