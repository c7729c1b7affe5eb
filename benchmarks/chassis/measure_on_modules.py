"""Run `jointbench measure` on every simulated module: as planned, and as it fits.

    python benchmarks/chassis/measure_on_modules.py --out docs/chassis-measure.md

The plan of examples/plates.toml is shortened to two points; for a module that cannot do
it, what its message says is changed, until it measures.
"""

import argparse
import tempfile
import tomllib
from collections.abc import Callable
from pathlib import Path

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.station.measure.bench_session import run_measure

PLAN = Path(__file__).parents[2] / "examples" / "plates.toml"
MODULES = ("9234", "9231", "9250", "9230", "4431", "9215")
Change = Callable[[str], str]


def short(text: str) -> str:
    """Two points, one torque, two hits each."""
    text = text.replace('points = ["1", "2", "3", "4", "5"]', 'points = ["1", "2"]')
    text = text.replace(
        'torques = ["20 N m", "50 N m", "80 N m"]', 'torques = ["20 N m"]'
    )
    return text.replace("repeats = 3", "repeats = 2")


def fewer_inputs(count: int) -> Change:
    """Leave out the sensors beyond some inputs."""

    def change(text: str) -> str:
        head, *sensors = text.split("[[sensors]]")
        return "[[sensors]]".join([head, *sensors[:count]])

    return change


def replaced(old: str, new: str) -> Change:
    """Replace words of the plan."""
    return lambda text: text.replace(old, new)


def own_supply(text: str) -> str:
    """DC coupling and sensors with a supply of their own."""
    return text.replace("serial =", "coupling = 'DC'\niepe = '0 mA'\nserial =")


CHANGES: dict[str, tuple[str, tuple[Change, ...]]] = {
    "9250": ("two sensors", (fewer_inputs(2),)),
    "9230": (
        "three sensors, 12.8 kHz",
        (fewer_inputs(3), replaced("25.6 kHz", "12.8 kHz")),
    ),
    "4431": ("inputs Dev1/ai0 to ai3", (replaced("cDAQSim1Mod1", "Dev1"),)),
    "9215": ("DC, no current", (own_supply,)),
}


def measured(plan: str, module: str, folder: Path) -> str:
    """Return what came of a plan on a module."""
    tomllib.loads(plan)
    file, out = folder / "plan.toml", folder / f"{module}.h5"
    file.write_text(plan)
    url = f"sim:plates?seed=1&module={module}"
    try:
        result = run_measure(
            file, out, source=url, overwrite=True, json_target=str(folder / "j.json")
        )
    except JointbenchError as error:
        return f"refused: {error}"
    hits = sum(hit.verdict.value == "ok" for hit in result.record.hits)
    return f"measured: {hits} good hits at {result.sample_rate / 1e3:g} kHz"


HEAD = """# `measure` on every module of the simulated chassis
The plan is [examples/plates.toml](../examples/plates.toml), shortened to two points and one torque.
What a module cannot do is refused before the first hit. Written by `benchmarks/chassis/measure_on_modules.py`.

| module | plan | result |
|---|---|---|
"""  # noqa: E501


def main() -> None:
    """Measure on all modules and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="page to write")
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for module in MODULES:
            plan = short(PLAN.read_text())
            rows.append((module, "as it is", measured(plan, module, Path(scratch))))
            words, changes = CHANGES.get(module, ("", ()))
            for change in changes:
                plan = change(plan)
            if changes:
                rows.append((module, words, measured(plan, module, Path(scratch))))
    lines = [f"| {' | '.join(row)} |\n" for row in rows]
    arguments.out.write_text(HEAD + "".join(lines))


if __name__ == "__main__":
    main()
