# SPDX-License-Identifier: MIT
"""A reduced machine against its unreduced matrices, and transients in time.

The grinder of the examples with plausible and with printed joint values: frequencies
and tool receptance from sparse solves of the whole machine; the motion under the load
by the matrix exponential of the state matrix, step by step.

python benchmarks/structures/machine_numbers.py [--page docs/machine-numbers.md]
"""

import argparse
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine_claims import BED, GUIDE, MODEL
from scipy import sparse
from scipy.linalg import expm
from scipy.sparse.linalg import splu

from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
    VariantState,
    jointed,
    lean_machine,
)
from jointbench.analysis.structures.machine.loads import HarmonicLoad
from jointbench.analysis.structures.machine.machine_parts import JointSetting, Machine
from jointbench.analysis.structures.machine.reduce_machine import reduce_machine
from jointbench.analysis.structures.machine.tool_bound import tool_bound
from jointbench.analysis.structures.machine.transient import transient
from jointbench.analysis.structures.matrices.structure import pick
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.station.files.toml_file import read_toml
from jointbench.station.machine.machine_file import MachineModel, machine_of

LINES = (0.0, 1.0, 5.0, 16.0, 50.0, 120.0, 200.0, 300.0, 400.0)
# Of a sparse solve, relative to the largest receptance.
ROUNDING = 1e-9
MODES, RATE, AMPLITUDE = 10, 100.0, (100.0, 120.0, 280.0)
INTRODUCTION = """# A reduced machine in numbers

Made by `benchmarks/structures/machine_numbers.py` from `examples/grinder.toml` without
loss of the bodies ({freedoms:,} degrees of freedom, band {band:g} Hz). Differences are
relative: of ten frequencies from those of the whole mesh; of the tool receptance (nine
lines from 0 to 400 Hz, largest of the 3 x 3 entries over the largest) from sparse
solves of the whole, with its bound; of two seconds of the tool's motion at 1 ms under (100, 120, 280) N
sin(100 t) from the matrix exponential of the state matrix, over the largest
displacement. CPU is one thread, in seconds.

| joints | frequencies | receptance | its bound | motion, all poles | motion, 80 poles | reduction | 60 s at 1 ms, 80 poles |
|---|---|---|---|---|---|---|---|
"""  # noqa: E501


def by_exponential(state: VariantState, count: int, step: float) -> np.ndarray:
    """Return the motion from rest by the exponential of state and load together."""
    size = state.eigenvalue.size
    omega = np.sqrt(state.eigenvalue)
    whole = np.zeros((2 * size + 2, 2 * size + 2))
    whole[:size, size : 2 * size] = np.diag(omega)
    whole[size : 2 * size, :size] = -np.diag(omega)
    whole[size : 2 * size, size : 2 * size] = -state.damping
    # The last two states are the sine and the cosine of the load.
    whole[size : 2 * size, -2] = state.rows.T @ np.array(AMPLITUDE)
    whole[-2, -1], whole[-1, -2] = RATE, -RATE
    advance = expm(whole * step)
    now = np.zeros(2 * size + 2)
    now[-1] = 1.0
    found = np.zeros((3, count))
    for at in range(count):
        found[:, at] = state.rows @ (now[:size] / omega)
        now = advance @ now
    return found


def receptance_error(
    machine: Machine, lean: LeanMachine, state: VariantState
) -> tuple[float, float]:
    """Return the largest relative difference from sparse solves, and its bound."""
    structure, reduced = machine.structure, lean.machine
    point = machine.points["tool"]
    rows = pick(structure, point.body, point.position)
    stiffness = structure.with_joints(reduced.stiffness)
    damping = sum(
        c * one for c, one in zip(reduced.damping, structure.spread, strict=True)
    )
    bound = tool_bound(lean, jointed(reduced), state, "tool", np.array(LINES))
    worst, largest = 0.0, 0.0
    for at, line in enumerate(LINES):
        s = 2j * np.pi * line
        dynamic = stiffness + s * damping + s * s * structure.mass
        solve = splu(sparse.csc_array(dynamic.astype(complex))).solve
        exact = rows @ solve(rows.T.toarray().astype(complex))
        found = state.poles.receptance(np.array([line]))[:, :, 0]
        size = np.abs(exact).max()
        error = np.abs(found - exact)
        if np.any(error > bound[:, :, at] + ROUNDING * size):
            raise AssertionError(f"the bound is broken at {line} Hz")
        worst = max(worst, float(error.max() / size))
        largest = max(largest, float(bound[:, :, at].max() / size))
    return worst, largest


def row(name: str, machine: Machine, band: float) -> str:
    """Return the row of one set of joint values."""
    start = time.process_time()
    reduced = reduce_machine(machine, band)
    lean = lean_machine(reduced, band)
    spent = time.process_time() - start
    state = lean.state(jointed(reduced))
    whole = solve_full(machine.structure, reduced.stiffness, MODES).natural_frequency
    level = np.sqrt(state.eigenvalue[:MODES]) / (2 * np.pi)
    poles = state.poles
    loads = [HarmonicLoad(at, size, RATE) for at, size in enumerate(AMPLITUDE)]
    errors = []
    exact = by_exponential(state, 2001, 1e-3)
    for some in (poles, poles.lowest(80)):
        _, found = transient(some, loads, duration=2.0, step=1e-3)
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    error, bound = receptance_error(machine, lean, state)
    start = time.process_time()
    transient(poles.lowest(80), loads, duration=60.0, step=1e-3)
    taken = time.process_time() - start
    return (
        f"| {name} | {np.abs(level / whole - 1).max():.1e} | "
        f"{error:.1e} | {bound:.1e} | {errors[0]:.1e} | "
        f"{errors[1]:.1e} | {spent:.1f} | {taken:.3f} |\n"
    )


def printed(names: list[str]) -> Mapping[str, JointSetting]:
    """Return the printed values: the bed's at all joints but the guide."""
    return {name: GUIDE if name == "guide" else BED for name in names}


def main() -> None:
    """Compare both sets of values and write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    model = read_toml(MODEL, MachineModel)
    lossless = {
        name: one.model_copy(update={"loss_factor": 0.0})
        for name, one in model.materials.items()
    }
    model = model.model_copy(update={"materials": lossless})
    machine = machine_of(model, MODEL.parent)
    band = model.analysis.band
    page = INTRODUCTION.format(freedoms=machine.structure.size, band=band)
    page += row("plausible", machine, band)
    settings = printed(list(machine.structure.joints))
    page += row("printed", replace(machine, settings=settings), band)
    print(page)
    if options.page is not None:
        options.page.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
