"""`identify` and `gap` on FRFs of other programs."""

from pathlib import Path

import numpy as np
import pytest
import xarray

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.station.commands.identify.identify_links_command import run_identify
from jointbench.station.gap.line_files import LineRequest, read_lines
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.joints.structure_states import measured_states

MASS, SUPPORT, JOINT = (9.0, 4.6), 2.2e7, 6e7
BENCH = """
[bodies.base]
mass = "9 kg"
channel = "a0"
[bodies.top]
mass = "4.6 kg"
channel = "a1"
[links.support]
between = ["ground", "base"]
[links.joint]
between = ["base", "top"]
"""


def accelerance(frequency: np.ndarray) -> np.ndarray:
    """Return the FRFs of two bodies on two springs, shape (2, n_lines)."""
    mass = np.diag(MASS)
    stiffness = np.array([[SUPPORT + JOINT, -JOINT], [-JOINT, JOINT]])
    damping = 5e-6 * stiffness
    omega = 2 * np.pi * frequency[:, None, None]
    dynamic = stiffness + 1j * omega * damping - omega**2 * mass
    return np.asarray(-(omega[:, 0] ** 2 * np.linalg.inv(dynamic)[:, :, 1])).T


@pytest.fixture(scope="module")
def netcdf(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write FRFs with variance as xarray does; the hammer strikes the top."""
    path = tmp_path_factory.mktemp("frf") / "frf.nc"
    frequency = np.arange(20.0, 1000.0, 0.5)
    response = accelerance(frequency)
    rng = np.random.default_rng(4)
    sd = 1e-3 * np.abs(response).mean()
    noise = rng.normal(0, sd, (2, *response.shape)) / np.sqrt(2)
    xarray.Dataset(
        {
            "H": (
                ("output", "frequency"),
                response + noise[0] + 1j * noise[1],
                {"units": "m s-2 N-1"},
            ),
            "variance": (("output", "frequency"), np.full(response.shape, sd**2)),
        },
        coords={
            "frequency": ("frequency", frequency, {"units": "Hz"}),
            "output": ["a0", "a1"],
        },
    ).to_netcdf(path, engine="h5netcdf")
    return path


def test_links_are_identified_from_frfs(netcdf: Path, tmp_path: Path) -> None:
    """Within three standard deviations, which are below 1 %."""
    bench = tmp_path / "bench.toml"
    bench.write_text(BENCH, encoding="ascii")
    found = run_identify(bench, [netcdf], options=FrfOptions(), json_target=None)
    for name, wanted in (("support", SUPPORT), ("joint", JOINT)):
        one = found.parameter(f"{name}.stiffness")
        assert one.identifiable
        assert one.sd < 0.01 * wanted
        assert abs(one.value - wanted) < 3 * one.sd + 1e-3 * wanted


def test_a_file_of_frfs_is_a_state_of_a_structure(netcdf: Path) -> None:
    """Named after the file, without a preload of its own, with intervals."""
    states = measured_states([netcdf], None, FrfOptions())
    model = states["frf"].chain.result.model
    assert states["frf"].preload is None
    assert model.outputs == ("a0", "a1")
    assert np.all(model.frequency_sd > 0)


def test_gap_refuses_frfs_with_the_reason_and_the_way_out(netcdf: Path) -> None:
    """An average of one level holds no trace of an effect that depends on level."""
    with pytest.raises(UsageError, match=r"one level.*frf_force.*jointbench identify"):
        run_gap(netcdf, without=None, report=None, json_target=None)


def test_a_file_of_frfs_is_one_level_of_records(netcdf: Path) -> None:
    """The lines of the period over those of its force are the FRF."""
    request = LineRequest(
        "force.shaker@top:N,acceleration.a0:m/s^2,acceleration.a1@top:m/s^2",
        4000.0,
        2.0,
    )
    found = read_lines(netcdf, request)
    assert [c.name for c in found.channels] == ["shaker", "a0", "a1"]
    assert np.sqrt(np.mean(np.square(found.samples[0]))) == pytest.approx(2.0)
    spectra = np.fft.rfft(found.samples)[:, 40:2000]
    stored = xarray.open_dataset(netcdf, engine="h5netcdf").H.values
    np.testing.assert_allclose(spectra[1:] / spectra[0], stored, rtol=1e-6)
