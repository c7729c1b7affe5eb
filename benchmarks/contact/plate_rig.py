# SPDX-License-Identifier: MIT
"""The marble plates of Appl. Sci. 2025, 15, 9040: predicted and measured."""

import math
from dataclasses import dataclass

import numpy as np
from claim import stiffness

from jointbench.analysis.contact.damping import (
    DampingChoice,
    EnergyForm,
    LossConvention,
    damping_coefficient,
    damping_ratio,
    loss_factor,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.inverse import preload_of
from jointbench.analysis.contact.material import ContactMaterial, effective_modulus
from jointbench.analysis.contact.model_catalogue import contact_model
from jointbench.analysis.contact.solve import solve_largest_area
from jointbench.analysis.contact.torque_to_preload import preload_from_torque
from jointbench.signal.fractal.fractal_fit import fractal_from_line

MEASURED, DAMPING = 2.8667e7, 1.2713e7  # [N/m], [N s/m], both printed
DIMENSION, ROUGHNESS = 1.5404, 9.497e-12  # of a line, printed
YOUNG, POISSON, DENSITY = 55e9, 0.25, 2600.0
LENGTH, WIDTH, HEIGHT = 0.5, 0.3, 0.05
MASS = LENGTH * WIDTH * HEIGHT * DENSITY
HARDNESS = (0.8e9, 1.5e9, 3e9)  # not printed: what marble and granite span
MODELS = ("mb_2d", "modified_2d", "friction_3d", "ke_2d", "ke_3d", "ke_3d_modified")
# Steel, stress area 157 mm^2, clamping two plates of 50 mm [N/m].
BOLTS = 4 * 210e9 * 157e-6 / 0.1
SPOT = 2e-3  # sampling length of a profile [m]
LINES = (
    (0.738, -15.149),
    (0.903, -12.050),
    (1.083, -9.771),
    (0.6741, -16.12),
    (1.198, -7.781),
)
PRELOAD = preload_from_torque(20.0, diameter=0.016, bolts=4).value


@dataclass(frozen=True, slots=True)
class Explanation:
    """Something that would change the prediction, and to what, over hardness [N/m]."""

    name: str
    stiffness: tuple[float, ...]
    note: str

    @property
    def distance(self) -> float:
        """Decades between prediction and measurement, at the middle hardness."""
        if not self.stiffness[1] > 0:
            return math.inf
        return abs(math.log10(self.stiffness[1] / MEASURED))


def marble(hardness: float) -> ContactMaterial:
    """Return two plates of the rig as one material."""
    modulus = effective_modulus(YOUNG, POISSON, YOUNG, POISSON)
    return ContactMaterial(modulus, hardness, POISSON)


def predicted(
    roughness: float, *, name: str = "ke_3d_modified", preload: float = PRELOAD
) -> tuple[float, ...]:
    """Return the joint's stiffness for each hardness [N/m]."""
    low = contact_model(name).topography.lowest_dimension
    return tuple(
        float(stiffness(name, DIMENSION + low - 1, roughness, marble(h), preload))
        for h in HARDNESS
    )


def mean_roughness(*, lag: float = 1.0, height: float = 1.0, ln: bool = False) -> float:
    """Return the mean G of the five lines if their units or logarithms were others [m].

    Args:
        lag: length that was written as 1 on the lag axis [m].
        height: length that was written as 1 on the height axis [m].
        ln: whether the printed numbers are natural logarithms.
    """
    found = []
    for slope, intercept in LINES:
        level = intercept / math.log(10) if ln else intercept
        level += 2 * math.log10(height) - slope * math.log10(lag)
        found.append(fractal_from_line(slope, level, constant="as-printed").roughness)
    return float(np.mean(found))


def explanations() -> list[Explanation]:
    """Return every explanation that changes K(P), the nearest first; none is tuned."""
    found = [*in_series(), *of_the_surface(), *of_the_load()]
    return sorted(found, key=lambda one: one.distance)


def in_series() -> list[Explanation]:
    """Return what may yield beside the contact."""
    contact = predicted(ROUGHNESS)
    bending = 48 * YOUNG * WIDTH * HEIGHT**3 / 12 / LENGTH**3
    return [
        Explanation(
            "the plate bends, in series",
            tuple(1 / (1 / k + 1 / bending) for k in contact),
            f"48 E I/L^3 = {bending:.2g} N/m, supported at its ends; where the bolts "
            "sit is not printed",
        ),
        Explanation(
            "natural logarithms, and the plate bends in series",
            tuple(
                1 / (1 / k + 1 / bending) for k in predicted(mean_roughness(ln=True))
            ),
            "both of the above",
        ),
        Explanation(
            "four M16 bolts, in series",
            tuple(1 / (1 / k + 1 / BOLTS) for k in contact),
            f"E A/l = {BOLTS:.2g} N/m, 0.1 m long; while the joint stays closed they "
            "act beside it, not in series",
        ),
        Explanation(
            "the plate is compressed, in series",
            tuple(1 / (1 / k + HEIGHT / (YOUNG * LENGTH * WIDTH)) for k in contact),
            "E A/h; nothing beside bending",
        ),
    ]


def of_the_surface() -> list[Explanation]:
    """Return other readings of the five fits and of G."""
    return [
        Explanation(
            "the five fits are natural logarithms",
            predicted(mean_roughness(ln=True)),
            f"mean G {mean_roughness(ln=True):.2g} m; a hypothesis, the pivot of the "
            "five lines then is the sampling step",
        ),
        Explanation(
            "lags in um, heights in m",
            predicted(mean_roughness(lag=1e-6)),
            f"mean G {mean_roughness(lag=1e-6):.2g} m: all contacts plastic, no K",
        ),
        Explanation(
            "heights in um, lags in m",
            predicted(mean_roughness(height=1e-6)),
            f"mean G {mean_roughness(height=1e-6):.2g} m: the wrong way",
        ),
        Explanation(
            "lags and heights in um",
            predicted(mean_roughness(lag=1e-6, height=1e-6)),
            f"mean G {mean_roughness(lag=1e-6, height=1e-6):.2g} m: the wrong way",
        ),
        Explanation(
            "the corrected constant of the structure function",
            predicted(float(np.mean([fractal_from_line(*x).roughness for x in LINES]))),
            "makes G smaller, K larger: the wrong way",
        ),
        Explanation(
            "G is printed in mm",
            predicted(1e-3 * ROUGHNESS),
            "the wrong way, as any unit below a metre is",
        ),
    ]


def of_the_load() -> list[Explanation]:
    """Return other readings of what bears the preload."""
    contact = predicted(ROUGHNESS)
    spots = LENGTH * WIDTH / SPOT**2
    alone = predicted(ROUGHNESS, preload=PRELOAD / spots)
    power = math.log(contact[1] / alone[1]) / math.log(spots)
    return [
        Explanation(
            "the preload is shared by spots as long as a profile, 2 mm",
            tuple(spots * k for k in alone),
            f"{spots:.0f} spots of {PRELOAD / spots:.2g} N: K ~ P^{power:.3f}",
        ),
        Explanation(
            "one such spot bears the joint alone",
            alone,
            "no joint, but what one profile's K would be",
        ),
    ]


def needed_preload() -> tuple[float, ...]:
    """Return the preload at which the printed D and G give the measured K [N]."""
    model = contact_model("ke_3d_modified")
    return tuple(
        float(
            preload_of(
                model,
                FractalSurface(
                    np.array(DIMENSION + 1), np.array(ROUGHNESS), np.array(h)
                ),
                marble(h),
                stiffness=MEASURED,
            )
        )
        for h in HARDNESS
    )


def needed_roughness() -> tuple[float, ...]:
    """Return the G that gives the measured K at 25 kN with the printed D [m]."""
    found = []
    for number in range(len(HARDNESS)):
        low, high = 1e-13, 1e-2
        for _ in range(60):
            middle = math.sqrt(low * high)
            stiff = predicted(middle)[number] > MEASURED
            low, high = (middle, high) if stiff else (low, middle)
        found.append(low)
    return tuple(found)


def plausible_damping() -> list[tuple[str, float, float, float]]:
    """Return loss factor, C and damping ratio by form and convention, ln fits' G."""
    model = contact_model("ke_3d_modified")
    hard = 1.5e9
    surface = FractalSurface(
        np.array(DIMENSION + 1), np.array(mean_roughness(ln=True)), np.array(hard)
    )
    solved = solve_largest_area(model, surface, marble(hard), np.array(PRELOAD))
    rows = []
    for form in EnergyForm:
        for convention in LossConvention:
            eta = loss_factor(
                model, surface, marble(hard), solved, form=form, convention=convention
            )
            choice = DampingChoice(mass=MASS, form=form, convention=convention)
            C = float(damping_coefficient(eta, np.array(MEASURED), choice))
            label = f"{form.value}, {convention.value}"
            rows.append((label, float(eta), C, damping_ratio(C, MEASURED, MASS)))
    return rows


def section() -> str:
    """Return the page's section on the rig."""
    text = f"""
## The plate rig

Printed: D = {DIMENSION}, G = {ROUGHNESS:g} m, four M16 bolts at 20 N m (nut factor 0.2:
{PRELOAD / 1e3:g} kN), marble 55 GPa, nu 0.25, 2600 kg/m^3, K = {MEASURED:g} N/m,
C = {DAMPING:g} N s/m. Not printed, so a range: the hardness. Predicted K at 25 kN:

| model | H = 0.8 GPa | 1.5 GPa | 3 GPa | over the measured, 1.5 GPa |
|---|---|---|---|---|
"""
    for name in MODELS:
        values = predicted(ROUGHNESS, name=name)
        cells = " | ".join(f"{v:.3g}" for v in values)
        text += f"| {name} | {cells} | {values[1] / MEASURED:.3g} |\n"
    loads, sizes = sorted(needed_preload()), sorted(needed_roughness())
    text += f"""
The printed D and G give the measured K at a preload of {loads[0] * 1e3:.2g} to
{loads[-1] * 1e3:.2g} mN; at 25 kN it takes G = {sizes[0]:.2g} to {sizes[-1]:.2g} m.
What else could be meant, the nearest first (`ke_3d_modified`); nothing is tuned:

| explanation | K, H = 0.8 | 1.5 | 3 GPa | over the measured, 1.5 GPa | note |
|---|---|---|---|---|---|
"""
    for one in explanations():
        cells = " | ".join(f"{v:.3g}" for v in one.stiffness)
        ratio = one.stiffness[1] / MEASURED
        text += f"| {one.name} | {cells} | {ratio:.3g} | {one.note} |\n"
    zeta = [damping_ratio(DAMPING, MEASURED, m) for m in (MASS, MASS / 2)]
    text += f"""
The damping {DAMPING:g} N s/m is impossible for a hit test: with one plate
({MASS:g} kg) on ground or two free plates the damping ratio is {zeta[0]:.0f} or
{zeta[1]:.0f}: beyond 1 there is no oscillation and no mode to observe.
Read as K eta in N/m it would be eta = {DAMPING / MEASURED:.3f}. Plausible values, from
the same K and mass (loss of a first loading, G of the natural-log reading, H = 1.5 GPa,
an upper bound for a small vibration):

| energies, convention | loss factor | C [N s/m] | damping ratio |
|---|---|---|---|
"""
    for label, eta, C, ratio in plausible_damping():
        if math.isfinite(eta):
            text += f"| {label} | {eta:.3g} | {C:.3g} | {ratio:.3g} |\n"
        else:
            text += f"| {label} | no contact is elastic, nothing stored | - | - |\n"
    return text
