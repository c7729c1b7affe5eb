"""No G without its interval, and none that is open over a decade."""

import json

import numpy as np
import pytest

from jointbench.acquisition.formats.heights.read_surfaces import read_surface
from jointbench.acquisition.records.session import new_session
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.simulators.rough_surfaces.surface_files import write_surfcom
from jointbench.station.commands.surface_command import run_surface
from jointbench.station.main import app, exit_code
from jointbench.station.pipeline.contact_prediction import surface_of
from jointbench.station.pipeline.process_session import process_session
from jointbench.station.pipeline.roughness_words import contact_surface_words
from jointbench.station.pipeline.stage_store import StageStore
from jointbench.station.report.surface_section import surface_section
from jointbench.station.schemas.recipe import Recipe
from jointbench.station.screen.page_parts import DataTable

MATERIAL = ["--modulus=29.3 GPa", "--hardness=1.5 GPa", "--load=4 kN", "--model=ke_2d"]


@pytest.fixture(scope="module")
def traces(tmp_path_factory):
    """Tables of a smooth trace, whose G is far below an atom, and of a clear one."""
    folder = tmp_path_factory.mktemp("traces")
    for name, dimension, roughness in (("smooth", 1.12, 1e-22), ("clear", 1.5, 1e-10)):
        trace = rough_profile(
            3000, dimension=dimension, roughness=roughness, spacing=0.5e-6, seed=3
        )
        x = 0.5 * np.arange(3000)
        np.savetxt(
            folder / f"{name}.csv",
            np.column_stack([x, trace.heights * 1e6]),
            fmt=["%.1f", "%.7f"],
            delimiter=",",
            header="x [um],z [um]",
            comments="",
        )
    return folder


def run(monkeypatch, *words):
    """Run the command line on a wide terminal."""
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr("sys.argv", ["jointbench", *map(str, words)])
    return exit_code(app, debug=False)


def test_the_terminal_shows_g_with_its_interval(traces, monkeypatch, capsys):
    """98.7 pm, and between which bounds."""
    assert run(monkeypatch, "surface", traces / "clear.csv") == 0
    shown = capsys.readouterr().out
    assert "98.67 pm (62.22 pm to 156.5 pm)" in shown


def test_a_g_open_over_a_decade_gives_way_to_s_at_its_pivot(
    traces, monkeypatch, capsys, tmp_path
):
    """5.7e-20 m between 5e-23 and 6e-17 m is no G; JSON keeps its keys."""
    target = tmp_path / "surface.json"
    assert run(monkeypatch, "surface", traces / "smooth.csv", "--json", target) == 0
    shown = capsys.readouterr().out
    assert "fm" not in shown
    assert "µm² (0.00565 to 0.00808) at 500 nm" in shown
    found = json.loads(target.read_text(encoding="utf-8"))["files"][0]
    low, high = found["roughness_interval_m"]
    assert high > 10 * low
    assert found["roughness_m"] is None
    assert found["roughness_known"] is False
    low, high = found["pivot_value_interval_m2"]
    assert low < found["pivot_value_m2"] < high < 2 * low


def test_the_report_follows_the_same_rule(traces):
    """Its table has the interval, or S."""
    chains = run_surface(
        [traces / "smooth.csv", traces / "clear.csv"], columns=None, json_target=None
    )
    items = surface_section(chains).items
    table = next(item for item in items if isinstance(item, DataTable))
    assert table.rows[0][3].startswith("S = 0.00676 µm² (")
    assert table.rows[1][3] == "98.67 pm (62.22 pm to 156.5 pm)"


def test_a_contact_prediction_says_of_its_surface_what_is_known(
    traces, monkeypatch, capsys, tmp_path
):
    """K has its interval all the same, from D and S together."""
    target = tmp_path / "contact.json"
    options = [*MATERIAL, "--json", target]
    face = traces / "smooth.csv"
    assert run(monkeypatch, "contact", "--surface", face, *options) == 0
    assert "G is open over more than a decade" in capsys.readouterr().out
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["roughness_m"] is None
    assert found["pivot_value_m2"] > 0
    low, high = found["models"][0]["normal_stiffness_interval"]
    assert low < found["models"][0]["normal_stiffness"] < high


def test_numbers_given_by_hand_are_reported_as_given():
    """D and G without a spread are no measurement; with one they have an interval."""
    plain = surface_of(1.54, "1e-9 m", [], None)
    assert contact_surface_words(plain) == "D = 1.5400 (line), G = 1e-09 m as given"
    spread = surface_of(1.54, "1e-9 m", [], None, roughness_sd="20 %")
    assert contact_surface_words(spread).endswith(
        "G = 1e-09 m (6.8e-10 m to 1.5e-09 m)"
    )


def test_cautions_of_the_heights_reach_screen_json_report_and_import(
    traces, monkeypatch, capsys, tmp_path
):
    """A trace that ends flat at its extreme is reported wherever it is used."""
    text = (traces / "clear.csv").read_text(encoding="ascii").splitlines()
    flat = [f"{1500 + 0.5 * i:.1f},2.0000000" for i in range(12)]
    path = tmp_path / "flat.csv"
    path.write_text("\n".join([*text, *flat]) + "\n", encoding="ascii")
    target = tmp_path / "surface.json"
    chains = run_surface([path], columns=None, json_target=str(target))
    assert "flat: caution: the trace ends in 12 equal" in capsys.readouterr().out
    found = json.loads(target.read_text(encoding="utf-8"))["files"][0]
    assert "12 equal heights" in found["cautions"][0]
    texts = [getattr(item, "text", "") for item in surface_section(chains).items]
    assert any("12 equal heights" in text for text in texts)
    assert run(monkeypatch, "contact", "--surface", path, *MATERIAL) == 3
    assert "; flat: caution: the trace ends in 12 equal" in capsys.readouterr().err
    session = tmp_path / "session.h5"
    assert run(monkeypatch, "import", path, "--out", session) == 0
    assert "12 equal heights" in capsys.readouterr().out


def test_cautions_of_a_face_stand_beside_the_contact_prediction(
    monkeypatch, capsys, tmp_path
):
    """A Surfcom trace without its TX3: the pitch rests on a nominal length."""
    face, target = tmp_path / "face.tx1", tmp_path / "contact.json"
    trace = rough_profile(3000, dimension=1.5, roughness=1e-10, spacing=5e-7, seed=3)
    write_surfcom(trace, face)
    options = [*MATERIAL, "--json", target]
    assert run(monkeypatch, "contact", "--surface", face, *options) == 0
    assert "face: caution: no TX3 file" in capsys.readouterr().out
    found = json.loads(target.read_text(encoding="utf-8"))
    assert len(found["cautions"]) == 1


def test_cautions_of_a_session_stand_among_the_remarks_of_its_results(tmp_path):
    """Results of a recipe report what is odd about the heights."""
    trace = rough_profile(400, dimension=1.5, roughness=1e-10, spacing=5e-7, seed=3)
    write_surfcom(trace, tmp_path / "face.tx1")
    face = read_surface(tmp_path / "face.tx1")
    session = new_session(source="test", simulated=True, surfaces=[face])
    stages = StageStore(tmp_path / "stages")
    found = process_session(session, "0" * 64, Recipe(), stages)
    assert any("Surface face: caution: no TX3" in said for said in found.remarks)
