"""The demo of two bolted plates leaves files of others alone."""

from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.demo.demo_plates import run_demo_plates


def test_hits_of_others_are_not_replaced(tmp_path: Path) -> None:
    """A file of the demo's name without its truth is refused, and stays."""
    hits = tmp_path / "plates.h5"
    hits.write_bytes(b"hits of somebody")
    with pytest.raises(UsageError, match="no campaign of the demo"):
        run_demo_plates(tmp_path, seed=1, json_target=None)
    assert hits.read_bytes() == b"hits of somebody"
