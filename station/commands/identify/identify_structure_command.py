# SPDX-License-Identifier: MIT
"""``jointbench identify`` of meshed structures: sessions to joints."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.lumped.identified import IdentificationVerdict
from jointbench.analysis.structures.identification.joint_result import (
    StructureIdentification,
)
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.joints.hypothesis_output import (
    hypothesis_section,
    show_hypotheses,
)
from jointbench.station.joints.identified_json import identified_json
from jointbench.station.joints.identify_run import identified_structure
from jointbench.station.report.theory_section import show_theory, theory_section
from jointbench.station.screen.joint_text import parameter_table
from jointbench.station.screen.terminal import console, table, write_json


def run_identify_structure(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None,
    cache: Path | None,
    report: Path | None,
    json_target: str | None,
    surfaces: Sequence[Path] = (),
    options: FrfOptions | None = None,
) -> bool:
    """Identify the joints of a structure, show and write them.

    With a table [contact] they are compared with the contact law.

    Returns:
        Whether the structure is consistent with the measurement and with the full mesh.
    """
    check_outputs([model, *sessions, *surfaces], [json_target, report])
    done = identified_structure(
        model,
        sessions,
        band=band,
        cache=cache,
        surfaces=surfaces,
        options=options,
    )
    result, rows = done.result, done.theory
    show_structure(result, json_target)
    show_hypotheses(done.hypotheses, json_target)
    show_theory(rows, json_target)
    write_json(json_target, identified_json(done))
    if report is not None:
        from jointbench.station.report.structure_report import write_structure_report

        write_structure_report(
            report,
            model.name,
            done.structure,
            done.reduced,
            result,
            (hypothesis_section(done.hypotheses), theory_section(rows)),
            simulated=any(one.simulated for one in done.measured.values()),
        )
    return result.verdict is not IdentificationVerdict.INCONSISTENT and all(
        one.agrees for one in result.full_check
    )


def show_structure(result: StructureIdentification, json_target: str | None) -> None:
    """Print the identified parameters, the solutions and the full check."""
    screen = console(json_target)
    title = f"Joints: {result.verdict.value}"
    screen.print(parameter_table(title, result.parameters))
    for reason in result.reasons:
        screen.print(f"  {reason}", markup=False)
    for state in result.states:
        pairs = [
            (f"{m:.6g}", f"{p:.6g}", f"{100 * (p / m - 1):+.3f} %")
            for m, p in zip(state.measured, state.predicted, strict=False)
        ]
        if pairs:
            columns = ("measured [Hz]", "predicted [Hz]", "error")
            screen.print(table(f"Modes of {state.label}", columns, pairs))
    for check in result.full_check:
        word = "agrees" if check.agrees else "DISAGREES"
        worst = (np.abs(check.reduced - check.full) / check.full).max(initial=0.0)
        screen.print(
            f"{check.label}: the full model {word} with the reduced model "
            f"(largest relative frequency difference {worst:.1e})"
        )
