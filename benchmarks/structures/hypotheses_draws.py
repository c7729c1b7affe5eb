"""One mode missing, one spurious, none wrong: are joints and hypotheses right?

Two marble plates with a random joint; natural frequencies with noise, of which one is
left out (never the highest, whose absence changes nothing), or one more is put in.

python benchmarks/structures/hypotheses_draws.py --case 0 --seeds 0 100
python benchmarks/structures/hypotheses_draws.py --page docs/joint-hypotheses-numbers.md
"""

import argparse
import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from cases import SENSORS, two_plates
from scipy.stats import binomtest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.hypotheses import HypothesisKind
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.identification.weigh_hypotheses import (
    StateHypotheses,
    weigh_hypotheses,
)
from jointbench.analysis.structures.reduction.mounted_sensors import (
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.predict_modes import (
    JointValues,
    predict_modes,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel

BOX = (1e7, 1e10)
MEASURED = 8
RIGID = 6
SPARE = 4
FREQUENCY_SD = 0.001
DAMPING_SD = 0.05
SHAPE_SD = 0.03
CASES = (
    ("one mode missing", False),
    ("as measured", False),
    ("one mode spurious", False),
    ("one mode missing", True),
    ("as measured", True),
)
RESULTS = Path(__file__).with_suffix(".jsonl")
# Draws from this seed on were made after the last change of the search (record 0380).
FRESH = 5207
HEAD = """# Joints with a mode missing: numbers

Made by `benchmarks/structures/hypotheses_draws.py` for
[joint-hypotheses.md](joint-hypotheses.md). Two free marble plates with a random joint
(normal 0.2 to 2 GN/m, tangents 50 to 500 MN/m); the lowest {modes} modes with noise of
{f:g} % of a frequency (with shapes: {d:g} % of a damping ratio, {s:g} % of the largest
shape). Missing is any of them but the highest, whose absence changes nothing; spurious
is a frequency anywhere between the lowest and the highest.

**Named** is the truth as the most probable hypothesis, **listed** among those that
survive, whose median number follows. Parameters are those over all hypotheses, each
with its probability; one that is not identifiable (open) counts as right where
its 95 % interval holds the truth. **All** are draws with every parameter so. "First
alone" takes the parameters of the most probable hypothesis. In brackets the 95 %
interval (Wilson). Draws are added one by one (`--seeds`).

## Since hypotheses are searched until one fits
Fresh draws, made at commit 6a985138 after the last change of the search
([record 0380](decisions/0380-hypotheses-are-searched-until-one-fits.md)).

{fresh}

{missed}

## Before
Draws of earlier code. Of the three with a mode missing that were not listed, seeds 30
and 80 are named first by later code even without that search; seed 78 is named first
with it, and so is seed 10 of the spurious ones.

{before}
"""
TABLE = (
    "| wrong | data | seeds | named | listed | number | in 2 sd | all | first alone "
    "| open |\n|---|---|---|---|---|---|---|---|---|---|\n"
)
# Joints are drawn log-uniform over these: each direction moves some of the modes.
JOINT = np.log([[2e8, 2e9], [5e7, 5e8], [5e7, 5e8]])


@dataclass(frozen=True)
class Draw:
    """A simulated measurement and what is wrong with it."""

    evidence: StructureEvidence
    truth: dict[str, float]
    kind: HypothesisKind
    at: int


def modes_of(
    model: ReducedModel,
    rows: FloatArray,
    values: JointValues,
    random: np.random.Generator,
    shapes: bool,
) -> MeasuredModes:
    """Return the lowest modes with noise."""
    found = predict_modes(model, values, rows)
    keep = slice(0, MEASURED)
    frequency = found.natural_frequency[keep]
    noisy = frequency * np.exp(FREQUENCY_SD * random.standard_normal(MEASURED))
    order = np.argsort(noisy)
    plain = MeasuredModes(noisy[order], FREQUENCY_SD * noisy[order])
    if not shapes:
        return plain
    size = np.abs(found.shapes[keep]).max(axis=1, keepdims=True)
    sd = np.broadcast_to(SHAPE_SD * size, found.shapes[keep].shape)
    noise = random.standard_normal((2, *sd.shape))
    shape = found.shapes[keep] + sd * (noise[0] + 1j * noise[1])
    ratio = found.damping_ratio[keep]
    ratio = ratio * (1.0 + DAMPING_SD * random.standard_normal(MEASURED))
    ratio = np.maximum(ratio, 1e-5)
    return MeasuredModes(
        plain.natural_frequency,
        plain.frequency_sd,
        ratio[order],
        DAMPING_SD * ratio[order],
        shape[order],
        sd[order],
        tuple(f"a{at + 1}" for at in range(rows.shape[0])),
    )


def without(modes: MeasuredModes, at: int) -> MeasuredModes:
    """Leave out one mode."""

    def rest(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else np.delete(values, at, axis=0)

    return MeasuredModes(
        np.delete(modes.natural_frequency, at),
        np.delete(modes.frequency_sd, at),
        rest(modes.damping_ratio),
        rest(modes.damping_ratio_sd),
        None if modes.shapes is None else np.delete(modes.shapes, at, axis=0),
        rest(modes.shape_sd),
        modes.outputs,
    )


def with_spurious(
    modes: MeasuredModes, random: np.random.Generator
) -> tuple[MeasuredModes, int]:
    """Add a frequency that is none of the structure."""
    frequency = modes.natural_frequency
    extra = float(np.exp(random.uniform(*np.log(frequency[[0, -1]]))))
    whole = np.sort(np.append(frequency, extra))
    place = int(np.searchsorted(frequency, extra))
    return MeasuredModes(whole, FREQUENCY_SD * whole), place


def draw_of(
    model: ReducedModel,
    rows: FloatArray,
    random: np.random.Generator,
    kind: HypothesisKind,
    shapes: bool,
) -> Draw:
    """Draw a joint and its measurement."""
    stiffness = np.exp(random.uniform(JOINT[:, 0], JOINT[:, 1]))
    values = JointValues(stiffness, 1e-5 * stiffness)
    modes, at = modes_of(model, rows, values, random, shapes), -1
    if kind is HypothesisKind.MISSING:
        at = int(random.integers(0, MEASURED - 1))
        modes = without(modes, at)
    elif kind is HypothesisKind.SPURIOUS:
        modes, at = with_spurious(modes, random)
    truth = {f"{n}_stiffness": v for n, v in zip(model.names, stiffness, strict=True)}
    if shapes:
        damping = zip(model.names, values.damping, strict=True)
        truth |= {f"{n}_damping": v for n, v in damping}
    outputs = rows if shapes else np.zeros((0, model.size))
    evidence = StructureEvidence("rig", modes, None, outputs, outputs[:0])
    return Draw(evidence, truth, kind, at)


def named(draw: Draw, found: StateHypotheses) -> str:
    """Return whether the truth is the most probable reading, listed, or not.

    With shapes, modes are paired by MAC: the one without a partner is then named in the
    text of the modes as measured.
    """
    for place, one in enumerate(found.surviving):
        if draw.kind is HypothesisKind.MISSING:
            right = f"mode {draw.at + 1} of the model" in one.text
        elif draw.kind is HypothesisKind.SPURIOUS:
            spurious = draw.evidence.modes.natural_frequency[draw.at]
            right = one.kind is draw.kind and f"{spurious:.5g} Hz" in one.text
        else:
            right = one.kind is HypothesisKind.AS_MEASURED
        if right:
            return "first" if place == 0 else "listed"
    return "no"


def within(found: StateHypotheses, truth: dict[str, float], best: bool) -> list[bool]:
    """Return for each parameter whether the truth is within 2 sd, or the interval."""
    chosen = found.hypotheses[0].parameters if best else found.parameters
    inside = []
    for one in chosen:
        if one.name not in truth:
            continue
        if one.sd is None:
            low, high = one.interval
            inside.append(bool(low <= truth[one.name] <= high))
        else:
            away = abs(np.log(truth[one.name] / one.value))
            inside.append(bool(away <= 2.0 * one.sd / one.value))
    return inside


def line_of(
    model: ReducedModel,
    rows: FloatArray,
    kind: HypothesisKind,
    shapes: bool,
    seed: int,
) -> dict[str, object]:
    """Draw once, weigh, and return what came out."""
    random = np.random.default_rng([seed, list(HypothesisKind).index(kind), shapes])
    draw = draw_of(model, rows, random, kind, shapes)
    begin = time.process_time()
    found = weigh_hypotheses(model, [draw.evidence])[0]
    return {
        "kind": kind.value,
        "shapes": shapes,
        "seed": seed,
        "named": named(draw, found),
        "listed": len(found.surviving),
        "inside": within(found, draw.truth, False),
        "inside_first": within(found, draw.truth, True),
        "open": sum(one.sd is None for one in found.parameters),
        "cpu_s": round(time.process_time() - begin, 2),
    }


def share(right: int, count: int) -> str:
    """Return a count with its rate and the 95 % interval (Wilson)."""
    ends = binomtest(right, count).proportion_ci(method="wilson")
    return (
        f"{right} of {count}, {100 * right / count:.1f} % "
        f"({100 * ends.low:.1f} to {100 * ends.high:.1f})"
    )


def row_of(lines: list[dict[str, object]]) -> str:
    """Return the row of one case."""
    count, seeds = len(lines), [int(str(one["seed"])) for one in lines]
    first = sum(one["named"] == "first" for one in lines)
    either = sum(one["named"] != "no" for one in lines)
    inside = np.array([one["inside"] for one in lines])
    leading = np.array([one["inside_first"] for one in lines])
    kind = lines[0]["kind"]
    cells = [
        "nothing" if kind == HypothesisKind.AS_MEASURED.value else str(kind),
        "shapes, damping" if lines[0]["shapes"] else "frequencies",
        f"{min(seeds)} to {max(seeds)}",
        share(first, count),
        share(either, count),
        f"{np.median([one['listed'] for one in lines]):.0f}",
        share(int(inside.sum()), inside.size),
        share(int(inside.all(axis=1).sum()), count),
        f"{100 * leading.mean():.1f} %",
        f"{sum(one['open'] for one in lines)} of {inside.size}",
    ]
    return "| " + " | ".join(cells) + " |"


def table_of(lines: list[dict[str, object]]) -> str:
    """Return the table of some draws, a row for each case."""
    rows = []
    for kind, shapes in CASES:
        own = [one for one in lines if (one["kind"], one["shapes"]) == (kind, shapes)]
        if own:
            rows.append(row_of(own))
    return TABLE + "\n".join(rows)


def missed(lines: list[dict[str, object]]) -> str:
    """Return the seeds at fault, as a sentence."""

    def listing(seeds: list[object]) -> str:
        return ", ".join(map(str, seeds)) or "none"

    unlisted = [one["seed"] for one in lines if one["named"] == "no"]
    outside = [one["seed"] for one in lines if not np.all(one["inside"])]
    both = sum(one["named"] != "no" and bool(np.all(one["inside"])) for one in lines)
    return (
        f"Listed, with every parameter in 2 sd: {share(both, len(lines))}. "
        f"Seeds whose truth is not listed: {listing(unlisted)}. "
        f"Seeds with a parameter outside: {listing(outside)}."
    )


def write_page(path: Path) -> None:
    """Write the page from all draws on file."""
    lines = [json.loads(one) for one in RESULTS.read_text("utf-8").splitlines()]
    fresh = [one for one in lines if one["seed"] >= FRESH]
    page = HEAD.format(
        f=100 * FREQUENCY_SD,
        d=100 * DAMPING_SD,
        s=100 * SHAPE_SD,
        modes=MEASURED,
        fresh=table_of(fresh),
        missed=missed(fresh),
        before=table_of([one for one in lines if one["seed"] < FRESH]),
    )
    path.write_text(page, encoding="utf-8")


def main() -> None:
    """Add draws of one case to the file, or write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 100))
    parser.add_argument("--case", type=int, default=0)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    if options.page is not None:
        write_page(options.page)
        return
    structure = two_plates((4, 3, 1))
    loads = sensor_rows(structure, SENSORS)
    count = RIGID + MEASURED + SPARE
    with one_thread():
        model = reduce_structure(structure, modes=count, box=BOX, loads=loads)
    rows = readout(structure, model, SENSORS)
    kind, shapes = CASES[options.case]
    for seed in range(*options.seeds):
        line = line_of(model, rows, HypothesisKind(kind), shapes, seed)
        with RESULTS.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")


if __name__ == "__main__":
    main()
