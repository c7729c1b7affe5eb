# SPDX-License-Identifier: MIT
"""The joint sums of Appl. Sci. 2023, 13, 11680, exactly as printed, with misprints.

Nothing here is to be used for a joint: it is the comparison for `corrected`. Numbers
    are written as in the paper, where its flattened text is legible.
"""

import math
from dataclasses import dataclass

from jointbench.analysis.contact.material import ContactMaterial


@dataclass(frozen=True, slots=True)
class PrintedInputs:
    """The paper's symbols at one state of a joint.

    Attributes:
        D: fractal dimension, of the profile (ch. 3) or of the surface (ch. 4) [-].
        G: fractal roughness [m].
        E: composite modulus [Pa].
        H: hardness [Pa].
        k: hardness over yield strength, eq. (8) [-].
        phi: yield strength over modulus, eq. (9) [-].
        k_mu: friction factor [-].
        gamma: of the Weierstrass-Mandelbrot function [-].
        a_l: largest contact area [m^2].
        a_c: critical contact area [m^2].
    """

    D: float
    G: float
    E: float
    H: float
    k: float
    phi: float
    k_mu: float
    gamma: float
    a_l: float
    a_c: float


def printed_inputs(
    material: ContactMaterial,
    *,
    dimension: float,
    roughness: float,
    gamma: float,
    largest_area: float,
    critical_area: float,
) -> PrintedInputs:
    """Return the paper's symbols from SI quantities; yield strength H/2.8 if none."""
    strength = material.yield_strength or material.hardness / 2.8
    return PrintedInputs(
        D=dimension,
        G=roughness,
        E=material.effective_modulus,
        H=material.hardness,
        k=material.hardness / strength,
        phi=strength / material.effective_modulus,
        k_mu=material.friction_factor,
        gamma=gamma,
        a_l=largest_area,
        a_c=critical_area,
    )


def critical_area_2d(p: PrintedInputs) -> float:
    """Eq. (23) [m^2]."""
    return float(p.G**2 / (p.k * p.phi / 2) ** (2 / (p.D - 1)))


def elastic_load_2d(p: PrintedInputs) -> float:
    """Eq. (24) [N]; E and D, which the print lacks, are restored, R is that of a_l."""
    D = p.D
    R = p.a_l ** (D / 2) / (math.pi**2 * p.G ** (D - 1))
    span = p.a_l**1.5 - p.a_c ** ((3 - D) / 2) * p.a_l ** (D / 2)
    return float((16 - 3 * math.pi) * p.E * D * span / (16 * R * math.pi * (3 - D)))


def first_stage_load_2d(p: PrintedInputs) -> float:
    """Eq. (26) [N]."""
    D = p.D
    scale = 24.7543 * D * p.E**0.85 * p.G ** (0.85 * (D - 1)) * p.H**0.15 * p.k**0.15
    limits = 6 ** ((0.925 * D - 1.425) / (D - 1)) - 1
    scale *= p.a_l ** (0.5 * D) * p.a_c ** (1.425 - 0.925 * D)
    return float(scale * limits / ((37 * D - 57) * math.pi))


def second_stage_load_2d(
    p: PrintedInputs, *, exponent_of_roughness: float = 0.8472
) -> float:
    """Eq. (27) [N]; the exponent of G is printed .8472, dimensions require .472."""
    D = p.D
    scale = 161.8203 * D * p.E**0.472 * p.G ** (exponent_of_roughness * (D - 1))
    scale *= p.H**0.528 * p.k**0.528 * p.a_l ** (0.5 * D)
    scale *= p.a_c ** (1.236 - 0.736 * D)
    power = (0.736 * D - 1.236) / (D - 1)
    return float(scale * (6**power - 110**power) / ((309 - 184 * D) * math.pi))


def plastic_load_2d(p: PrintedInputs) -> float:
    """Eq. (28) [N], as grouped in print: negative."""
    D = p.D
    root = (110 * p.a_c) ** ((D - 2) / (2 * (D - 1)))
    return float(root * D * p.H * p.a_l ** (D / 2) / (D - 2))


def elastic_stiffness(p: PrintedInputs) -> float:
    """Eq. (31) [N/m]; chapter 4 takes it over with the D of the surface."""
    D, power = p.D, (1 - p.D) / 2
    span = p.a_l**power - p.a_c**power
    return float(math.sqrt(3) * p.E * D * p.a_l ** (D / 2) / (2 * (1 - D)) * span)


def first_stage_stiffness_2d(p: PrintedInputs) -> float:
    """Eq. (33) [(N/m)^1.15 m^...: no stiffness by its dimensions]."""
    D = p.D
    scale = 17.6375 * 2**0.85 * 3**0.075 * D * p.E * p.G ** (0.15 * (1 - D))
    scale *= p.H**0.15 * p.a_l ** (0.5 * D) * p.a_c ** (0.5 - 0.425 * D)
    limits = 6 ** ((0.425 * D - 0.5) / (D - 1)) - 1
    return float(scale * limits / ((17 * D - 20) * math.pi))


def second_stage_stiffness_2d(
    p: PrintedInputs, *, coefficient: float = 161.8203
) -> float:
    """Eq. (35); its coefficient is that of eq. (27), for the load."""
    D = p.D
    scale = coefficient * 2**0.472 * 3**0.264 * D * p.E * p.G ** (0.528 * (1 - D))
    scale *= p.H**0.528 * p.a_l ** (0.5 * D) * p.a_c ** (0.5 - 0.236 * D)
    power = (0.236 * D - 0.5) / (D - 1)
    return float(scale * (6**power - 110**power) / ((125 - 59 * D) * math.pi))


def critical_area_3d(p: PrintedInputs) -> float:
    """Eq. (41) [m^2]: pi is inside the bracket and before it."""
    D, power = p.D, 2 / (2 - p.D)
    kappa = 33 * math.pi * p.k_mu * p.phi / 40
    area = 2 ** ((3 * D - 11) / (2 - D)) * kappa**power
    area *= math.pi ** ((4 - D) / (2 - D)) * math.log(p.gamma) ** (1 / (D - 2))
    return float(area * p.G**2)


def first_stage_load_3d(p: PrintedInputs) -> float:
    """Eq. (42) [N]: the distribution and the bounds are those of a profile."""
    D = p.D
    scale = 15.7636 * 2 ** (0.225 - 1.275 * D) * D * p.E * p.G ** (0.85 * D - 1.7)
    scale *= p.a_l ** (0.5 * D) * (p.phi * p.k_mu) ** 0.15
    scale *= math.pi ** (0.425 * D - 1.7) * math.log(p.gamma) ** 0.425
    scale *= p.a_c ** (1.85 - 0.925 * D)
    return float(scale * (6 ** ((0.925 * D - 1.85) / (D - 1)) - 1) / (D - 2))


def second_stage_load_3d(p: PrintedInputs) -> float:
    """Eq. (43) [N]: the distribution and the bounds are those of a profile."""
    D = p.D
    scale = 6.8692 * 2 ** (0.012 - 0.708 * D) * D * p.E * p.G ** (0.472 * D - 0.944)
    scale *= p.a_l ** (0.5 * D) * (p.phi * p.k_mu) ** 0.528
    scale *= math.pi ** (0.236 * D - 0.944) * math.log(p.gamma) ** 0.236
    scale *= p.a_c ** (1.472 - 0.736 * D)
    power = (0.736 * D - 1.472) / (D - 1)
    return float(scale * (110**power - 6**power) / (D - 2))


def first_stage_stiffness_3d(
    p: PrintedInputs, *, exponent_of_area: float = 0.175
) -> float:
    """Eq. (45) [N/m]; the exponent .425 D of the integral is printed .175 D."""
    D = p.D
    scale = 12.9865 * 2 ** (0.725 + 0.225 * D) * D * p.E * p.G ** (0.3 - 0.15 * D)
    scale *= p.a_l ** (0.5 * D) * (p.phi * p.k_mu) ** 0.15
    scale *= p.a_c ** (0.35 - exponent_of_area * D)
    limits = 6 ** ((exponent_of_area * D - 0.35) / (D - 1)) - 1
    below = (17 * D - 14) * math.pi ** (0.075 * D + 0.2)
    return float(scale * limits / (below * math.log(p.gamma) ** 0.075))


def second_stage_stiffness_3d(p: PrintedInputs) -> float:
    """Eq. (46) [N/m]: divided by D - 2 where the integral gives 59 D + 7, no ln."""
    D = p.D
    scale = 24.4098 * 2 ** (0.512 + 0.792 * D) * D * p.E * p.G ** (1.056 - 0.528 * D)
    scale *= p.a_l ** (0.5 * D) * (p.phi * p.k_mu) ** 0.528
    scale *= math.pi ** (0.556 - 0.264 * D) * p.a_c ** (-0.236 * D - 0.028)
    power = (0.236 * D + 0.028) / (D - 1)
    return float(scale * (110**power - 6**power) / (D - 2))
