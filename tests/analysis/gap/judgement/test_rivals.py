# SPDX-License-Identifier: MIT
"""Which fits count as rivals of the best one."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from jointbench.analysis.gap.catalogue.catalogue import (
    ALL_REAL_JOINTS,
    CATALOGUE,
    with_real_joints,
)
from jointbench.analysis.gap.judgement.rivals import rivals
from jointbench.analysis.gap.model.effect import Candidate, Site
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.residuals.fit_records import Fit

EFFECTS = {
    e.effect.name: e.effect for e in with_real_joints(CATALOGUE, (ALL_REAL_JOINTS,))
}
BENCH: Any = SimpleNamespace(policy=STANDARD, phases=lambda candidate: 0)


def fit(name: str, cost: float, link: str = "joint") -> Fit:
    """Return a fit of one law at a link with a cost."""
    none = np.zeros(0)
    law = Candidate(EFFECTS[name], Site("link", link))
    return Fit(none, 0, (law,), none, np.zeros((0, 0)), cost, none, none)


@pytest.mark.parametrize(
    ("other", "link", "count"),
    [
        ("bouc_wen_free", "joint", 1),  # contains the best one
        ("bouc_wen_free", "foot", 2),
        ("iwan_segalman", "joint", 2),  # contains another one
    ],
)
def test_a_law_that_contains_the_best_one_is_no_rival(
    other: str, link: str, count: int
) -> None:
    """Its further parameter gained less than it is charged."""
    best = fit("bouc_wen", 100.0)
    near = fit(other, 90.0, link)
    assert len(rivals(BENCH, [best, near])) == count


def test_a_law_that_gains_more_than_its_charge_leads_and_the_other_is_compared() -> (
    None
):
    """The simpler law is a rival until the gain is the charge and the limit."""
    simple = fit("bouc_wen", 100.0)
    assert len(rivals(BENCH, [fit("bouc_wen_free", 75.0), simple])) == 2
    assert len(rivals(BENCH, [fit("bouc_wen_free", 65.0), simple])) == 1
