"""Files of every layout that was ever written are read by this version."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.store import SESSION_SCHEMA, read_session
from jointbench.station.archive.archive_table import TABLE_SCHEMA
from jointbench.station.archive.ledger import LEDGER_SCHEMA, open_ledger, read_ledger
from jointbench.station.results.result_rows import MODAL_SCHEMA, PROCESSED_SCHEMA
from jointbench.station.results.results_read import read_result

KEPT = Path(__file__).parents[2] / "fixtures"
WRITTEN = {
    SESSION_SCHEMA: "session-1.h5",
    LIVE_SCHEMA: "live-1.h5",
    MODAL_SCHEMA: "modal-1.results.h5",
    PROCESSED_SCHEMA: "processed-2.results.h5",
    TABLE_SCHEMA: "archive-1.nc",
}


@pytest.mark.parametrize("schema", WRITTEN)
def test_every_layout_that_is_written_has_a_file_that_is_kept(schema: str) -> None:
    """Whoever raises a version must add a file of it to tests/fixtures."""
    with h5py.File(KEPT / WRITTEN[schema], "r") as file:
        assert file.attrs["schema"] == schema.encode()


def test_session_layout_1() -> None:
    """Samples, hits, surface, setup as they were written in 2026."""
    session = read_session(KEPT / "session-1.h5")
    recording = session.recordings[0]
    assert recording.samples.shape == (2, 2048)
    assert [hit.verdict for hit in recording.hits] == [Verdict.OK, Verdict.OK]
    assert recording.hits[0].trigger == 103
    assert recording.channels[1].unit == "g"
    assert session.joint is not None
    assert (session.joint.torque, session.joint.masses) == (20.0, {"top": 4.6})
    face = session.surfaces[0]
    assert np.flatnonzero(~face.valid).tolist() == [5]
    assert face.instrument.stylus_radius == 2e-6


def test_live_layout_1() -> None:
    """A recording that was cut off opens with its two blocks."""
    session = read_session(KEPT / "live-1.h5")
    assert session.recordings[0].samples.shape == (2, 1024)
    assert session.recordings[0].preload == 10.0


@pytest.mark.parametrize(("name", "preload"), [("modal-1", None), ("processed-2", 5e3)])
def test_results_layouts_1_and_2(name: str, preload: float | None) -> None:
    """The mode at 150 Hz is read from either; what layout 1 lacks is empty."""
    result = read_result(KEPT / f"{name}.results.h5")
    modes = [q for q in result.quantities if q.name == "natural_frequency"]
    assert modes[0].value == pytest.approx(150.0, rel=1e-3)
    assert result.preload == preload
    assert bool(result.stages) is (preload is not None)


def test_ledger_layout_1(tmp_path: Path) -> None:
    """A file that was refused is remembered by its key."""
    kept = KEPT / "ledger-1.jsonl"
    assert read_ledger(kept)[0]["schema"] == LEDGER_SCHEMA
    copy = tmp_path / "l.jsonl"
    copy.write_bytes(kept.read_bytes())
    with open_ledger(copy, {}) as ledger:
        assert ledger.refused == {"bad.h5": ("k", "is empty")}


def test_results_of_a_later_layout_are_refused_with_the_way_out(
    tmp_path: Path,
) -> None:
    """The message says that a later version reads it."""
    path = tmp_path / "r.results.h5"
    path.write_bytes((KEPT / "processed-2.results.h5").read_bytes())
    with h5py.File(path, "a") as file:
        file.attrs["schema"] = np.bytes_("jointbench-results/9")
    with pytest.raises(FormatError, match="a later jointbench reads it"):
        read_result(path)
