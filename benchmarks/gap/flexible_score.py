# SPDX-License-Identifier: MIT
"""Examine campaigns on flexible bodies and compare each verdict with its truth.

Usage: python benchmarks/gap/flexible_score.py FOLDER RUNS.jsonl [--take-out]

FOLDER is filled by flexible_campaigns.py. Every campaign goes through the command, in a
process of its own; its verdict is appended to RUNS.jsonl, and campaigns that are there
already are skipped. The table of all runs is printed at the end. With --take-out the
hidden effects are left out of the catalogue.
"""

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from outcomes import share_text

NEAR = 2e-3
"""Distance at which two names are the same place [m]."""
_MOST_SECONDS = 600
"""CPU time after which a campaign counts as not finished [s]."""
_FAMILIES = (
    {"microslip", "macroslip", "damping_law"},
    {"clearance", "cubic", "quadratic"},
    {"joint_compliance_normal", "joint_compliance_rocking", "contact_patch"},
    {"loose_bolt", "contact_patch"},
    {"preload_stiffness", "preload_damping"},
    {"added_mass", "hidden_mode", "rattling_mass"},
    {"added_stiffness", "support", "foot_stop"},
    {"gain_error", "polarity", "wrong_direction", "cross_axis", "wrong_position"},
    {"delay", "cable_resonance"},
)
"""Effects that hits hardly distinguish; another name of the family is `family`."""
Json = dict[str, Any]
_KEPT = (
    *("verdict", "reason", "effects", "closest", "gap_before", "gap_after"),
    *("base", "remarks", "explanations"),
)
"""Keys of the verdict that are kept."""


def examined(folder: Path, take_out: Sequence[str]) -> Json:
    """Return the verdict of the command on one campaign, with CPU time and memory.

    Args:
        folder: of the campaign.
        take_out: effects to leave out of the catalogue.
    """
    out = folder / "verdict.json"
    command = [sys.executable, "-m", "jointbench", "gap", str(folder / "hits.h5")]
    command += ["--json", str(out)]
    if take_out:
        command += ["--without", ",".join(take_out)]
    out.unlink(missing_ok=True)
    with tempfile.TemporaryFile() as words:
        running = subprocess.Popen(
            command, stdout=words, stderr=subprocess.STDOUT, preexec_fn=_limited
        )
        _, status, used = os.wait4(running.pid, 0)
        running.returncode = os.waitstatus_to_exitcode(status)
        words.seek(0)
        reason = words.read().decode(errors="replace")[-300:]
    if running.returncode == -signal.SIGXCPU:
        reason = f"more than {_MOST_SECONDS} CPU s"
    found: Json = {"verdict": "crash", "reason": reason, "effects": []}
    if out.exists():
        found = json.loads(out.read_text(encoding="utf-8"))
    return {key: found.get(key) for key in _KEPT} | {
        "cpu_s": round(used.ru_utime + used.ru_stime, 1),
        "memory_mb": round(used.ru_maxrss / 1024),
    }


def _limited() -> None:
    """Limit the CPU time of the process that will run: others may load the machine."""
    resource.setrlimit(resource.RLIMIT_CPU, (_MOST_SECONDS, _MOST_SECONDS + 10))


def places_of(folder: Path) -> Mapping[str, Sequence[float]]:
    """Return the positions of sensors and hammer points by name [m]."""
    nominal = json.loads((folder / "sheet.json").read_text(encoding="utf-8"))
    entries = nominal["hammer_points"] | {s["name"]: s for s in nominal["sensors"]}
    return {
        name: [1e-3 * value for value in entry["position_mm"]]
        for name, entry in entries.items()
    }


def place_right(
    where: Json, site: str, places: Mapping[str, Sequence[float]]
) -> bool | None:
    """Return whether a site is that of the truth; None where there is nothing to find.

    Args:
        where: of the truth.
        site: as named, for example ``bolt:2``.
        places: positions by name.
    """
    kind, _, name = site.removesuffix(" normal").partition(":")
    if "bolt" in where:
        return None if where["bolt"] == "all" else site == f"bolt:{where['bolt']}"
    for key, word in (("foot", "foot"), ("body", "body"), ("axis", "joint")):
        if key in where and "xyz_mm" not in where:
            return site == f"{word}:{where[key]}"
    own = where.get("point", where.get("channel"))
    if own is None:
        return None
    if kind == "channel" or name not in places:
        return bool(name == own)
    return bool(np.linalg.norm(np.subtract(places[name], places[own])) < NEAR)


def word_for(run: Json) -> str:
    """Return the score of a verdict: right, family, wrong, unknown, none or crash."""
    found, truth = run["found"], set(run["names"])
    if found["verdict"] in {"crash", "unknown", "none"}:
        return "right" if found["verdict"] == run["wanted"] else found["verdict"]
    named = {str(effect["name"]) for effect in found["effects"] or ()}
    if run["wanted"] == "named" and named == truth:
        return "right"
    if run["wanted"] == "named" and named and named < truth:
        return "one of two"
    alike = all(any({t, n} <= f for f in _FAMILIES) for t in truth for n in named)
    if truth and named and alike:
        return "family"
    return "wrong" if found["verdict"] == "named" else str(found["verdict"])


def run_one(folder: Path, *, take_out: bool) -> Json:
    """Return truth and verdict of one campaign."""
    truth: Json = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    names = list(truth["effects"])
    found = examined(folder, names if take_out else ())
    hidden = take_out or truth["truth"] == ["unknown"]
    wanted = "none" if not names else "unknown" if hidden else "named"
    run = {
        "name": folder.name,
        "world": truth["world"],
        "names": names,
        "where": truth["where"],
        "margins": {k: v["margin"] for k, v in truth["margins"].items()},
        "wanted": wanted,
        "found": found,
    }
    run["word"] = word_for(run)
    sites = {e["name"]: e["site"] for e in found["effects"] or ()}
    places = places_of(folder)
    run["places"] = {
        name: place_right(truth["where"][name], sites[name], places)
        for name in names
        if name in sites
    }
    return run


def score_table(runs: Sequence[Json]) -> str:
    """Return the scores by world and kind as a table."""
    sets: dict[tuple[str, str], list[Json]] = {}
    for run in runs:
        sets.setdefault((run["world"], run["wanted"]), []).append(run)
    lines = ["| table | wanted | right | wrong | place right | others | CPU s |"]
    lines.append("|---|---|---|---|---|---|---|")
    for (world, wanted), own in sorted(sets.items()):
        words = Counter(run["word"] for run in own)
        found = [p for r in own for p in r["places"].values() if p is not None]
        rest = ", ".join(
            f"{word} {n}" for word, n in words.items() if word not in {"right", "wrong"}
        )
        lines.append(
            f"| {world} | {wanted} | {share_text(words['right'], len(own))} | "
            f"{share_text(words['wrong'], len(own))} | "
            f"{share_text(sum(found), len(found))} | {rest or '-'} | "
            f"{np.median([r['found']['cpu_s'] for r in own]):.0f} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Examine the campaigns that are not yet in the file, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--take-out", action="store_true")
    arguments = parser.parse_args()
    runs: list[Json] = []
    if arguments.runs.exists():
        lines = arguments.runs.read_text(encoding="utf-8").splitlines()
        runs = [json.loads(line) for line in lines]
    done = {run["name"] for run in runs}
    for path in sorted(arguments.folder.glob("*/truth.json")):
        if path.parent.name in done:
            continue
        run = run_one(path.parent, take_out=arguments.take_out)
        runs.append(run)
        with arguments.runs.open("a", encoding="utf-8") as out:
            out.write(json.dumps(run) + "\n")
        print(run["name"], run["word"], run["found"]["effects"], flush=True)
    print(score_table(runs))


if __name__ == "__main__":
    main()
