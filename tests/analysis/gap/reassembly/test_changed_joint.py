"""Assemblies of a joint: their scatter, the next one, and a change."""

import numpy as np
import pytest
from scipy.stats import norm

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.contact_bench.joint_states import (
    ContactQuantity,
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.reassembly.assembly_rows import assembly_rows
from jointbench.analysis.gap.reassembly.assembly_scatter import (
    ScatterPosterior,
)
from jointbench.analysis.gap.reassembly.changed_joint import (
    JointChange,
    compare_assemblies,
)
from jointbench.analysis.gap.reassembly.expected_values import (
    expected_values,
    quantiles,
)

TORQUE = np.array([10.0, 20.0, 40.0, 80.0])
ERROR = 0.02


def joint(
    offsets: list[float], *, slopes: list[float] | None = None, seed: int = 1
) -> JointData:
    """Return a joint k ~ T^0.7 whose assemblies have offsets and slopes of ln k."""
    random = np.random.default_rng(seed)
    slopes = slopes or [0.0] * len(offsets)
    x = np.log(TORQUE / TORQUE[0])
    values = [18.0 + (0.7 + s) * x + o for o, s in zip(offsets, slopes, strict=True)]
    value = np.concatenate(values)
    value += ERROR * random.normal(size=value.size)
    return joint_of(value, len(offsets))


def joint_of(value: FloatArray, assemblies: int) -> JointData:
    """Return a joint with given logarithms, assembly by assembly."""
    size, none = value.size, np.full(value.size, np.nan)
    facts = JointFacts(4, 0.01, 0.2, 0.1, 0.03, 0.15, 0.01, 2e11, 0.3)
    states = JointStates(
        torque=np.tile(TORQUE, assemblies),
        preload=none,
        preload_sd=none,
        assembly=np.repeat(np.arange(assemblies), TORQUE.size),
        falling=np.zeros(size, dtype=np.bool_),
        time=none,
        shear=none,
        frequency=none,
    )
    rows = JointRows(
        np.arange(size),
        np.zeros(size, dtype=np.int64),
        value,
        np.diag(np.full(size, ERROR**2)),
        np.zeros(size, dtype=np.bool_),
    )
    return JointData("joint", facts, states, rows)


USUAL = [0.05, -0.12, 0.10, -0.04, 0.09, -0.08]


def test_a_latest_assembly_like_those_before_is_within_the_scatter() -> None:
    found = compare_assemblies(joint(USUAL))
    latest = found.quantities[ContactQuantity.NORMAL].latest
    assert found.change is JointChange.SCATTER
    assert latest.interval[0] < latest.ratio < latest.interval[1]


def test_half_the_stiffness_is_a_change_of_that_size() -> None:
    found = compare_assemblies(joint([*USUAL[:-1], np.log(0.5)]))
    latest = found.quantities[ContactQuantity.NORMAL].latest
    assert found.change is JointChange.CHANGED
    # The mean of the offsets before is 1.6 %.
    assert latest.ratio == pytest.approx(0.5 / 1.016, rel=0.05)


def test_another_course_over_the_torque_is_a_change_without_an_offset() -> None:
    slopes = [0.0] * 5 + [0.4]
    middle = float(np.log(TORQUE / TORQUE[0]).mean())
    found = compare_assemblies(joint([*USUAL[:-1], -0.4 * middle], slopes=slopes))
    latest = found.quantities[ContactQuantity.NORMAL].latest
    assert found.change is JointChange.CHANGED
    assert latest.shape_probability < 1e-3 < latest.offset_probability


def test_a_joint_that_was_not_opened_may_not_scatter_like_an_assembly() -> None:
    data = joint([*USUAL[:-1], USUAL[-2] - 0.2])
    assert compare_assemblies(data).change is JointChange.SCATTER
    assert compare_assemblies(data, reassembled=False).change is JointChange.CHANGED


def test_two_assemblies_of_a_joint_that_scatters_decide_nothing() -> None:
    found = compare_assemblies(joint(USUAL[:2]))
    assert found.change is JointChange.OPEN
    assert found.quantities[ContactQuantity.NORMAL].latest.detectable > 2.0


def test_the_next_assembly_is_predicted_as_the_closed_form_says() -> None:
    # With known scatters and a constant trend the prediction is that of the mean of
    # n assemblies with m equal values each: variance b^2 + w^2 + b^2/n + (w^2+e^2)/nm.
    rows = assembly_rows(joint_of(np.tile([18.0, 18.2, 18.1, 17.9], 3), 3))
    one = rows[ContactQuantity.NORMAL]
    between, within = 0.2, 0.05
    known = ScatterPosterior(
        one, 0, np.array([between]), np.array([within]), np.array([1.0])
    )
    found = expected_values(known, TORQUE[:1], np.array([9]), np.zeros((1, 1)))
    variance = between**2 * (1 + 1 / 3) + within**2 + (within**2 + ERROR**2) / 12
    assert found.mean[0, 0] == pytest.approx(18.05, abs=1e-12)
    assert found.covariance[0, 0, 0] == pytest.approx(variance, rel=1e-12)
    (high,) = quantiles(found, (0.975,))
    assert high[0] == pytest.approx(18.05 + norm.ppf(0.975) * variance**0.5, rel=1e-9)


def test_a_level_far_from_those_measured_is_refused() -> None:
    with pytest.raises(BadData, match="too far from those measured, 10 to 80"):
        compare_assemblies(joint(USUAL), level=np.array([300.0]))


def test_one_assembly_is_refused_with_the_way_out() -> None:
    with pytest.raises(BadData, match="in one assembly only; give the sessions"):
        compare_assemblies(joint(USUAL[:1]))


def test_the_interval_of_the_next_assembly_covers_assemblies_of_heavy_tails() -> None:
    # 3 degrees of freedom, where the model assumes normal offsets: 40 joints of five
    # assemblies, 95 % nominal; 5 or fewer of 40 outside is expected in 98 of 100.
    random, inside = np.random.default_rng(7), 0
    for k in range(40):
        offsets = 0.1 * random.standard_t(3, 6)
        one = compare_assemblies(joint(list(offsets[:5]), seed=k))
        _, low, high = one.quantities[ContactQuantity.NORMAL].next_assembly
        truth = np.exp(18.0 + 0.7 * np.log(TORQUE[1] / TORQUE[0]) + offsets[5])
        inside += bool(low[1] <= truth <= high[1])
    assert inside >= 35


def test_the_scatters_are_found_from_many_assemblies() -> None:
    random = np.random.default_rng(3)
    value = np.concatenate(
        [
            18.0
            + 0.7 * np.log(TORQUE / TORQUE[0])
            + 0.2 * random.normal()
            + 0.06 * random.normal(size=TORQUE.size)
            for _ in range(25)
        ]
    )
    found = compare_assemblies(joint_of(value, 25))
    scatter = found.quantities[ContactQuantity.NORMAL].scatter
    _, low, high = scatter.interval("between")
    assert low < 0.2 < high < 0.3
    _, low, high = scatter.interval("within")
    assert low < 0.06 < high < 0.08
