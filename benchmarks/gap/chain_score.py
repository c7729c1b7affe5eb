# SPDX-License-Identifier: MIT
"""Count how often the chain finds the right link and the right name.

::

    python benchmarks/gap/chain_score.py --seed 700 --count 30 --out /tmp/chain.jsonl
        [--strong] [--plates]

Appends one JSON line for each chain, continues where it ended, and prints the counts:
of all chains, and of those whose effect has an expected margin of 50 or more at its own
link, with their 95 % Wilson intervals. After a right name every torque is predicted
from the others, and so are the modes at it (`chain_held`); at the contact the hits on
one body are predicted from those on the other. ``--strong`` passes chains over whose
effect is weaker, or that lack nothing, and predicts nothing held out; ``--plates``
takes two meshed plates as the structure (`chain_plates`), read from a session file.
"""

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from chain_cases import CONTACT, LUMPED, expected, make_case, scaled_joint
from chain_held import modes_inside, torques_inside, unseen_point
from chain_plates import (
    PLATE_STATES,
    PLATES,
    draw_plates,
    expected_margin,
    full_modes,
    middle_stiffness,
    write_plates,
)
from outcomes import NAMEABLE, share_text

from jointbench.analysis.gap.chain.chain_diagnosis import (
    ChainDiagnosis,
    diagnose_chain,
)
from jointbench.analysis.gap.chain.locate_link import Chain
from jointbench.analysis.gap.chain.lumped_structure import read_lumped
from jointbench.station.chain.identified_chain import read_identified
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.structure_model import StructureModel


def hidden_in(seed: int) -> tuple[str, str]:
    """Return link and effect of a seed; links take turns, and effects at a link."""
    turn, number = seed % 6, seed // 6
    if turn == 5:
        return "", ""
    if turn == 4:
        return "surface", "scale_cut"
    at, effects = (2 * number + turn // 2), CONTACT if turn % 2 == 0 else LUMPED
    link = "contact" if turn % 2 == 0 else "structure"
    return link, effects[at % len(effects)]


def judged(seed: int, *, strong: bool) -> dict[str, object]:
    """Make one chain, diagnose it, and return truth and answer.

    Args:
        seed: of all draws.
        strong: whether chains with a weak effect or none are passed over.
    """
    link, effect = hidden_in(seed)
    margin = expected(seed, link, effect) if link else 0.0
    if strong and margin < NAMEABLE:
        return {"seed": seed, "link": link, "effect": effect, "margin": margin}
    case = make_case(seed, link, effect)
    start = time.process_time()
    structure = read_lumped(case.campaigns, link=1)
    found = diagnose_chain(Chain(case.surface, structure.reading, case.states))
    row = {"seed": seed, "link": link, "effect": effect, "margin": margin}
    row |= _answer(found)
    row |= {"states": len(case.campaigns), "cpu_s": time.process_time() - start}
    if link and not strong and outcome(row) == ("right", "right"):
        row["torques"] = torques_inside(found)
        row["modes"] = modes_inside(found, structure)
        if link == "contact":
            row["point"] = unseen_point(case)
    return row


def plates_hidden_in(seed: int) -> tuple[str, str]:
    """Return link and effect of a seed with plates; links take turns."""
    turn, number = seed % 8, seed // 8
    if turn == 7:
        return "", ""
    if turn % 2:
        return "structure", PLATES[(3 * number + turn // 2) % len(PLATES)]
    return "contact", CONTACT[(4 * number + turn // 2) % len(CONTACT)]


def judged_plates(seed: int, *, strong: bool) -> dict[str, object]:
    """Make one chain with plates, diagnose it, and return truth and answer.

    Args:
        seed: of all draws.
        strong: whether chains with a weak effect or none are passed over.
    """
    link, effect = plates_hidden_in(seed)
    plates = draw_plates(seed, effect if link == "structure" else "")
    own = effect if link == "contact" else ""
    joint = scaled_joint(seed, own, middle_stiffness(plates), PLATE_STATES)
    margin = 0.0
    if link == "contact":
        margin = expected(seed, link, effect, PLATE_STATES)
    row = {"seed": seed, "link": link, "effect": effect, "margin": margin}
    if strong and link != "structure" and margin < NAMEABLE:
        return row
    states = full_modes(plates, joint.stiffness)
    if link == "structure":
        row["margin"] = expected_margin(plates, joint.stiffness, states)
        if strong and row["margin"] < NAMEABLE:
            return row
    with TemporaryDirectory() as folder:
        rng = np.random.default_rng([seed, 33])
        preload = joint.states.preload
        session, model = write_plates(plates, preload, states, Path(folder), rng)
        table = read_toml(model, StructureModel).bolted_joint
        assert table is not None
        start = time.process_time()
        read = read_identified([session], model, table, None)
    kept = [int(np.argmin(np.abs(preload - p))) for p in read.states.preload]
    known = replace(
        joint.states, preload=preload[kept], assembly=joint.states.assembly[kept]
    )
    found = diagnose_chain(Chain(joint.surface, read.reading, known))
    return (
        row
        | _answer(found)
        | {"states": len(kept), "cpu_s": time.process_time() - start}
    )


def _answer(found: ChainDiagnosis) -> dict[str, object]:
    """Return what a diagnosis says."""
    sets = []
    if found.several is not None:
        own = [c.name for c in found.several.causes]
        sets = [own, *map(list, found.several.rivals)]
    return {
        "finding": found.finding.value,
        "places": [[x.value for x in p.links] for p in found.location.places],
        "names": list(found.names),
        "sets": sets,
        "without": [t.passed for t in found.location.hypotheses[0].tests],
    }


def outcome(row: dict) -> tuple[str, str]:
    """Return how link and name of a chain are judged: right, ambiguous, open, wrong."""
    wanted = [row["link"]] if row["link"] else []
    places = row["places"]
    if not places:
        return "open", "open"
    link = "right" if places[0] == wanted and len(places) == 1 else "wrong"
    if link == "wrong" and wanted in places:
        link = "ambiguous"
    if link == "wrong" and not places[0]:
        link = "open"
    if link != "right" or not wanted:
        return link, link
    names = {name.partition("@")[0] for name in row["names"]}
    if row["finding"] == "named":
        return link, "right" if names == {row["effect"]} else "wrong"
    if row["finding"] == "ambiguous":
        sets = row["sets"] if row["link"] == "contact" else [[n] for n in names]
        held = any(row["effect"] in one for one in sets)
        return link, "ambiguous" if held else "wrong"
    return link, "open"


def main() -> None:
    """Diagnose the chains that are missing, and print the counts."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--strong", action="store_true")
    parser.add_argument("--plates", action="store_true")
    given = parser.parse_args()
    judge = judged_plates if given.plates else judged
    done = []
    if given.out.exists():
        done = [json.loads(x) for x in given.out.read_text().splitlines()]
    known = {row["seed"] for row in done}
    for seed in range(given.seed, given.seed + given.count):
        if seed not in known:
            done.append(judge(seed, strong=given.strong))
            with given.out.open("a") as file:
                file.write(json.dumps(done[-1]) + "\n")
    done = [row for row in done if "finding" in row]
    hidden = [row for row in done if row["link"]]
    print(f"nothing missing: {shares([r for r in done if not r['link']])}")
    print(f"one effect, all: {shares(hidden)}")
    strong = [row for row in hidden if row["margin"] >= NAMEABLE]
    print(f"one effect, margin >= {NAMEABLE:g}: {shares(strong)}")
    for effect in (*CONTACT, "scale_cut", *LUMPED, *PLATES[:1]):
        print(f"  {effect}: {shares([r for r in strong if r['effect'] == effect])}")
    named = [row for row in strong if "torques" in row]
    for what in ("torques", "modes"):
        inside, count = (sum(row[what][k] for row in named) for k in (0, 1))
        if count:
            print(f"{what} within 95 % after a right name: {share_text(inside, count)}")
    points = np.array([row["point"] for row in named if row.get("point")])
    if points.size:
        before, after = np.median(points, axis=0)
        words = f"{before:.2g} by the law alone, {after:.2g} with what was named"
        print(f"hits on the other body, residual over response: {words}")
        print(f"  (medians of {len(points)})")
    seconds = [row["cpu_s"] for row in done]
    print(f"CPU s of a diagnosis: median {np.median(seconds):.1f}, {max(seconds):.1f}")


def shares(rows: list[dict]) -> str:
    """Return how many links and names are right, ambiguous and wrong, in words."""
    if not rows:
        return "none"
    pairs = [outcome(row) for row in rows]
    words = []
    for at, what in enumerate(("link", "name")):
        for word in ("right", "ambiguous", "wrong"):
            count = sum(pair[at] == word for pair in pairs)
            words.append(f"{what} {word} {share_text(count, len(rows))}")
    return "; ".join(words)


if __name__ == "__main__":
    main()
