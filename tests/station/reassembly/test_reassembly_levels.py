"""Levels of a prediction that are no level."""

from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.reassembly.run_reassembly import reassembly_of

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.mark.parametrize("level", ["nan N m", "0 N m", "-5 N m", "inf N m"])
def test_a_level_that_is_none_is_an_error_of_use(level: str) -> None:
    """With the option's name."""
    joint = next(EXAMPLES.glob("**/joint-stiffness.toml"))
    with pytest.raises(UsageError, match="--level"):
        reassembly_of([joint], [level], opened=True)
