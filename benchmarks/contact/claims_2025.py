# SPDX-License-Identifier: MIT
"""What Appl. Sci. 2025, 15, 9040 says of joints, each claim computed again."""

import math

import numpy as np
import plate_rig as rig
from claim import (
    CANNOT,
    CORRECTED,
    DOES_NOT,
    REPRODUCES,
    Claim,
    stiffness,
)
from printed_errors import what_errors_ask

from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.inverse import largest_area_of_real_area
from jointbench.analysis.contact.joint_sums import joint_sums
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.models import interaction_share
from jointbench.analysis.contact.torque_to_preload import preload_from_torque
from jointbench.signal.fractal.fractal_fit import fractal_from_line

PAPER = "2025"
TRIO = ("ke_2d", "ke_3d", "ke_3d_modified")
DIMENSIONS = (1.4, 1.54, 1.7)


def claims() -> list[Claim]:
    """Return every claim of the paper that a computation can reach."""
    return [*single(), *figure_3(), *fits(), *figure_9(), *machine()]


def single() -> list[Claim]:
    """Return the formulas of one asperity and of the distribution."""
    share = 3 * math.pi / 16
    own = interaction_share(contact_model("ke_3d_modified"))
    by_depth = (1 - share) * math.sqrt(math.pi) * 0.75 / share**1.5
    return [
        Claim(
            PAPER,
            "eqs. (1)-(5)",
            "interaction leaves 3 pi/16 of the deformation, k = sqrt(3)/2 E sqrt(a)",
            DOES_NOT,
            f"Hertz and eq. (2) together ask {own:.4f}, not {share:.4f}, in the "
            f"geometry a = pi R delta; at 3 pi/16 one load is {by_depth:.3f} times "
            "the other, and k is no derivative of either",
        ),
        Claim(
            PAPER,
            "eq. (6)",
            "the distribution of contact areas",
            CORRECTED,
            "(D - 1)/4 must be (D - 1)/2 for one contact of the largest area: f = 1, "
            "not 1/2",
        ),
        Claim(
            PAPER,
            "eq. (7)",
            "A_r = (D - 1) a_l/(2 (3 - D))",
            CORRECTED,
            "the lower limit is 0, not a_c, and f = 1/2 as in eq. (6)",
        ),
        Claim(
            PAPER,
            "eq. (8)",
            "the total stiffness, three coefficients",
            REPRODUCES,
            "0.4330, 0.4894, 0.2300 from its own laws (0.433, 0.4894, 0.2301 printed) "
            "with f = 1/2, exponent 1.236, yield as in CEB and bounds 1/(D-2), where "
            "the limits of its integrals print 1/(D-1)",
        ),
    ]


def at_equal_area(name: str, dimension: float, real_area: float, mode: str) -> float:
    """Return K at a real contact area, G = 1e-10 m, the rig's marble."""
    model = contact_model(name, mode)
    hard = 1.5e9
    surface = FractalSurface(
        np.array(dimension + model.topography.lowest_dimension - 1),
        np.array(1e-10),
        np.array(hard),
    )
    largest = largest_area_of_real_area(model, surface, real_area)
    sums = joint_sums(model, surface, rig.marble(hard), np.log(largest))
    return float(sums.stiffness.sum())


def figure_3() -> list[Claim]:
    """Return the ranking of three models, at equal real area and at equal load."""
    found = []
    for mode in ("corrected", "as-printed"):
        area = {
            d: [at_equal_area(name, d, 1e-6, mode) for name in TRIO] for d in DIMENSIONS
        }
        load = {
            d: [
                float(
                    stiffness(
                        name,
                        d + (0 if name == "ke_2d" else 1),
                        1e-10,
                        rig.marble(1.5e9),
                        1e3,
                        mode=mode,
                    )
                )
                for name in TRIO
            ]
            for d in DIMENSIONS
        }
        for what, values in (("equal A_r = 1 mm^2", area), ("equal load 1 kN", load)):
            ranked = all(v[0] < v[1] < v[2] for v in values.values())
            detail = "; ".join(
                f"D = {d}: 3D/2D {v[1] / v[0]:.3f}, modified/3D {v[2] / v[1]:.3f}"
                for d, v in values.items()
            )
            found.append(
                Claim(
                    PAPER,
                    f"Fig. 3, {mode}",
                    f"2D < 3D < modified 3D at {what}",
                    REPRODUCES if ranked else DOES_NOT,
                    detail,
                )
            )
    return found


def fits() -> list[Claim]:
    """Return the five fits and what follows from them."""
    printed = [fractal_from_line(*x, constant="as-printed") for x in rig.LINES]
    G = np.array([one.roughness for one in printed])
    D = np.array([one.dimension for one in printed])
    mended = np.mean([fractal_from_line(*x).roughness for x in rig.LINES])
    slope, intercept = np.array(rig.LINES).T
    pivot = -np.polyfit(slope, intercept, 1)[0]
    together = np.corrcoef(slope, intercept)[0, 1]
    return [
        Claim(
            PAPER,
            "Fig. 5, 6",
            "five profiles of 2 mm",
            CANNOT,
            "the heights are not published; resolution and scale of the microscope are "
            "printed as 0.01 and 0.1 nm",
        ),
        Claim(
            PAPER,
            "Fig. 7, 8, D",
            "mean D = 1.5404",
            REPRODUCES,
            f"{D.mean():.5f} from the five slopes, {D.min():.3f} to {D.max():.3f}",
        ),
        Claim(
            PAPER,
            "Fig. 7, 8, G",
            "mean G = 9.497e-12 m",
            CORRECTED,
            f"{G.mean():.4g} m as an arithmetic mean with C as printed; they span "
            f"{G.min():.2g} to {G.max():.2g} m, geometric mean "
            f"{np.exp(np.log(G).mean()):.3g}, median {np.median(G):.3g}; with the "
            f"corrected C, which is for cos(2 pi gamma^n x), {mended:.3g} m",
        ),
        Claim(
            PAPER,
            "Fig. 7, the five lines",
            "structure functions of like surfaces, in lg",
            DOES_NOT,
            f"slope and intercept correlate {together:.3f}: all lines meet at "
            f"lg tau = {pivot:.1f}, {10**pivot:.1g} m; read as natural logarithms "
            f"they meet at {math.exp(pivot):.2g} m, the sampling step",
        ),
    ]


def figure_9() -> list[Claim]:
    """Return the errors of three models against the test, and what they ask for."""
    rows = []
    for hard in rig.HARDNESS:
        values = [
            float(
                stiffness(
                    name,
                    rig.DIMENSION + (0 if name == "ke_2d" else 1),
                    rig.ROUGHNESS,
                    rig.marble(hard),
                    rig.PRELOAD,
                )
            )
            for name in TRIO
        ]
        rows.append((values[1] / values[0], values[2] / values[1], values[1]))
    ratios = np.array(rows)
    torque = [
        float(
            stiffness(
                "ke_3d_modified",
                rig.DIMENSION + 1,
                rig.ROUGHNESS,
                rig.marble(1.5e9),
                preload_from_torque(t, diameter=0.016, bolts=4).value,
            )
        )
        for t in (20.0, 50.0, 80.0)
    ]
    return [
        Claim(
            PAPER,
            "Fig. 9, stiffness",
            "errors 62.97, 25.21, 15.97 % of 2D, 3D and modified 3D",
            DOES_NOT,
            f"with the printed D and G the predictions are {ratios[:, 2].min():.2g} to "
            f"{ratios[:, 2].max():.2g} N/m (ke_3d), a million times the test. "
            + what_errors_ask(ratios[:, 0], ratios[:, 1])
            + "; near the test value no contact is elastic and the last step changes "
            "nothing",
        ),
        Claim(
            PAPER,
            "Fig. 9, three torques",
            "averages over 20, 50 and 80 N m",
            CANNOT,
            "test values at 50 and 80 N m are not printed; ke_3d_modified gives "
            + ", ".join(f"{k:.3g}" for k in torque)
            + " N/m",
        ),
        Claim(
            PAPER,
            "Fig. 9, damping",
            "errors 61.72, 29.74, 16 %",
            CANNOT,
            "no damping law is printed (only eta = W_d/W_e), and the measured "
            f"{rig.DAMPING:g} N s/m is impossible, see below",
        ),
    ]


def machine() -> list[Claim]:
    """Return the printed joints of the GP300 and the response under grinding load."""
    bed, guide = (
        (8.762e9, 9.887e6, 1.615e5, 6.873e5, 6.000e5, 2.957e5),
        (5.003e5, 8.977e7, 5.197e5, 5.753e5, 2.861e5, 2.719e5),
    )

    def words(joint: tuple[float, ...]) -> str:
        kn, kx, ky, cn, cx, cy = joint
        times = (cn / kn, cx / kx, cy / ky)
        return (
            f"K_t/K_n = {kx / kn:.2g} and {ky / kn:.2g}; C/K = "
            + ", ".join(f"{t:.2g}" for t in times)
            + " s"
        )

    at_50 = 2 * math.pi * 50 * bed[3] / bed[0]
    return [
        Claim(
            PAPER,
            "sec. 4, bed joint",
            "six characteristic parameters",
            CANNOT,
            f"{words(bed)}; Mindlin's ratio is 0.86 (nu 0.25), so the identification "
            "was blind to some of them; only the normal C/K is plausible (loss factor "
            f"{at_50:.3f} at 50 Hz)",
        ),
        Claim(
            PAPER,
            "sec. 4, guide joint",
            "six characteristic parameters",
            CANNOT,
            f"{words(guide)}: 179 times stiffer along than across, and the normal "
            "stiffness of a weak spring; bolts, materials and surfaces are not given",
        ),
        Claim(
            PAPER,
            "Fig. 12",
            "largest displacement at 33 s under sin(100 t)",
            DOES_NOT,
            f"a linear model repeats every {2 * math.pi / 100 * 1e3:.0f} ms in steady "
            "state; a maximum over 60 s is its start-up or an artefact of the steps",
        ),
    ]
