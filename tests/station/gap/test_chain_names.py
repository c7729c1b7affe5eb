"""Names of effects to leave out of a chain."""

from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.chain.examine_chain import examine_chain
from jointbench.station.gap.gap_request import GapRequest

EXAMPLE = Path(__file__).parents[3] / "examples" / "campaign" / "bench.toml"
TABLE = """
[bolted_joint]
link = "joint"
direction = "normal"
bolts = 4
diameter = "8 mm"
area = "64 cm^2"
modulus = "55 GPa"
poisson = 0.25
hardness = "1.5 GPa"
"""


def test_an_unknown_name_is_an_error_before_anything_is_read(tmp_path: Path) -> None:
    """A mistyped name would leave the effect in the catalogue."""
    model = tmp_path / "bench.toml"
    model.write_text(EXAMPLE.read_text(encoding="utf-8") + TABLE, encoding="utf-8")
    wanted = GapRequest(model=model, without=frozenset({"bogus"}))
    with pytest.raises(UsageError, match="no effect is called 'bogus'"):
        examine_chain([tmp_path / "a.h5"], [tmp_path / "a.csv"], wanted)
