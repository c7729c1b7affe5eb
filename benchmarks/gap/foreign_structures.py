# SPDX-License-Identifier: MIT
"""Structures of other programs: K and M by scikit-fem, hits by another integrator.

Usage: python benchmarks/gap/foreign_structures.py FOLDER [--seeds 1 2] [--hide iwan]

Each case is made, given to `jointbench gap SESSION --model MODEL.toml` in a process of
its own, and its verdict appended to FOLDER/runs.jsonl; cases that are there already are
skipped. --page FILE writes the page. Needs scikit-fem.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path

from foreign_bodies import PATCHES, node_pairs, plates
from foreign_campaign import (
    FEET,
    HIDDEN,
    NOMINAL,
    POINTS,
    SENSORS,
    draw_truth,
    make_session,
)

BAND = "2200 Hz"
EXPECTED = {
    "none": ("none", {""}, ""),
    "loose": ("named", {"loose_bolt"}, "left"),
    "iwan": ("named", {"microslip", "macroslip"}, "left"),
    "thickness": ("named", {"thickness"}, "upper"),
}
"""Verdict, names of the family, and place by what is hidden."""


PAGE = """# Structures of other programs

Made by `benchmarks/gap/foreign_structures.py` on {date}. Two steel plates, meshed and
assembled by scikit-fem (tetrahedra with ten nodes, K and M of {lower} and {upper}
degrees of freedom), on two joints with {pairs} pairs of nodes at their interface.
Springs, and the 24 sliders of an Iwan law, sit at every pair; the motion is integrated
by a Runge-Kutta method in the benchmark. `jointbench gap session.h5 --model model.toml`
reads K, M and the mesh, and follows a few relative motions of each joint
([0460](decisions/0460-bolted-areas-as-few-relative-motions.md)). Moduli, damping of the
plates, stiffness and damping of joints and feet, aim and tilt of the hits are off their
nominal values in every case. Hidden: `loose`, the left joint at a quarter of its
stiffness and damping; `iwan`, sliders in the left joint; `thickness`, the upper plate
6 % thicker than in the model, which then meshes boxes itself.
"""


def model_text(*, matrices: bool) -> str:
    """Return the model file of the plates.

    Args:
        matrices: True for K and M of the other library; False for boxes.
    """
    lines = []
    if not matrices:
        lines += [
            "[materials.steel]",
            'youngs_modulus = "206 GPa"',
            "poisson_ratio = 0.3",
        ]
        lines += ['density = "7850 kg/m^3"']
    boxes = {
        "lower": (("360 mm", "200 mm", "20 mm"), ("0 mm", "0 mm", "0 mm"), (18, 10, 2)),
        "upper": (
            ("300 mm", "160 mm", "16 mm"),
            ("30 mm", "20 mm", "20 mm"),
            (15, 8, 2),
        ),
    }
    for name, (size, origin, cells) in boxes.items():
        lines.append(f"[bodies.{name}]")
        if matrices:
            lines += [f'mesh = "{name}.inp"', f'stiffness = "{name}_k.mtx"']
            lines.append(f'mass = "{name}_m.mtx"')
        else:
            lines += [f"box = {list(size)}", f"origin = {list(origin)}"]
            lines += [f"cells = {list(cells)}", 'material = "steel"']
    for name, corners in PATCHES.items():
        sides = [
            [f"{1e3 * x:g} mm" for x in side] for side in zip(*corners, strict=True)
        ]
        lines += [f"[joints.{name}]", 'between = ["lower", "upper"]']
        lines.append(f"patches = [{{ rectangle = {sides} }}]")
    for word, places in (("sensors", SENSORS), ("hits", POINTS)):
        for name, (body, place, along) in places.items():
            at = [f"{1e3 * x:g} mm" for x in place]
            lines += [f"[{word}.{name}]", f'body = "{body}"', f"position = {at}"]
            lines.append(f"direction = {list(along)}")
    lines += [
        "[gap]",
        f'band = "{BAND}"',
        f'damping_ratio = "{NOMINAL["damping_ratio"]}"',
    ]
    lines += ['aim_sd = "1 mm"', 'tilt_sd = "1 deg"', "[gap.bolt]"]
    lines += [f'normal = "{NOMINAL["normal"]:g} N/m"']
    lines += [f'tangential_{k} = "{NOMINAL["tangential"]:g} N/m"' for k in (1, 2)]
    lines += [
        f'{word}_damping = "{NOMINAL[f"{word}_damping"]:g} N s/m"'
        for word in ("normal", "tangential")
    ]
    feet = [
        f'{{ body = "lower", position = ["{1e3 * x:g} mm", "{1e3 * y:g} mm", "0 mm"] }}'
        for x, y in FEET
    ]
    lines += ["[gap.feet]", f"places = [{', '.join(feet)}]"]
    lines += [f'stiffness = "{NOMINAL["foot"]:g} N/m"']
    lines += [f'damping = "{NOMINAL["foot_damping"]:g} N s/m"', ""]
    return "\n".join(lines)


def make_case(folder: Path, hide: str, seed: int) -> Path:
    """Write model, matrices and session of a case, unless they are there."""
    place = folder / f"{hide}-{seed}"
    if (place / "truth.json").exists():
        return place
    place.mkdir(parents=True, exist_ok=True)
    truth = draw_truth(seed, hide)
    matrices = hide != "thickness"
    (place / "model.toml").write_text(model_text(matrices=matrices), encoding="utf-8")
    if matrices:
        for body in plates():
            body.export(place)
    facts = make_session(place / "session.h5", truth, seed)
    text = json.dumps(vars(truth) | facts, indent=1)
    (place / "truth.json").write_text(text, encoding="utf-8")
    return place


def run_case(place: Path, hide: str, seed: int) -> dict:
    """Examine a case with the command; return verdict, time and memory."""
    out = place / "verdict.json"
    out.unlink(missing_ok=True)
    command = [sys.executable, "-m", "jointbench", "gap", str(place / "session.h5")]
    command += ["--model", str(place / "model.toml"), "--json", str(out)]
    began = time.perf_counter()
    with tempfile.TemporaryFile() as words:
        running = subprocess.Popen(command, stdout=words, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(running.pid, 0)
        running.returncode = os.waitstatus_to_exitcode(status)
        words.seek(0)
        said = words.read().decode(errors="replace")
    found = json.loads(out.read_text(encoding="utf-8")) if out.exists() else {}
    return {
        "hide": hide,
        "seed": seed,
        "verdict": found.get("verdict", "crash"),
        "effects": [
            {"name": e["name"], "site": e["site"], "parameters": e.get("parameters")}
            for e in found.get("effects") or ()
        ],
        "closest": found.get("closest"),
        "reason": found.get("reason", said[-400:]),
        "cpu_s": round(used.ru_utime + used.ru_stime, 1),
        "clock_s": round(time.perf_counter() - began, 1),
        "memory_mb": round(used.ru_maxrss / 1024),
    }


def right(run: dict) -> bool:
    """Return whether verdict, family and place are those of the truth."""
    verdict, names, place = EXPECTED[run["hide"]]
    if run["verdict"] != verdict:
        return False
    sites = {e["site"].partition(":")[2] for e in run["effects"]}
    return verdict == "none" or (
        {e["name"] for e in run["effects"]} <= names and sites == {place}
    )


def page(runs: list[dict]) -> str:
    """Return the page of all runs."""
    lower, upper = plates()
    pairs = {name: node_pairs(lower, upper, name).share.size for name in PATCHES}
    text = PAGE.format(
        date=f"{datetime.now(UTC):%Y-%m-%d}",
        lower=3 * len(lower.nodes),
        upper=3 * len(upper.nodes),
        pairs=sum(pairs.values()),
    )
    lines = [
        text,
        "| hidden | seed | verdict | effects | right | CPU s | memory [GB] |",
        "|---|---|---|---|---|---|---|",
    ]
    for run in runs:
        effects = ", ".join(f"{e['name']} {e['site']}" for e in run["effects"]) or "-"
        if run["verdict"] == "unknown" and run["closest"]:
            effects = "closest: " + ", ".join(run["closest"]["effects"])
        lines.append(
            f"| {run['hide']} | {run['seed']} | {run['verdict']} | {effects} | "
            f"{'yes' if right(run) else 'no'} | {run['cpu_s']:.0f} | "
            f"{run['memory_mb'] / 1024:.2f} |"
        )
    return "\n".join([*lines, ""])


def main() -> None:
    """Make and examine the cases that are not yet in the folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, nargs="*", default=[1])
    parser.add_argument("--hide", nargs="*", choices=HIDDEN, default=list(HIDDEN))
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    log = options.folder / "runs.jsonl"
    lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    runs = [json.loads(line) for line in lines]
    done = {(run["hide"], run["seed"]) for run in runs}
    for seed in options.seeds:
        for hide in options.hide:
            if (hide, seed) in done:
                continue
            run = run_case(make_case(options.folder, hide, seed), hide, seed)
            runs.append(run)
            with log.open("a", encoding="utf-8") as out:
                out.write(json.dumps(run) + "\n")
            print(hide, seed, run["verdict"], run["effects"], run["cpu_s"], flush=True)
    if options.page:
        options.page.write_text(page(runs), encoding="utf-8")


if __name__ == "__main__":
    main()
