# SPDX-License-Identifier: MIT
"""The page of the reduction by interfaces, from records of `machine_reduction.py`.

python benchmarks/structures/machine_reduction.py --points 200 --lines 8 --damped 6
    --append RECORDS
python benchmarks/structures/machine_reduction.py --scale 4.33 --points 5 --lines 0
    --append RECORDS
python benchmarks/structures/machine_reduction_page.py RECORDS
    [--command FOLDER] [--page docs/machine-reduction.md]

`machine_reduction.jsonl` holds the records of the page. With --command, `jointbench
machine` is also run twice on `examples/grinder.toml` with 4.2 times the cells, and its
cost is appended to the records.
"""

import argparse
import json
import re
import sys
from pathlib import Path
from typing import Any

from large import measured
from machine_reduction import commit

MODEL = Path(__file__).resolve().parents[2] / "examples" / "grinder.toml"
FINE = 4.2
INTRODUCTION = """# Seven bodies and six joints, reduced by their interfaces

Made by `benchmarks/structures/machine_reduction.py` and `machine_reduction_page.py` on a
stand-in for the 2025 paper's grinder (`benchmarks/structures/grinder.py`, every dimension
assumed): seven bodies in hex20 elements, six joints with 18 stiffnesses, base fixed, 20
modes, joints from 1e5 to 1e11 N/m. One thread of a two-core machine shared with other work;
time is CPU time. How it works: [0141](decisions/0141-reduction-by-interfaces.md),
[0142](decisions/0142-bound-from-parts.md), [0143](decisions/0143-receptance-by-projection.md),
[0169](decisions/0169-decays-by-responses-at-real-s.md). The band of the reduction is three
times the highest line.
"""  # noqa: E501
HEAD = """
## {title}
Commit {commit}, load average {load}.

| | value | wanted |
|---|---|---|
"""


def bodies(record: dict[str, Any]) -> list[str]:
    """Return rows on the reduction."""
    return [
        f"degrees of freedom, coordinates | {record['freedoms']:,}, "
        f"{record['coordinates']} |",
        f"assembly | {record['assembly_s']:.1f} s, {record['assembly_gb']:.1f} GB |",
        f"bodies reduced, or read from a cache | {record['reduction_s']:.1f} s | 300 s",
        f"largest memory | {record['reduction_gb']:.1f} GB | 6 GB",
    ]


def modes(found: dict[str, Any]) -> list[str]:
    """Return rows on frequencies at points of the box."""
    spent = found["modes_ms"]["cpu_least"]
    where = f" (commit {found['commit']})" if "commit" in found else ""
    lowest = found["lowest_hz"]
    shown = "not recorded" if lowest is None else f"{lowest:.2f} Hz"
    return [
        f"points with full solves | {found['points']}{where} |",
        f"largest error of a frequency | {found['largest_error']:.1e} | 1e-4",
        f"its bound | median {found['median_bound']:.1e}, largest "
        f"{found['largest_bound']:.1e} |",
        f"points where the bound is broken | {found['bound_broken']} | 0",
        f"20 modes{where} | median {spent['median']:.1f} ms, largest "
        f"{spent['largest']:.1f} ms | 10 ms",
        f"lowest mode | {shown} | 1 Hz",
    ]


def timed(found: dict[str, Any]) -> list[str]:
    """Return a row on the time at points without full solves."""
    spent = found["cpu_least"]
    where = f" (commit {found['commit']})" if "commit" in found else ""
    return [
        f"20 modes at {found['points']} points{where} | median "
        f"{spent['median']:.1f} ms, "
        f"largest {spent['largest']:.1f} ms | 10 ms"
    ]


def receptances(found: dict[str, Any]) -> list[str]:
    """Return rows on receptances of 2,000 lines, 3 x 3."""
    rows = []
    for name, one in found.items():
        spent = one["ms"]
        rows.append(
            f"receptance, {name} | {spent['cpu_least']:.0f} ms least, "
            f"{spent['cpu_median']:.0f} ms median | 50 ms"
        )
        rows.append(
            f"its error, {one['lines_checked']} lines away from antiresonances | "
            f"{one['largest_error']:.1e} | 1e-3"
        )
        rows.append(
            f"its bound, broken | {one['bound_largest']:.1e}, {one['bound_broken']} of "
            f"{one['lines_checked']} | 0"
        )
    return rows


def command(record: dict[str, Any]) -> list[str]:
    """Return rows on the command, without and with its cache."""
    return [
        f"degrees of freedom | {record['freedoms']:,} |",
        f"JSON and report, first run | {record['first_s']:.0f} s, "
        f"{record['first_gb']:.1f} GB | 300 s, 6 GB",
        f"from the cache | {record['cached_s']:.0f} s, {record['cached_gb']:.1f} GB | "
        "seconds",
    ]


def run_command(folder: Path) -> dict[str, Any]:
    """Run the command twice on a fine mesh of the example."""
    text = re.sub(
        r"cells = \[(\d+), (\d+), (\d+)\]",
        lambda found: f"cells = {[round(FINE * int(one)) for one in found.groups()]}",
        MODEL.read_text(encoding="utf-8"),
    )
    (folder / "machine.toml").write_text(text, encoding="utf-8")
    words = [sys.executable, "-m", "jointbench", "machine", "machine.toml"]
    words += ["--cache", "bodies", "--json", "m.json", "--report", "m.html"]
    first, cached = measured(words, folder), measured(words, folder)
    content = json.loads((folder / "m.json").read_text(encoding="utf-8"))
    return {
        "commit": commit(),
        "freedoms": content["degrees_of_freedom"],
        "first_s": first[0],
        "first_gb": first[1],
        "cached_s": cached[0],
        "cached_gb": cached[1],
    }


def section(record: dict[str, Any]) -> str:
    """Return the section of one record."""
    if "cached_s" in record:
        title, rows = "The command on a fine mesh of the example", command(record)
    else:
        title, rows = f"{record['freedoms']:,} degrees of freedom", bodies(record)
        rows += modes(record["modes"]) if "modes" in record else []
        rows += timed(record["timed"]) if "timed" in record else []
        rows += receptances(record.get("receptance", {}))
    load = record.get("load_average")
    said = "not recorded" if load is None else f"{load:.0f}"
    head = HEAD.format(title=title, commit=record["commit"], load=said)
    return head + "".join(f"| {row} |\n" for row in rows)


def main() -> None:
    """Write the page from the last record of each size."""
    parser = argparse.ArgumentParser()
    parser.add_argument("records", type=Path)
    parser.add_argument("--command", type=Path)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    if options.command is not None:
        options.command.mkdir(parents=True, exist_ok=True)
        with options.records.open("a", encoding="utf-8") as file:
            file.write(json.dumps(run_command(options.command)) + "\n")
    lines = options.records.read_text(encoding="utf-8").splitlines()
    last = {("cached_s" in r, r["freedoms"]): r for r in map(json.loads, lines)}
    text = INTRODUCTION + "".join(section(last[key]) for key in sorted(last))
    print(text)
    if options.page is not None:
        options.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
