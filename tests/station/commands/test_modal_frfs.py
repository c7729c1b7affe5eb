"""`jointbench modal` on FRFs: the same modes as from the samples they came from."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
from typer.testing import CliRunner

from jointbench.acquisition.basics.errors import BadData, JointbenchError
from jointbench.station.main import app
from jointbench.station.results.results_modes import read_run

POLES = np.array([-2.0 + 2j * np.pi * 60.0, -4.0 + 2j * np.pi * 95.0])
RESIDUES = np.array([[0.9, -0.4], [0.5, 0.8]])
RATE, SAMPLES = 1024.0, 12288
"""Long enough to end quietly: FRFs do not say where their records ended (0158)."""
BOTH = ("natural_frequency", "damping_ratio")


def run(*arguments: object) -> tuple[int, str]:
    """Run a command; return its exit code and all that it printed."""
    result = CliRunner().invoke(app, list(map(str, arguments)))
    if isinstance(result.exception, JointbenchError):
        code = 3 if isinstance(result.exception, BadData) else 2
        return code, str(result.exception)
    return result.exit_code, result.output


def hits(folder: Path) -> list[Path]:
    """Write three hits on two modes and two accelerometers, with noise."""
    time = np.arange(SAMPLES) / RATE
    decay = np.exp(np.outer(POLES, time)).imag
    rng = np.random.default_rng(11)
    files = []
    for number in range(3):
        force = np.zeros(SAMPLES)
        force[64:72] = (100.0 + 20.0 * number) * np.hanning(10)[1:-1]
        motion = RESIDUES @ decay
        response = np.array([np.convolve(force, row)[:SAMPLES] for row in motion])
        response += 1e-3 * np.abs(response).max() * rng.standard_normal(response.shape)
        # Without it the spectrum of the force has zeros, where the FRF is infinite.
        force += 1e-4 * force.max() * rng.standard_normal(SAMPLES)
        path = folder / f"hit{number}.npy"
        np.save(path, np.vstack([time, force, response]))
        files.append(path)
    return files


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """A session, its modes as JSON, and its results exported as a universal file."""
    folder = tmp_path_factory.mktemp("frf")
    session = folder / "s.h5"
    columns = "time:s,force:N,acceleration.a1@1:m/s^2,acceleration.a2@2:m/s^2"
    files = hits(folder)
    assert run("import", *files, "--out", session, "--columns", columns)[0] == 0
    done = run("modal", session, "--json", folder / "s.json", "--uff", folder / "s.uff")
    assert done[0] == 0, done[1]
    return folder


def modes(path: Path) -> tuple[list[float], list[float], list[float]]:
    """Return frequencies, damping ratios and their standard deviations."""
    page = json.loads(path.read_text())["modes"]
    return tuple(
        [mode[name] for mode in page]
        for name in ("frequency_hz", "damping_ratio", "damping_ratio_sd")
    )


def test_exported_frfs_have_the_modes_of_the_samples(measured, tmp_path):
    """Frequencies, damping ratios and their intervals agree to 1e-6."""
    own = tmp_path / "u.json"
    code, shown = run("modal", measured / "s.uff", "--json", own)
    assert code == 0, shown
    for one, other in zip(modes(own), modes(measured / "s.json"), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6)
    page = json.loads(own.read_text())
    assert page["results"] == str(measured / "s-uff.results.h5")
    assert page["averages"] == 3
    assert page["hits"] == []


def test_frfs_have_results_a_report_and_an_export(measured, tmp_path):
    """The results file names its input; the report needs nothing else."""
    target, page = tmp_path / "f.results.h5", tmp_path / "f.html"
    assert run("modal", measured / "s.uff", "--out", target)[0] == 0
    code, shown = run("report", target, "--out", page)
    assert code == 0, shown
    assert "no samples were given" in page.read_text()
    code, shown = run("report", measured / "s.uff", "--results", target, "--out", page)
    assert code == 0, shown
    code, shown = run("report", measured / "s.results.h5", "--out", page)
    assert code == 2
    assert "session" in shown
    assert run("export", target, "--to", "uff", "--out", tmp_path)[0] == 0
    again = tmp_path / "g.json"
    assert run("modal", tmp_path / "f.results.uff", "--json", again)[0] == 0
    stored = read_run(target).modes[0].result.model
    np.testing.assert_allclose(modes(again)[0], stored.natural_frequency, rtol=1e-9)


def test_modes_of_frfs_are_kept_and_dropped_by_the_user(measured, tmp_path):
    """The same options as for samples."""
    target = tmp_path / "k.results.h5"
    code, shown = run(
        "modal", measured / "s.uff", "--drop", "60", "--keep", "95", "--out", target
    )
    assert code == 0, shown
    model = read_run(target).modes[0].result.model
    assert np.abs(model.natural_frequency - 60.0).min() > 1.0
    assert model.by_hand.sum() == 1


def test_other_formats_give_the_same_modes(measured, tmp_path):
    """Text, arrays and MAT of one FRF, without its noise, agree with each other."""
    with h5py.File(measured / "s.results.h5") as file:
        group = file["frf"]
        lines = group["frequency"][()]
        frf = group["frf_re"][()] + 1j * group["frf_im"][()]
    np.savez(tmp_path / "a.npz", f=lines, H=frf)
    scipy.io.savemat(tmp_path / "a.mat", {"f": lines, "H": np.moveaxis(frf, 2, 0)})
    rows = [lines, *(part for row in frf[:, 0] for part in (row.real, row.imag))]
    np.savetxt(tmp_path / "a.txt", np.array(rows).T, fmt="%.17g")
    arrays = "frequency.f:Hz,frf.H:m/s^2/N"
    table = "frequency:Hz,real.1:m/s^2/N,imaginary.1:m/s^2/N,"
    table += "real.2:m/s^2/N,imaginary.2:m/s^2/N"
    found = []
    for name, columns in (("npz", arrays), ("mat", arrays), ("txt", table)):
        target = tmp_path / f"{name}.json"
        args = ("modal", tmp_path / f"a.{name}", "--columns", columns)
        code, shown = run(*args, "--json", target)
        assert code == 0, shown
        assert "estimated from the differences of neighbouring" in " ".join(
            json.loads(target.read_text())["notes"]
        )
        found.append(modes(target))
    for other in found[1:]:
        np.testing.assert_allclose(other[0], found[0][0], rtol=1e-9)
        np.testing.assert_allclose(other[1], found[0][1], rtol=1e-6)
    frequency, _, _ = modes(measured / "s.json")
    for value in np.abs(POLES) / (2 * np.pi):
        assert np.abs(np.array(found[0][0]) - value).min() < 0.02
        assert np.abs(np.array(frequency) - value).min() < 0.02


def test_coherence_and_averages_give_the_variance(measured, tmp_path):
    """--averages turns coherence into intervals like those of the scatter."""
    with h5py.File(measured / "s.results.h5") as file:
        group = file["frf"]
        arrays = {
            "f": group["frequency"][()],
            "H": group["frf_re"][()] + 1j * group["frf_im"][()],
            "c": group["coherence"][()],
        }
    np.savez(tmp_path / "a.npz", **arrays)
    columns = "frequency.f:Hz,frf.H:m/s^2/N,coherence.c"
    target = tmp_path / "a.json"
    args = ("modal", tmp_path / "a.npz", "--columns", columns, "--averages", "3")
    code, shown = run(*args, "--json", target)
    assert code == 0, shown
    own, stated = modes(target), modes(measured / "s.json")
    assert "coherence" in " ".join(json.loads(target.read_text())["notes"])
    strong = [int(np.argmin(np.abs(np.array(own[0]) - f))) for f in (60.0, 95.0)]
    there = [int(np.argmin(np.abs(np.array(stated[0]) - f))) for f in (60.0, 95.0)]
    ratio = np.array(own[2])[strong] / np.array(stated[2])[there]
    assert np.all((ratio > 0.5) & (ratio < 2.0))


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("hit0.npy", "--averages", "3"), 3, "for FRFs --columns"),
        (("s.uff", "hit0.npy"), 2, "holds FRFs"),
        (("s.uff", "s.uff"), 2, "the same data"),
        (("s.h5", "--averages", "3"), 2, "files of FRFs"),
        (("cut.uff",), 3, "cut short"),
        (("s.uff", "--columns", "frf:g/N"), 3, "by its file"),
    ],
)
def test_what_does_not_fit_is_one_line_with_its_code(measured, arguments, code, words):
    """Exit code 2 for the request, 3 for the data."""
    (measured / "cut.uff").write_bytes((measured / "s.uff").read_bytes()[:-900])
    first = [str(measured / a) if "." in a and ":" not in a else a for a in arguments]
    if arguments[0] == "hit0.npy":
        first = first[:1]
    found, shown = run("modal", *first)
    assert found == code, shown
    assert words in " ".join(shown.split())


def test_a_missing_pair_is_named(tmp_path):
    """Two outputs and two inputs need four FRFs."""
    lines = np.arange(200.0)
    rows = [lines] + [np.cos(lines)] * 6
    np.savetxt(tmp_path / "a.txt", np.array(rows).T)
    labels = ("1/1", "2/1", "2/2")
    columns = ",".join(f"real.{n}:m/N,imaginary.{n}:m/N" for n in labels)
    code, shown = run(
        "modal", tmp_path / "a.txt", "--columns", f"frequency:Hz,{columns}"
    )
    assert code == 3
    assert "output '1' from input '2' is missing" in " ".join(shown.split())
