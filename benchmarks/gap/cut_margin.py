# SPDX-License-Identifier: MIT
"""How coarse must a surface instrument be for its cut-off to show in the hits?

::

    python benchmarks/gap/cut_margin.py --first 3000 --count 40

For the joints of `chain_score` the margin of a cut-off r times too long over the
contact law alone, both linearised: (ln r)^2 v' C^-1 v, where v is the change of ln k of
each state per ln r and C the covariance of the readings with all priors of the base.
That is the largest margin there can be: rivals and the prior of r itself only lower it.
"""

import argparse

import numpy as np
from chain_cases import as_read
from contact_campaigns import make_joint
from outcomes import NAMEABLE

from jointbench.analysis.gap.contact_bench.contact_bench import make_contact_bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL

RATIOS = (2.0, 4.0, 10.0, 100.0)


def unit_margin(seed: int) -> tuple[float, float]:
    """Return the margin per (ln r)^2, and the largest change of ln k per ln r."""
    joint = as_read(make_joint(seed, "scale_cut"))
    bench = make_contact_bench(joint.clean, joint.law)
    at = np.zeros(bench.base_sd.size)
    rows = bench.data.rows
    shift = bench.law.cut_shift(bench.nominal.log_preload)[rows.quantity, rows.state]
    known = bench.values.whitener @ shift
    spread = bench.slopes(at, (), FULL) * bench.base_sd
    covariance = np.eye(known.size) + spread @ spread.T
    return float(known @ np.linalg.solve(covariance, known)), float(np.abs(shift).max())


def main() -> None:
    """Print the margins of all joints."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--first", type=int, default=3000)
    parser.add_argument("--count", type=int, default=40)
    given = parser.parse_args()
    found = np.array(
        [unit_margin(s) for s in range(given.first, given.first + given.count)]
    )
    low, middle, high = np.quantile(found[:, 1], [0.0, 0.5, 1.0])
    print(f"change of ln k per ln r: {low:.3g} to {high:.3g}, median {middle:.3g}")
    for ratio in RATIOS:
        margin = found[:, 0] * np.log(ratio) ** 2
        strong = int(np.sum(margin >= NAMEABLE))
        print(
            f"{ratio:g} times too long: median margin {np.median(margin):.2g}, "
            f"largest {margin.max():.2g}, {strong} of {len(margin)} strong"
        )
    needed = np.exp(np.sqrt(NAMEABLE / found[:, 0].max()))
    print(f"a margin of {NAMEABLE:g} takes a ratio of {needed:.2g} or more")


if __name__ == "__main__":
    main()
