# SPDX-License-Identifier: MIT
"""Identified joints beside the contact law: simulated plates, and printed numbers.

The simulated plates are measured through the chassis of `jointbench measure`, hit by
hit, at 20, 50 and 80 N m; nothing of the identification is known to them, nor the
other way round. The faces are profiles of the Weierstrass-Mandelbrot function, as an
instrument would export them. No parameter is fitted to make law and joint agree.

OMP_NUM_THREADS=1 python benchmarks/structures/theory.py [--session plates.h5]
    [--page FILE]
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from cases import MARBLE, PLATE
from scipy import sparse
from scipy.io import mmwrite

from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.structures.matrices.element_assembly import Sparse, assemble
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh
from jointbench.simulators.plates.plates import (
    POINTS,
    REFERENCE_TORQUE,
    PlatesDesign,
)
from jointbench.station.commands.identify.identify_structure_command import (
    run_identify_structure,
)
from jointbench.station.joints.contact_comparison import against_theory, theory_json
from jointbench.station.joints.structure_contact import TheoryTable
from jointbench.station.joints.theory_records import (
    IdentifiedState,
    JointQuantity,
    StateEstimate,
)
from jointbench.station.measure.bench_session import run_measure

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from weierstrass_surfaces import weierstrass_profile

PLAN = Path(__file__).parents[2] / "examples" / "plates.toml"
TORQUES = (20.0, 50.0, 80.0)
BAND = "100:2900"
CELLS = (10, 6, 2)
BOLTS = ((0.15, 0.2), (0.85, 0.2), (0.15, 0.8), (0.85, 0.8))
FEET = ((0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9))
SPOT = 0.02
# Holds the middle plane in its plane, as the simulator's plates are held [N/m a node].
HELD = 1e10
DIMENSION, ROUGHNESS = 1.54, 1e-9
PRINTED_STIFFNESS, PRINTED_DAMPING = 2.8667e7, 1.2713e7
CONTACT = {
    "modulus": "29.3 GPa",
    "hardness": "1.5 GPa",
    "hardness_sd": "30 %",
    "bolts": 4,
    "diameter": "16 mm",
    "nut_factor": 0.2,
    "nut_factor_sd": 0.03,
}
INTRODUCTION = """# Identified joints compared with the contact law

Made by `benchmarks/structures/theory.py`. Values have 95 % intervals; "x" is
predicted over identified. The comparison follows Fig. 9 of Appl. Sci. 2025, 15, 9040.

## The simulated plates, end to end

`jointbench measure examples/plates.toml` on `sim:plates?seed=1`, then `jointbench
identify MODEL plates.h5 --surface face-a.csv --surface face-b.csv`. The simulator's
joint has four springs at the bolts whose stiffness grows as torque^0.4, so the true
value is known. Its plates bend but do not move or stretch in their own plane; the model
(hex20 plates with {size} degrees of freedom together, separate matrices) constrains
their middle planes in the same way. The assumed errors are 0.5 % for frequencies and
5 % for damping ratios (about the difference between mesh and plate theory).
Verdict: {verdict}.
The surfaces are synthetic (D = 1.54, G = 1 nm each) and unrelated to the simulator's
springs, so this table should show that law and joint disagree. The tangential stiffness
is too large, increasingly with torque: the mesh is compliant around the bolt patches
(8 G r/(2 - nu) per side, about 4e9 N/m in total, in series), whereas the simulator's
point springs on plates are not. In the normal direction the difference is 2 to 5 %.

"""
HEAD = (
    "| quantity | T [N m] | truth | identified | "
    + " | ".join(f"{one}, predicted" for one in ("ke_2d", "ke_3d", "ke_3d_modified"))
    + " |\n|---|---|---|---|---|---|---|\n"
)


def write_model(folder: Path) -> Path:
    """Write the model of the simulated plates and the matrices it names."""
    mesh = box_mesh(PLATE, CELLS)
    stiffness, mass = assemble(mesh, MARBLE)
    mmwrite(folder / "k.mtx", _held(mesh, stiffness), symmetry="general")
    mmwrite(folder / "m.mtx", mass, symmetry="general")
    size, cells = [f"{1e3 * one:g} mm" for one in PLATE], list(CELLS)
    lines = [
        '[materials.marble]\nyoungs_modulus = "55 GPa"\ndensity = "2600 kg/m^3"',
        f"loss_factor = {2 * PlatesDesign().damping_ratio:g}",
    ]
    for name, height in (("lower", 0.0), ("upper", PLATE[2])):
        lines += [
            f"[bodies.{name}]\nbox = {size}\ncells = {cells}",
            f'origin = ["0 m", "0 m", "{height:g} m"]\nmaterial = "marble"',
            'stiffness = "k.mtx"\nmass = "m.mtx"',
        ]
    lines += ['[joints.bolted]\nbetween = ["upper", "lower"]', _patches(BOLTS)]
    lines += ['[joints.feet]\nbetween = ["lower", "ground"]\nface = "z-"']
    lines += [_patches(FEET)]
    for kind, names in (("sensors", ("1", "2", "6")), ("hits", ("1",))):
        for name in names:
            lines.append(_place(kind, name))
    lines += [
        '[identify]\ndata = "modes"\nstiffness_box = ["100 kN/m", "10 GN/m"]',
        'sought = ["bolted.normal", "bolted.tangential_1", "bolted.tangential_2",',
        '          "feet.normal"]',
        'frequency_sd = "0.5 %"\ndamping_sd = "5 %"',
        '[contact]\njoint = "bolted"\ncolumns = "x:um,z:um"',
        *(f"{key} = {json.dumps(value)}" for key, value in CONTACT.items()),
    ]
    path = folder / "plates-model.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _held(mesh: Mesh, stiffness: Sparse) -> Sparse:
    middle = np.abs(mesh.nodes[:, 2] - PLATE[2] / 2) < 1e-9
    diagonal = np.zeros((mesh.nodes.shape[0], 3))
    diagonal[middle, :2] = HELD
    return Sparse(stiffness + sparse.diags_array(diagonal.ravel()))


def _patches(shares: Sequence[tuple[float, float]]) -> str:
    spots = [
        f'  {{ centre = ["{x * PLATE[0]:g} m", "{y * PLATE[1]:g} m"], '
        f'radius = "{SPOT:g} m" }},'
        for x, y in shares
    ]
    return "\n".join(["patches = [", *spots, "]"])


def _place(kind: str, name: str) -> str:
    plate, along, across = POINTS[name]
    height = 2 * PLATE[2] if plate == "t" else 0.0
    label = f"a{name}" if kind == "sensors" else name
    return (
        f'[{kind}.{label}]\nbody = "{"upper" if plate == "t" else "lower"}"\n'
        f'position = ["{along * PLATE[0]:g} m", "{across * PLATE[1]:g} m", '
        f'"{height:g} m"]\ndirection = [0, 0, 1]'
    )


def write_faces(folder: Path) -> list[Path]:
    """Write one profile of each face, 2 mm long, as plain tables in um."""
    paths = []
    for number, name in enumerate("ab"):
        profile = weierstrass_profile(
            8192,
            spacing=2e-3 / 8192,
            dimension=DIMENSION,
            roughness=ROUGHNESS,
            seed=number,
        )
        along = profile.spacing * np.arange(profile.heights.size)
        table = np.column_stack([along, profile.heights]) * 1e6
        paths.append(folder / f"face-{name}.csv")
        np.savetxt(paths[-1], table, fmt="%.9g", delimiter=",")
    return paths


def truth_of(quantity: str, torque: float) -> float:
    """Return what the simulator's joint is, all bolts together."""
    design = PlatesDesign()
    share = (torque / REFERENCE_TORQUE) ** design.stiffness_exponent
    each = {
        JointQuantity.NORMAL_STIFFNESS: share * design.normal_stiffness,
        JointQuantity.NORMAL_DAMPING: design.joint_damping,
    }
    tangential = share * design.tangential_stiffness
    return len(BOLTS) * each.get(JointQuantity(quantity), tangential)


def cells_of(row: Mapping[str, object], truth: str) -> str:
    """Return one line of the table from a row of the JSON."""
    predicted = row["predicted"]
    assert isinstance(predicted, dict)
    cells = [
        f"{str(row['quantity']).replace('_', ' ')} [{row['unit']}]",
        f"{row['torque_n_m']:.3g}",
        truth,
        _with_ends(row["identified"], row["identified_interval_95"])
        + ("" if row["identifiable"] else ", open"),
        *(
            "-"
            if one is None
            else f"{_with_ends(one['value'], one['interval_95'])}, x{one['ratio']:.3g}"
            for one in predicted.values()
        ),
    ]
    return "| " + " | ".join(cells) + " |\n"


def _with_ends(value: object, ends: object) -> str:
    assert isinstance(ends, list)
    words = ["open" if one is None else f"{one:.3g}" for one in ends]
    return f"{value:.4g}" + (
        "" if words == ["open"] * 2 else f" ({' to '.join(words)})"
    )


def simulated(session: Path | None) -> str:
    """Measure, identify, compare; return the section of the page."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if session is None:
            session = folder / "plates.h5"
            run_measure(
                PLAN,
                session,
                source="sim:plates?seed=1",
                overwrite=False,
                json_target=None,
            )
        target = folder / "joint.json"
        run_identify_structure(
            write_model(folder),
            [session],
            band=BAND,
            cache=None,
            report=None,
            json_target=str(target),
            surfaces=write_faces(folder),
        )
        content = json.loads(target.read_text(encoding="utf-8"))
    size = 2 * 3 * box_mesh(PLATE, CELLS).nodes.shape[0]
    text = INTRODUCTION.format(size=size, verdict=content["verdict"]) + HEAD
    rows = sorted(content["theory"], key=lambda one: str(one["quantity"]))
    for row in rows:
        text += cells_of(row, f"{truth_of(row['quantity'], row['torque_n_m']):.4g}")
    errors = [_error(row) for row in rows]
    modes = [
        abs(p / m - 1)
        for state in content["states"]
        for m, p in zip(state["measured_hz"], state["predicted_hz"], strict=False)
    ]
    text += f"\nIdentified against the truth: {'; '.join(errors)}. "
    text += f"The largest error of {len(modes)} frequencies is "
    return text + f"{100 * max(modes):.2f} %.\n"


def _error(row: Mapping[str, object]) -> str:
    """Return the error of a row's identified value as text."""
    quantity, torque, value = row["quantity"], row["torque_n_m"], row["identified"]
    assert isinstance(quantity, str)
    assert isinstance(torque, float)
    assert isinstance(value, float)
    percent = 100 * (value / truth_of(quantity, torque) - 1)
    return f"{quantity.replace('_', ' ')} {percent:+.1f} % at {torque:g} N m"


def printed() -> str:
    """Return the section on the printed numbers of the 2025 paper."""
    table = TheoryTable.model_validate(CONTACT)
    surface = ContactSurface(1.5404, 9.497e-12)
    mass, states = 19.5, []
    for torque in TORQUES:
        preload = 4 * torque / (0.2 * 0.016)
        values = {
            JointQuantity.NORMAL_STIFFNESS: StateEstimate(PRINTED_STIFFNESS, None, None)
        }
        if torque == TORQUES[0]:
            values[JointQuantity.NORMAL_DAMPING] = StateEstimate(
                PRINTED_DAMPING, None, None
            )
        frequency = float(np.sqrt(PRINTED_STIFFNESS / mass) / (2 * np.pi))
        clamped = table.spread_preload(preload)
        states.append(IdentifiedState("printed", clamped, frequency, values))
    text = """
## The published numbers of 2025

D = 1.5404, G = 9.497e-12 m, four M16 bolts, K = 2.8667e7 N/m and C = 1.2713e7 N s/m,
published for 20 N m without an uncertainty. No test values are published for 50 and
80 N m; these rows are compared with the value at 20 N m. Hardness (1.5 GPa, 30 %) and
nut factor (0.2 +- 0.03) are assumed.
C is at 193 Hz, the natural frequency of one plate on K.

"""
    rows = theory_json(against_theory(states, surface, table))
    return text + HEAD + "".join(cells_of(row, "-") for row in rows)


def main() -> None:
    """Write both sections."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--session", type=Path)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    page = simulated(options.session) + printed()
    print(page)
    if options.page is not None:
        options.page.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
