"""``jointbench gap`` on campaigns of the simulators' own physics."""

import json
from pathlib import Path
from typing import Any

import pytest
from short_campaigns import write_short

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.simulators.campaigns.campaign_records import quick_campaign
from jointbench.station.gap.run_gap import run_gap

KEYS = {
    "verdict",
    "effects",
    "candidates",
    "where",
    "gap_before",
    "gap_after",
    "shrink",
    "experiment",
}


def diagnosis(
    folder: Path, *effects: str, without: str | None = None
) -> dict[str, Any]:
    """Hide effects in a fresh campaign and return what the command says."""
    path, target = folder / "campaign.h5", folder / "gap.json"
    write_short(quick_campaign(77, effects=effects, grid="small"), path)
    page = folder / "gap.html"
    run_gap(path, without=without, report=page, json_target=str(target))
    assert "</html>" in page.read_text(encoding="utf-8")
    content: dict[str, Any] = json.loads(target.read_text())
    return content


def test_a_hidden_cubic_spring_is_named_and_the_gap_shrinks(tmp_path: Path) -> None:
    """Name, site, shrink and the contract's keys."""
    kept = {"cubic_stiffness", "quadratic_stiffness", "gap", "delay", "added_mass"}
    others = ",".join(sorted({e.effect.name for e in CATALOGUE} - kept))
    found = diagnosis(tmp_path, "cubic_stiffness", without=others)
    assert set(found) >= KEYS
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert (effect["name"], effect["site"]) == ("cubic_stiffness", "link:joint")
    assert effect["parameters"]["k3"]["unit"] == "N/m^3"


def test_where_nothing_is_missing_nothing_is_named(tmp_path: Path) -> None:
    """A model that explains the records is left alone."""
    found = diagnosis(tmp_path)
    assert found["verdict"] == "none"
    assert found["effects"] == []


def test_an_unknown_effect_in_without_is_a_usage_error(tmp_path: Path) -> None:
    """A typing error must not silently leave the catalogue whole."""
    with pytest.raises(UsageError, match="jenkin"):
        diagnosis(tmp_path, without="jenkin")


def test_a_file_that_is_no_campaign_is_bad_data(tmp_path: Path) -> None:
    """One line, code three."""
    path = tmp_path / "campaign.h5"
    path.write_bytes(b"not a campaign")
    with pytest.raises(BadData, match=r"campaign\.h5"):
        run_gap(path, without=None, report=None, json_target=None)
