"""A session whose every text is hostile, through every command that reads one."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.session import JointSetup
from jointbench.acquisition.records.surfaces import Profile, SurfaceInstrument
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.files.spreadsheet_text import escaped
from jointbench.station.main import app, exit_code
from jointbench.station.screen.page import render
from jointbench.station.screen.page_parts import DataTable, Plot, Report, Section

COMMANDS = "\x07\x08\x1b\x7f\x9b\x9d"
DIRECTIONS = "\u061c\u200f\u202e\u2066"
NO_WIDTH = "\u00ad\u034f\u200b\u200d\u2060\u3164\ufe0f\ufeff\U000e0041"
LINES = "\r\x85\u2028\u2029"
BAD = COMMANDS + DIRECTIONS + NO_WIDTH + LINES
SPOILT = re.compile(f"zq[{BAD}]|[{BAD}]zq|\nFORGED")
FORMULA = re.compile('(^|[,\n])"?=zq')
TEXT_FILES = {".csv", ".html", ".uff", ".json", ".jsonl", ".txt", ".toml", ".log"}


def hostile(what: str) -> str:
    """Return a text with everything that must not be shown as it is."""
    return f"=zq{what}zq" + "zq".join(BAD) + "zq\nFORGED<script>zq</script><a href=x>zq"


@pytest.fixture
def sessions(tmp_path: Path, make_session) -> list[Path]:
    """Return two sessions of hostile texts that are alike but for the noise."""
    paths = [make_session(f"{seed}.h5", seed=seed, hits=3) for seed in (1, 2)]
    for path in paths:
        spoil(path)
    return paths


def spoil(path: Path) -> None:
    """Put a hostile text wherever a session holds one."""
    session = read_session(path)
    how = (step(hostile("step"), detail=hostile("detail")),)
    one = session.recordings[0]
    channels = tuple(
        replace(c, name=hostile(c.name), point=hostile("p"), direction=way)
        for c, way in zip(one.channels, (hostile("d"), "+z"), strict=True)
    )
    hits = tuple(
        replace(hit, reason=hostile("reason"), point=hostile("p")) for hit in one.hits
    )
    heights = np.random.default_rng(1).normal(size=400).cumsum() * 1e-7
    stylus = SurfaceInstrument(hostile("stylus"))
    face = Profile(hostile("face"), heights, 1e-6, np.ones(400, bool), stylus, how)
    path.unlink()
    write_session(
        replace(
            session,
            uuid=hostile("uuid") + path.stem,
            created=hostile("created"),
            software=hostile("software"),
            operator=hostile("operator"),
            notes=f"specimen: {hostile('notes')}",
            source=hostile("source"),
            joint=JointSetup(
                2e4, 20.0, {hostile("modulus"): 2e11}, {hostile("base"): 9.0}
            ),
            recordings=(
                replace(
                    one,
                    name=hostile("stream"),
                    channels=channels,
                    hits=hits,
                    provenance=how,
                ),
            ),
            surfaces=(face,),
            provenance=how,
        ),
        path,
    )


BENCH = """\
[bodies.base]
mass = "9 kg"
channel = "a0"
[links."\\u001bzq"]
between = ["ground", "base"]
"""


def test_no_command_shows_what_a_file_wants_a_terminal_or_browser_to_do(
    sessions: list[Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Neither the screen nor a text file holds a raw character of a name."""
    first, second = map(str, sessions)
    out = tmp_path / "out"
    out.mkdir()
    (out / "wide.toml").write_text('[windows]\nforce_width = "30 ms"\n')
    (out / "bench.toml").write_text(BENCH)
    (out / "narrow.toml").write_text("\n")
    bad = tmp_path / "zq\x1bzq\nFORGED.h5"
    bad.write_bytes(b"\x89HDF\r\n\x1a\n" + b"zq\x1bzq" * 9)
    reported = ""

    def run(*words: str | Path, code: int = 0) -> None:
        nonlocal reported
        monkeypatch.setattr(sys, "argv", ["jointbench", *map(str, words)])
        found = exit_code(app, debug=False)
        shown = "".join(capsys.readouterr())
        assert found == code, shown
        spoilt = SPOILT.search(shown)
        assert spoilt is None, (words, shown[max(0, spoilt.start() - 80) :][:200])
        reported += shown

    run("inspect", first)
    run("verify", first)
    run("verify", bad, code=3)
    run("modal", first, "--out", out / "m.results.h5", "--uff", out / "m.uff")
    run("inspect", out / "m.results.h5")
    run("modal", first, "--drop", "99", code=2)
    run("modal", first, "--output-only", code=3)
    run("process", first, "--recipe", out / "narrow.toml", "--json", out / "p.json")
    run("process", second, "--recipe", out / "narrow.toml")
    both = str(tmp_path / "*.h5")
    run("reprocess", both, "--recipe", out / "wide.toml", "--jobs", "1", code=5)
    old, new = (str(tmp_path / f"*.{name}.results.h5") for name in ("narrow", "wide"))
    run("compare", old, new, "--json", out / "c.json")
    run("archive", new, "--out", out / "all.csv", "--trend", "torque")
    run("report", first, "--out", out / "report.html")
    run("identify", out / "bench.toml", first, code=3)
    run("gap", first, "--model", out / "bench.toml", code=3)
    run("gap", first, code=2)
    run("calibrate", first, "--mass", "4 kg", code=5)
    for file in (first, tmp_path / "1.narrow.results.h5"):
        for kind in ("csv", "uff"):
            run("export", file, "--to", kind, "--out", out)
    run("export", out / "m.uff", "--to", "csv", "--out", out)
    assert r"\x1b" in reported
    looked_at = [p for p in tmp_path.rglob("*") if p.suffix in TEXT_FILES]
    assert {".csv", ".html", ".uff", ".json"} <= {p.suffix for p in looked_at}
    for path in looked_at:
        text = path.read_text(encoding="utf-8")
        spoilt = SPOILT.search(text)
        assert spoilt is None, (path, text[max(0, spoilt.start() - 80) :][:200])
        assert path.suffix != ".html" or "<script>zq" not in text
        assert path.suffix != ".csv" or not FORMULA.search(text), path


@pytest.mark.parametrize("bad", BAD)
def test_every_character_that_does_not_show_is_written_as_its_escape(bad: str) -> None:
    """A backslash and its number stand for it; what shows is not touched."""
    assert visible(f"Träger [m/s²] {bad}") == f"Träger [m/s²] {_escaped(bad)}"


def _escaped(one: str) -> str:
    written = {"\r": "\\r"}.get(one)
    size = ord(one)
    return written or (
        f"\\x{size:02x}"
        if size < 0x100
        else f"\\u{size:04x}"
        if size < 0x10000
        else f"\\U{size:08x}"
    )


@pytest.mark.parametrize("cell", ["=1+1", "+1", "-1", "@A1", " =1", "\uff1d1", "\t=1"])
def test_no_cell_of_a_table_begins_as_a_formula(cell: str) -> None:
    """A quote, or a backslash that was a tab, comes before what calculates."""
    assert escaped(cell)[0] in "'\\"
    assert escaped("1 = 1") == "1 = 1"


def test_a_name_in_a_figure_is_text() -> None:
    """Names stand in legends, at points and in what is read aloud: never as markup."""
    name = "a<br>b<a href='https://x'>c</a>\u202e"
    trace = {
        "name": name,
        "mode": "markers+text",
        "text": [name],
        "x": [1.0],
        "y": [1.0],
    }
    axes = {"xaxis": {"title": {"text": name}}, "annotations": [{"text": name, "x": 1}]}
    figure = {"data": [trace, {**trace, "name": f"{name}2"}], "layout": axes}
    plot = Plot("p", "caption", figure)
    solid = {**trace, "type": "scatter3d", "z": [1.0]}
    scene = Plot("q", "caption", {"data": [solid], "layout": {}})
    table = DataTable("t", ("c",), ((name,),))
    section = Section("s", "s", (plot, scene, table))
    page = render(Report("t", "", "", False, (), (section,)))
    assert page.count("a&lt;br&gt;b&lt;a href=") >= 6
    assert r"a\u003cbr\u003eb\u003ca" in page
    assert "<a href='https" not in page
    assert "<br>" not in page
    assert "\u202e" not in page


def test_a_colour_in_a_figure_is_a_colour() -> None:
    """What is no colour is drawn in the colour of the model."""
    bad = "red;} body{display:none"
    line = {"x": [0, 1], "y": [0, 1], "line": {"color": bad, "dash": bad, "width": bad}}
    plot = Plot("p", "caption", {"data": [line], "layout": {}})
    page = render(Report("t", "", "", False, (), (Section("s", "s", (plot,)),)))
    assert "display:none" not in page.partition("</style>")[2]
    assert '<path class="ln c-model"' in page
