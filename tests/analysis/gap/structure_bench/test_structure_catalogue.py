"""Effects on bolted bodies: each vanishes where it is off, and acts at its sites."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hit_campaigns import Hidden, write_campaign

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.search.screening import start_grid
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_bench.structure_catalogue import (
    STRUCTURE_CATALOGUE,
)
from jointbench.analysis.gap.structure_response.surface_around import SurfaceAround
from jointbench.station.schemas.nominal_bench_file import read_nominal

PLACES = np.array([[0.1, 0.1], [0.3, 0.1], [0.3, 0.2], [0.1, 0.2]])
NAMES = tuple(entry.effect.name for entry in STRUCTURE_CATALOGUE)
LANDING = np.zeros((4, 4))
RIGID = {"joint_compliance_normal", "joint_compliance_tangential"}
MESHED = {"thickness"}
"""Effects that a modal table cannot show."""


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> StructureBench:
    """Return a bench whose table lists all directions at the sensors."""
    path, nominal = write_campaign(tmp_path_factory.mktemp("complete"), Hidden())
    campaign = read_hit_campaign(path, *read_nominal(nominal))
    bodies = campaign.bodies
    around = _bent(bodies.omega.size)
    across = np.stack([np.roll(bodies.sensors, k, axis=1) for k in (1, 2)], axis=1)
    campaign = replace(
        campaign,
        bodies=replace(
            bodies,
            across=across,
            around_channels=dict.fromkeys(bodies.channels, around),
            around_points={"P1": around},
        ),
        nominal=replace(campaign.nominal, bolt_places=PLACES),
    )
    return make_structure_bench(campaign)


def _bent(modes: int) -> SurfaceAround:
    """Return a surface with quadratic shapes."""
    powers = np.array([(i, j) for i in range(3) for j in range(3 - i)])
    shapes = 0.1 * np.random.default_rng(8).standard_normal((len(powers), 3, modes))
    return SurfaceAround((0, 1), np.array([0.06, 0.06]), powers, shapes)


def test_sites_are_those_of_the_structure(bench: StructureBench) -> None:
    """Four bolts and feet, two bodies and axes, three channels, eight more points."""
    count = Counter(c.effect.name for c in bench.candidates)
    assert not (RIGID | MESHED) & set(count)
    assert [count[name] for name in ("loose_bolt", "cubic", "support")] == [4, 4, 4]
    assert [count[name] for name in ("contact_patch", "modulus")] == [2, 2]
    assert [count[name] for name in ("polarity", "cross_axis")] == [3, 3]
    assert [count[name] for name in ("wrong_position", "wrong_hit_point")] == [3, 1]
    assert [count[name] for name in ("macroslip", "microslip")] == [5, 1]
    assert count["preload_damping"] == 1
    points = {c.site.name for c in bench.candidates if c.effect.name == "hidden_mode"}
    assert {"P1", "P1 normal", "top bolt 3", "foot 0"} <= points


@pytest.mark.parametrize("name", [n for n in NAMES if n not in RIGID | MESHED])
def test_an_effect_vanishes_where_it_is_off(bench: StructureBench, name: str) -> None:
    """Off it changes nothing, and a little of it changes the response."""
    candidate = next(c for c in bench.candidates if c.effect.name == name)
    first = candidate.effect.parameters[0]
    base, window = np.zeros(bench.base_sd.size), 0.003
    plain = bench.response(base, (), window)
    peak = np.abs(plain).max()
    shape = start_grid(candidate)[-1]

    def change(amplitude: float) -> float:
        u = np.array([first.encode(amplitude), *shape[1:]])
        moved = bench.response(base, (Term(candidate, u),), window)
        return float(np.abs(moved - plain).max() / peak)

    assert change(0.0) < 1e-12
    assert 1e-6 < change(first.far[len(first.far) // 2] if first.far else 0.3) < 30.0
    assert _finite(bench, candidate, shape)


def test_errors_of_a_table_weigh_as_few_numbers(bench: StructureBench) -> None:
    """Neither hits nor samples average them out; masses scale what they spoil."""
    nominal = replace(bench.campaign.nominal, table_sd=(0.005, 0.02))
    uncertain = make_structure_bench(replace(bench.campaign, nominal=nominal))
    records, _, count = bench.campaign.hits.response.shape
    assert uncertain.layout.tuned is not None
    modes = uncertain.layout.tuned.omega.size
    assert bench.coherence == 1.0
    assert uncertain.coherence == pytest.approx(records / 2 * count / (2 * modes))
    known = dict(zip(uncertain.base_names, uncertain.base_sd, strict=True))
    assert known["mass top"] == pytest.approx(np.hypot(0.001, 0.02))


def test_two_laws_are_not_paired_and_nothing_goes_twice(bench: StructureBench) -> None:
    """A joint that rocks goes with a mass and with micro-slip."""
    first = {c.effect.name: c for c in reversed(bench.candidates)}
    rocks, slips, stops, heavy = (
        first[name]
        for name in ("joint_compliance_rocking", "microslip", "clearance", "added_mass")
    )
    assert bench.may_add(heavy, (rocks,))
    assert bench.may_add(slips, (heavy,))
    assert bench.may_add(slips, (rocks,)) and bench.may_add(rocks, (slips,))
    assert not bench.may_add(stops, (slips,))
    assert not bench.may_add(heavy, (heavy,))


def test_a_joint_rocks_about_bolts_that_yield(bench: StructureBench) -> None:
    """Where the model holds them rigid, beside their compliance alone."""
    bodies = bench.campaign.bodies
    stiff = replace(bodies, rigid=np.array([False, False, True]))
    held = make_structure_bench(replace(bench.campaign, bodies=stiff))
    first = {c.effect.name: c for c in reversed(held.candidates)}
    yields, heavy = (first[n] for n in ("joint_compliance_normal", "added_mass"))
    for name in ("joint_compliance_rocking", "contact_patch"):
        assert bench.may_add(first[name], ())
        assert not held.may_add(first[name], ())
        assert not held.may_add(first[name], (heavy,))
        assert held.may_add(first[name], (yields,))


def _finite(bench: StructureBench, candidate: Candidate, shape: FloatArray) -> bool:
    values = np.array(
        [
            p.decode(float(u)) * bench.scale(p.scale)
            for p, u in zip(candidate.effect.parameters, shape, strict=True)
        ]
    )
    return all(np.isfinite(one.value) for one in candidate.effect.reported(values))


@pytest.mark.parametrize("name", ["microslip", "clearance"])
def test_laws_in_a_window_act_as_in_the_whole_record(
    bench: StructureBench, name: str
) -> None:
    """Their forces are integrated to a little beyond it, and held from there on."""
    candidate = next(c for c in bench.candidates if c.effect.name == name)
    shape = start_grid(candidate)[0]
    amplitude = 0.5 if name == "microslip" else 1.0
    terms = (Term(candidate, np.concatenate([[amplitude], shape[1:]])),)
    base = np.zeros(bench.base_sd.size)
    parts = []
    for window in (0.006, None):
        law = bench.response(base, terms, window) - bench.response(base, (), window)
        parts.append(law)
    short, whole = parts[0], parts[1][..., : parts[0].shape[2]]
    peak = np.abs(bench.response(base, (), None)).max(axis=2, keepdims=True)
    assert np.abs(whole / peak).max() > 1e-3
    assert np.abs((short - whole) / peak).max() < 5e-4


@pytest.mark.parametrize("name", ["microslip", "cubic"])
def test_slopes_by_a_law_are_those_of_differences(
    bench: StructureBench, name: str
) -> None:
    """The columns of a law, from its forces alone, agree with the whole model."""
    candidate = next(c for c in bench.candidates if c.effect.name == name)
    shape = start_grid(candidate)[-1]
    u = np.array([candidate.effect.parameters[0].encode(0.3), *shape[1:]])
    base, window = np.zeros(bench.base_sd.size), Resolution(0.003)
    few = bench.chosen(np.arange(4)).at(base, (Term(candidate, u),), LANDING, 1e-3)
    slopes = few.slopes(base, (Term(candidate, u),), window)
    assert slopes.shape[1] == base.size + u.size
    for k in range(u.size):
        step = np.where(np.arange(u.size) == k, 1e-5, 0.0)
        up, down = (
            few.residual(base, (Term(candidate, u + sign * step),), window)
            for sign in (1.0, -1.0)
        )
        difference = (up - down) / 2e-5
        apart = np.abs(slopes[:, base.size + k] - difference).max()
        assert apart < 0.02 * np.abs(difference).max(), k
