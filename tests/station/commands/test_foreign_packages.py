"""Instruments and file formats of other packages, through the real commands."""

import json
import logging
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from package_commands import run
from plugin_distributions import install, install_example

from jointbench.acquisition.records.surfaces import Profile
from jointbench.acquisition.session_file.store import read_session

EXAMPLE_PLAN = Path(__file__).parents[3] / "examples" / "plates.toml"
FORCE = [0.0, 80.0, 20.0, 0.0, 0.0, 0.0]
ACCELERATION = [0.0, 4.0, -3.0, 2.0, -1.0, 0.5]
HEIGHTS = np.round(
    np.cumsum(np.random.default_rng(8).normal(size=600)) / 10, 3
)  # [um], a walk with D near 1.5
PITCH = 0.5  # [um]


def started(folder: Path, *words: object) -> "subprocess.CompletedProcess[str]":
    """Run a command in a process of its own, with a folder of packages."""
    code = (
        f"import sys; sys.path.insert(0, {str(folder)!r})\n"
        "from jointbench.station.main import run\n"
        "run()\n"
    )
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
    )


def samples_file(folder: Path, name: str = "hit.xyz") -> Path:
    """Write a file of the example's sample format."""
    rows = [f"{f} {a}" for f, a in zip(FORCE, ACCELERATION, strict=True)]
    head = ["LAB LOGGER 2", "rate 4000", "channels force[N] acceleration[m/s^2]"]
    path = folder / name
    path.write_text("\n".join([*head, *rows, ""]), encoding="utf-8")
    return path


def heights_file(folder: Path, name: str = "face.abc") -> Path:
    """Write a file of the example's height format."""
    rows = [f"{z:.3f}" for z in HEIGHTS]
    path = folder / name
    text = "\n".join(["ABC PROFILE", f"pitch_um {PITCH}", *rows, ""])
    path.write_text(text, encoding="utf-8")
    return path


def details(steps: object, name: str) -> dict[str, object]:
    """Return the details of the one step of provenance with a name."""
    (found,) = [one for one in steps if one.name == name]  # type: ignore[attr-defined]
    return dict(found.detail)


@pytest.mark.usefixtures("example")
def test_import_reads_samples_and_heights_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Values in SI, and provenance names format, package and version."""
    out = tmp_path / "s.h5"
    files = samples_file(tmp_path), heights_file(tmp_path)
    assert run(monkeypatch, "import", *files, "--out", out) == 0
    session = read_session(out)
    (recording,), (surface,) = session.recordings, session.surfaces
    assert recording.sample_rate == 4000.0
    np.testing.assert_allclose(recording.samples, [FORCE, ACCELERATION])
    assert isinstance(surface, Profile)
    np.testing.assert_allclose(surface.heights, 1e-6 * HEIGHTS)
    assert surface.spacing == pytest.approx(1e-6 * PITCH)
    for record, name in ((recording, "lab-samples"), (surface, "lab-heights")):
        found = details(record.provenance, "package")
        assert found["format"] == name
        assert found["package"] == "jointbench-example 1.0"


def test_surface_reads_a_profile_of_a_package_in_a_process_of_its_own(
    example: Path, tmp_path: Path
) -> None:
    """The same fractal parameters as of the same heights in a plain table."""
    path = heights_file(tmp_path)
    plain = tmp_path / "face.csv"
    rows = [f"{PITCH * i:.1f},{z:.3f}" for i, z in enumerate(HEIGHTS)]
    plain.write_text("\n".join(["x [um],z [um]", *rows, ""]), encoding="utf-8")
    found = []
    for file in (path, plain):
        target = tmp_path / f"{file.name}.json"
        done = started(example, "surface", file, "--json", target)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        found.append(json.loads(target.read_text(encoding="utf-8")))
    of_package, of_table = (content["files"][0] for content in found)
    assert of_package["dimension"] == pytest.approx(of_table["dimension"], rel=1e-9)


@pytest.mark.usefixtures("example")
def test_profile_fetches_from_a_roughness_tester_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Through pyserial, from the simulator that the package brings along."""
    out = tmp_path / "face.csv"
    line = "sim:lab-stylus?points=300"
    assert run(monkeypatch, "profile", "lab-stylus", line, "--out", out) == 0
    heights = np.loadtxt(out, delimiter=",", skiprows=1)
    assert heights.shape == (300, 2)
    assert heights[1, 0] == pytest.approx(0.5)


@pytest.mark.usefixtures("example")
def test_measure_reads_the_bolts_with_a_torque_tester_of_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four bolts at 20 N m, each the largest reading between two rests."""
    plan = plan_file(tmp_path, "lab-torque", "sim:lab-torque?torque=20.2")
    out = tmp_path / "s.h5"
    words = ("measure", plan, "--out", out, "--source", "sim:plates")
    assert run(monkeypatch, *words) == 0
    steps = [dict(s.detail) for s in read_session(out).provenance if s.name == "bolt"]
    assert [s["torque"] for s in steps] == pytest.approx([20.2] * 4)
    assert steps[0]["raw"] == "T=20.20"


def plan_file(folder: Path, instrument: str, line: str) -> Path:
    """Write the example's plan with a torque tester."""
    text = EXAMPLE_PLAN.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    hits = (
        'points = ["1"]\ntorques = ["20 N m"]\nrepeats = 1\ntrial_hits = 0\n'
        'length = "0.3 s"\nwait = "20 s"\n'
    )
    torque = f'[torque]\ninstrument = "{instrument}"\nline = "{line}"\npoll = "1 ms"\n'
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{hits}{torque}[joint]{tail}", encoding="utf-8")
    return path


@pytest.mark.usefixtures("example")
@pytest.mark.parametrize(
    ("instrument", "words"),
    [
        ("lab-torqe", "'lab-torqe' is no torque tester; there are mark10, lab-torque"),
        ("lab-stylus", "'lab-stylus' is no torque tester"),
    ],
)
def test_a_plan_names_a_torque_tester_that_there_is(
    instrument: str,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The line lists the testers, with a near match; the plan is bad data."""
    plan = plan_file(tmp_path, instrument, "COM3")
    out = tmp_path / "s.h5"
    assert run(monkeypatch, "measure", plan, "--out", out) == 3
    assert words in one_line(capsys)


@pytest.mark.usefixtures("example")
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("lab-torque", "COM3"), "'lab-torque' is no roughness tester; there are"),
        (("lab-stylos", "COM3"), "did you mean 'lab-stylus'?"),
        (("lab-stylus", "sim:lab-stylus?point=3"), "has no key ['point']"),
        (("lab-stylus", "sim:lab-stylus?points=many"), "package jointbench-example"),
        (("diavite", "sim:lab"), "sim:mark10, sim:lab-stylus, sim:lab-torque"),
    ],
)
def test_a_wrong_name_or_key_is_one_line(
    arguments: tuple[str, str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The names of packages stand beside those that are built in."""
    out = tmp_path / "face.csv"
    more = ("--traverse", "4.8 mm", "--out", out)
    assert run(monkeypatch, "profile", *arguments, *more) == 2
    assert words in one_line(capsys)
    assert not out.exists()


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line on standard error."""
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("jointbench: error: ")
    return line


SAMPLES = "jointbench.sample_formats"
BROKEN = {
    "raises at import": ("1 / 0", "ZeroDivisionError"),
    "wrong type": ("FORMAT = 'xyz'", "has the type str"),
    "takes every file": (
        "from jointbench.acquisition.formats.samples.sample_format import SampleFormat"
        "\nFORMAT = SampleFormat('bad', (), print)",
        "neither suffixes nor recognise",
    ),
}


@pytest.mark.parametrize("kind", sorted(BROKEN))
def test_a_package_that_cannot_be_used_is_one_warning_and_the_command_continues(
    kind: str, tmp_path: Path
) -> None:
    """Exit code 0, the file is read, and one line on standard error says it."""
    text, reason = BROKEN[kind]
    site = install(
        tmp_path / "site", "bad-lab", {SAMPLES: {"bad": "bad_lab:FORMAT"}}, {}
    )
    (site / "bad_lab.py").write_text(text, encoding="utf-8")
    hits = tmp_path / "hit.csv"
    rows = [
        f"{i / 4000},{f},{a}"
        for i, (f, a) in enumerate(zip(FORCE, ACCELERATION, strict=True))
    ]
    hits.write_text("\n".join([*rows, ""]), encoding="utf-8")
    again = tmp_path / "again.csv"
    again.write_text("\n".join([*rows[1:], ""]), encoding="utf-8")
    columns = ("--columns", "time:s,force:N,acceleration:m/s^2")
    out = tmp_path / "s.h5"
    done = started(site, "import", hits, again, "--out", out, *columns)
    assert done.returncode == 0, done.stderr
    assert len(read_session(out).recordings) == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith("jointbench: warning: package bad-lab 1.0: ")
    assert reason in line
    assert "jointbench continues without it" in line


def test_a_name_of_two_packages_ends_the_command(example: Path, tmp_path: Path) -> None:
    """Exit code 2 and one line with both packages."""
    site = install(
        tmp_path / "site",
        "other-lab",
        {SAMPLES: {"lab-samples": "other_lab:FORMAT"}},
        {"other_lab": "raise ValueError"},
    )
    both = install_example(site)
    done = started(both, "import", samples_file(tmp_path), "--out", tmp_path / "s.h5")
    assert example != both
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "jointbench-example 1.0 and other-lab 1.0 both add" in line
    assert "'lab-samples'" in line


FAILING = """
from jointbench.acquisition.formats.samples.sample_format import SampleFormat
def read(path, options):
    {body}
FORMAT = SampleFormat("failing", (".bad",), read)
"""


@pytest.mark.parametrize(
    ("body", "reason"),
    [("return {}['rate']", "KeyError"), ("return ()", "at least one Recording")],
)
def test_a_reader_of_a_package_that_fails_is_bad_data_in_one_line(
    body: str,
    reason: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """No traceback: format, package and reason, code 3, and no session."""
    module = f"failing_{len(body)}"
    modules = {module: FAILING.format(body=body)}
    site = install(
        tmp_path / "site", "fails", {SAMPLES: {"failing": f"{module}:FORMAT"}}, modules
    )
    monkeypatch.syspath_prepend(site)
    path, out = tmp_path / "a.bad", tmp_path / "s.h5"
    path.write_text("1\n", encoding="utf-8")
    assert run(monkeypatch, "import", path, "--out", out) == 3
    line = one_line(capsys)
    assert "'failing' of package fails 1.0" in line
    assert reason in line
    assert not out.exists()


@pytest.mark.usefixtures("example")
def test_a_file_that_two_packages_take_is_refused(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Another package takes the same ending; no order decides between them."""
    text = FAILING.format(body="return ()").replace(".bad", ".xyz")
    points = {SAMPLES: {"failing": "taker:FORMAT"}}
    site = install(tmp_path / "site", "taker", points, {"taker": text})
    monkeypatch.syspath_prepend(site)
    path = samples_file(tmp_path)
    assert run(monkeypatch, "import", path, "--out", tmp_path / "s.h5") == 2
    line = one_line(capsys)
    assert "'lab-samples' of jointbench-example 1.0 and 'failing' of taker 1.0" in line


@pytest.mark.usefixtures("example")
def test_built_in_formats_are_read_as_before_beside_a_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A file that no package takes has no package in its provenance."""
    path, out = tmp_path / "face.csv", tmp_path / "s.h5"
    rows = [f"{PITCH * i:.1f},{z:.3f}" for i, z in enumerate(HEIGHTS)]
    path.write_text("\n".join(["x [um],z [um]", *rows, ""]), encoding="utf-8")
    with caplog.at_level(logging.WARNING):
        assert run(monkeypatch, "import", path, "--out", out) == 0
    (surface,) = read_session(out).surfaces
    assert "package" not in {step.name for step in surface.provenance}
    assert not caplog.records


GREEDY = """
from jointbench.acquisition.formats.heights.height_format import HeightFormat
FORMAT = HeightFormat("greedy", lambda file: {recognise}, None, with_columns=True)
"""


@pytest.mark.parametrize(
    ("recognise", "warnings"),
    [("file.lines[0] == 'MARK'", 0), ("file.lines['first']", 1), ("1 / 0 > 1", 1)],
)
def test_a_format_that_fails_to_recognise_leaves_the_others_alone(
    recognise: str,
    warnings: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    """A .npy array is no text: that is a no; an error of the code is one warning."""
    module = f"greedy_{len(recognise)}"
    points = {"jointbench.height_formats": {"greedy": f"{module}:FORMAT"}}
    modules = {module: GREEDY.format(recognise=recognise)}
    monkeypatch.syspath_prepend(install(tmp_path / "site", module, points, modules))
    text, array = tmp_path / "a.csv", tmp_path / "b.npy"
    text.write_text("0 1\n1 2\n2 4\n", encoding="utf-8")
    np.save(array, np.array([[0.0, 1.0, 2.0], [1.0, 2.0, 4.0]]).T)
    out = tmp_path / "s.h5"
    words = ("--columns", "x:um,z:um", "--out", out)
    with caplog.at_level(logging.WARNING):
        assert run(monkeypatch, "import", array, text, *words) == 0
    assert len(read_session(out).surfaces) == 2
    assert len(caplog.records) == warnings
