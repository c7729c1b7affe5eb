# SPDX-License-Identifier: MIT
"""The provenance of a gap report: software, policy, and the settings of a verdict."""

from jointbench.acquisition.records.session import software_version
from jointbench.analysis.gap.model.policy import STANDARD, Policy, policy_digest
from jointbench.analysis.gap.model.setting import settings_of
from jointbench.station.screen.page_parts import DataTable, ItemGroup, Section, Text

DIGEST_DIGITS = 16


def policy_section(policy: Policy) -> Section:
    """Return the decision settings that a verdict rests on, with their basis."""
    kind = "the standard policy" if policy == STANDARD else "a varied policy"
    digest = policy_digest(policy)[:DIGEST_DIGITS]
    rows = tuple(
        (s.name, f"{s.value:g}", s.unit, s.purpose, s.basis, s.effect or "not measured")
        for s in settings_of(policy)
    )
    columns = (
        "setting",
        "value",
        "unit",
        "what it does",
        "how it was set",
        "verdicts of 20 campaigns that change",
    )
    caption = (
        "Settings that decide the verdict. Last column: the effect of a change of the "
        "setting alone by 30 % down and up, on campaigns made for it."
    )
    text = f"{software_version()}: gap, with {kind} of the engine (digest {digest})."
    fold = ItemGroup(
        f"{len(rows)} settings that decide the verdict",
        (DataTable(caption, columns, rows),),
    )
    return Section("provenance", "Provenance", (Text(text), fold))
