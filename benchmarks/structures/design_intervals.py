"""Intervals that `design` expects, beside those that identification then states.

Each session is the plan that `design` chooses for the shipped bolted plates, with its
own noise and, in the second case, its own gains of sensors and aims of hits. The FRFs
are those of the model with the noise of each line; the joints are fitted to them.

python benchmarks/structures/design_intervals.py [--sessions 50] [--seed 1]
    [--page docs/joint-design-numbers.md]
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.design.fisher_plan import (
    Criterion,
    HitPlan,
    PlanPrior,
    plan_covariance,
)
from jointbench.analysis.design.plan_search import PlanRequest, choose_plan
from jointbench.analysis.structures.design.pair_information import (
    HammerTest,
    pair_information,
)
from jointbench.analysis.structures.identification.frf_gains import FrfGains
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import pose_problem
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.reduction.mounted_sensors import (
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.predict_response import predict_frf
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import (
    StructureModel,
    sensors_of,
    structure_of,
)
from jointbench.station.joints.structure_tables import DesignTable

MODEL = Path(__file__).parents[2] / "examples" / "bolted-plates.toml"
MODES = 30
# The search of each session starts this far away, in ln.
AWAY = 0.1
# Standard deviation that counts as none: a prior of zero is refused.
NONE = 1e-9


@dataclass(frozen=True)
class Bench:
    """The structure, its joint, and how it is struck."""

    model: ReducedModel
    rows: FloatArray
    values: JointValues
    test: HammerTest
    table: DesignTable


def bench() -> Bench:
    """Read, mesh and reduce the shipped plates."""
    settings = read_toml(MODEL, StructureModel)
    table = settings.design
    structure = structure_of(settings, MODEL.parent)
    mounted = list(sensors_of(settings.reachable).values())
    box, loads = settings.identify.stiffness_box, sensor_rows(structure, mounted)
    model = reduce_structure(structure, modes=MODES, box=box, loads=loads)
    names = structure.parameter_names
    values = JointValues(
        np.array([table.stiffness[name] for name in names]),
        np.array([table.damping[name] for name in names]),
    )
    test = HammerTest(
        table.peak,
        table.contact,
        table.noise,
        table.sample_rate,
        table.duration,
        table.band,
        settings.identify.lines,
    )
    return Bench(model, readout(structure, model, mounted), values, test, table)


def sessions(
    own: Bench, plan: HitPlan, gain: float, count: int, seed: int
) -> tuple[FloatArray, FloatArray]:
    """Simulate and identify; errors and stated standard deviations, in ln."""
    random = np.random.default_rng([seed, int(1e4 * gain)])
    frequency = own.test.frequency()
    laplace = 2j * np.pi * frequency
    outputs, inputs = own.rows[list(plan.sensors)], own.rows[list(plan.hits)]
    exact: ComplexArray = (
        predict_frf(own.model, own.values, laplace, outputs, inputs).response
        * laplace**2
    )
    variance = own.test.variance(frequency) / plan.repeats
    truth = np.log(np.concatenate([own.values.stiffness, own.values.damping]))
    errors, stated = [], []
    for _ in range(count):
        noise = random.standard_normal((2, *exact.shape)) * np.sqrt(0.5 * variance)
        sensor = np.exp(gain * random.standard_normal((len(plan.sensors), 1, 1)))
        aim = np.exp(gain * random.standard_normal((1, len(plan.hits), 1)))
        frf = Frf(
            frequency=frequency,
            response=sensor * aim * exact + noise[0] + 1j * noise[1],
            kind=FrfKind.ACCELERANCE,
            variance=np.broadcast_to(variance, exact.shape),
        )
        evidence = StructureEvidence(
            "session", None, frf, outputs, inputs, gains=FrfGains(gain, gain)
        )
        start = truth + AWAY * random.standard_normal(truth.size)
        # As the search does: with exact gains first.
        exactly = pose_problem(own.model, [replace(evidence, gains=FrfGains())])
        start = descend(exactly, start).unknowns
        end = descend(pose_problem(own.model, [evidence]), start)
        errors.append(end.unknowns - truth)
        stated.append(np.sqrt(end.noise() * np.diag(end.covariance())))
    return np.array(errors), np.array(stated)


@one_thread()
def main() -> None:
    """Choose the plan, simulate the sessions, write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sessions", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    own = bench()
    pairs = pair_information(own.model, own.values, own.test, own.rows, own.rows)
    open_ = np.full(2 * len(own.model.names), np.inf)
    table, rows = own.table, []
    for gain in (table.gain_sd, NONE):
        prior = PlanPrior(open_, gain, gain)
        request = PlanRequest(
            pairs, prior, np.arange(open_.size), Criterion.D, float(table.repeats)
        )
        plan = choose_plan(request, table.sensors, table.hits)
        expected = np.sqrt(np.diag(plan_covariance(pairs, prior, plan)))
        own_gain = 0.0 if gain == NONE else gain
        errors, stated = sessions(own, plan, own_gain, options.sessions, options.seed)
        for at, name in enumerate(
            [f"{n} {q}" for q in ("stiffness", "damping") for n in own.model.names]
        ):
            ratio = np.median(expected[at] / stated[:, at])
            scatter = np.sqrt(np.mean(errors[:, at] ** 2)) / expected[at]
            rows.append(
                f"| {100 * own_gain:g} % | {name} | {100 * expected[at]:.3g} % "
                f"| {100 * np.median(stated[:, at]):.3g} % | {ratio:.2f} "
                f"| {scatter:.2f} |"
            )
            print(rows[-1], flush=True)
    if options.page is not None:
        head = HEAD.format(sessions=options.sessions, seed=options.seed)
        options.page.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")


HEAD = """# Expected and obtained intervals: numbers

Made by `benchmarks/structures/design_intervals.py --sessions {sessions} --seed {seed}`
for [joint-design.md](joint-design.md): the plan that `design` chooses for
`examples/bolted-plates.toml`, {sessions} simulated sessions with their own noise, and
gains of sensors and aims of hits that are off by 2 % each, or exact.

**Expected** is the standard deviation before the first hit; **stated** the median of
those that the fit to the FRFs states, enlarged where chi2 shows it; **ratio** the
median of expected over stated; **error** the rms error over the expected one. The fit
knows gains and aims as the expectation does: `identify.gain_sd` and
`identify.force_sd`. Without them their errors are taken for noise: the stated
deviations are then 50 times the expected ones, and the errors 70 to 1200 times.

The noise is 1e-6 of the FRFs here, so that products of two gains, which the linear
elimination leaves out, count: they widen the stated deviations by a tenth, and errors
of the damping exceed them. At such noise the model is the limit, not the plan.

| gains | parameter | expected | stated | ratio | error |
|---|---|---|---|---|---|
"""


if __name__ == "__main__":
    main()
