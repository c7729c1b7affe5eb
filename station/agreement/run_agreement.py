# SPDX-License-Identifier: MIT
"""``jointbench agreement``: a measured structure beside its identified model."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.agreement.agreement_json import agreement_json
from jointbench.station.agreement.agreement_text import show_agreement
from jointbench.station.agreement.compare_states import compare_states
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.joints.state_values import read_identified
from jointbench.station.screen.terminal import write_json


@dataclass(frozen=True, slots=True)
class AgreementOutputs:
    """Where results go.

    Attributes:
        report: HTML, or None.
        json: JSON, or None.
        cache: folder that keeps reduced structures, or None.
    """

    report: Path | None = None
    json: str | None = None
    cache: Path | None = None


def run_agreement(
    model: Path,
    identified: Path,
    sessions: Sequence[Path],
    *,
    band: str | None,
    outputs: AgreementOutputs,
) -> bool:
    """Compare sessions with a model, show and write the comparison.

    Args:
        model: structure model (TOML).
        identified: JSON of ``identify``.
        sessions: measured.
        band: of the modes, as typed.
        outputs: where results go.

    Returns:
        Whether no coordinate is suspected.

    Raises:
        UsageError: there is no session.
    """
    if not sessions:
        raise UsageError("no session to compare with; name one or several")
    check_outputs([model, identified, *sessions], [outputs.json, outputs.report])
    done = compare_states(
        model, read_identified(identified), sessions, band=band, cache=outputs.cache
    )
    show_agreement(done.states, outputs.json)
    write_json(
        outputs.json, {name: agreement_json(one) for name, one in done.states.items()}
    )
    if outputs.report is not None:
        from jointbench.station.agreement.agreement_report import (
            write_agreement_report,
        )

        write_agreement_report(
            outputs.report, model.name, done.states, simulated=done.simulated
        )
    return not done.suspected
