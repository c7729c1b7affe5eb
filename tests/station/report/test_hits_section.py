"""The section on hits: what its tables hold."""

import numpy as np

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Verdict,
)
from jointbench.station.report.hits_section import hits_section
from jointbench.station.screen.page_parts import DataTable, ItemGroup


def recording(*temperatures: float | None) -> Recording:
    """Return one accepted and one rejected hit, and their temperatures."""
    channels = (
        Channel("force", Quantity.FORCE),
        Channel("a1", Quantity.ACCELERATION, "1"),
    )
    samples = np.random.default_rng(1).normal(size=(2, 400))
    verdicts = (Verdict.OK, Verdict.DOUBLE)
    hits = tuple(
        Hit(200 * k, 200 * k + 20, 200 * k + 200, "1", 9.0, verdict, 0.0, "r", warm)
        for k, (verdict, warm) in enumerate(zip(verdicts, temperatures, strict=True))
    )
    return Recording("r", samples, 1000.0, channels, hits=hits)


def tables(one: Recording) -> list[DataTable]:
    """Return the tables of rejected and accepted hits."""
    items = hits_section([one]).items
    folded = [i for group in items if isinstance(group, ItemGroup) for i in group.items]
    return [i for i in (*items, *folded) if isinstance(i, DataTable)]


def test_the_temperature_of_each_hit_is_in_the_tables_where_it_was_measured() -> None:
    """One column more, before the reason; a hit without one has a dash."""
    rejected, accepted = tables(recording(21.04, None))
    assert accepted.columns[-1] == "temperature [°C]"
    assert accepted.rows[0][-1] == "21.0"
    assert rejected.columns[-2:] == ("temperature [°C]", "reason")
    assert rejected.rows[0][-2:] == ("-", "r")


def test_sessions_without_a_thermometer_have_no_column_for_it() -> None:
    """As before."""
    rejected, accepted = tables(recording(None, None))
    assert accepted.columns[-1] == "verdict"
    assert rejected.columns[-1] == "reason"
