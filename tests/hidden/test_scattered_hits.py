"""Hits that scatter in ways the engine does not share: fixed seeds.

The statistics over many campaigns: benchmarks/gap/scatter.py and docs/gap-scatter.md.
"""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest
from short_campaigns import write_short

from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import Finding

SIMULATION = Path(__file__).parents[2] / "benchmarks" / "gap" / "scattered_campaigns.py"


def drawing() -> ModuleType:
    """Load the simulation of the benchmark by its path."""
    name = "scattered_campaigns"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, SIMULATION)
        assert spec is not None and spec.loader is not None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


@pytest.mark.parametrize(("way", "size"), [("channel", 0.01), ("wander", 0.03)])
def test_scatter_of_hits_is_no_effect(way: str, size: float, tmp_path: Path) -> None:
    """Gains of each channel and hit, independent and correlated: nothing is missing."""
    campaign, _ = drawing().scattered_null(7, way, size, grid="small")
    write_short(campaign, tmp_path / "campaign.h5")
    found = diagnose(read_campaign(tmp_path / "campaign.h5"))
    assert found.verdict is Finding.NONE
    assert found.scatter is not None
    sizes = {d.name: d.size for d in found.scatter.directions}
    total = max(sizes["channel gain"], sizes["force gain"])
    assert total == pytest.approx(size, rel=0.8)


def test_one_bad_hit_among_good_ones_is_listed(tmp_path: Path) -> None:
    """24 % too strong or too weak, with its sign; the verdict is none."""
    campaign, truth = drawing().scattered_null(9, "bad", 0.03, grid="middle")
    write_short(campaign, tmp_path / "campaign.h5")
    found = diagnose(read_campaign(tmp_path / "campaign.h5"))
    assert found.verdict is Finding.NONE
    assert found.scatter is not None
    listed = {h.record: h.value for h in found.scatter.hits}
    (bad,) = truth.bad
    assert listed[bad] == pytest.approx(truth.gain[bad].mean() - 1.0, rel=0.2)
