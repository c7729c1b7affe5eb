"""Reduced machines in the cache, by the description of their bodies and interfaces."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.analysis.structures.machine.lean_machine import jointed, lean_machine
from jointbench.station.files.toml_file import read_toml
from jointbench.station.machine import machine_cache
from jointbench.station.machine.machine_cache import machine_key, reduced_machine_of
from jointbench.station.machine.machine_file import MachineModel

MODEL = """
[materials.steel]
youngs_modulus = "200 GPa"
density = "7850 kg/m^3"

[bodies.bed]
box = ["200 mm", "100 mm", "50 mm"]
cells = [2, 1, 1]
material = "steel"

[[supports]]
body = "bed"
face = "z-"

[rigid.motor]
position = ["100 mm", "50 mm", "100 mm"]
mass = "5 kg"
inertia = ["0.02 kg m^2", "0.02 kg m^2", "0.02 kg m^2"]

[springs.mount]
between = ["motor", "bed"]
position = ["100 mm", "50 mm", "50 mm"]
face = ["", "z+"]
stiffness = ["5 MN/m", "5 MN/m", "9 MN/m"]
rotational_stiffness = ["50 kN m/rad", "50 kN m/rad", "50 kN m/rad"]

[points.tool]
body = "motor"
position = ["100 mm", "50 mm", "120 mm"]

[analysis]
band = "600 Hz"
"""


def model_with(folder: Path, old: str = "", new: str = "") -> MachineModel:
    """Return the model with one replacement."""
    path = folder / "model.toml"
    path.write_text(MODEL.replace(old, new, 1) if old else MODEL, encoding="utf-8")
    return read_toml(path, MachineModel)


def test_a_machine_from_the_cache_is_the_same_without_a_mesh(tmp_path, monkeypatch):
    """Other joint values take the same bodies."""
    cache = tmp_path / "cache"
    first = reduced_machine_of(model_with(tmp_path), tmp_path, cache)

    def no_mesh(*_: object) -> None:
        raise AssertionError("meshed")

    monkeypatch.setattr(machine_cache, "machine_of", no_mesh)
    second = reduced_machine_of(model_with(tmp_path), tmp_path, cache)
    for one in (first, second):
        assert one.stiffness[:3] == pytest.approx([5e6, 5e6, 9e6])
    states = [lean_machine(one, 600.0).state(jointed(one)) for one in (first, second)]
    assert np.array_equal(states[0].eigenvalue, states[1].eigenvalue)
    assert np.array_equal(states[0].static, states[1].static)
    softer = model_with(tmp_path, '"9 MN/m"', '"8 MN/m"')
    third = reduced_machine_of(softer, tmp_path, cache)
    assert third.stiffness[2] == pytest.approx(8e6)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("200 GPa", "210 GPa"),
        ('"100 mm", "50 mm"]\ncells', '"100 mm", "60 mm"]\ncells'),
        ('["", "z+"]', '["", "z-"]'),
        ('"5 kg"', '"6 kg"'),
        ('"120 mm"]', '"130 mm"]'),
        ("600 Hz", "700 Hz"),
    ],
)
def test_what_changes_the_bodies_changes_the_key(tmp_path, old, new):
    """Material, size, interface, mass, point, band."""
    key = machine_key(model_with(tmp_path), tmp_path)
    assert machine_key(model_with(tmp_path, old, new), tmp_path) != key


def test_the_content_of_a_mesh_file_is_part_of_the_key(tmp_path):
    """Not its name or its time."""
    body = 'box = ["200 mm", "100 mm", "50 mm"]\ncells = [2, 1, 1]'
    model = model_with(tmp_path, body, 'mesh = "bed.inp"')
    keys = []
    for text in ("one", "other", "one"):
        (tmp_path / "bed.inp").write_text(text)
        keys.append(machine_key(model, tmp_path))
    assert keys[0] == keys[2] != keys[1]
