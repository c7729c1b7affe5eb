# SPDX-License-Identifier: MIT
"""Write docs/gap-structures-score.md from the runs of flexible_rows.py.

Usage: python benchmarks/gap/flexible_page.py RUNS.jsonl [...] [--out PAGE.md]
    [--note TEXT]

Runs with uncertain tables have a page of their own, docs/gap-structures-life.md, made
from benchmarks/gap/flexible_life.jsonl.
"""

import argparse
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from flexible_estimates import base_pairs, effect_pairs, loop_error
from flexible_rows import Json, counted
from outcomes import share_text

PAGE = Path(__file__).parents[2] / "docs" / "gap-structures-score.md"
FRICTION = ("microslip", "macroslip")
"""Effects that may be counted apart."""
_ONE_CALL = 30
"""Largest distance of seeds of one call: some are skipped."""
_LOOP = 0.15
"""Largest error of a loop that counts as right [-]."""
_BARS = {
    "null-exact": "none >= 97 %, a name <= 1 %, n >= 60",
    "single-exact": "right >= 90 %, wrong <= 2 %, place >= 93 %, n >= 120",
    "null-life": "none >= 95 %, a name <= 2 %, n >= 60",
    "single-life": "right or family >= 80 %, wrong <= 4 %, place >= 85 %, n >= 80",
    "hidden-exact": "unknown or family >= 88 %, a wrong name <= 5 %, n >= 40",
    "hidden-life": "unknown or family >= 88 %, a wrong name <= 7 %, n >= 40",
    "pair-exact": "both >= 60 %, wrong <= 5 %, n >= 40",
}
_SHRINK = {"exact": ">= 85 %", "life": ">= 60 %"}
_HEAD = """# {title}

Made by `benchmarks/gap/flexible_page.py` on {date} from {count} diagnoses by the
command. The simulated benches ([flexible-benches.md](flexible-benches.md)) differ from
the model in discretisation and integrator, and in everything the nominal values leave
open; their friction is drawn among three laws
([0481](decisions/0481-friction-of-simulated-bolts-is-drawn-among-laws.md)), of which
that of Bouc and Wen is none of the model's
([0496](decisions/0496-strengths-of-sliders-have-an-end-or-a-tail.md)). Effects have a
margin of 50 or more. Shares have 95 % Wilson intervals; seeds of a row are those
stated, but for those whose effect is counted apart: {apart}.

## Verdicts

| row | bar | right | right or family | a wrong name | one of two | ambiguous | \
unknown | none | place right | seeds |
|---|---|---|---|---|---|---|---|---|---|---|
"""
_VERDICTS = "## Verdicts\n"
_TITLE = "The gap on bolted bodies: how often the verdict is right"
_LIFE = f"{_TITLE}, with uncertain modal tables"
_ROW_WORDS = """
`null`: nothing missing. `single`: one effect, each of the catalogue in turn.
`hidden`: the true effect is taken out of the catalogue; right is `unknown`. `pair`: two
effects.
`exact`: the modal table lists the modes of the bodies; `life`: frequencies off by 0.2
to 1 %, shapes by 2 %. `family`: an effect that hits hardly distinguish from the true
one. `crash`: an internal error, or more than 600 CPU s.
"""


def _share(runs: Sequence[Json], *words: str) -> str:
    hits = sum(run["word"] in words for run in runs)
    return share_text(hits, len(runs))


def _count(runs: Sequence[Json], word: str) -> str:
    return str(sum(run["word"] == word for run in runs))


def _ambiguous(runs: Sequence[Json]) -> str:
    """Return how many verdicts leave several effects, and in how many the true one."""
    own = [run for run in runs if run["word"] == "ambiguous"]
    true = sum(
        any(effect["name"] in run["names"] for effect in run["found"]["effects"])
        for run in own
    )
    return f"{len(own)}, {true} with the true one" if own else "0"


def _seeds(runs: Sequence[Json]) -> str:
    """Return the ranges of seeds, those of one call being near each other."""
    seeds = sorted(int(run["seed"]) for run in runs)
    starts = [s for k, s in enumerate(seeds) if not k or s - seeds[k - 1] > _ONE_CALL]
    ends = [max(s for s in seeds if s < n) for n in starts[1:]] + seeds[-1:]
    return ", ".join(f"{a} to {b}" for a, b in zip(starts, ends, strict=True))


def verdict_rows(runs: Sequence[Json]) -> Iterable[str]:
    """Yield a line of the table of verdicts for each row that has runs."""
    for row, bar in _BARS.items():
        own = [run for run in runs if run["row"] == row]
        if not own:
            continue
        right = [run for run in own if run["word"] in {"right", "family"}]
        places = [p for run in right for p in run["places"].values() if p is not None]
        cells = [row, bar, _share(own, "right"), _share(own, "right", "family")]
        cells.append(_share(own, "wrong"))
        cells += [_count(own, "one of two"), _ambiguous(own)]
        cells += [
            str(sum(run["found"]["verdict"] == word for run in own))
            for word in ("unknown", "none")
        ]
        cells += [share_text(sum(places), len(places)), _seeds(own)]
        yield f"| {' | '.join(cells)} |"


def apart(runs: Sequence[Json]) -> str:
    """Return the friction that no campaign has, in words."""
    had = {name for run in runs for name in run["names"]}
    return " and ".join(f"`{name}`" for name in FRICTION if name not in had) or "none"


def worlds_of(runs: Sequence[Json]) -> list[str]:
    """Return the kinds of modal tables of the runs."""
    return sorted({run["world"] for run in runs})


def effect_rows(runs: Sequence[Json]) -> Iterable[str]:
    """Yield a line for each effect: how often it was right among single ones."""
    singles = [run for run in runs if run["row"].startswith("single")]
    for name in sorted({run["names"][0] for run in singles}):
        cells = [name]
        for world in worlds_of(runs):
            own = [r for r in singles if r["names"] == [name] and r["world"] == world]
            words = ", ".join(run["word"] for run in own) or "-"
            cells.append(words)
        yield f"| {' | '.join(cells)} |"


def misses(runs: Sequence[Json]) -> Iterable[str]:
    """Yield a line for each verdict that is not right, with the reason it states."""
    for run in runs:
        if run["word"] == "right":
            continue
        margins = ", ".join(f"{value:.0e}" for value in run["margins"].values())
        hidden = ", ".join(run["names"]) or "nothing"
        cells = [run["row"], str(run["seed"]), run["truth"]["kind"], hidden]
        cells += [margins or "-", run["found"]["verdict"], run["found"]["reason"]]
        yield f"| {' | '.join(cells)} |"


def bad_hits(runs: Sequence[Json]) -> tuple[str, str]:
    """Return the shares of bad hits that were found and of good ones left out."""
    found = wanted = dropped = 0
    for run in runs:
        bad = set(run["truth"]["bad_hits"])
        lines = [r for r in run["found"]["remarks"] or () if r.startswith("left out ")]
        left = {line.removeprefix("left out ").partition(":")[0] for line in lines}
        found, wanted = found + len(left & bad), wanted + len(bad)
        dropped += len(left - bad)
    return share_text(found, wanted), f"{dropped}"


def coverage(runs: Sequence[Json]) -> dict[str, str]:
    """Return the shares of estimates within 2 sd of the truth where it was right.

    Fits that are refused, because nothing explains the hits, are pooled apart.
    """
    world = min(worlds_of(runs))
    right = [r for r in runs if r["word"] == "right" and r["world"] == world]
    refused = [r for r in right if r["found"]["verdict"] == "unknown"]
    right = [r for r in right if r["found"]["verdict"] != "unknown"]
    named = [r for r in right if r["found"]["effects"]]
    sets = {
        "refused": [p for run in refused for p in base_pairs(run)],
        "base": [p for run in right for p in base_pairs(run)],
        "effects": [p for run in named for p in effect_pairs(run)],
    }
    sets["pooled"] = [*sets["base"], *sets["effects"]]
    return {
        name: share_text(
            sum(abs(value - true) <= 2 * sd for _, value, sd, true in pairs), len(pairs)
        )
        for name, pairs in sets.items()
    }


def loops(runs: Sequence[Json]) -> str:
    """Return the share of right laws at one bolt whose loops are within 15 %."""
    row = f"single-{min(worlds_of(runs))}"
    right = [run for run in runs if run["row"] == row and run["word"] == "right"]
    named = [run for run in right if len(run["found"]["effects"]) == 1]
    errors = [loop_error(run) for run in named]
    known = [error for error in errors if error is not None]
    return share_text(sum(error < _LOOP for error in known), len(known))


def shrink(runs: Sequence[Json], world: str) -> str:
    """Return the median shrink of the held-out gap where an effect was named."""
    found = [
        1.0 - run["found"]["gap_after"] / run["found"]["gap_before"]
        for run in runs
        if run["row"] == f"single-{world}" and run["found"]["gap_before"]
        if run["found"]["verdict"] != "crash"
    ]
    return f"{100 * np.median(found):.1f} % (n = {len(found)})" if found else "-"


def page(runs: Sequence[Json]) -> str:
    """Return the page."""
    date = datetime.now(tz=UTC).strftime("%Y-%m-%d")
    times = [run["found"]["cpu_s"] for run in runs]
    memory = [run["found"]["memory_mb"] for run in runs]
    found, dropped = bad_hits(runs)
    worlds = worlds_of(runs)
    cover = coverage(runs)
    lines = [
        _HEAD.format(
            title=_LIFE if worlds == ["life"] else _TITLE,
            date=date,
            count=len(runs),
            apart=apart(runs),
        )
        + "\n".join(verdict_rows(runs)),
        _ROW_WORDS,
        "## Further figures\n\n| figure | bar | seen |\n|---|---|---|",
        f"| bad hits found | >= 97 % | {found} |",
        f"| good hits left out | <= 2 % | {dropped} |",
        f"| estimates within 2 sd, pooled | 88 to 98 % | {cover['pooled']} |",
        f"| of the base; of effects | | {cover['base']}; {cover['effects']} |",
        f"| of the base where nothing explains the hits | | {cover['refused']} |",
        f"| loops of laws within 15 % | all | {loops(runs)} |",
        *(
            f"| held-out gap shrinks, median of all singles, {world} | {_SHRINK[world]}"
            f" | {shrink(runs, world)} |"
            for world in worlds
        ),
        f"| CPU time, median; worst | <= 40 s; 6 min | {np.median(times):.0f} s; "
        f"{max(times):.0f} s |",
        f"| memory, median; worst | < 3 GB | {np.median(memory) / 1024:.2f} GiB; "
        f"{max(memory) / 1024:.2f} GiB |",
        "\nCPU times are of one core, in part beside other work, which lengthens them.",
        f"\n## Single effects\n\n| effect | {' | '.join(worlds)} |",
        "|---" * (1 + len(worlds)) + "|",
        *effect_rows(runs),
        "\n## Verdicts that are not right\n\n| row | seed | bodies | hidden | margin | "
        "verdict | its reason |\n|---|---|---|---|---|---|---|",
        *misses(runs),
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, default=PAGE)
    parser.add_argument("--note", default="", help="what the runs do not say, in words")
    arguments = parser.parse_args()
    runs = [run for path in arguments.runs for run in counted(path)]
    note = f"{arguments.note}\n\n" if arguments.note else ""
    noted = page(runs).replace(_VERDICTS, f"{note}{_VERDICTS}", 1)
    arguments.out.write_text(noted, encoding="utf-8")


if __name__ == "__main__":
    main()
