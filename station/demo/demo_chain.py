# SPDX-License-Identifier: MIT
"""``jointbench demo --chain``: why a joint is softer than the law of its surfaces.

The stiffness of the joint comes from its own surfaces, bolts and bodies: boundary
elements for the roughness, thick layers for the pressure of the bolts, half-spaces for
the bodies, waves that the bolts press flat. The station measures surfaces and hits, and
its contact law uses none of these.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.analysis.gap.chain.chain_records import ChainLink
from jointbench.analysis.gap.response.threads import side_by_side
from jointbench.simulators.campaigns.joint_campaign import (
    FACE_SPACING,
    ground_surfaces,
)
from jointbench.simulators.rough_surfaces.profilometer import (
    Profilometer,
    measure_areal,
)
from jointbench.simulators.rough_surfaces.surface_files import DATE, write_keyence_csv
from jointbench.station.chain.chain_json import chain_json
from jointbench.station.chain.chain_report import chain_report
from jointbench.station.chain.chain_words import show_chain
from jointbench.station.chain.examine_chain import ExaminedChain, examine_chain
from jointbench.station.demo.demo import EXIT_QUALITY, truth_table
from jointbench.station.files.output_paths import (
    check_folder,
    check_outputs,
    require_mark,
    write_text,
)
from jointbench.station.gap.gap_request import GapRequest
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import DataTable, Section, Text
from jointbench.station.screen.terminal import console, table, working, write_json
from jointbench.station.screen.truth_table import (
    TruthComparison,
    as_json,
    compare_value,
)
from jointbench.station.screen.value_text import engineering
from jointbench.station.sources.recorded_session import record_session_file

FILES = (
    "blocks.h5",
    "blocks.toml",
    "blocks.truth.json",
    "surface-a.csv",
    "surface-b.csv",
    "chain-report.html",
    "chain-summary.json",
)
"""All that this demo makes; it overwrites these and nothing else."""
_NOISE = 2e-9
"""Of the simulated profilometer [m]."""
_INDEPENDENT = (
    "The joint of the simulated bench is not typed in. Its roughness is a layer whose "
    "gap comes from boundary elements on the two maps; the pressure of the bolts is "
    "that in the middle of thick layers; the bodies are elastic half-spaces around the "
    "contact; waves of 6 to 20 mm, which no map shows, are pressed together as far as "
    "the bolts do it; the bolts act in parallel. The contact law of the station uses "
    "the spectra of the maps, and neither these solvers nor these sizes."
)


def run_demo_chain(out: Path, *, seed: int, json_target: str | None) -> int:
    """Measure surfaces and hits of two bolted blocks, and diagnose the chain.

    Args:
        out: folder for surfaces, hits, model, truth, report and summary.
        seed: of the bench.
        json_target: where the summary goes besides ``chain-summary.json``.

    Returns:
        0, or 5 if another link is found or the causes named do not account for the
        ratio between law and joint within a factor of two.

    Raises:
        UsageError: a file of these names is somebody's own.
    """
    check_folder(out, FILES)
    check_outputs([], [json_target])
    _require_own(out)
    out.mkdir(parents=True, exist_ok=True)
    with working("pressing two ground surfaces together, striking two blocks"):
        written = record_session_file(
            f"sim:bolted-blocks?seed={seed}", out / FILES[0], overwrite=True
        )
        surfaces = _measure_surfaces(out, seed)
    truth = json.loads((out / FILES[2]).read_text(encoding="utf-8"))
    with side_by_side(), working("diagnosing the chain"):
        # From here on everything comes from the files, as it would for any user's own.
        done = examine_chain([written.path], surfaces, GapRequest(model=written.model))
    comparisons = _compare(done)
    show_chain(done, json_target)
    screen = console(json_target)
    made = _made_of(truth, done)
    screen.print(table(made.caption, made.columns, made.rows, words={0}))
    content = truth_table(comparisons)
    screen.print(table(content.caption, content.columns, content.rows))
    _write(out, done, made, comparisons, truth, json_target)
    screen.print(f"\nreport: {out / FILES[5]}   summary: {out / FILES[6]}")
    return 0 if all(c.passed for c in comparisons) else EXIT_QUALITY


def _require_own(out: Path) -> None:
    """Refuse a folder in which files of these names are none of this demo's."""
    if (out / FILES[0]).exists() and not (out / FILES[2]).exists():
        raise UsageError(
            f"'{out / FILES[0]}' is there already and no session of the demo; choose "
            "another folder with --out"
        )
    for name in FILES[3:5]:
        require_mark(out / name, DATE.encode(), "demo")


def _measure_surfaces(out: Path, seed: int) -> list[Path]:
    """Measure both surfaces, and export them as the instrument does."""
    paths = []
    for k, heights in enumerate(ground_surfaces(seed)):
        spacing = (FACE_SPACING, FACE_SPACING)
        path = out / FILES[3 + k]
        true = Areal(path.stem, heights, spacing, all_valid(heights))
        instrument = Profilometer(noise=_NOISE)
        write_keyence_csv(measure_areal(true, instrument, seed=2 * seed + k), path)
        paths.append(path)
    return paths


def _compare(done: ExaminedChain) -> tuple[TruthComparison, ...]:
    """Return whether the link is right and the causes account for the ratio."""
    found, several = done.found, done.found.several
    right = found.links == (ChainLink.CONTACT,) and len(found.location.places) == 1
    off = None
    if several is not None:
        off = float(np.log2(several.product.factor / several.measured))
    return (
        compare_value(
            "link[contact]", "-", 1.0, float(right), limit=0.0, absolute=True
        ),
        compare_value("log2(product/ratio)", "-", 0.0, off, limit=1.0, absolute=True),
    )


def _made_of(truth: dict[str, Any], done: ExaminedChain) -> DataTable:
    """Return how the joint of the bench is built up at the middle torque."""
    several = done.found.several
    at = 0 if several is None else several.reference
    one = truth["joint"][at]
    law = float(done.stiffness.before[at])
    rows = [
        ("law of the measured surfaces", f"{law:.3g}", "1"),
        (
            "roughness by boundary elements",
            f"{one['rough']:.3g}",
            _over(one["rough"], law),
        ),
    ]
    names = ("patch", "bodies", "waves", "bolted")
    for (cause, factor), key in zip(one["factors"].items(), names, strict=True):
        rows.append((cause, f"{one[key]:.3g}", f"{factor:.3g}"))
    preload = engineering(float(done.stiffness.preload[at]), "N")
    return DataTable(
        f"What the joint of the bench is made of, at {preload}",
        ("added", "stiffness [N/m]", "factor"),
        tuple(rows),
    )


def _over(value: float, other: float) -> str:
    return f"{value / other:.3g}"


def _write(
    out: Path,
    done: ExaminedChain,
    made: DataTable,
    comparisons: tuple[TruthComparison, ...],
    truth: dict[str, Any],
    json_target: str | None,
) -> None:
    """Write report and summary."""
    report = chain_report(done)
    section = Section(
        "truth",
        "What the bench is made of",
        (Text(_INDEPENDENT), made, truth_table(comparisons)),
    )
    write_report(replace(report, sections=(*report.sections, section)), out / FILES[5])
    summary = {
        "passed": all(c.passed for c in comparisons),
        "comparisons": as_json(comparisons),
        "chain": chain_json(done),
        "truth": truth,
    }
    write_text(out / FILES[6], json.dumps(summary, indent=1) + "\n")
    write_json(json_target, summary)
