# SPDX-License-Identifier: MIT
"""Count how often the chain finds the right link and the right name.

::

    python benchmarks/gap/chain_score.py --seed 700 --count 30 --out /tmp/chain.jsonl

Appends one JSON line for each chain, continues where it ended, and prints the counts:
of all chains, and of those whose effect has an expected margin of 50 or more at its own
link, with their 95 % Wilson intervals. After a right name every torque is predicted
from the others, and so are the modes at it (`chain_held`); at the contact the hits on
one body are predicted from those on the other.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np
from chain_cases import CONTACT, LUMPED, expected, make_case
from chain_held import modes_inside, torques_inside, unseen_point
from outcomes import NAMEABLE, share_text

from jointbench.analysis.gap.chain.chain_diagnosis import diagnose_chain
from jointbench.analysis.gap.chain.locate_link import Chain
from jointbench.analysis.gap.chain.lumped_structure import read_lumped


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


def judged(seed: int) -> dict[str, object]:
    """Make one chain, diagnose it, and return truth and answer."""
    link, effect = hidden_in(seed)
    case = make_case(seed, link, effect)
    start = time.process_time()
    structure = read_lumped(case.campaigns, link=1)
    found = diagnose_chain(Chain(case.surface, structure.reading, case.states))
    sets = []
    if found.several is not None:
        sets = [
            [c.name for c in found.several.causes],
            *map(list, found.several.rivals),
        ]
    row = {
        "seed": seed,
        "margin": expected(seed, link, effect) if link else 0.0,
        "link": link,
        "effect": effect,
        "finding": found.finding.value,
        "places": [[x.value for x in p.links] for p in found.location.places],
        "names": list(found.names),
        "sets": sets,
        "without": [t.passed for t in found.location.hypotheses[0].tests],
        "states": len(case.campaigns),
        "cpu_s": time.process_time() - start,
    }
    if link and outcome(row) == ("right", "right"):
        row["torques"] = torques_inside(found)
        row["modes"] = modes_inside(found, structure)
        if link == "contact":
            row["point"] = unseen_point(case)
    return row


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
    given = parser.parse_args()
    done = []
    if given.out.exists():
        done = [json.loads(x) for x in given.out.read_text().splitlines()]
    known = {row["seed"] for row in done}
    for seed in range(given.seed, given.seed + given.count):
        if seed not in known:
            done.append(judged(seed))
            with given.out.open("a") as file:
                file.write(json.dumps(done[-1]) + "\n")
    hidden = [row for row in done if row["link"]]
    print(f"nothing missing: {shares([r for r in done if not r['link']])}")
    print(f"one effect, all: {shares(hidden)}")
    strong = [row for row in hidden if row["margin"] >= NAMEABLE]
    print(f"one effect, margin >= {NAMEABLE:g}: {shares(strong)}")
    for effect in (*CONTACT, "scale_cut", *LUMPED):
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
