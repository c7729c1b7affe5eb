"""``import jointbench as jb``: functions that take and return records."""

import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import jointbench as jb
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session, write_session

LIGHT = "import jointbench, sys; print(sorted({'numpy', 'rich'} & set(sys.modules)))"
Maker = Callable[..., Path]
FREQUENCY = np.array([150.0, 420.0])
RATE = 2048.0
"""Of the sessions that `make_session` writes [Hz]."""


@pytest.fixture
def two_preloads(make_session: Maker) -> Path:
    """Return a session with hits at 2 kN and at 4 kN."""
    path = make_session("one.h5")
    one = read_session(path)
    recordings = tuple(
        replace(one.recordings[0], name=f"run-{i}", preload=2000.0 * i) for i in (1, 2)
    )
    both: Session = replace(one, recordings=recordings)
    write_session(both, path.with_name("two.h5"))
    return path.with_name("two.h5")


def test_the_import_loads_nothing_and_lists_its_functions() -> None:
    """A script that only imports pays nothing; `dir` shows the functions."""
    done = subprocess.run(
        [sys.executable, "-c", LIGHT], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
    assert set(jb.__all__) == set(dir(jb))
    assert all(getattr(jb, name).__doc__ for name in jb.__all__)
    with pytest.raises(AttributeError, match="no attribute 'mode'"):
        _ = jb.mode


def test_modes_of_a_session_have_labels_units_and_a_view(make_session: Maker) -> None:
    """From the file to labelled arrays, text and HTML."""
    found = jb.modes(make_session("s.h5"))
    data = found.to_xarray()
    assert data.frequency.values == pytest.approx(FREQUENCY, rel=1e-3)
    assert data.frequency.attrs["units"] == "Hz"
    assert (data.frequency_sd > 0).all()
    assert str(found).splitlines()[1].startswith("mode  natural frequency [Hz]")
    page = found._repr_html_()
    assert page.count("<path") == 2
    assert "frequency [Hz]" in page


def test_each_step_gives_what_the_next_one_takes(make_session: Maker) -> None:
    """Modes are the same from the file, the hits and the FRF."""
    path = make_session("s.h5", bounce=0.6, hits=3)
    measured = jb.open(path)
    hits = jb.hits(measured)
    assert [hit.verdict.value for hit in hits.hits] == ["double", "ok", "ok"]
    assert hits.to_xarray().verdict.values.tolist() == ["double", "ok", "ok"]
    frf = jb.frf(hits)
    data = frf.to_xarray()
    assert data.accelerance.dims == ("output", "input", "frequency")
    assert data.variance.attrs["units"] == "m2 s-4 N-2"
    ends = [jb.modes(one).chain.result.model for one in (path, hits, frf)]
    for other in ends[1:]:
        assert np.array_equal(other.natural_frequency, ends[0].natural_frequency)


def test_samples_are_labelled_by_time_and_channel(make_session: Maker) -> None:
    """Names, units and the rate, as recorded."""
    data = jb.open(make_session("s.h5")).to_xarray("stream")
    assert data.a1.attrs["units"] == "m s-2"
    assert data.time.values[1] == pytest.approx(1 / RATE)


def test_several_preloads_are_never_averaged(two_preloads: Path) -> None:
    """The error names the preloads; `at` selects one of them."""
    measured = jb.open(two_preloads)
    with pytest.raises(UsageError, match="preloads 2000 N, 4000 N"):
        jb.modes(measured)
    assert jb.hits(measured.at("4 kN")).recordings[0].preload == 4000
    with pytest.raises(UsageError, match="preloads are 2000 N, 4000 N"):
        measured.at("3 kN")


def test_names_from_files_are_shown_as_text(make_session: Maker) -> None:
    """A name in a foreign file cannot put a script into a notebook."""
    path = make_session("<script>x.h5")
    page = jb.open(path)._repr_html_()
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


def test_a_surface_and_a_contact_law(tmp_path: Path) -> None:
    """Structure function with units; an unknown option is named."""
    rng = np.random.default_rng(1)
    heights = np.cumsum(rng.normal(0, 2e-8, 4000))
    file = tmp_path / "face.csv"
    lines = [f"{i},{1e6 * z:.9g}" for i, z in enumerate(heights)]
    file.write_text("\n".join(lines) + "\n")
    fitted = jb.surface(file, columns="x:um,z:um")
    assert fitted.to_xarray().structure_function.attrs["units"] == "m2"
    assert "face" in str(fitted)
    joint = jb.contact(
        dimension=1.54,
        roughness="1e-9 m",
        modulus="29.3 GPa",
        hardness="1.5 GPa",
        load=["1 kN", "5 kN"],
    )
    stiffness = joint.to_xarray().normal_stiffness
    assert stiffness.attrs["units"] == "N m-1"
    assert stiffness.values[1] > stiffness.values[0]
    with pytest.raises(UsageError, match="no option lod"):
        jb.contact(modulus="29.3 GPa", hardness="1.5 GPa", lod="1 kN")


def test_an_archive_is_one_table(make_session: Maker, tmp_path: Path) -> None:
    """Process, collect, write: the numbers of the results."""
    for seed, torque in ((1, 10.0), (2, 20.0)):
        jb.process(make_session(f"{seed}/s.h5", seed=seed, torque=torque))
    table = jb.archive(tmp_path)
    data = table.to_xarray()
    first = data.value.values[(data.name == "natural_frequency").values]
    assert first[0] == pytest.approx(FREQUENCY[0], rel=1e-3)
    assert set(data.torque.values) == {10.0, 20.0}
    assert data.torque.attrs["units"] == "N m"
    assert "natural_frequency" in table.write(tmp_path / "all.csv").read_text()


def test_joints_are_identified_by_name(make_session: Maker, tmp_path: Path) -> None:
    """A parameter by its name, with interval; a wrong name lists the known ones."""
    model = tmp_path / "bench.toml"
    model.write_text(BENCH)
    found = jb.identify(model, make_session("s.h5"))
    assert found["joint.stiffness"].unit == "N/m"
    with pytest.raises(UsageError, match=r"identified are .*joint\.stiffness"):
        _ = found["bolt.stiffness"]
    with pytest.raises(UsageError, match="needs sessions, hits or FRFs"):
        jb.identify(model)


def test_the_scripts_of_the_page_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From hits to modes, to a verdict, and to the table of an archive.

    Nothing is hidden in the campaign: its model is found beside the session, and
    nothing is missing.
    """
    page = (Path(__file__).parents[3] / "docs" / "library.md").read_text()
    scripts = re.findall(r"^```python\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for script in scripts:
        exec(compile(script, "library.md", "exec"), names)
    assert (tmp_path / "all.csv").exists()
    assert names["campaign"].model == Path("campaign.toml")
    found = names["found"]
    assert (found.verdict, found.effects) == ("none", ())
    assert found.to_dict()["verdict"] == "none"
    report = (tmp_path / "gap.html").read_text()
    assert "</html>" in report and "Simulated instruments" in report


BENCH = """
[bodies.base]
mass = "20 kg"
mass_sd = "0.02 kg"

[bodies.top]
mass = "10 kg"
mass_sd = "0.01 kg"
channel = "a1"

[links.support]
between = ["ground", "base"]

[links.joint]
between = ["base", "top"]
"""
