# SPDX-License-Identifier: MIT
"""The report of a session as one HTML file."""

from pathlib import Path

from jointbench.station.files.output_paths import check_outputs
from jointbench.station.library.argument_checks import one_path
from jointbench.station.report.frf_analysis import report_path
from jointbench.station.report.session_report import session_page
from jointbench.station.screen.page import write_report


def report(
    session: str | Path,
    out: str | Path | None = None,
    *,
    model: str | Path | None = None,
    geometry: str | Path | None = None,
) -> Path:
    """Write the report of a session: hits, FRFs, modes, surfaces, joint.

    Args:
        session: session file, file of FRFs, or results of FRFs.
        out: HTML file to write; None for next to the session.
        model: bench model; identification and contact law are compared.
        geometry: of the hit points, for animated shapes.

    Returns:
        The file that was written.

    Raises:
        BadData: a file cannot be used.
        UsageError: a file name is none.
    """
    given = one_path(session, "a session, or a file of FRFs")
    target = report_path(given) if out is None else one_path(out, "the report")
    bench = None if model is None else one_path(model, "a bench model")
    points = None if geometry is None else one_path(geometry, "a geometry")
    check_outputs([p for p in (given, bench, points) if p is not None], [target])
    page, _ = session_page(given, model=bench, geometry=points)
    write_report(page, target)
    return target
