# SPDX-License-Identifier: MIT
"""``jointbench next``: the experiment that separates what survives on a joint."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.law_diagnosis.contact_diagnosis import (
    ContactDiagnosis,
    diagnose_contact,
)
from jointbench.analysis.gap.next_experiment.contact_series import torque_series
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.joint_states.joint_state_files import read_joints
from jointbench.station.joint_states.next_plan import write_plan
from jointbench.station.screen.terminal import console, table, write_json

_COLUMNS = ("experiment", "minutes", "gain of probability", "per hour", "decides")


def run_next(
    joints: Sequence[Path],
    *,
    plan: Path | None,
    out: Path | None,
    json_target: str | None,
) -> ContactDiagnosis:
    """Rank experiments on a joint, and write the best one as a plan if asked.

    Args:
        joints: joint over its preload (TOML), and further sessions of it.
        plan: of the first session, whose sensors and points the new one takes.
        out: plan to write, or None.
        json_target: where the JSON goes.

    Raises:
        UsageError: a plan is to be written without that of the first session.
    """
    if out is not None and plan is None:
        raise UsageError(
            "--out needs sensors and points: give the plan of the first session with "
            "--plan plan.toml"
        )
    check_outputs([*joints, *([plan] if plan else [])], [out, json_target])
    joint = read_joints(joints)
    done = diagnose_contact(joint.data, joint.law)
    screen = console(json_target)
    screen.print(f"verdict: {done.found.verdict.value}", style="bold")
    screen.print(done.found.reason)
    rows = [
        (
            one.name,
            f"{one.minutes:.0f}",
            f"{one.expected.gain:+.2f}",
            f"{one.gain_per_hour:+.2f}",
            f"{100 * one.expected.decided:.0f} %",
        )
        for one in done.experiments
    ]
    if rows:
        screen.print(table("Experiments, best first", _COLUMNS, rows, words={0}))
    screen.print(f"next: {done.found.experiment}")
    if out is not None and plan is not None:
        if not done.experiments:
            raise UsageError("nothing is left to decide; no plan is written")
        series = torque_series(joint.data.states)[done.experiments[0].index]
        write_plan(plan, series, out)
        screen.print(f"plan: {out}", soft_wrap=True)
    write_json(json_target, _json(done))
    return done


def _json(done: ContactDiagnosis) -> dict[str, object]:
    return {
        "verdict": done.found.verdict.value,
        "experiment": done.found.experiment,
        "experiments": [
            {
                "name": one.name,
                "words": one.words,
                "minutes": one.minutes,
                "gain": one.expected.gain,
                "gain_per_hour": one.gain_per_hour,
                "decided": one.expected.decided,
                "decided_wrongly": one.expected.wrong,
            }
            for one in done.experiments
        ],
    }
