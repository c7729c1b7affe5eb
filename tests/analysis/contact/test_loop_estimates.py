"""Stiffness and losses of loops against the closed forms of Mindlin and of a slider."""

from collections.abc import Callable

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.loops.joint_loop import JointLoop, loop_cycles
from jointbench.analysis.contact.loops.loop_estimates import estimate_loop

STIFFNESS, LIMIT = 2e8, 1000.0
"""Of the contact before it slips [N/m], force at which it slides [N]."""
Backbone = Callable[[FloatArray], FloatArray]


def mindlin(force: FloatArray) -> FloatArray:
    """Return the displacement of one contact at a first force [m]."""
    left = 1.0 - np.abs(force) / LIMIT
    return np.sign(force) * 1.5 * LIMIT / STIFFNESS * (1.0 - left ** (2.0 / 3.0))


def mindlin_energy(force: float) -> float:
    """Return the energy of a cycle [J].

    Mindlin and Deresiewicz 1953, J. Appl. Mech. 20, 327, in Johnson, Contact Mechanics,
    eq. (7.61), with the stiffness in place of 8 G* a.
    """
    left = 1.0 - force / LIMIT
    first = 1.0 - left ** (5.0 / 3.0)
    second = 5.0 * force / (6.0 * LIMIT) * (1.0 + left ** (2.0 / 3.0))
    return 7.2 * LIMIT**2 / STIFFNESS * (first - second)


def cycled(
    backbone: Backbone, levels: list[float], cycles: int = 3, samples: int = 150
) -> tuple[FloatArray, FloatArray]:
    """Return displacement and force of cycles by Masing, at rising amplitudes."""
    force, place = [np.zeros(1)], [np.zeros(1)]
    for level in levels:
        way = np.linspace(force[-1][-1], level, samples)[1:]
        force.append(way)
        place.append(backbone(way))
        for sign in [1.0, -1.0] * cycles:
            way = np.linspace(sign * level, -sign * level, samples)[1:]
            back = backbone(0.5 * (level - sign * way))
            force.append(way)
            place.append(sign * (backbone(np.array([level])) - 2.0 * back))
    return np.concatenate(place), np.concatenate(force)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_a_loop_of_one_contact_has_mindlin_s_stiffness_and_energy(share: float) -> None:
    """Without noise: 0.1 % of the stiffness, 0.1 % of the energy of 150 samples."""
    force = share * LIMIT
    found = estimate_loop(JointLoop(*cycled(mindlin, [force])))
    assert found.stiffness == pytest.approx(STIFFNESS, rel=1e-3)
    (level,) = found.levels
    assert level.cycles == 3
    assert level.force == pytest.approx(force, rel=1e-9)
    assert level.energy == pytest.approx(mindlin_energy(force), rel=1e-3)
    stored = np.pi * force * float(mindlin(np.array([force]))[0])
    assert level.loss_factor == pytest.approx(mindlin_energy(force) / stored, rel=1e-3)


def test_an_elastic_slider_dissipates_its_parallelogram() -> None:
    """A spring that slides at 1 kN, driven to twice its elastic way: 4 F (u - F/k)."""
    reach = 2.0 * LIMIT / STIFFNESS
    place = np.concatenate(
        [np.linspace(a, b, 200)[1:] for a, b in [(1, -1), (-1, 1)] * 2]
    )
    force, sliding = [], LIMIT
    for step in np.diff(np.concatenate([[1.0], place])) * reach:
        sliding = float(np.clip(sliding + STIFFNESS * step, -LIMIT, LIMIT))
        force.append(sliding)
    found = estimate_loop(JointLoop(reach * place, np.array(force)))
    assert found.stiffness == pytest.approx(STIFFNESS, rel=1e-3)
    energy = 4.0 * LIMIT * (reach - LIMIT / STIFFNESS)
    assert found.levels[0].energy == pytest.approx(energy, rel=0.01)


def test_intervals_hold_under_noise_on_both_channels() -> None:
    """60 records at two amplitudes: errors over their sd have an sd near 1."""
    place, force = cycled(mindlin, [300.0, 900.0], samples=120)
    exact = estimate_loop(JointLoop(place, force))
    errors = []
    for seed in range(60):
        random = np.random.default_rng(seed)
        noisy = estimate_loop(
            JointLoop(
                place + 0.002 * np.ptp(place) * random.standard_normal(place.size),
                force + 0.001 * np.ptp(force) * random.standard_normal(force.size),
            )
        )
        own = [np.log(noisy.stiffness / STIFFNESS) / noisy.stiffness_sd]
        for level, known in zip(noisy.levels, exact.levels, strict=True):
            own.append((level.energy / known.energy - 1.0) / level.energy_sd)
        errors.append(own)
    spread = np.sqrt(np.mean(np.square(errors), axis=0))
    # The larger of noise and scatter is stated: an sd below 1 is expected.
    assert np.all((spread > 0.6) & (spread < 1.3))


def test_loading_for_the_first_time_belongs_to_no_cycle() -> None:
    """Two amplitudes: the way up to each is left out; cycles are counted by size."""
    loop = JointLoop(*cycled(mindlin, [200.0, 800.0], cycles=2))
    assert len(loop_cycles(loop)) == 3
    found = estimate_loop(loop)
    assert [level.cycles for level in found.levels] == [1, 2]


def test_a_loss_below_the_noise_is_not_determined() -> None:
    """An elastic joint: the energy is within its sd of zero."""
    place, force = cycled(lambda f: f / STIFFNESS, [500.0])
    random = np.random.default_rng(3)
    place = place + 0.005 * np.ptp(place) * random.standard_normal(place.size)
    (level,) = estimate_loop(JointLoop(place, force)).levels
    assert not level.dissipates


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda u, f: (u, -f), "change the sign of one"),
        (lambda u, f: (u[:160], f[:160]), "no closed cycle"),
        (lambda u, f: (u[::20], f[::20]), "too few samples after its reversal"),
        (lambda u, f: (u[:9], f[:9]), "the loop has 9 samples"),
        (lambda u, f: (0.0 * u, f), "the displacement of the loop never changes"),
    ],
)
def test_records_that_are_no_loop_are_refused(
    change: Callable[..., tuple[FloatArray, FloatArray]], words: str
) -> None:
    """One line with what was found and what to do."""
    place, force = cycled(mindlin, [500.0])
    with pytest.raises(BadData, match=words) as caught:
        estimate_loop(JointLoop(*change(place, force)))
    assert "\n" not in str(caught.value)
