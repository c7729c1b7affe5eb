"""From hits on a hung mass, through the chassis, to the ratio of the sensors."""

import json
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.commands.calibrate_command import run_calibrate
from jointbench.station.measure.bench_session import run_measure

PLAN = Path(__file__).parents[3] / "examples" / "calibration.toml"


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Measure on a mass with a hammer 3 % high and accelerometers 2 % low."""
    out = tmp_path_factory.mktemp("mass") / "mass.h5"
    source = "sim:mass?mass=4.512&hammer=1.03&response=0.98&seed=4"
    measured = run_measure(PLAN, out, source=source, overwrite=False, json_target=None)
    assert measured.whole
    assert measured.record.checks == []
    return out


def test_the_ratio_of_the_true_sensitivities_is_found(
    session: Path, tmp_path: Path
) -> None:
    """0.98 / 1.03 for each of three accelerometers, within the interval stated."""
    target = tmp_path / "c.json"
    run_calibrate(session, mass="4.512 kg", mass_sd="0.5 g", json_target=str(target))
    found = json.loads(target.read_text())["calibrations"]
    assert [each["channel"] for each in found] == ["a1", "a2", "a6"]
    for each in found:
        assert abs(each["ratio"] - 0.98 / 1.03) < each["ratio_expanded_95"] < 5e-4
        assert each["passed"]


def test_a_mass_of_nothing_is_refused(session: Path) -> None:
    """The message names what is missing."""
    with pytest.raises(UsageError, match="above zero"):
        run_calibrate(session, mass="0 kg", mass_sd="0 g", json_target=None)
