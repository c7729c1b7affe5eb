# SPDX-License-Identifier: MIT
"""What Appl. Sci. 2023, 13, 11680 says of joints, each claim computed again."""

import math

import numpy as np
from claim import (
    CANNOT,
    CORRECTED,
    DOES_NOT,
    REPRODUCES,
    Claim,
    between,
    stiffness,
)

from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.printed_formulas import PrintedTerm, printed_terms

PAPER = "2023"
# Fig. 7: E = 69.3 GPa, nu = 0.25, HB = 231.
IRON = ContactMaterial(69.3e9, 231 * 9.80665e6, 0.25)
STATES_2D = ((1.3, 1e-9), (1.5, 1e-10), (1.7, 1e-9), (1.8, 1e-9))
STATES_3D = ((2.3, 1e-9), (2.4, 1e-9), (2.54, 1e-11), (2.7, 1e-9))
LOADS = np.logspace(2, 4, 21)
ROUGHNESS = np.logspace(-12, -8, 21)


def claims() -> list[Claim]:
    """Return every claim of the paper that is about a joint's contact."""
    return [
        *equations("modified_2d", STATES_2D),
        *equations("friction_3d", STATES_3D),
        *figure_7_and_10(),
        *figures_8_to_12(),
        *table_1(),
    ]


def equations(name: str, states: tuple[tuple[float, float], ...]) -> list[Claim]:
    """Return the printed sums, each with its factor to the mended one."""
    rows: dict[int, list[PrintedTerm]] = {}
    for dimension, roughness in states:
        for term in printed_terms(
            name,
            dimension=dimension,
            roughness=roughness,
            material=IRON,
            largest_area=max(3 * critical(name, dimension, roughness), 1e-9),
        ):
            rows.setdefault(term.equation, []).append(term)
    return [equation(name, terms) for terms in rows.values()]


def critical(name: str, dimension: float, roughness: float) -> float:
    """Return the critical area, from any state of the model."""
    terms = printed_terms(
        name,
        dimension=dimension,
        roughness=roughness,
        material=IRON,
        largest_area=1e-9,
    )
    return terms[0].mended


def equation(name: str, terms: list[PrintedTerm]) -> Claim:
    """Return one equation over all states."""
    first = terms[0]
    what = f"eq. ({first.equation}), {first.quantity} of {name}"
    sizes = between([term.factor for term in terms])
    evidence = f"printed over the correct sum of the same laws: {sizes}"
    if not first.fault:
        return Claim(PAPER, what, "a closed form", REPRODUCES, evidence)
    return Claim(PAPER, what, "a closed form", CORRECTED, f"{first.fault}; {evidence}")


def figure_7_and_10() -> list[Claim]:
    """Return the trends of both figures: with load, with G, with D."""
    found = []
    for number, name, low in ((7, "modified_2d", 1), (10, "friction_3d", 2)):
        rising = all(
            np.all(np.diff(stiffness(name, low + e, 1e-9, IRON, LOADS)) >= 0)
            for e in (0.1, 0.3, 0.5, 0.7, 0.9)
        )
        falling = all(
            np.all(np.diff(stiffness(name, low + e, ROUGHNESS, IRON, 1e3)) <= 0)
            for e in (0.1, 0.3, 0.5, 0.7, 0.9)
        )
        D = low + np.linspace(0.3, 0.97, 671)
        best = [
            D[np.argmax(stiffness(name, D, g, IRON, p))]
            for g in (1e-12, 1e-10, 1e-9, 1e-8)
            for p in (1e2, 1e4)
        ]
        seed = [
            D[np.argmax(stiffness(name, D, g, IRON, 1e3, mode="as-printed"))]
            for g in (1e-12, 1e-8)
        ]
        none = stiffness(name, low + 0.1, 1e-9, IRON, 1e4)
        where = f"Fig. {number} ({name})"
        found += [
            Claim(
                PAPER,
                where,
                "K rises with the normal load",
                REPRODUCES if rising else DOES_NOT,
                "five D, 0.1 to 10 kN, G = 1 nm; where all contacts are plastic K is "
                f"0 and stays 0 (D = {low + 0.1:g} at 10 kN: {float(none):g} N/m)",
            ),
            Claim(
                PAPER,
                where,
                "K falls as G rises",
                REPRODUCES if falling else DOES_NOT,
                "five D, G = 1 pm to 10 nm, 1 kN",
            ),
            Claim(
                PAPER,
                where,
                "K rises with D",
                CORRECTED,
                f"only up to D = {between(best)} (G 1 pm to 10 nm, 0.1 and 10 kN), "
                f"{between(seed)} with the paper's exponent 1.236: beyond it more and "
                "more of the load is borne by plastic contacts, and K falls",
            ),
        ]
    return found


def figures_8_to_12() -> list[Claim]:
    """Return the comparisons between models, and with other people's data."""
    ratio = stiffness("modified_2d", 1.7, 1e-9, IRON, LOADS) / stiffness(
        "mb_2d", 1.7, 1e-9, IRON, LOADS
    )
    plane = [
        stiffness("friction_3d", 1 + d, 1e-9, IRON, LOADS)
        / stiffness("modified_2d", d, 1e-9, IRON, LOADS)
        for d in (1.4, 1.54, 1.7)
    ]
    flat = between([x for ratios in plane for x in ratios])
    lost = [float(stiffness("friction_3d", 2.1, 1e-9, IRON, p)) for p in (1e2, 1e6)]
    needed = soft_enough()
    return [
        Claim(
            PAPER,
            "Fig. 8",
            "the modified model is nearer to measured data than MB",
            CANNOT,
            "the data are another paper's and not given; modified/MB is "
            f"{between(list(ratio))} at D = 1.7, G = 1 nm, 0.1 to 10 kN",
        ),
        Claim(
            PAPER,
            "Fig. 9",
            "the 3D surface is smoother with D",
            CORRECTED,
            "its amplitude L (G/L)^(D-2) is: "
            f"{0.89 * (1.36e-7 / 0.89) ** 0.1:.3g} m at D = 2.1, "
            f"{0.89 * (1.36e-7 / 0.89) ** 0.8:.3g} m at 2.8; its spectrum is flatter, "
            "and two ridges (M = 2) are no isotropic surface",
        ),
        Claim(
            PAPER,
            "Fig. 10, 11a",
            "a finite K at D = 2.1",
            DOES_NOT,
            f"K = {lost[0]:g} and {lost[1]:g} N/m at 0.1 kN and 1 MN with "
            "sigma_y = H/2.8: every contact is fully plastic; K appears at 1 kN only "
            f"from phi = {needed:.3g} on (0.0117 with these numbers)",
        ),
        Claim(
            PAPER,
            "Fig. 11",
            "the same trend as a model of reference [22]",
            CANNOT,
            "that model is not given, and the value of phi is unreadable ('= 2.5')",
        ),
        Claim(
            PAPER,
            "Fig. 12",
            "the 3D model gives a larger K than the 2D model of ch. 3",
            DOES_NOT,
            f"friction_3d/modified_2d at equal load is {flat} (D = 1.4, 1.54, 1.7 and "
            "one more, G = 1 nm, 0.1 to 10 kN); with the printed sums of ch. 4, wrong "
            "by up to a million, anything can be had",
        ),
    ]


def soft_enough() -> float:
    """Return the smallest phi = sigma_y/E at which D = 2.1 has a stiffness at 1 kN."""
    low, high = 0.01, 1.0
    for _ in range(40):
        middle = math.sqrt(low * high)
        material = ContactMaterial(
            IRON.effective_modulus,
            IRON.hardness,
            0.25,
            yield_strength=middle * IRON.effective_modulus,
        )
        some = float(stiffness("friction_3d", 2.1, 1e-9, material, 1e3)) > 0
        low, high = (low, middle) if some else (middle, high)
    return high


def table_1() -> list[Claim]:
    """Return the natural frequencies and the identified stiffnesses."""
    measured = np.array([48.7, 166.5, 310.7])
    with_joint = 100 * (np.array([48.8, 165.8, 313.6]) / measured - 1)
    glued = 100 * (np.array([402.1, 842.5, 1068.9]) / measured - 1)
    masses = np.array([1.68e10, 2.46e7, 6.16e8]) / (2 * math.pi * measured) ** 2
    return [
        Claim(
            PAPER,
            "Table 1",
            "considering the joint is closer to experiment",
            REPRODUCES,
            "errors " + ", ".join(f"{x:+.1f} %" for x in with_joint) + "; glued "
            "together " + ", ".join(f"{x:+.0f} %" for x in glued),
        ),
        Claim(
            PAPER,
            "sec. 2.2, K = 1.68e10, 2.46e7, 6.16e8 N/m",
            "identified from the three frequencies",
            CANNOT,
            "the finite-element model is not given; K = m omega^2 would ask for masses "
            f"of {masses[0]:.2g}, {masses[1]:.2g} and {masses[2]:.2g} kg; the "
            "tangential over normal 0.0015 and 0.037 are far from Mindlin's 0.86",
        ),
    ]
