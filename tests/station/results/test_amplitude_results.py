# SPDX-License-Identifier: MIT
"""Modes over amplitude in a results file come back as they were."""

from pathlib import Path

import h5py
import numpy as np

from jointbench.signal.amplitude.amplitude_curve import (
    CURVE_ARRAYS,
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
    LawFit,
    SoftLimit,
)
from jointbench.station.pipeline.amplitude_summary import amplitude_json
from jointbench.station.results.amplitude_results import (
    read_amplitude,
    write_amplitude,
)
from jointbench.station.results.quantities import amplitude_quantities


def one_mode() -> AmplitudeMode:
    """Return a mode with a curve of five points and two laws."""
    rows = {
        name: np.linspace(1.0, 2.0, 5) * (k + 1) for k, name in enumerate(CURVE_ARRAYS)
    }
    return AmplitudeMode(
        dependence=Dependence.DEPENDS,
        reason="score test 1e-9",
        curve=AmplitudeCurve(
            amplitude=np.geomspace(0.1, 10.0, 5), channel="a1@2", unit="m/s^2", **rows
        ),
        soft=SoftLimit(80.0, 0.01, 0.005, 1e-5),
        significance=1e-9,
        residual_ratio=1.1,
        linear_residual_ratio=9.0,
        frequency_change=-0.01,
        frequency_change_sd=1e-5,
        damping_change=0.002,
        damping_change_sd=1e-4,
        family="friction or micro-slip",
        ratio=0.3,
        laws=(LawFit("micro-slip power law", 0.6, 0.01, 3.0, 9.0),) * 2,
        replaces=(79.9, 80.1),
    )


def plain_mode() -> AmplitudeMode:
    """Return a mode without a curve."""
    return AmplitudeMode(
        dependence=Dependence.NOT_DECIDED,
        reason="hits of one level",
        curve=None,
        soft=SoftLimit(200.0, 0.1, 0.004, 1e-4),
        significance=float("nan"),
        residual_ratio=float("nan"),
        linear_residual_ratio=float("nan"),
        replaces=(200.0,),
    )


def test_modes_come_back_as_they_were_written(tmp_path: Path) -> None:
    """Every number and word that ``modal --json`` prints, to the last digit."""
    found = (one_mode(), plain_mode())
    with h5py.File(tmp_path / "made.h5", "w") as file:
        write_amplitude(file.create_group("amplitude"), found)
        again = read_amplitude(file["amplitude"])
    assert amplitude_json(again) == amplitude_json(found)


def test_trends_get_the_changes_of_modes_that_depend_on_amplitude() -> None:
    """Changes and exponent with their sd, under the number of the mode at 80 Hz."""
    frequency = np.array([20.0, 80.01, 200.0])
    rows = list(amplitude_quantities((one_mode(), plain_mode()), frequency, 5e3))
    assert {row.item for row in rows} == {"2"}
    assert [(row.name, row.value, row.sd) for row in rows] == [
        ("frequency_change", -0.01, 1e-5),
        ("damping_change", 0.002, 1e-4),
        ("amplitude_exponent", 0.6, 0.01),
    ]
