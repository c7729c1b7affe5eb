"""``jointbench pressure`` from the command line and from Python."""

import json
from pathlib import Path

import numpy as np
import pytest

import jointbench as jb
from jointbench.acquisition.basics.errors import BadData, JointbenchError
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel, structure_of
from jointbench.station.main import app
from jointbench.station.pressure.run_pressure import pressure_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "pressed-plates.toml"
LAW = EXAMPLE.read_text(encoding="utf-8").replace(
    "cells = [10, 8, 2]", "cells = [6, 4, 1]"
)
CONTACT = """
[contact]
modulus = "112 GPa"
hardness = "2 GPa"
poisson = 0.29
models = ["ke_3d_modified"]
dimension = 1.5
roughness = "1e-4 um"
"""


def model(folder: Path, *changes: tuple[str, str]) -> Path:
    """Write the example with few elements and some changes."""
    text = LAW
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    path = folder / "plates.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_command_writes_totals_points_and_a_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The points add up to the totals, and the page shows the open part."""
    path = model(tmp_path)
    names = {name: str(tmp_path / name) for name in ("p.html", "p.csv", "p.json")}
    asked = ["--json", names["p.json"], "--report", names["p.html"]]
    app(
        ["pressure", str(path), *asked, "--points", names["p.csv"]],
        standalone_mode=False,
    )
    shown = " ".join(capsys.readouterr().out.split())
    assert "rocking 1 stiffness" in shown
    assert "% of the surface is open" in shown
    totals = json.loads((tmp_path / "p.json").read_text())["totals"]
    table = np.loadtxt(names["p.csv"], delimiter=",", skiprows=1)
    normal = totals["normal_stiffness"]
    assert table[:, 2] @ table[:, 5] == pytest.approx(normal["value"], rel=1e-4)
    assert normal["interval"][0] < normal["value"] < normal["interval"][1]
    assert "Open parts are left blank" in (tmp_path / "p.html").read_text()


def test_the_points_are_the_pattern_of_a_joint(tmp_path: Path) -> None:
    """A structure that takes them has its springs where the pressure is."""
    path = model(tmp_path)
    app(
        ["pressure", str(path), "--points", str(tmp_path / "p.csv")],
        standalone_mode=False,
    )
    pressed = model(
        tmp_path,
        (
            'between = ["upper", "lower"]',
            'between = ["upper", "lower"]\npattern = "p.csv"',
        ),
    )
    face = structure_of(read_toml(pressed, StructureModel), tmp_path).faces[0]
    arm = (face.points.position[:, 0] - 0.08) ** 2
    found = jb.pressure(path).result
    share = found.totals[3] / found.totals[0]
    assert face.points.weight @ arm / face.points.area == pytest.approx(share, rel=0.05)


def test_python_and_the_command_agree(tmp_path: Path) -> None:
    """The same numbers, and a text with the finding."""
    found = jb.pressure(model(tmp_path))
    assert found.to_dict()["force_N"] == pytest.approx(found.result.force)
    assert "of the surface is open" in str(found)


def test_a_law_of_the_papers_needs_its_reference_area(tmp_path: Path) -> None:
    """With it the law is one per area; without it one line names what to give."""
    begin, end = LAW.index("[pressure.law]"), LAW.index("[[pressure.bolts]]")
    law = LAW[begin:end]
    bare = model(tmp_path, (law, ""), ("[pressure]", CONTACT + "\n[pressure]"))
    with pytest.raises(BadData, match="reference_area"):
        pressure_of(bare)
    area = 'gravity = [0, 0, -1]\nreference_area = "1 mm^2"\nreference_area_sd = "50 %"'
    text = bare.read_text().replace("gravity = [0, 0, -1]", area)
    bare.write_text(text)
    found = pressure_of(bare)
    assert "reference area A = 1 mm^2" in found.law.source
    assert found.parts["reference area"][0] != 0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("[pressure]", "[pressure]\njoint = 'other'"), "pressure.joint is 'other'"),
        (('preload = "20 kN"', 'preload = "nan kN"'), "preload"),
        (('preload = "20 kN"', 'preload = "20"'), "preload"),
        (('["25 mm", "25 mm"]', '["25 m", "25 mm"]'), "bolt 1: it is"),
        (('"0 mm", "0 mm", "-25 mm"]', '"0 mm", "0 mm", "-35 mm"]'), "touches nothing"),
        (('head = "20 mm"', 'head = "10 mm"'), "not larger than its hole"),
    ],
    ids=["joint", "nan", "unit", "outside", "apart", "head"],
)
def test_a_wrong_model_is_refused_in_one_line(
    tmp_path: Path, change: tuple[str, str], said: str
) -> None:
    """Names, numbers, units, places, bodies apart."""
    with pytest.raises(JointbenchError, match=said) as caught:
        pressure_of(model(tmp_path, change))
    assert "\n" not in str(caught.value)


def test_a_model_without_the_table_says_what_to_add(tmp_path: Path) -> None:
    """No [pressure]."""
    path = tmp_path / "plates.toml"
    path.write_text(LAW[: LAW.index("[pressure]")], encoding="utf-8")
    with pytest.raises(BadData, match=r"no table \[pressure\]"):
        pressure_of(path)
