"""A session in which the device itself looks for the hits."""

from pathlib import Path

import pytest

from jointbench.acquisition.records.recordings import Verdict
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.measure.bench_session import Measured, run_measure

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"


def run(folder: Path, source: str) -> Measured:
    """Measure two points, two hits each, after one trial hit, by the device."""
    text = EXAMPLE.read_text(encoding="utf-8")
    text = text.replace('"25.6 kHz"', '"12.8 kHz"\ntrigger = "hardware"')
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    hits = (
        'points = ["1", "2"]\ntorques = ["20 N m"]\nrepeats = 2\ntrial_hits = 1\n'
        'length = "0.3 s"\n'
    )
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{hits}\n[joint]{tail}", encoding="utf-8")
    return run_measure(
        path, folder / "s.h5", source=source, overwrite=False, json_target=None
    )


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Measured:
    """Measure once on modules that have a trigger."""
    return run(tmp_path_factory.mktemp("hardware"), "sim:plates?seed=2")


def test_the_plan_is_done_with_a_block_for_each_hit(measured: Measured) -> None:
    """Each is a recording of its own, of pre-trigger, length and some room."""
    session = read_session(measured.path)
    blocks = [r for r in session.recordings if r.name.startswith("20 Nm")]
    assert measured.whole
    assert [hit.point for r in blocks for hit in r.hits] == ["1", "1", "2", "2"]
    room = 64
    for recording in blocks:
        assert recording.samples.shape[1] == 128 + 3840 + room


def test_nothing_is_lost_between_the_blocks_that_the_device_delivered(
    measured: Measured,
) -> None:
    """What was read is in the file; what was not requested is no loss."""
    assert measured.counters.lost == 0
    stored = sum(r.samples.shape[1] for r in read_session(measured.path).recordings)
    assert stored == measured.counters.delivered


def test_the_edge_of_a_hit_stands_where_the_program_finds_it_too(
    measured: Measured,
) -> None:
    """Device and program agree on the sample of the edge within one."""
    for recording in read_session(measured.path).recordings:
        for hit in recording.hits:
            if hit.verdict is Verdict.OK:
                assert abs(hit.trigger - (128 + 32)) <= 1


def test_modules_without_a_trigger_leave_it_to_the_program(tmp_path: Path) -> None:
    """With a warning; the plan is done nevertheless."""
    measured = run(tmp_path, "sim:plates?trigger=0")
    steps = read_session(tmp_path / "s.h5").provenance
    warnings = [str(dict(s.detail)["words"]) for s in steps if s.name == "warning"]
    assert measured.whole
    assert any("trigger = 'hardware'" in words for words in warnings)
