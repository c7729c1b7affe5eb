# SPDX-License-Identifier: MIT
"""``jointbench design``: hit points and sensors, before the first hit."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.design.fisher_plan import (
    Criterion,
    HitPlan,
    PairInformation,
    PlanPrior,
    hits_needed,
    plan_covariance,
)
from jointbench.analysis.design.plan_search import (
    NextStep,
    PlanRequest,
    choose_plan,
    next_steps,
    random_plan,
)
from jointbench.analysis.structures.design.pair_information import (
    AddedMass,
    HammerTest,
    information_names,
    pair_information,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    is_modulus,
    with_moduli,
)
from jointbench.analysis.structures.reduction.mounted_sensors import (
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.station.design.design_checks import require_points, require_wanted
from jointbench.station.design.design_records import (
    DesignedTest,
    DesignRequest,
)
from jointbench.station.design.torque_next import (
    StruckPlan,
    known_states,
    next_torques,
    with_moduli_of_one,
)
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.identify_checks import known_priors
from jointbench.station.joints.state_values import read_identified, state_values
from jointbench.station.joints.structure_model import (
    StructureModel,
    sensors_of,
    structure_of,
)
from jointbench.station.joints.structure_tables import DesignTable

RANDOM_PLANS = 200
_MODES = 30


def designed_test(model: Path, request: DesignRequest) -> DesignedTest:
    """Design the test of a structure.

    Args:
        model: structure model with [design] and [reachable.*].
        request: what is asked for.

    Raises:
        BadData: the model lacks what a design needs.
        UsageError: more points are asked for than there are.
    """
    settings = read_toml(model, StructureModel)
    table = settings.design
    if table is None or not settings.reachable:
        raise BadData(
            f"{model}: a design needs a table [design] with a band, and the points "
            "that can be reached as [reachable.NAME] with body, position and direction"
        )
    places = {**settings.reachable}
    if request.measured:
        places |= {**settings.sensors, **settings.hits}
    require_points(settings, table, request)
    test = _test(table, settings.identify.lines)
    test.frequency()
    structure = structure_of(settings, model.parent)
    require_wanted(settings, table, structure)
    joints = _values(settings, table, structure, request)
    mounted = list(sensors_of(places).values())
    loads = sensor_rows(structure, mounted)
    modes, box = settings.identify.modes or _MODES, settings.identify.stiffness_box
    reduced = reduce_structure(structure, modes=modes, box=box, loads=loads)
    reduced = with_moduli(reduced, list(settings.identify.modulus_sd))
    values = with_moduli_of_one(joints, reduced)
    rows = readout(structure, reduced, mounted)
    pairs = pair_information(reduced, values, test, rows, rows)
    search = _search(settings, table, reduced, pairs)
    names = tuple(places)
    if not request.measured:
        plan = choose_plan(search, table.sensors, table.hits)
        return _result(search, reduced, names, plan, request)
    plan = _measured(settings, names, table)
    found = _result(search, reduced, names, plan, request)
    steps = list(next_steps(search, plan))
    if request.mass is not None:
        for at in range(len(settings.reachable)):
            added = AddedMass(request.mass, rows[at])
            more = pair_information(reduced, values, test, rows, rows, added)
            steps.append(_mass_step(search, plan, more, at))
    states = known_states(settings, structure, request, joints)
    torques = next_torques(
        StruckPlan(reduced, test, rows[list(plan.sensors)], rows[list(plan.hits)]),
        search,
        plan,
        states,
        (*table.torques, *request.plan_torques),
        table.torque_scatter,
    )
    steps += [NextStep("torque", at, one.step.width) for at, one in enumerate(torques)]
    steps.sort(key=lambda one: one.width)
    known = len({one.torque for one in states})
    return replace(found, steps=tuple(steps), torques=torques, known_torques=known)


def _mass_step(
    search: PlanRequest, plan: HitPlan, more: PairInformation, at: int
) -> NextStep:
    """Return what a second run of the plan with a mass at a point buys."""
    own = search.pairs
    both = PairInformation(
        own.common + more.common, own.cross + more.cross, own.own + more.own
    )
    again = PlanRequest(
        both, search.prior, search.wanted, search.criterion, search.repeats
    )
    return NextStep("mass", at, again.width(plan) / search.width(plan))


def _result(
    search: PlanRequest,
    reduced: ReducedModel,
    names: tuple[str, ...],
    plan: HitPlan,
    request: DesignRequest,
) -> DesignedTest:
    count = search.pairs.own.shape
    even = HitPlan(
        _spread(len(plan.sensors), count[0]),
        _spread(len(plan.hits), count[1]),
        plan.repeats,
    )
    rng = np.random.default_rng(0)
    sizes = len(plan.sensors), len(plan.hits)
    randoms = [
        search.width(random_plan(search, *sizes, rng)) for _ in range(RANDOM_PLANS)
    ]
    width = search.width(plan)
    wanted = tuple(int(one) for one in search.wanted)
    needed = None
    if request.deviation is not None:
        needed = hits_needed(
            search.pairs, search.prior, plan, wanted, request.deviation
        )
    return DesignedTest(
        information_names(reduced),
        wanted,
        names,
        plan,
        np.sqrt(np.diag(plan_covariance(search.pairs, search.prior, plan))),
        np.sqrt(np.diag(plan_covariance(search.pairs, search.prior, even))),
        search.width(even) / width,
        min(randoms) / width,
        needed,
    )


def _spread(count: int, there: int) -> tuple[int, ...]:
    """Return numbers evenly spread over a list."""
    return tuple(
        int(one) for one in np.unique(np.linspace(0, there - 1, count).round())
    )


def _values(
    settings: StructureModel,
    table: DesignTable,
    structure: Structure,
    request: DesignRequest,
) -> JointValues:
    if request.identified is not None:
        file = read_identified(request.identified)
        return state_values(file, structure, settings.identify, request.state).joints
    names = structure.parameter_names
    for key, given in (("stiffness", table.stiffness), ("damping", table.damping)):
        missing = [name for name in names if name not in given]
        if missing:
            raise BadData(
                f"design.{key} holds no {missing[0]!r}; write the expected value, or "
                "give the JSON of 'jointbench identify'"
            )
    return JointValues(
        np.array([table.stiffness[name] for name in names]),
        np.array([table.damping[name] for name in names]),
    )


def _test(table: DesignTable, lines: int) -> HammerTest:
    return HammerTest(
        table.peak,
        table.contact,
        table.noise,
        table.sample_rate,
        table.duration,
        table.band,
        lines,
    )


def _search(
    settings: StructureModel,
    table: DesignTable,
    reduced: ReducedModel,
    pairs: PairInformation,
) -> PlanRequest:
    names = information_names(reduced)
    deviation = np.full(len(names), np.inf)
    for name, known in known_priors(settings.identify).items():
        label = name if is_modulus(name) else f"{name}_stiffness"
        deviation[names.index(label)] = known.relative_sd
    wanted = table.wanted or tuple(one for one in names if not is_modulus(one))
    prior = PlanPrior(deviation, table.gain_sd, table.force_sd)
    return PlanRequest(
        pairs,
        prior,
        np.array([names.index(one) for one in wanted]),
        Criterion(table.criterion),
        float(table.repeats),
    )


def _measured(
    settings: StructureModel, names: Sequence[str], table: DesignTable
) -> HitPlan:
    return HitPlan(
        tuple(names.index(one) for one in settings.sensors),
        tuple(names.index(one) for one in settings.hits),
        float(table.repeats),
    )
