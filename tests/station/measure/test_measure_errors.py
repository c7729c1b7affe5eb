"""A session that continues after errors of the device, each by NI's own number."""

from pathlib import Path

import pytest

from jointbench.acquisition.session_file.store import read_session
from jointbench.station.commands.verify_command import run_verify
from jointbench.station.measure.bench_session import Measured, run_measure

EXAMPLE = Path(__file__).parents[3] / "examples" / "plates.toml"


def run(folder: Path, faults: str) -> Measured:
    """Measure two hits at one point, with what goes wrong meanwhile."""
    text = EXAMPLE.read_text(encoding="utf-8").replace("25.6 kHz", "12.8 kHz")
    head, _, rest = text.partition("[hits]")
    _, _, tail = rest.partition("[joint]")
    hits = (
        'points = ["1"]\ntorques = ["20 N m"]\nrepeats = 2\ntrial_hits = 0\n'
        'length = "0.5 s"\n'
    )
    path = folder / "plan.toml"
    path.write_text(f"{head}[hits]\n{hits}\n[joint]{tail}", encoding="utf-8")
    return run_measure(
        path,
        folder / "s.h5",
        source=f"sim:plates?faults={faults}",
        overwrite=False,
        json_target=None,
    )


@pytest.mark.parametrize(
    ("code", "gaps"),
    [
        (200361, ["rearmed"]),
        (200222, ["rearmed"]),
        (200045, ["lost", "back"]),
        (201390, ["lost", "back"]),
        (200284, []),
    ],
)
def test_the_plan_is_done_though_the_device_stopped_went_away_or_was_late(
    tmp_path: Path, code: int, gaps: list[str]
) -> None:
    """The file records what happened and is whole; nothing is lost that was there."""
    measured = run(tmp_path, f"error@6400:{code}")
    steps = read_session(tmp_path / "s.h5").provenance
    assert measured.whole
    assert [dict(s.detail)["what"] for s in steps if s.name == "gap"] == gaps
    assert measured.counters.lost == 0
    assert run_verify(tmp_path / "s.h5", json_target=None)


@pytest.mark.parametrize("code", [200741, 200753])
def test_a_plan_with_serial_numbers_is_measured_on_modules_without_teds(
    tmp_path: Path, code: int
) -> None:
    """Every sensor of the example states one; each is taken at its word."""
    measured = run(tmp_path, f"teds_error@0:{code}")
    steps = read_session(tmp_path / "s.h5").provenance
    assert measured.whole
    words = [str(dict(s.detail)["words"]) for s in steps if s.name == "warning"]
    assert not [line for line in words if "serial number" in line]
