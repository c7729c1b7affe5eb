"""Closed responses of bolted bodies against an integrator, slopes by differences."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bolted_bodies import FILTER, NOMINAL, integrated, random_bodies, smooth_hits
from scipy.integrate import quad
from scipy.special import gamma

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    base_layout,
)
from jointbench.analysis.gap.structure_response.closed_flexibility import (
    closed_flexibility,
)
from jointbench.analysis.gap.structure_response.closed_response import close
from jointbench.analysis.gap.structure_response.common_filter import CommonFilter
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import hit_frame
from jointbench.analysis.gap.structure_response.hit_response import HitModel, hit_model
from jointbench.analysis.gap.structure_response.joint_state import (
    Attached,
    JointState,
    state_of,
)
from jointbench.analysis.gap.structure_response.landing import (
    landing_weights,
    point_columns,
)
from jointbench.analysis.gap.structure_response.port_laws import (
    LawForm,
    PortLaws,
    spread_sliders,
)
from jointbench.analysis.gap.structure_response.table_errors import tuned_modes

LANDING = np.array([[0.02, -0.01, 8e-4, -5e-4], [0.0, 0.0, 0.0, 0.0]])


def campaign(rigid: tuple[bool, bool, bool] = (False, False, False)) -> HitCampaign:
    """Return two hits on random bodies."""
    stiffness = np.where(rigid, np.inf, NOMINAL.stiffness)
    nominal = replace(NOMINAL, stiffness=stiffness)
    return HitCampaign("made", random_bodies(rigid=rigid), nominal, smooth_hits())


def uncertain_campaign() -> tuple[HitCampaign, BaseLayout]:
    """Return hits whose modal table is uncertain, with the frequencies left open."""
    made = campaign()
    made = replace(made, nominal=replace(made.nominal, table_sd=(0.005, 0.0)))
    plain = base_layout(made.bodies, made.nominal)
    nominal = state_of(made.bodies, made.nominal, plain, np.zeros(plain.sd.size))
    return made, base_layout(made.bodies, made.nominal, tuned_modes(made, nominal))


def state_at(made: HitCampaign, seed: int = 3) -> JointState:
    """Return a state with all base coordinates moved."""
    layout = base_layout(made.bodies, made.nominal)
    base = 0.5 * layout.sd * np.random.default_rng(seed).standard_normal(layout.sd.size)
    return state_of(made.bodies, made.nominal, layout, base)


def model_of(made: HitCampaign, state: JointState) -> HitModel:
    """Return the model of the hits in the whole window."""
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    return hit_model(made, state, frame, landing_weights(LANDING))


def slopes_of(model: HitModel, layout: BaseLayout) -> FloatArray:
    """Return the slopes by all base coordinates, (n_base, n_records, *shape)."""
    records = len(model.frame.force)
    found = np.empty((layout.sd.size, records, *model.shape))
    model.write_slopes(layout, (), np.ones((records, model.shape[0])), found)
    return found


def judged(made: HitCampaign, state: JointState) -> FloatArray:
    """Return the first record by the integrator."""
    column = landing_weights(LANDING)[0] @ point_columns(made.bodies.points[0])
    return integrated(made.bodies, state, made.hits.raw_force[0], column)


def distance(one: FloatArray, two: FloatArray) -> float:
    """Return the largest difference over the peak.

    The last samples are left out: the filter of the integrator's record ends there.
    """
    apart = np.abs(one - two)[:, : -FILTER.half]
    return float(apart.max() / np.abs(two).max())


def test_the_linear_response_is_that_of_an_integrator() -> None:
    """The closure on the damped line agrees with solve_ivp to 1e-4 of the peak."""
    made = campaign()
    state = state_at(made)
    found = model_of(made, state).response()[0]
    assert distance(found, judged(made, state)) < 1e-4


def test_a_short_window_is_the_begin_of_the_whole_record() -> None:
    """A window needs less room after it, where a filter ends what is before the hit."""
    made = campaign()
    state = state_at(made)
    whole, count = model_of(made, state).response()[0], 60
    frame = hit_frame(made.hits, count)
    early = hit_model(made, state, frame, landing_weights(LANDING)).response()[0]
    apart = np.abs(early - whole[:, :count]).max()
    assert apart < 1e-3 * np.abs(whole[:, :count]).max()
    plain = replace(made.hits, filter=CommonFilter(np.ones(1), 1))
    assert frame.size < hit_frame(plain, count).size


FOUR_LAWS = (
    PortLaws((2,), 4e15, kind=LawForm.CUBIC),
    PortLaws((5,), 1e11, kind=LawForm.QUADRATIC),
    PortLaws((8,), 2e7, kind=LawForm.STOP, gap=2e-6),
    PortLaws((11,), 2e4, kind=LawForm.SQUARE_DAMPING),
)


@pytest.mark.parametrize(("others", "gradual"), [((), True), (FOUR_LAWS, False)])
def test_laws_at_four_bolts_are_those_of_an_integrator(
    others: tuple[PortLaws, ...], gradual: bool
) -> None:
    """Sliders at eight ports, alone and beside four normal laws, agree to 1e-4.

    Alone, a part of each yields gradually, as the law of Bouc and Wen does.
    """
    made = campaign()
    slips, weights = spread_sliders(7e-7, 0.32, 0.0)
    ports = tuple(3 * k + d for k in range(4) for d in (0, 1))
    linear = state_at(made)
    slides = PortLaws(ports, 0.5, slips, weights)
    if gradual:
        slips, weights = np.full(2, 5e-7), np.array([0.3, 0.7])
        slides = PortLaws(ports, 0.5, slips, weights, gradual=1)
    found, stuck, without = (
        model_of(made, replace(linear, laws=laws)).response()[0]
        for laws in ((slides, *others), (), (slides,))
    )
    assert distance(found, stuck) > 0.02
    assert not others or distance(found, without) > 0.02
    assert distance(found, judged(made, replace(linear, laws=(slides, *others)))) < 1e-4


def test_a_law_in_a_joint_that_rocks_is_that_of_an_integrator() -> None:
    """Bolts are coupled by the inverse of their compliance, in time as on lines."""
    made = campaign()
    arm = np.array([-0.1, 0.1, 0.1, -0.1])
    linear = replace(state_at(made), rocking=2e-6 * np.outer(arm, arm))
    stop = PortLaws((2, 5), 2e7, kind=LawForm.STOP, gap=1e-6)
    states = [replace(linear, laws=laws) for laws in ((stop,), ())]
    states.append(replace(states[0], rocking=None))
    found, free, plain = (model_of(made, state).response()[0] for state in states)
    assert distance(found, free) > 0.02 and distance(found, plain) > 0.02
    assert distance(found, judged(made, states[0])) < 1e-4


def test_fits_take_coarser_steps_than_what_is_judged() -> None:
    """In fits, friction is within 2e-4 of the peak and other laws within 2e-3."""
    made, weights = campaign(), landing_weights(LANDING)
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    slips, shares = spread_sliders(7e-7, 0.32, 0.0)
    slides = PortLaws((0, 1, 3, 4), 0.5, slips, shares)
    for laws, allowed in (((slides,), 2e-4), (FOUR_LAWS, 2e-3)):
        state = replace(state_at(made), laws=laws)
        coarse, fine = (
            hit_model(made, state, frame, weights, fine=fine).response()[0]
            for fine in (False, True)
        )
        assert 1e-6 < distance(coarse, fine) < allowed


def weibull(motion: float, shape: float) -> float:
    """Return the force of Weibull's strengths with a mean of 1."""
    scale = 1.0 / gamma(1.0 + 1.0 / shape)
    return float(
        quad(lambda phi: np.exp(-((phi / scale) ** shape)), 0.0, motion, epsrel=1e-8)[0]
    )


def contact(motion: float, exponent: float) -> float:
    """Return the tangential force of a contact of normal force ~ depth^exponent."""
    return 1.0 - max(1.0 - motion / exponent, 0.0) ** exponent


def richard_abbott(motion: float, exponent: float) -> float:
    """Return the force of Richard and Abbott 1975."""
    return float(motion / (1.0 + motion**exponent) ** (1.0 / exponent))


@pytest.mark.parametrize(
    ("curve", "exponent", "tail"),
    [
        *((weibull, shape, 0.0) for shape in (0.4, 1.0, 2.1, 8.0)),
        *((contact, m, -1.0 / m) for m in (1.03, 1.5, 3.0)),
        *((richard_abbott, n, n / (2.0 * n + 1.0)) for n in (0.5, 2.0, 8.0)),
    ],
)
def test_sliders_hold_what_their_strengths_hold(
    curve: Callable[[float, float], float], exponent: float, tail: float
) -> None:
    """Stiffness 1, limit the mean; between them loading curves in closed form."""
    slip, step = 3e-6, 1e-4
    rise = curve(0.5 + step, exponent) - curve(0.5 - step, exponent)
    slips, weights = spread_sliders(slip, 1.0 - rise / (2.0 * step), tail)
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ slips == pytest.approx(slip)
    for motion in (0.05, 0.3, 1.0, 3.0):
        held = weights @ np.minimum(slips, slip * motion) / slip
        assert held == pytest.approx(curve(motion, exponent), rel=3e-3)


CHANGES: dict[str, dict[str, Any]] = {
    "mass": {"attached": (Attached(0, 0.4),)},
    "spring": {"attached": (Attached(0, 0.0, stiffness=2e6, normal=True),)},
    "foot and sensor": {
        "foot_factor": np.array([1.0, 60.0, 1.0, 1.0]),
        "sensors": np.roll(random_bodies().sensors, 1, axis=1),
    },
}


@pytest.mark.parametrize("change", CHANGES)
def test_linear_changes_are_those_of_an_integrator(change: str) -> None:
    """A mass, a spring, a stiff foot and a turned sensor agree with solve_ivp."""
    made = campaign()
    plain = state_at(made)
    state = replace(plain, **CHANGES[change])
    found, before = (model_of(made, one).response()[0] for one in (state, plain))
    assert distance(found, before) > 0.02
    assert distance(found, judged(made, state)) < 1e-4


def test_a_rocking_joint_is_one_of_softer_coupled_bolts() -> None:
    """The closure with a rocking compliance has the stiffness of its inverse."""
    made = campaign()
    plain = replace(state_at(made), bolt=np.ones(4))
    arm = np.array([-0.1, 0.1, 0.1, -0.1])
    rocking = 2e-6 * np.outer(arm, arm)
    state = replace(plain, rocking=rocking)
    s = np.array([200.0 + 2j * np.pi * 400.0])
    column = point_columns(made.bodies.points[0])[:1]
    found = close(made.bodies, state, s, column)[0, :, 0]
    rows = made.bodies.bolts[:, 2]
    soft = np.linalg.inv(np.diag(np.full(4, plain.compliance[2])) + rocking)
    change = soft - np.eye(4) / plain.compliance[2]
    lossy = 1.0 + plain.compliance[2] * plain.damping[2] * s[0]
    ports = close(made.bodies, plain, s, np.concatenate([column, rows]))
    at_bolts = replace(plain, sensors=rows)
    inner = close(made.bodies, at_bolts, s, np.concatenate([column, rows]))
    h_bb, h_bc = inner[0, :, 1:], inner[0, :, 0]
    added = np.linalg.solve(np.eye(4) + lossy * change @ h_bb, lossy * change @ h_bc)
    expected = ports[0, :, 0] - ports[0, :, 1:] @ added
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("change", sorted(CHANGES))
def test_the_response_to_many_columns_is_that_to_each_of_them(change: str) -> None:
    """Sensors are closed where hits are more, and hits where sensors are."""
    made, layout = uncertain_campaign()
    state = state_of(made.bodies, made.nominal, layout, 0.3 * layout.sd)
    rocking = 1e-6 * np.outer([-0.1, 0.1, 0.1, -0.1], [-0.1, 0.1, 0.1, -0.1])
    state = replace(state, **({"rocking": rocking} | CHANGES[change]))
    bodies = state.bodies_of(made.bodies)
    sensors = len(state.sensors_of(bodies))
    rng = np.random.default_rng(520)
    columns = rng.standard_normal((sensors + 4, bodies.omega.size))
    s = 150.0 + 2j * np.pi * np.array([40.0, 333.0, 900.0])
    found = close(bodies, state, s, columns)
    assert found.shape == (s.size, sensors, sensors + 4)
    for k in range(len(columns)):
        one = close(bodies, state, s, columns[k : k + 1])[:, :, 0]
        assert np.abs(found[:, :, k] - one).max() < 1e-12 * np.abs(one).max()


@pytest.mark.parametrize("attached", [(), (Attached(0, 0.4, 500.0, 0.02),)])
@pytest.mark.parametrize("rigid", [(False, False, False), (True, True, False)])
def test_slopes_are_those_of_differences(
    rigid: tuple[bool, bool, bool], attached: tuple[Attached, ...]
) -> None:
    """Every base coordinate has the slope of a central difference."""
    made = campaign(rigid)
    made = replace(made, nominal=replace(made.nominal, table_sd=(0.005, 0.0)))
    rigid_joint = base_layout(made.bodies, made.nominal)
    nominal = state_of(
        made.bodies, made.nominal, rigid_joint, np.zeros(rigid_joint.sd.size)
    )
    layout = base_layout(made.bodies, made.nominal, tuned_modes(made, nominal))
    assert layout.tuned is not None and layout.tuned.omega.size >= 2
    base = 0.3 * layout.sd

    def response(x: FloatArray) -> FloatArray:
        bare = state_of(made.bodies, made.nominal, layout, x)
        return model_of(made, replace(bare, attached=attached)).response()

    bare = state_of(made.bodies, made.nominal, layout, base)
    model = model_of(made, replace(bare, attached=attached))
    slopes = slopes_of(model, layout).transpose(1, 0, 2, 3)
    for k, name in enumerate(layout.names):
        step = np.zeros(layout.sd.size)
        step[k] = 1e-5
        difference = (response(base + step) - response(base - step)) / 2e-5
        scale = np.abs(difference).max()
        if name == "bolt damping tangential" and rigid[0]:
            assert scale == 0.0
            continue
        assert np.abs(slopes[:, k] - difference).max() < 1e-5 * scale, name


@pytest.mark.parametrize("change", sorted(CHANGES))
def test_a_closed_flexibility_gives_the_response_and_slopes_of_the_closure(
    change: str,
) -> None:
    """Attached things are products with it; where joints change it is not taken."""
    made, layout = uncertain_campaign()
    start = state_of(made.bodies, made.nominal, layout, 0.3 * layout.sd)
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    flexibility = closed_flexibility(made.bodies, start, frame.s)
    assert flexibility is not None
    state = replace(start, **CHANGES[change])
    weights = landing_weights(LANDING)
    quick = hit_model(made, state, frame, weights, flexibility=flexibility)
    whole = hit_model(made, state, frame, weights)
    assert flexibility.holds(state, frame.s) == ("attached" in CHANGES[change])
    found, expected = (m.response()[0] for m in (quick, whole))
    assert distance(found, expected) < 1e-9
    slopes = (slopes_of(m, layout) for m in (quick, whole))
    for one, two in zip(*slopes, strict=True):
        assert np.abs(one - two).max() <= 1e-9 * np.abs(two).max()


def test_a_closed_flexibility_is_that_of_its_joints_bodies_and_modes() -> None:
    """Whatever closes them otherwise is not taken from it."""
    made, layout = uncertain_campaign()
    tuning = layout.at("frequency of mode 1")
    base, moved = np.zeros(layout.sd.size), np.zeros(layout.sd.size)
    moved[tuning] = layout.sd[tuning]
    start, other = (
        state_of(made.bodies, made.nominal, layout, x) for x in (base, moved)
    )
    s = hit_frame(made.hits, made.hits.force.shape[1]).s
    flexibility = closed_flexibility(made.bodies, start, s)
    assert flexibility is not None
    again = state_of(made.bodies, made.nominal, layout, base)
    assert flexibility.holds(replace(again, gain=0.1 + again.gain), s)
    assert not flexibility.holds(again, s.copy())
    others = [
        other,
        replace(start, tuned=None),
        replace(start, rocking=1e-6 * np.eye(4)),
        replace(start, damping_exponent=0.5),
        replace(start, bodies=random_bodies()),
    ]
    assert not any(flexibility.holds(one, s) for one in others)


def test_a_joint_that_follows_the_torque_has_no_flexibility_of_its_own() -> None:
    """Its closure differs from hit to hit."""
    made = campaign()
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    state = replace(state_at(made), exponent=0.5)
    assert closed_flexibility(made.bodies, state, frame.s) is None
