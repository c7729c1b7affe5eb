"""Options of ``contact`` and ``pressure-map`` that no joint can have."""

from dataclasses import replace
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.station.contact.pressure_map_options import PressureMapOptions
from jointbench.station.joints.pressure_map import run_pressure_map
from jointbench.station.pipeline.contact_options import ContactOptions
from jointbench.station.pipeline.contact_request import parse_request

MAP = PressureMapOptions(
    maps=[Path("a.csv")], modulus="115 GPa", hardness="2 GPa", pressure=["1 MPa"]
)
CONTACT = ContactOptions(modulus="29 GPa", hardness="1.5 GPa", load=["1 kN"])


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("modulus", "0 GPa"),
        ("hardness", "-2 GPa"),
        ("cutoff", "0 mm"),
        ("pressure", ["1 MPa", "0 MPa"]),
    ],
)
def test_quantities_of_a_pressure_map_are_positive(
    name: str, value: str | list[str]
) -> None:
    """Zero and negative ones are refused before any file is read."""
    with pytest.raises(BadData, match=f"--{name} is .*must be positive"):
        run_pressure_map(replace(MAP, **{name: value}))  # type: ignore[arg-type]


def test_a_pressure_map_needs_points() -> None:
    """No points at all, or fewer than the solver takes."""
    with pytest.raises(UsageError, match="at least 16"):
        run_pressure_map(replace(MAP, points=0))


def test_loads_are_positive_and_spreads_not_negative() -> None:
    """One line names the option."""
    with pytest.raises(BadData, match="preload is 0 N"):
        parse_request(replace(CONTACT, load=["0 N"]))
    with pytest.raises(BadData, match="--modulus-sd"):
        parse_request(replace(CONTACT, modulus_sd="-3 %"))
