# SPDX-License-Identifier: MIT
"""Diagnose a folder of campaigns and store each verdict with the truth.

Usage: python benchmarks/gap/judge.py FOLDER RUNS.jsonl [--jobs 2] [--kind single]

One JSON line per campaign: truth, the whole diagnosis, CPU seconds. Campaigns that are
already in the file are skipped, so that an interrupted run can be continued.
With --whole those of the kind "hidden" are judged by the whole catalogue, and count as
single effects.
"""

import argparse
import json
import multiprocessing
import os
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from jointbench.analysis.gap.model.policy import STANDARD, Policy

os.environ.setdefault("OMP_NUM_THREADS", "1")


def judged_as(name: str, whole: bool) -> str:
    """Return what a campaign counts as; judged by the whole catalogue, none hides."""
    return name.replace("hidden", "single") if whole else name


def judge_one(
    truth_path: Path, *, whole: bool, policy: Policy = STANDARD
) -> dict[str, Any]:
    """Return the truth and the diagnosis of one campaign, under a policy."""
    from jointbench.analysis.gap.diagnosis.diagnose import diagnose
    from jointbench.analysis.gap.intake.read_campaign import read_campaign
    from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json

    truth: dict[str, Any] = json.loads(truth_path.read_text(encoding="utf-8"))
    truth["kind"] = judged_as(truth["kind"], whole)
    without = frozenset(truth["truth"]) if truth["kind"] == "hidden" else frozenset()
    campaign = read_campaign(truth_path.with_suffix(".h5"))
    start = time.process_time()
    try:
        diagnosis = diagnose(campaign, without=without, policy=policy)
        found: dict[str, Any] = diagnosis_json(diagnosis)
    except Exception as error:  # noqa: BLE001 - a crash is an outcome to be counted
        found = {"verdict": "crash", "reason": f"{type(error).__name__}: {error}"}
    return truth | {"found": found, "seconds": time.process_time() - start}


def key_of(run: dict[str, Any]) -> str:
    """Return the key that identifies a campaign."""
    return f"{run['kind']}-{run['seed']}"


def main() -> None:
    """Diagnose the campaigns that are not yet in the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--kind", default="")
    parser.add_argument("--whole", action="store_true")
    arguments = parser.parse_args()
    whole = arguments.whole
    done = set()
    if arguments.runs.exists():
        lines = arguments.runs.read_text(encoding="utf-8").splitlines()
        done = {key_of(json.loads(line)) for line in lines}
    paths = sorted(
        path
        for path in arguments.folder.glob(f"{arguments.kind}*.json")
        if "truth" not in path.name and judged_as(path.stem, whole) not in done
    )
    judge = partial(judge_one, whole=whole)
    with (
        multiprocessing.Pool(arguments.jobs, maxtasksperchild=50) as pool,
        arguments.runs.open("a", encoding="utf-8") as out,
    ):
        for k, run in enumerate(pool.imap_unordered(judge, paths)):
            out.write(json.dumps(run) + "\n")
            out.flush()
            sys.stderr.write(f"\r{k + 1}/{len(paths)} {key_of(run)}   ")
    sys.stderr.write("\n")


if __name__ == "__main__":
    main()
