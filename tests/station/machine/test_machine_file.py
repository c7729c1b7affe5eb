"""The machine file: the example, and the one that the page shows."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.analysis.structures.machine.analyse_machine import analyse_machine
from jointbench.analysis.structures.machine.loads import HarmonicLoad, TableLoad
from jointbench.analysis.structures.machine.machine_request import MachineRequest
from jointbench.analysis.structures.machine.reduce_machine import reduce_machine
from jointbench.station.files.toml_file import read_toml
from jointbench.station.machine.machine_file import MachineModel, loads_of, machine_of
from jointbench.station.machine.run_machine import request_of

ROOT = Path(__file__).parents[3]
GRINDER = ROOT / "examples" / "grinder.toml"


def test_the_example_falls_in_frequency_and_moves_most_along_z() -> None:
    """The paper's statements that hold with plausible joints."""
    model = read_toml(GRINDER, MachineModel)
    machine = machine_of(model, GRINDER.parent)
    request = replace(request_of(model, GRINDER.parent), samples=20, lines=100)
    found = analyse_machine(reduce_machine(machine, request.band_hz), request)
    soft, rigid = found.jointed, found.glued
    assert np.all(soft.modes.natural_frequency < rigid.modes.natural_frequency)
    assert rigid.modes.energy.weakest(0)[0] == "column"
    assert soft.modes.energy.weakest(0)[0] in {"foot", "beam"}
    assert soft.motion is not None
    assert rigid.motion is not None
    assert int(np.argmax(soft.motion.late)) == 2
    assert np.all(soft.motion.late > rigid.motion.late)
    assert np.all(soft.motion.largest_at < 2.0)


def test_the_model_on_the_page_runs(tmp_path: Path) -> None:
    """Shapes, a beam, a rigid body, springs; all bodies take part."""
    pytest.importorskip("gmsh")
    text = (ROOT / "docs" / "machine.md").read_text(encoding="utf-8")
    path = tmp_path / "page.toml"
    # A wider hole needs fewer elements.
    text = text.replace('radius = "40 mm"', 'radius = "80 mm"')
    path.write_text(text.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    model = read_toml(path, MachineModel)
    machine = machine_of(model, tmp_path)
    assert machine.bodies == ["bed", "housing", "spindle", "motor"]
    request = MachineRequest(400.0, modes=4, lines=50, samples=20)
    result = analyse_machine(reduce_machine(machine, 400.0), request)
    joints = {one.name for one in result.costs}
    assert joints == {"foot", "front_bearing", "rear_bearing", "drive"}
    assert np.all(result.jointed.modes.natural_frequency > 1.0)


def test_a_load_is_split_along_the_axes(tmp_path: Path) -> None:
    """A sine of 100 N along (0, 3, 4), and a table along x."""
    model = read_toml(GRINDER, MachineModel)
    sine = model.loads[0].model_copy(
        update={"direction": (0.0, 3.0, 4.0), "phase": 0.5}
    )
    table = model.loads[0].model_copy(
        update={"amplitude": None, "rate": None, "time": (0.0, 1.0), "force": (2.0, 4)}
    )
    found = loads_of(model.model_copy(update={"loads": (sine, table)}), tmp_path)
    assert [one.input for one in found] == [1, 2, 0]
    assert isinstance(found[0], HarmonicLoad)
    assert found[0].amplitude == pytest.approx(60.0)
    assert found[1] == HarmonicLoad(2, pytest.approx(80.0), 100.0, 0.5)
    assert isinstance(found[2], TableLoad)
    assert found[2].at(np.array([0.5])) == pytest.approx([3.0])
