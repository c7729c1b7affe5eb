"""Hits that cannot be used, by their force."""

import numpy as np
import pytest

from jointbench.analysis.gap.intake.raw_hits import QuietHit, bad_hit

AIMED = 10.0


@pytest.mark.parametrize(
    ("peak", "reason"),
    [(2.0, "glancing"), (8.0, ""), (13.0, ""), (60.0, "overload")],
)
def test_a_hit_far_from_its_aimed_peak_is_left_out(peak: float, reason: str) -> None:
    """All inputs stay within their range; the levels of the plan are left."""
    force = np.zeros((2, 400))
    force[0, 100:120] = peak * np.sin(np.linspace(0, np.pi, 20))
    hit = QuietHit(force, np.full(2, 1e-3))
    found = bad_hit(hit, 1e-2 * force, 10.0, AIMED)
    assert found.startswith(reason)
    assert bool(found) == bool(reason)
