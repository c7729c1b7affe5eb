# SPDX-License-Identifier: MIT
"""Count how often the next assembly lies in its interval, and changes that are seen.

    python benchmarks/contact/reassembly.py RUNS.jsonl --first 40000 --count 1000
    python benchmarks/contact/reassembly.py RUNS.jsonl --page PAGE.md

The joints are made by what the product does not assume: stiffness from a saturating law
in series with the bodies, assemblies that scatter in several ways (log-normal; heavy
tails; one in four on other spots; by an exponent that differs too), nut factors from
a gamma distribution for each tightening, measurement errors up to a third larger than
stated. Nominal scatters are wrong by up to a factor of two.
"""

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)
from jointbench.analysis.gap.reassembly.changed_joint import compare_assemblies

Run = dict[str, Any]
WAYS = ("log-normal", "heavy tails", "two kinds", "exponent too")
"""How assemblies scatter."""
CHANGES = ("none", "x 0.5", "x 2", "exponent")
_T_FREEDOM = 4
_SPOTS = 0.25
"""Share of the assemblies that rest on other spots."""


class Joint:
    """A joint whose assemblies and tightenings are drawn one after the other."""

    def __init__(self, seed: int) -> None:
        """Draw the joint; `seed` gives all of it."""
        self.random = random = np.random.default_rng(seed)
        self.way = WAYS[seed % len(WAYS)]
        self.between = random.uniform(0.05, 0.3)
        self.within = random.uniform(0.02, 0.1)
        count = int(random.integers(3, 6))
        self.torque = np.geomspace(5.0, 5.0 * random.uniform(3.0, 12.0), count)
        self.exponent = random.uniform(0.4, 1.0)
        self.series = random.uniform(0.0, 1.0)
        self.measured = random.uniform(0.01, 0.05)
        self.worse = random.uniform(1.0, 1.33)

    def assembly(self, factor: float = 1.0, exponent: float = 0.0) -> FloatArray:
        """Return ln k at each torque of a new assembly, without measurement error."""
        offset, other = self._offset()
        shape = 1.0 / self.within**2
        preload = self.torque * self.random.gamma(shape, 1.0 / shape, self.torque.size)
        power = self.exponent * (1.0 + other) + exponent
        scaled = preload / self.torque[0]
        contact = 1e8 * np.exp(offset) * factor * scaled**power
        found: FloatArray = -np.log(1.0 / contact + self.series / 5e8)
        return found

    def _offset(self) -> tuple[float, float]:
        random, between = self.random, self.between
        if self.way == "heavy tails":
            spread = np.sqrt(_T_FREEDOM / (_T_FREEDOM - 2.0))
            return between / spread * float(random.standard_t(_T_FREEDOM)), 0.0
        if self.way == "two kinds":
            # Mean 0 and the same sd: one in four lies three times as far.
            step = between / np.sqrt(_SPOTS * (1.0 - _SPOTS))
            other = float(random.random() < _SPOTS)
            return step * (other - _SPOTS), 0.0
        if self.way == "exponent too":
            return between * float(random.normal()), 0.05 * float(random.normal())
        return between * float(random.normal()), 0.0

    def measure(self, value: FloatArray) -> FloatArray:
        """Return values with measurement errors."""
        sd = self.measured * self.worse
        found: FloatArray = value + sd * self.random.normal(size=value.size)
        return found


def joint_data(joint: Joint, values: Sequence[FloatArray]) -> JointData:
    """Return assemblies as the product reads them.

    Args:
        joint: that was measured.
        values: ln k at each torque, one array an assembly.
    """
    size = joint.torque.size
    count = len(values) * size
    none = np.full(count, np.nan)
    wrong = joint.random.uniform(0.5, 2.0, 2)
    facts = JointFacts(
        4,
        0.01,
        0.2,
        0.15,
        float(joint.within * joint.exponent * wrong[0]),
        float(joint.between * wrong[1]),
        0.01,
        2e11,
        0.3,
    )
    states = JointStates(
        torque=np.tile(joint.torque, len(values)),
        preload=none,
        preload_sd=none,
        assembly=np.repeat(np.arange(len(values)), size),
        falling=np.zeros(count, dtype=np.bool_),
        time=none,
        shear=none,
        frequency=none,
    )
    rows = JointRows(
        np.arange(count),
        np.full(count, QUANTITIES.index(ContactQuantity.NORMAL)),
        np.concatenate([joint.measure(one) for one in values]),
        np.diag(np.full(count, joint.measured**2)),
        np.zeros(count, dtype=np.bool_),
    )
    return JointData("joint", facts, states, rows)


def judged(seed: int) -> Run:
    """Make one joint, compare its assemblies, and return truth and answer."""
    joint = Joint(seed)
    count = int(joint.random.integers(2, 9))
    change = CHANGES[(seed // len(WAYS)) % len(CHANGES)]
    values = [joint.assembly() for _ in range(count - 1)]
    last: dict[str, Callable[[], FloatArray]] = {
        "none": joint.assembly,
        "x 0.5": lambda: joint.assembly(0.5),
        "x 2": lambda: joint.assembly(2.0),
        "exponent": lambda: joint.assembly(1.0, 0.3),
    }
    data = joint_data(joint, [*values, last[change]()])
    found = compare_assemblies(data).quantities[ContactQuantity.NORMAL]
    covered = []
    if change == "none":
        truth = np.exp(joint.assembly())
        _, low, high = found.next_assembly
        covered = ((low <= truth) & (truth <= high)).tolist()
    _, low, high = found.next_assembly
    return {
        "seed": seed,
        "way": joint.way,
        "assemblies": count,
        "between": joint.between,
        "change": change,
        "verdict": found.latest.change.value,
        "ratio": found.latest.ratio,
        "covered": covered,
        "width": float(np.median(np.log(high / low)) / (2 * 1.96)),
        "true_sd": float(np.hypot(joint.between, joint.within * joint.exponent)),
    }


def wilson(count: int, total: int) -> str:
    """Return a share with its 95 % interval by Wilson's formula."""
    if not total:
        return "none"
    low, high = binomtest(count, total).proportion_ci(method="wilson")
    ends = f"({100 * low:.1f} to {100 * high:.1f})"
    return f"{count} of {total} = {100 * count / total:.1f} % {ends}"


def page(runs: Sequence[Run]) -> str:
    """Return the page of counts."""
    lines = [
        "# Assemblies of a joint: counts",
        "`python benchmarks/contact/reassembly.py RUNS.jsonl --count 1000`, then "
        "`--page docs/joint-reassembly-numbers.md`.",
        "",
        f"{len(runs)} simulated joints of 2 to 8 assemblies at 3 to 5 torques, seeds "
        f"{min(r['seed'] for r in runs)} to {max(r['seed'] for r in runs)}. The "
        "simulations share no law, no distribution and no nominal value with the "
        "product: see the head of the script. In brackets are 95 % intervals by "
        "Wilson's formula.",
        "",
        "## The next assembly lies in its 95 % interval",
        "Levels of one joint fall in or out together; the share of joints counts.",
        "",
        "| assemblies scatter | assemblies measured | levels in | all levels of the "
        "joint in | width over that of the true scatter, median |",
        "|---|---|---|---|---|",
    ]
    for way in (*WAYS, "all"):
        for least, most in ((2, 3), (4, 8), (2, 8)):
            own = [
                r
                for r in runs
                if r["covered"]
                and way in (r["way"], "all")
                and least <= r["assemblies"] <= most
            ]
            levels = [x for r in own for x in r["covered"]]
            whole = [all(r["covered"]) for r in own]
            ratio = np.median([r["width"] / r["true_sd"] for r in own] or [np.nan])
            lines.append(
                f"| {way} | {least} to {most} | {wilson(sum(levels), len(levels))} | "
                f"{wilson(sum(whole), len(whole))} | {ratio:.2f} |"
            )
    lines += [
        "",
        "## Has the joint changed?",
        "",
        "| the latest assembly | changed | within its scatter | cannot be determined |",
        "|---|---|---|---|",
    ]
    for change in CHANGES:
        own = [r for r in runs if r["change"] == change]
        cells = [
            wilson(sum(r["verdict"] == word for r in own), len(own))
            for word in ("changed", "within its scatter", "cannot be determined")
        ]
        lines.append(f"| {change} | {' | '.join(cells)} |")
    close = [r for r in runs if r["change"] != "none" and r["true_sd"] < 0.15]
    seen = sum(r["verdict"] == "changed" for r in close)
    lines += [
        "",
        "Changes where the true scatter is below 15 %: seen in "
        f"{wilson(seen, len(close))}.",
    ]
    return "\n".join([*lines, ""])


def main() -> None:
    """Collect what is not in the file yet, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--first", type=int, default=40000)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--page", type=Path)
    arguments = parser.parse_args()
    path: Path = arguments.runs
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    runs = [json.loads(line) for line in lines]
    if arguments.page:
        arguments.page.write_text(page(runs), encoding="utf-8")
        return
    done = {r["seed"] for r in runs}
    with path.open("a", encoding="utf-8") as out:
        for seed in range(arguments.first, arguments.first + arguments.count):
            if seed not in done:
                out.write(json.dumps(judged(seed)) + "\n")


if __name__ == "__main__":
    main()
