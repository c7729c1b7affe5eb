"""The contact bench: slopes, effects that are off, bounds, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from joint_campaigns import FACTS, LAW, joint

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.gap.contact_bench.contact_bench import make_contact_bench
from jointbench.analysis.gap.contact_bench.contact_catalogue import CONTACT_NAMES
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.joint_states import JointRows
from jointbench.analysis.gap.contact_bench.preload_laws import (
    AsperityPreloadLaw,
    LinearPreloadLaw,
    asperity_parameters,
    fractal_parameters,
    mindlin_ratio,
)
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL


def test_slopes_of_the_base_are_differences() -> None:
    """Grouped differences equal those of one coordinate after the other."""
    bench = make_contact_bench(joint(seed=1), LAW)
    x = 0.5 * bench.base_sd
    slopes = bench.slopes(x, (), FULL)
    for k in range(0, x.size, 3):
        step = np.zeros(x.size)
        step[k] = 1e-6
        change = bench.residual(x + step, (), FULL) - bench.residual(x - step, (), FULL)
        np.testing.assert_allclose(slopes[:, k], change / 2e-6, atol=2e-3)


def test_effects_vanish_at_off() -> None:
    """Every effect with an amplitude of 0 leaves the base as it is."""
    bench = make_contact_bench(joint(seed=2), LAW)
    x = np.zeros(bench.base_sd.size)
    plain = bench.predict(x, ())
    for candidate in (*bench.candidates, *bench.probes):
        first, *shape = candidate.effect.parameters
        if first.off is not None:
            start = [first.off, *(p.encode(p.starts[0]) for p in shape)]
            term = Term(candidate, np.array(start))
            np.testing.assert_array_equal(bench.predict(x, (term,)), plain)


def test_a_value_known_from_below_acts_upwards_only() -> None:
    """A bound costs nothing where the model is above it, and much where it is below."""
    data = joint(seed=3)
    rows = data.rows
    bound = np.zeros(rows.value.size, dtype=bool)
    bound[0] = True
    seen = JointRows(rows.state, rows.quantity, rows.value, rows.covariance, bound)
    bench = make_contact_bench(replace(data, rows=seen), LAW)
    x = np.zeros(bench.base_sd.size)
    x[bench.layout.factor] = 1.0
    above = bench.residual(x, (), FULL)[0]
    x[bench.layout.factor] = -1.0
    below = bench.residual(x, (), FULL)[0]
    assert above < 0.01
    assert below > 5.0
    assert bench.blocks.dof == rows.value.size - 1


def test_gaussian_summits_have_the_limits_of_greenwood_and_williamson() -> None:
    """At light loads stiffness grows nearly as the load, over the summits' height."""
    law = AsperityPreloadLaw(
        asperity_parameters((1e-6, 0.1), (0.1, 0.1), (2e4, 0.1), (1e11, 0.05)),
        0.01,
        0.3,
    )
    log_p = np.log([1.0, 2.0])
    normal, tangential = law.log_stiffness(log_p, np.zeros(4))
    assert np.diff(normal)[0] / np.log(2.0) == pytest.approx(0.95, abs=0.03)
    assert np.exp(tangential - normal) == pytest.approx(mindlin_ratio(0.3))


def test_a_linear_law_is_the_load_over_a_length() -> None:
    """K = P/(share h_rms)."""
    parameters = asperity_parameters((1e-6, 0.1), (0.1, 0.1), (1e4, 0.1), (1e11, 0.1))
    share = replace(parameters[1], name="share", value=0.4)
    law = LinearPreloadLaw((parameters[0], share), 0.3)
    normal, _ = law.log_stiffness(np.log([4000.0]), np.zeros(2))
    assert np.exp(normal[0]) == pytest.approx(4000.0 / 0.4e-6)


def test_fractal_parameters_keep_their_order() -> None:
    """Dimension, roughness and hardness with their relative sd."""
    found = fractal_parameters((2.5, 0.01), (1e-10, 0.5), (2e9, 0.1))
    assert [p.name for p in found] == ["dimension", "roughness", "hardness"]
    assert [p.log_sd for p in found] == [0.01, 0.5, 0.1]


def test_unknown_names_and_impossible_values_are_refused() -> None:
    """One line with the value and the way out."""
    with pytest.raises(UsageError, match="no effect of the contact bench is called"):
        make_contact_bench(joint(), LAW, without=frozenset({"gap"}))
    with pytest.raises(BadData, match="area is 0"):
        replace(FACTS, area=0.0)
    with pytest.raises(BadData, match="bandwidth"):
        AsperityPreloadLaw(
            asperity_parameters((1e-9, 0.1), (1.0, 0.1), (1.0, 0.1), (1e11, 0.1)),
            0.01,
            0.3,
        ).log_stiffness(np.zeros(1), np.zeros(4))
    assert len(set(CONTACT_NAMES)) == len(CONTACT_NAMES) == 15


def test_bolts_of_stated_length_bear_in_parallel_along_their_axes() -> None:
    """1e8 N/m beside the contact's normal stiffness; the tangential one is unmoved."""
    data = joint(seed=4)
    bolted = replace(data, facts=replace(data.facts, bolt_stiffness=1e8))
    plain, held = make_contact_bench(data, LAW), make_contact_bench(bolted, LAW)
    before = plain.joint(np.zeros(plain.base_sd.size), ()).table
    after = held.joint(np.zeros(held.base_sd.size), ()).table
    np.testing.assert_allclose(after[0] - before[0], 1e8)
    np.testing.assert_allclose(after[1], before[1])


def test_waves_that_no_surface_showed_count_as_heights() -> None:
    """As high as the roughness they take the stiffness down by the root of two."""
    data = joint(seed=5)
    short = replace(LAW, roughness_alone=CONTACT.wave_height)
    plain, waved = make_contact_bench(data, LAW), make_contact_bench(data, short)
    before = plain.predict(np.zeros(plain.base_sd.size), ())
    after = waved.predict(np.zeros(waved.base_sd.size), ())
    np.testing.assert_allclose(before - after, 0.5 * np.log(2.0))


def test_states_of_one_setting_share_their_preload() -> None:
    """One coordinate for them, whose slope moves the values of all of them."""
    data = joint(seed=1)
    count = data.states.torque.size
    setting = np.arange(count) // 2
    tied = replace(data, states=replace(data.states, setting=setting))
    bench = make_contact_bench(tied, LAW)
    apart = make_contact_bench(data, LAW)
    assert apart.base_sd.size - bench.base_sd.size == count - setting.max() - 1
    x = 0.5 * bench.base_sd
    slopes = bench.slopes(x, (), FULL)
    for k in range(bench.layout.state, x.size):
        step = np.zeros(x.size)
        step[k] = 1e-6
        change = bench.residual(x + step, (), FULL) - bench.residual(x - step, (), FULL)
        np.testing.assert_allclose(slopes[:, k], change / 2e-6, atol=2e-3)


@pytest.mark.parametrize("exponent", [1.0 / 3.0, 0.7, 1.0])
def test_losses_of_cycles_are_those_of_masing_s_rule(exponent: float) -> None:
    """Energy of cycles with the tangent k (1 - q)^m, summed over their branches."""
    data = joint(seed=1)
    states, rows = data.states, data.rows
    shear = np.array([300.0, 900.0] * (states.torque.size // 2 + 1))
    tied = replace(
        states,
        setting=np.arange(states.torque.size) // 2,
        shear=shear[: states.torque.size],
        frequency=np.full(states.torque.size, 1.0 / (2.0 * np.pi)),
    )
    seen = JointRows(
        np.arange(states.torque.size),
        np.full(states.torque.size, 5),
        np.zeros(states.torque.size),
        np.eye(states.torque.size),
        np.zeros(states.torque.size, dtype=bool),
    )
    bench = make_contact_bench(replace(data, states=tied, rows=seen), LAW)
    (slip,) = [c for c in bench.candidates if c.effect.name == "microslip_damping"]
    place = bench.nominal.preload
    joint_now = replace(
        bench.nominal, table=np.vstack([np.ones((4, place.size)), 0 * place, 0 * place])
    )
    relative = shear[: place.size] / 900.0 * np.exp(bench.nominal.middle) / place
    q = 0.9 * relative / relative.max()
    loss = 2.0 * exponent * 0.9 / (3.0 * np.pi * relative.max())
    entry = bench.entries[slip.label]
    found = entry.act(np.array([loss, exponent]), joint_now)[5]
    np.testing.assert_allclose(found, _cycled(q, exponent), rtol=1e-3)
    assert rows.value.size


def _cycled(share: np.ndarray, exponent: float) -> np.ndarray:
    """Return energy of a cycle over pi k u^2, from its branches, shape (n,)."""
    found = []
    for q in share.tolist():
        forces = np.linspace(0.0, q, 20001)
        slopes = (1.0 - forces) ** -exponent
        steps = 0.5 * (slopes[1:] + slopes[:-1]) * np.diff(forces)
        way = np.concatenate([[0.0], np.cumsum(steps)])
        branch = 2.0 * np.interp(0.5 * (forces + q), forces, way) - way[-1]
        back = -2.0 * np.interp(0.5 * (q - forces), forces, way) + way[-1]
        # Both branches are point-symmetric: the part above zero force is half of it.
        energy = 2.0 * np.trapezoid(back - branch, forces)
        found.append(energy / (np.pi * way[-1] ** 2))
    return np.array(found)
