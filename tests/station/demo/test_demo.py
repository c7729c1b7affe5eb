"""The main job, end to end, on the embedded simulated bench."""

import json
import re
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.store import read_session, write_session
from jointbench.station.commands.identify.identify_links_command import run_identify
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.demo.demo import require_demo, run_demo
from jointbench.station.demo.demo_bench import HITS
from jointbench.station.files.toml_file import read_toml
from jointbench.station.pipeline.modal_options import modal_settings
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.screen.page import render
from jointbench.station.screen.page_parts import DataTable, Report, Section, Text


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run the demo once, with a seed that no default uses."""
    folder = tmp_path_factory.mktemp("demo")
    assert run_demo(folder, seed=11, json_target=None) == 0
    return folder


@pytest.fixture(scope="module")
def summary(demo: Path) -> dict[str, Any]:
    """Return the demo's summary."""
    content: dict[str, Any] = json.loads((demo / "summary.json").read_text())
    return content


def test_the_summary_lays_truth_beside_estimate(summary: dict[str, Any]) -> None:
    """Frequencies within 0.1 %, damping within 10 %, D within 0.03."""
    rows = {row["quantity"]: row for row in summary["comparisons"]}
    for mode in range(2):
        row = rows[f"natural_frequency[{mode}]"]
        assert abs(row["estimate"] / row["truth"] - 1) < 1e-3
        row = rows[f"damping_ratio[{mode}]"]
        assert abs(row["estimate"] / row["truth"] - 1) < 0.1
    for face in ("face-a", "face-b"):
        row = rows[f"dimension[{face}]"]
        assert abs(row["estimate"] - row["truth"]) < 0.03
    for link in ("support", "joint"):
        row = rows[f"{link}.stiffness"]
        assert abs(row["estimate"] - row["truth"]) < 4 * row["sd"]


def test_every_hit_is_found_and_judged_as_it_was_struck(
    summary: dict[str, Any],
) -> None:
    """Doubles and overloads are rejected, and only they."""
    rows = {row["quantity"]: row for row in summary["comparisons"]}
    assert rows["hits_judged_right"]["estimate"] == HITS
    verdicts = {hit["verdict"] for hit in summary["modal"]["hits"]}
    assert "ok" in verdicts


def test_the_second_session_names_the_hidden_effect(
    demo: Path, summary: dict[str, Any]
) -> None:
    """Name, site and parameter; session, model and truth lie beside the summary."""
    found = summary["gap"]
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert {effect["name"]: effect["site"]} == found["truth"]["sites"]
    assert found["gap_after"] < 0.1 * found["gap_before"]
    rows = {row["quantity"]: row for row in summary["comparisons"]}
    assert abs(rows["gap.k3"]["estimate"] / rows["gap.k3"]["truth"] - 1) < 0.03
    assert len(read_session(demo / "gap-session.h5").recordings) == 8
    assert read_toml(demo / "gap-session.toml", BenchModel).gap.preload_reference
    assert "Gap between model and measurement" in (demo / "report.html").read_text(
        "utf-8"
    )


def test_the_session_holds_what_the_summary_speaks_of(demo: Path) -> None:
    """The file is the evidence: three channels, all hits, both surfaces, no truth."""
    session = read_session(demo / "session.h5")
    (recording,) = session.recordings
    assert [c.name for c in recording.channels] == ["force", "a0", "a1"]
    assert len(recording.hits) == HITS
    assert [s.name for s in session.surfaces] == ["face-a", "face-b"]
    assert session.simulated


def test_session_and_results_open_in_xarray(demo: Path) -> None:
    """Whoever does not have jointbench still reads the data, with units."""
    stream = xr.open_dataset(
        demo / "session.h5", group="stream/stream", engine="h5netcdf"
    )
    assert stream["samples"].shape[0] == 3
    modes = xr.open_dataset(
        demo / "session.results.h5", group="modes", engine="h5netcdf"
    )
    assert modes["natural_frequency"].attrs["units"] == "Hz"
    assert modes["natural_frequency"].size == 2


def test_prediction_and_identification_are_compared_by_their_ratio(
    demo: Path,
) -> None:
    """The sentence of the report names both sides of the ratio."""
    page = (demo / "report.html").read_text(encoding="utf-8")
    assert re.search(r"N/m; predicted / identified = \d", page)


def test_the_report_asks_nothing_of_the_network(demo: Path) -> None:
    """No element loads an address outside the file, and a policy forbids it besides."""
    page = (demo / "report.html").read_text(encoding="utf-8")
    assert "default-src 'none'" in page
    loaded = re.findall(r"""(?:src|href)\s*=\s*["']?([^"'\s>]{1,40})""", page)
    outside = [one for one in loaded if not one.startswith(("#", "data:image/png"))]
    assert [one for one in outside if one != "URL.createObjectURL(new"] == []
    assert not re.search(r"@import|url\(|fetch\(|XMLHttpRequest|import\(", page)


def test_the_report_is_small(demo: Path) -> None:
    """Below 2 MB with every figure; it had 6.3 MB with a library for them."""
    assert (demo / "report.html").stat().st_size < 600_000


def test_the_report_begins_with_the_finding(demo: Path) -> None:
    """Sentences, then up to six numbers with intervals, then figures."""
    page = (demo / "report.html").read_text(encoding="utf-8")
    head = page.partition("<main")[0]
    first = head.partition('<dl class="tiles">')
    assert first[0].count('<p class="finding">') >= 4
    assert "Cubic stiffness in the joint explains" in first[0]
    shown = first[2].partition("</dl>")[0]
    assert 3 <= shown.count("<dt>") <= 6
    assert shown.count("95 %:") >= 4
    assert "<svg" not in head


def test_accepted_hits_are_folded_and_rejected_ones_have_their_reasons(
    demo: Path, summary: dict[str, Any]
) -> None:
    """Each hit stands in the report once, and none is lost."""
    page = (demo / "report.html").read_text(encoding="utf-8")
    hits = page.partition('<section id="hits">')[2].partition("</section>")[0]
    shown, _, folded = hits.rpartition("<details>")
    verdicts = [hit["verdict"] for hit in summary["modal"]["hits"]]
    assert folded.count('<tr role="row">') - 1 == verdicts.count("ok")
    assert shown.count('class="bad prose"') == len(verdicts) - verdicts.count("ok")
    rejected = [h for h in summary["modal"]["hits"] if h["verdict"] != "ok"]
    assert all(hit["reason"] in unescape(shown) for hit in rejected)


def test_identify_repeats_the_joint_from_the_files_alone(
    demo: Path, summary: dict[str, Any]
) -> None:
    """Model and session on disk are enough; nothing is carried over in memory."""
    found = run_identify(demo / "bench.toml", [demo / "session.h5"], json_target=None)
    before = summary["joint"]["parameters"]["joint.stiffness"]["value"]
    assert np.isclose(found.parameter("joint.stiffness").value, before, rtol=1e-9)


def test_a_narrow_band_finds_only_the_mode_inside(demo: Path) -> None:
    """--band restricts the fit."""
    chain = run_modal(
        [demo / "session.h5"],
        modal_settings("100:400", None, "H1", (), ()),
        out=demo / "narrow.h5",
    )
    assert chain.result.model.natural_frequency.size == 1


def test_the_demo_writes_a_model_that_reads_back(demo: Path) -> None:
    """The masses are weighed, not copied from the truth."""
    model = read_toml(demo / "bench.toml", BenchModel)
    assert set(model.bodies) == {"base", "top"}
    assert model.bodies["top"].mass != 4.6
    assert abs(model.bodies["top"].mass / 4.6 - 1) < 0.01


def test_the_demo_can_be_run_again_where_it_was_run(demo: Path) -> None:
    """All that it left is its own."""
    require_demo(demo)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("bench.toml", "# my bench\n"),
        ("face-a.csv", "x [um],z [um]\n0,1\n"),
        ("session.h5", "no session"),
    ],
)
def test_files_of_the_demos_names_that_are_ones_own_are_kept(
    tmp_path: Path, name: str, content: str
) -> None:
    """A model, a table of heights, anything else."""
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(UsageError):
        run_demo(tmp_path, seed=1, json_target=None)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text(encoding="utf-8") == content


def test_a_session_of_a_real_bench_is_kept_from_the_demo(tmp_path: Path) -> None:
    """Measured into the folder of the demo, under the name that it uses."""
    path = tmp_path / "session.h5"
    write_session(new_session(source="ni:", simulated=False), path)
    before = path.read_bytes()
    with pytest.raises(UsageError, match="no demo"):
        run_demo(tmp_path, seed=1, json_target=None)
    assert path.read_bytes() == before


def test_texts_from_files_cannot_become_markup() -> None:
    """A name out of a file is shown, not run."""
    evil = "</script><script>alert(1)</script>"
    section = Section("s", evil, (Text(evil), DataTable(evil, ("reason",), ((evil,),))))
    page = render(Report(evil, evil, "jointbench", False, (), (section,)))
    assert "<script>alert" not in page
