# SPDX-License-Identifier: MIT
"""The recommended experiment on a joint as a plan of `jointbench measure`."""

import re
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.next_experiment.contact_series import TorqueSeries
from jointbench.station.files.output_paths import write_text
from jointbench.station.files.toml_file import read_toml
from jointbench.station.schemas.plan_model import MeasureTable

_HITS = re.compile(r"^\[hits\][^\n]*\n", re.MULTILINE)
_TORQUES = re.compile(r"^torques\s*=\s*\[[^\]]*\][^\n]*\n", re.MULTILINE)


def plan_text(before: str, series: TorqueSeries) -> str:
    """Return the text of a plan with the torques of a series.

    Args:
        before: plan of the first session: sensors, points, settings.
        series: to be measured.

    Raises:
        BadData: the plan has no table [hits].
    """
    if not _HITS.search(before):
        raise BadData("the plan has no table [hits]; write it on a line of its own")
    rising = dict.fromkeys(f'"{torque:.4g} N m"' for torque in series.torque)
    line = f"torques = [{', '.join(rising)}]\n"
    notes = [f"next experiment: {series.words}"]
    if series.assemblies > 1:
        notes.append(f"measure it {series.assemblies} times, each after a new assembly")
    if series.falling.any():
        notes.append("then the same torques falling, as a plan with the list reversed")
    if series.washer:
        notes.append("put a load washer under each bolt and write down the preload")
    heads = "".join(f"# {one}\n" for one in notes)
    text = _TORQUES.sub("", before)
    return heads + _HITS.sub(lambda found: found.group() + line, text, count=1)


def write_plan(before: Path, series: TorqueSeries, target: Path) -> None:
    """Write the plan of a series, and check that `measure` takes it.

    Args:
        before: plan of the first session.
        series: to be measured.
        target: plan to write.

    Raises:
        BadData: the plan of the first session cannot be read.
    """
    read_toml(before, MeasureTable)
    text = plan_text(before.read_text(encoding="utf-8-sig"), series)
    write_text(target, text)
    read_toml(target, MeasureTable)
