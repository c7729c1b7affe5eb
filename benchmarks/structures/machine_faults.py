# SPDX-License-Identifier: MIT
"""Faults in a machine file, each by the command: one line and exit code 3.

Every case changes one place of `examples/grinder.toml`.

python benchmarks/structures/machine_faults.py [--page docs/machine-faults.md]
"""

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from large import write_deck

from jointbench.analysis.structures.meshes.mesh import box_mesh

MODEL = Path(__file__).resolve().parents[2] / "examples" / "grinder.toml"
BAD_DATA = 3
WHEEL = """box = ["0.2 m", "0.2 m", "0.04 m"]
origin = ["1.5 m", "0.4 m", "0.88 m"]
cells = [3, 3, 1]
material = "steel"
"""
FLANGE = '[joints.flange]\nbetween = ["wheel", "spindle"]\n'
SKEWED = """%%MatrixMarket matrix coordinate real general
2 2 4
1 1 2.0
1 2 -1.0
2 1 -0.5
2 2 2.0
"""
INTRODUCTION = """# Faults in a machine file

Made by `benchmarks/structures/machine_faults.py`: `jointbench machine` on
`examples/grinder.toml` with one fault each. FOLDER is that of the model.

| fault | exit code | lines | the line |
|---|---|---|---|
"""


def without_joint(text: str, _: Path) -> str:
    """Leave out the joint of the wheel, which floats then."""
    begin = text.index(FLANGE)
    return text[:begin] + text[text.index("[points.tool]") :]


def apart(text: str, _: Path) -> str:
    """Raise the wheel's place by a millimetre: a gap below the spindle."""
    return text.replace('["1.5 m", "0.4 m", "0.88 m"]', '["1.5 m", "0.4 m", "0.879 m"]')


def inverted(text: str, folder: Path) -> str:
    """Give the wheel as a mesh whose nodes were mirrored, not its elements."""
    mesh = box_mesh((0.2, 0.2, 0.04), (1, 1, 1), origin=(1.5, 0.4, 0.88))
    nodes = mesh.nodes.copy()
    nodes[:, 0] = 3.2 - nodes[:, 0]
    write_deck(replace(mesh, nodes=nodes), folder / "wheel.inp")
    whole = 'mesh = "wheel.inp"\nmesh_unit = "1 m"\nmaterial = "steel"\n'
    return text.replace(WHEEL, whole)


def no_unit(text: str, _: Path) -> str:
    """Leave out the unit of a stiffness."""
    return text.replace('["5 GN/m", "2 GN/m"', '["5", "2 GN/m"', 1)


def no_unit_of_length(text: str, _: Path) -> str:
    """Leave out the units of a box."""
    return text.replace('["0.2 m", "0.2 m", "0.04 m"]', "[0.2, 0.2, 0.04]")


def skewed(text: str, folder: Path) -> str:
    """Give the wheel by K and M of another program, not symmetric."""
    (folder / "k.mtx").write_text(SKEWED, encoding="ascii")
    files = WHEEL.replace('material = "steel"', 'stiffness = "k.mtx"\nmass = "k.mtx"')
    return text.replace(WHEEL, files)


FAULTS: dict[str, Callable[[str, Path], str]] = {
    "a body without a joint": without_joint,
    "a joint of bodies 1 mm apart": apart,
    "a mesh with inverted elements": inverted,
    "a stiffness without its unit": no_unit,
    "lengths without their unit": no_unit_of_length,
    "K of another program that is not symmetric": skewed,
}


def run(change: Callable[[str, Path], str]) -> tuple[int, str]:
    """Run the command on a changed model and return exit code and error text."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        before = MODEL.read_text(encoding="utf-8")
        after = change(before, folder)
        if after == before:
            raise SystemExit(f"{change.__name__} changes nothing in {MODEL.name}")
        model = folder / "machine.toml"
        model.write_text(after, encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-m", "jointbench", "machine", str(model)],
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stderr.replace(str(folder), "FOLDER")


def main() -> None:
    """Run every fault, and print or write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    text, failed = INTRODUCTION, 0
    for name, change in FAULTS.items():
        code, line = run(change)
        failed += code != BAD_DATA or line.count("\n") != 1
        shown = line.strip().replace("\n", " / ").replace("|", "\\|")
        text += f"| {name} | {code} | {line.count(chr(10))} | `{shown}` |\n"
    print(text)
    if options.page is not None:
        options.page.write_text(text, encoding="utf-8")
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
