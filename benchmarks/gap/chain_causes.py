# SPDX-License-Identifier: MIT
"""Factors of the causes at the joint of `jointbench demo --chain`, on several seeds.

::

    python benchmarks/gap/chain_causes.py RUNS.jsonl --first 900 --count 6 --rms 0.6
    python benchmarks/gap/chain_causes.py RUNS.jsonl --first 920 --count 4 --rms 1.5
    python benchmarks/gap/chain_causes.py RUNS.jsonl --page docs/gap-chain-causes.md

Surfaces, joint and surface instrument are those of the demo; the joint's stiffness is
given to the diagnosis as the hits of the demo give it (sd 0.1 %), without striking.
Appends one JSON line for each joint and continues where it ended.
"""

import argparse
import json
import subprocess
import time
import tomllib
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.analysis.gap.chain.chain_diagnosis import diagnose_chain
from jointbench.analysis.gap.chain.chain_records import (
    JointReading,
    LinkTest,
    StructureReading,
    SurfaceReading,
)
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.chain.locate_link import Chain
from jointbench.simulators.campaigns.joint_campaign import (
    FACE_SPACING,
    TORQUES,
    TightenedJoint,
    nominal_preload,
    pressed_joint,
)
from jointbench.simulators.rough_surfaces.profilometer import (
    Profilometer,
    measure_areal,
)
from jointbench.station.chain.surface_reading import surface_law
from jointbench.station.joint_states.joint_state_files import joint_facts
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable
from jointbench.station.sources.campaign_model import joint_table

_NOISE = 2e-9
_READING_SD = 1e-3
_LIMIT = 2.0


def measured_chain(seed: int, rms: float) -> tuple[TightenedJoint, Chain]:
    """Return a joint and its chain as the demo measures it."""
    made = pressed_joint(seed, np.random.default_rng([seed, 43]), rms)
    surfaces = [
        measure_areal(
            Areal(name, heights, (FACE_SPACING, FACE_SPACING), all_valid(heights)),
            Profilometer(noise=_NOISE),
            seed=2 * seed + k,
        )
        for k, (name, heights) in enumerate(zip("ab", made.heights, strict=True))
    ]
    table = BoltedLinkTable.model_validate(
        tomllib.loads(joint_table(made.surfaces))["bolted_joint"]
    )
    count = len(TORQUES)
    preload = np.array([nominal_preload(one) for one in TORQUES])
    states = BoltedStates(
        f"blocks-{seed}",
        joint_facts(table, table),
        preload,
        np.zeros(count, dtype=np.int64),
    )
    rng = np.random.default_rng([seed, 44])
    read = np.log(made.scattered) + _READING_SD * rng.standard_normal(count)
    good = LinkTest(1.0, 1, passed=True)
    reading = JointReading(read, np.eye(count) * _READING_SD**2, good)
    law = surface_law(surfaces, table, states)
    return made, Chain(SurfaceReading(law, good), StructureReading(reading), states)


def judged(seed: int, rms: float) -> dict[str, object]:
    """Make one joint, diagnose it, and return truth and answer."""
    made, chain = measured_chain(seed, rms)
    start = time.process_time()
    found = diagnose_chain(chain)
    several = found.several
    row: dict[str, object] = {
        "seed": seed,
        "rms": rms,
        "finding": found.finding.value,
        "links": [link.value for link in found.links],
        "cpu_s": time.process_time() - start,
    }
    if several is None:
        return row
    one = made.stiffness[several.reference]
    law = float(np.exp(chain.reading.log_stiffness[several.reference]))
    law /= several.measured
    causes = (*several.causes, *several.known)
    return row | {
        "causes": [[c.name, c.factor, c.low, c.high] for c in causes],
        "sets": 1 + len(several.rivals),
        "product": [several.product.factor, several.product.low, several.product.high],
        "ratio": several.measured,
        "roughness": one.rough / law,
        "truth": one.factors,
        "inside": [bool(x) for x in several.held.inside],
    }


def page(rows: list[dict]) -> str:
    """Return the page."""
    done = [row for row in rows if "ratio" in row]
    off = [row["product"][0] / row["ratio"] for row in done]
    within = sum(1 / _LIMIT <= x <= _LIMIT for x in off)
    covered = sum(r["product"][1] <= r["ratio"] <= r["product"][2] for r in done)
    held = [x for row in done for x in row["inside"]]
    placed = sum(row["links"] == ["contact"] for row in rows)
    commit = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], capture_output=True, check=True
    ).stdout.decode()
    lines = [
        "# Do the causes at a joint account for it?",
        "",
        f"Made by `python benchmarks/gap/chain_causes.py` (engine {commit.strip()}) "
        f"from {len(rows)} joints of `jointbench demo --chain`. Surfaces, joint and "
        "surface instrument are those of the demo; the joint's stiffness is given as "
        "its hits give it (sd 0.1 %). The law is that of the measured maps. Rms height "
        "of each surface: 0.6 µm as in the demo, or rougher.",
        "",
        f"The product of the factors is within {_LIMIT:g} of the ratio between joint "
        f"and law in **{within} of {len(rows)}**; the 95 % interval of the product "
        f"holds the ratio in {covered}. Torques predicted from the others: "
        f"{sum(held)} of {len(held)} within their 95 % interval. The contact law is "
        f"the place in {placed}.",
        "",
        "| seed | rms [µm] | causes: factor (95 %) | product (95 %) | joint over law "
        "| product over ratio | sets | verdict |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row, x in zip(done, off, strict=True):
        words = "; ".join(
            f"{n.replace('_', ' ')} {f:.3g} ({a:.3g} to {b:.3g})"
            for n, f, a, b in row["causes"]
        )
        f, a, b = row["product"]
        lines.append(
            f"| {row['seed']} | {row['rms'] * 1e6:g} | {words} | {f:.3g} ({a:.3g} to "
            f"{b:.3g}) | {row['ratio']:.3g} | {x:.2f} | {row['sets']} "
            f"| {row['finding']} |"
        )
    lines += [
        "",
        "What the joints are made of (factors at the same torque; the first is the "
        "roughness by boundary elements over the law, with the true nut factor). Here "
        "the bodies come before the waves; above, waves that no map shows act on the "
        "contact first, so that the bodies soften a contact that is softer already: "
        "single factors do not compare, their product does. The last column is the "
        "product above over that of pressure, bodies, waves and bolts here.",
        "",
        "| seed | rms [µm] | roughness | bolt pressure | bodies | waviness | bolts "
        "| stated over true |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in done:
        true = list(row["truth"].values())
        values = [row["roughness"], *true, row["product"][0] / np.prod(true)]
        cells = " | ".join(f"{v:.3g}" for v in values)
        lines.append(f"| {row['seed']} | {row['rms'] * 1e6:g} | {cells} |")
    return "\n".join([*lines, ""])


def main() -> None:
    """Diagnose the joints that are missing, or write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("runs", type=Path)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--rms", type=float, default=0.6, help="[µm]")
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    done = []
    if given.runs.exists():
        done = [json.loads(x) for x in given.runs.read_text().splitlines()]
    known = {(row["seed"], row["rms"]) for row in done}
    rms = given.rms * 1e-6
    for seed in range(given.first, given.first + given.count):
        if (seed, rms) not in known:
            done.append(judged(seed, rms))
            with given.runs.open("a") as file:
                file.write(json.dumps(done[-1]) + "\n")
    if given.page is not None:
        given.page.write_text(page(done), encoding="utf-8")


if __name__ == "__main__":
    main()
