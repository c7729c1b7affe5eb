"""Real hits and real surfaces, through the commands a user types."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.simulators.rough_surfaces.surface_files import write_keyence_csv
from jointbench.station.commands.import_command import ImportRequest, run_import
from jointbench.station.commands.modal_command import run_modal
from jointbench.station.commands.surface_command import run_surface

DATA = Path(__file__).parents[4] / "shared" / "data"
COLUMNS = "time:s,force:N,acceleration:m/s^2"
VERDICTS = {
    "fractal",
    "fractal within a band",
    "instrument-limited",
    "no scaling range",
}

pytestmark = pytest.mark.skipif(
    not DATA.is_dir(), reason="the shared measurements are not beside the checkout"
)

# Two independent fitters; frequency [Hz], its tolerance [Hz], range of damping [-].
REFERENCE = (
    (810.2, 0.15, 1.3e-3, 1.5e-3),
    (900.0, 0.15, 1.1e-3, 1.3e-3),
    (2640.2, 0.15, 2.55e-4, 2.55e-4),
    (3668.85, 0.3, 2.4e-4, 3.3e-4),
    (4391.8, 0.3, 5.4e-4, 5.9e-4),
)


@pytest.fixture(scope="module")
def modes(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, float]]:
    """Return the modes of the three real hits, by import and modal."""
    folder = tmp_path_factory.mktemp("hits")
    session, found = folder / "hits.h5", folder / "modes.json"
    files = [DATA / "hits" / f"measurements_{n}.npy" for n in (1, 2, 3)]
    run_import(
        files,
        session,
        ImportRequest(SampleOptions(COLUMNS), overwrite=False, json_target=None),
    )
    run_modal([session], json_target=str(found))
    content: list[dict[str, float]] = json.loads(found.read_text())["modes"]
    return content


@pytest.mark.parametrize(("frequency", "tolerance", "low", "high"), REFERENCE)
def test_the_strong_modes_of_the_real_hits_are_found(
    modes: list[dict[str, float]],
    frequency: float,
    tolerance: float,
    low: float,
    high: float,
) -> None:
    """Frequency within the stated tolerance, damping within 20 % of the range."""
    mode = min(modes, key=lambda m: abs(m["frequency_hz"] - frequency))
    assert abs(mode["frequency_hz"] - frequency) < tolerance
    assert 0.8 * low < mode["damping_ratio"] < 1.2 * high
    assert mode["frequency_sd_hz"] > 0
    assert mode["damping_ratio_sd"] > 0


def verdict_of(path: Path, folder: Path, columns: str | None = None) -> dict[str, Any]:
    """Run ``surface`` on one file and return what it says."""
    target = folder / "surface.json"
    run_surface([path], columns=columns, json_target=str(target))
    (found,) = json.loads(target.read_text())["files"]
    content: dict[str, Any] = found
    return content


@pytest.mark.parametrize(
    ("name", "columns"),
    [("surfcom/GI-EI.tx1", None), ("nanovea/test1.txt", "x:mm,y:mm,z:um")],
)
def test_a_real_surface_gets_a_verdict_with_its_reason(
    name: str, columns: str | None, tmp_path: Path
) -> None:
    """None of these is one straight line; the reason states what it is instead."""
    found = verdict_of(DATA / "surfaces" / name, tmp_path, columns)
    assert found["verdict"] in VERDICTS
    assert len(found["reason"]) > 20
    assert len(found["local_slope"]["lag_m"]) > 5
    without = {"no scaling range", "instrument-limited"}
    assert found["verdict"] != "no scaling range" or found["dimension"] is None
    assert found["dimension"] is not None or found["verdict"] in without


def test_a_real_laser_map_written_as_keyence_csv_gets_a_verdict(
    tmp_path: Path,
) -> None:
    """The vendor binary is read by a public library, our CSV reader does the rest."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        topography = pytest.importorskip("SurfaceTopography")
    (path,) = (DATA / "surfaces" / "keyence").glob("*.vk6")
    with warnings.catch_warnings():  # the library's own deprecations
        warnings.simplefilter("ignore")
        scan = topography.read_topography(str(path))
        heights = np.ma.asarray(scan.heights()).T
    length = scan.physical_sizes[0] / heights.shape[1]
    heights = heights[:192, :256]  # a small part takes the same way in less time
    factor = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "pm": 1e-12}[
        scan.unit
    ]
    mask = ~np.ma.getmaskarray(heights)
    spacing = length * factor
    filled = np.where(mask, np.ma.filled(heights, 0.0), 0.0) * factor
    areal = Areal("vk6", filled, (spacing, spacing), mask & all_valid(filled))
    csv = tmp_path / "vk6.csv"
    write_keyence_csv(areal, csv)
    found = verdict_of(csv, tmp_path)
    assert found["verdict"] in VERDICTS
    assert spacing == pytest.approx(271.217e-9, rel=1e-3)
