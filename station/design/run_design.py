# SPDX-License-Identifier: MIT
"""``jointbench design``: hit points and sensors, before the first hit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
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
    require_choice,
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
    modulus_name,
    with_moduli,
)
from jointbench.analysis.structures.reduction.mounted_sensors import (
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
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


@dataclass(frozen=True, slots=True, eq=False)
class DesignedTest:
    """A test plan with what it is expected to give.

    Attributes:
        names: of the common parameters.
        wanted: numbers of the wanted ones.
        points: names of the points, sensors and hits alike.
        plan: chosen, or as measured.
        deviation: expected sd of the common parameters in ln, shape (p,).
        even: the same of an evenly spread plan.
        ratio_even: width of that plan over that of the chosen one [-].
        ratio_random: width of the best of 200 random plans, likewise [-].
        needed: hits at each point for the wanted deviation; None where there is none.
        steps: what one more step buys, the best first.
    """

    names: tuple[str, ...]
    wanted: tuple[int, ...]
    points: tuple[str, ...]
    plan: HitPlan
    deviation: FloatArray
    even: FloatArray
    ratio_even: float
    ratio_random: float
    needed: int | None
    steps: tuple[NextStep, ...]


@dataclass(frozen=True, slots=True)
class DesignRequest:
    """What is asked for.

    Attributes:
        identified: JSON of ``identify``; None takes the expected values of the model.
        state: label in it.
        measured: whether [sensors] and [hits] of the model are the plan, and the next
            step is asked for.
        deviation: wanted sd [-], or None.
        mass: added at each point in turn as a next step [kg], or None.
        plan_sensors: response sensors of the plan to be written, or None.
    """

    identified: Path | None = None
    state: str | None = None
    measured: bool = False
    deviation: float | None = None
    mass: float | None = None
    plan_sensors: int | None = None


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
    _require_points(settings, table, request)
    test = _test(table, settings.identify.lines)
    test.frequency()
    structure = structure_of(settings, model.parent)
    _require_wanted(settings, table, structure)
    values = _values(settings, table, structure, request)
    mounted = list(sensors_of(places).values())
    loads = sensor_rows(structure, mounted)
    modes, box = settings.identify.modes or _MODES, settings.identify.stiffness_box
    reduced = reduce_structure(structure, modes=modes, box=box, loads=loads)
    moduli = list(settings.identify.modulus_sd)
    reduced = with_moduli(reduced, moduli)
    values = JointValues(
        np.append(values.stiffness, np.ones(len(moduli))),
        np.append(values.damping, np.zeros(len(moduli))),
    )
    rows = readout(structure, reduced, mounted)
    pairs = pair_information(reduced, values, test, rows, rows)
    search = _search(settings, table, reduced, pairs)
    names = tuple(places)
    if request.measured:
        plan = _measured(settings, names, table)
        steps = list(next_steps(search, plan))
        if request.mass is not None:
            for at in range(len(settings.reachable)):
                added = AddedMass(request.mass, rows[at])
                more = pair_information(reduced, values, test, rows, rows, added)
                steps.append(_mass_step(search, plan, more, at))
        steps.sort(key=lambda one: one.width)
    else:
        plan, steps = choose_plan(search, table.sensors, table.hits), []
    return _result(search, reduced, names, plan, tuple(steps), request)


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
    steps: tuple[NextStep, ...],
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
        steps,
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


def _require_points(
    settings: StructureModel, table: DesignTable, request: DesignRequest
) -> None:
    """Check sensors and hit points before the meshes are reduced, which takes long."""
    if request.measured:
        if not settings.sensors or not settings.hits:
            raise BadData("--next needs [sensors.*] and [hits.*] as they were measured")
        chosen = len(settings.sensors)
    else:
        require_choice(table.sensors, table.hits, (len(settings.reachable),) * 2)
        chosen = table.sensors
    if request.plan_sensors not in {None, chosen}:
        raise BadData(
            f"the plan has {request.plan_sensors} response sensors with a point, the "
            f"design {chosen}; give the plan as many, or change design.sensors"
        )


def _require_wanted(
    settings: StructureModel, table: DesignTable, structure: Structure
) -> None:
    """Check the names of wanted parameters before the meshes are reduced."""
    there = [
        f"{name}_{kind}"
        for kind in ("stiffness", "damping")
        for name in structure.parameter_names
    ]
    there += [modulus_name(body) for body in settings.identify.modulus_sd]
    unknown = [one for one in table.wanted if one not in there]
    if unknown:
        raise UsageError(f"design.wanted: no {unknown[0]!r}; there are {there}")


def _measured(
    settings: StructureModel, names: Sequence[str], table: DesignTable
) -> HitPlan:
    return HitPlan(
        tuple(names.index(one) for one in settings.sensors),
        tuple(names.index(one) for one in settings.hits),
        float(table.repeats),
    )
