# SPDX-License-Identifier: MIT
"""Pressure over a joint: finite elements against boundary elements of layers.

Two plates under four bolts are one cell of a pattern that mirrors itself at its sides:
there the normal displacement of the sides is 0, and the motion of each surface under
a wave of pressure on either surface is known in closed form for every thickness
(Sneddon, Fourier Transforms (1951), sec. 45-46). Short waves see half-spaces.

Run: ``python benchmarks/structures/joint_pressure.py``; it writes
docs/joint-pressure-numbers.md.
"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import ndimage

from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import build_structure
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.pressure.clamped_loads import ClampBolt
from jointbench.analysis.structures.pressure.interface_law import PowerInterface
from jointbench.analysis.structures.pressure.joint_pressure import (
    PressureCase,
    joint_pressure,
)
from jointbench.analysis.structures.pressure.pressure_totals import OPEN

PAGE = Path(__file__).parents[2] / "docs" / "joint-pressure-numbers.md"
MESHES = (10, 14, 18)
MODULUS, POISSON = 200e9, 0.3
SIDE, GRID = 0.2, 80
MIRRORS = ("x+", "x-", "y+", "y-")
STIFF = 1e13


@dataclass(frozen=True)
class Plates:
    """Two plates of one thickness, four bolts at equal distance from the middle."""

    name: str
    thickness: float
    reach: float
    head: float
    preload: float
    stiffness: float
    exponent: float


CASES = (
    Plates("30 mm, soft law", 0.03, 0.05, 0.03, 2e4, 1e13, 0.5),
    Plates("20 mm, stiff law", 0.02, 0.05, 0.03, 2e4, 5e13, 0.5),
    Plates("20 mm, steep law", 0.02, 0.05, 0.03, 4e4, 3e13, 0.8),
    Plates("30 mm, bolts near the sides", 0.03, 0.075, 0.03, 3e4, 5e13, 0.6),
)
"""Reach: of the bolts from the middle along x and y [m]; stiffness at 1 MPa [N/m^3]."""


def finite_elements(case: Plates, cells: int) -> tuple[float, float, float, float]:
    """Return closed share, normal and rocking stiffness, and CPU seconds."""
    begin = time.process_time()
    steel = Material(MODULUS, POISSON, 7850.0, 0.0)
    count = (cells, cells, max(2, cells // 5))
    size = (SIDE, SIDE, case.thickness)
    bodies = [
        solid_body(name, box_mesh(size, count, origin=(0.0, 0.0, level)), steel)
        for name, level in (("upper", 0.0), ("lower", -case.thickness))
    ]
    sides = [
        Support(one.name, face, SupportKind.SPRINGS, (STIFF, 0.0, 0.0))
        for one in bodies
        for face in MIRRORS
    ]
    joint = Joint("plates", ("upper", "lower"))
    structure = build_structure(bodies, [joint], supports=sides)
    law = PowerInterface(case.stiffness, 1e6, case.exponent, 0.8, 0.0, 100.0, 0.0)
    middle = SIDE / 2
    bolts = tuple(
        ClampBolt(
            f"bolt {x} {y}",
            (middle + x * case.reach, middle + y * case.reach),
            case.preload,
            0.0,
            case.head,
            0.0,
        )
        for x in (-1, 1)
        for y in (-1, 1)
    )
    pressed = PressureCase(("upper", "lower"), bolts, lambda at, _: law.law(at))
    found = joint_pressure(structure, "plates", pressed)
    spent = time.process_time() - begin
    return 1 - found.opened, float(found.totals[0]), float(found.totals[2]), spent


def boundary_elements(case: Plates, count: int = GRID) -> tuple[float, float, float]:
    """Return closed share, normal and rocking stiffness of the layers."""
    step = SIDE / count
    # Cells of a quarter; a mirror at each side and in both middles.
    centres = (np.arange(count) + 0.5) * step - SIDE / 2
    x, y = np.meshgrid(centres, centres, indexing="ij")
    wave = 2 * np.pi * np.fft.fftfreq(count, step)
    size = np.hypot(*np.meshgrid(wave, wave, indexing="ij"))
    size[0, 0] = 1.0
    reach = np.minimum(size * case.thickness, 300.0)
    plane = MODULUS / (1 - POISSON**2)
    even = 2 / (plane * size) * (np.cosh(reach) - 1) / (np.sinh(reach) + reach)
    odd = 2 / (plane * size) * (np.cosh(reach) + 1) / (np.sinh(reach) - reach)
    even[0, 0] = odd[0, 0] = 0.0
    # Inward motion of the inner surface: own pressure, and pressure on the outer one.
    own, across = 0.5 * (even + odd), 0.5 * (even - odd)

    def moved(factor: np.ndarray, pressure: np.ndarray) -> np.ndarray:
        return 2 * np.fft.ifft2(factor * np.fft.fft2(pressure)).real

    heads = _heads(case, x, y, step)
    half = count // 2
    quarter = (slice(half, None), slice(half, None))
    area = np.full(half * half, 4 * step**2)
    matrix = np.empty((half * half, half * half))
    for column in range(half * half):
        unit = np.zeros((half, half))
        unit.flat[column] = 1.0
        matrix[:, column] = moved(own, _mirrored(unit))[quarter].ravel()
    outer = moved(across, heads)[quarter].ravel()
    pressure = _complementary(case, matrix, -outer, area)
    stiffness = case.stiffness * (pressure / 1e6) ** case.exponent
    mean = float(area @ pressure) / SIDE**2
    # The edge of the patch is finer than the cells: straight between their centres.
    fine = ndimage.zoom(
        pressure.reshape(half, half), 8, order=1, grid_mode=True, mode="nearest"
    )
    closed = float((fine >= OPEN * mean).mean())
    arm = (y[quarter] ** 2).ravel()
    return closed, float(area @ stiffness), float(area @ (stiffness * arm))


def _mirrored(quarter: np.ndarray) -> np.ndarray:
    right = np.concatenate([quarter[::-1], quarter], axis=0)
    return np.concatenate([right[:, ::-1], right], axis=1)


def _heads(case: Plates, x: np.ndarray, y: np.ndarray, step: float) -> np.ndarray:
    """Return the pressure below the heads, cells cut by an edge in part [Pa]."""
    fine = (np.arange(8) + 0.5) / 8 * step - step / 2
    covered = np.zeros_like(x)
    for a in fine:
        for b in fine:
            from_bolt = np.hypot(np.abs(x + a) - case.reach, np.abs(y + b) - case.reach)
            covered += from_bolt <= case.head / 2
    return covered * 4 * case.preload / (covered.sum() * step**2)


def _complementary(
    case: Plates, matrix: np.ndarray, free: np.ndarray, area: np.ndarray
) -> np.ndarray:
    """Return pressures p >= 0 with approach(p) + G p - free = c where p > 0 [Pa]."""
    force = 4 * case.preload
    least = 1e-6 * force / area.sum()
    pressure = np.full(area.size, force / area.sum())
    constant = 0.0
    for _ in range(200):
        slope = case.stiffness * (np.maximum(pressure, least) / 1e6) ** case.exponent
        approach = pressure / (slope * (1 - case.exponent))
        on = pressure > 0
        inside = matrix[np.ix_(on, on)] + np.diag(1 / slope[on])
        count = int(on.sum())
        system = np.block([[inside, -np.ones((count, 1))], [area[on], np.zeros(1)]])
        residual = free - approach - matrix @ pressure
        right = np.append(residual[on] + constant, force - area @ pressure)
        # The constant is the approach of the plates: its change is solved for.
        answer = np.linalg.solve(system, right)
        new = pressure.copy()
        new[on] = np.clip(
            pressure[on] + answer[:-1], 0.1 * pressure[on], 10 * pressure[on]
        )
        constant += answer[-1]
        new[new < least] = 0.0
        back = (~on) & (free + constant - matrix @ new > 0)
        new[back] = 2 * least
        change = np.abs(new - pressure).sum() / new.sum()
        pressure = new
        if change < 1e-7:
            return pressure
    raise RuntimeError(f"{case.name}: the boundary elements did not settle")


def main() -> None:
    """Run every case on every mesh, and write the page."""
    rows, widest, spread = [], np.zeros(3), np.zeros(3)
    for case in CASES:
        reference = np.array(boundary_elements(case))
        coarse = np.array(boundary_elements(case, GRID * 3 // 4))
        found = np.array([finite_elements(case, cells) for cells in MESHES])
        off = found[:, :3] / reference - 1
        widest = np.maximum(widest, np.abs(off[-1]))
        spread = np.maximum(
            spread, np.abs(np.ptp(found[:, :3], axis=0) / found[-1, :3])
        )
        own = np.abs(coarse / reference - 1).max()
        rows.append(
            f"| {case.name} | reference, {GRID} x {GRID} | {100 * reference[0]:.2f} | "
            f"{reference[1]:.4g} | {reference[2]:.4g} | {100 * own:.2f} % from "
            f"{GRID * 3 // 4} x {GRID * 3 // 4} |"
        )
        for cells, one, part in zip(MESHES, found, off, strict=True):
            rows.append(
                f"| | {cells} x {cells} cells | {100 * one[0]:.2f} "
                f"({100 * part[0]:+.2f} %) | {one[1]:.4g} ({100 * part[1]:+.2f} %) | "
                f"{one[2]:.4g} "
                f"({100 * part[2]:+.2f} %) | {one[3]:.0f} CPU s |"
            )
        sys.stdout.write("\n".join(rows[-4:]) + "\n")
        sys.stdout.flush()
    PAGE.write_text(_page(rows, widest, spread), encoding="utf-8")


def _page(rows: list[str], widest: np.ndarray, spread: np.ndarray) -> str:
    head = """# Pressure over a joint: numbers
Written by `python benchmarks/structures/joint_pressure.py`; the command is described in [joint-pressure.md](joint-pressure.md).

Two steel plates of 200 x 200 mm under four heads of 30 mm, one cell of a pattern with mirrors at its sides. **Reference**: boundary elements, as the
half-space ones of `pressure-map` but with the closed influence of elastic layers of finite thickness: a half-space has no second surface for a bolt head to press on, and the
layer becomes a half-space for waves shorter than its thickness. It shares no code with the finite elements; the law enters without its straight
start. Both are without friction. **Closed**: at least 1 % of the mean pressure.

| plates | | closed [%] | normal [N/m] | rocking [N m/rad] | |
|---|---|---|---|---|---|
"""  # noqa: E501
    names = ("closed area", "normal stiffness", "rocking stiffness")
    bars = (5, 10, 10)
    lines = [
        f"| {name} | {100 * a:.2f} % | {bar} % | {100 * b:.2f} % | 2 % |"
        for name, a, b, bar in zip(names, widest, spread, bars, strict=True)
    ]
    cells = ", ".join(map(str, MESHES))
    tail = [
        "",
        "| largest of all plates | finest mesh off the reference | wanted | "
        f"between meshes of {cells} cells a side | wanted |",
        "|---|---|---|---|---|",
        *lines,
        "",
    ]
    return head + "\n".join([*rows, *tail])


if __name__ == "__main__":
    main()
