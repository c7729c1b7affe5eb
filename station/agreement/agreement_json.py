# SPDX-License-Identifier: MIT
"""The comparison of a measured structure with its model as plain numbers."""

from typing import Any

import numpy as np

from jointbench.analysis.structures.agreement.compare_structure import Agreement
from jointbench.analysis.structures.agreement.paired_modes import unpaired


def agreement_json(found: Agreement) -> dict[str, Any]:
    """Return pairs, MAC, CoMAC, FRAC and suspected coordinates."""
    missing = unpaired(found.pairs, found.measured.frequency.size, "measured")
    return {
        "pairs": [
            {
                "measured_hz": float(found.measured.frequency[one.measured]),
                "computed_hz": float(found.computed.frequency[one.computed]),
                "mac": one.mac,
                "frequency_difference": one.frequency,
                "frequency_interval_95": list(one.frequency_interval),
                "damping_difference": one.damping,
                "damping_interval_95": list(one.damping_interval),
            }
            for one in found.pairs
        ],
        "measured_without_partner_hz": found.measured.frequency[missing].tolist(),
        "mac": found.mac.tolist(),
        "comac": dict(zip(found.outputs, found.comac.tolist(), strict=True)),
        "enhanced_comac": dict(
            zip(found.outputs, found.enhanced_comac.tolist(), strict=True)
        ),
        "frac": {
            output: dict(zip(found.inputs, row, strict=True))
            for output, row in zip(
                found.outputs, np.asarray(found.frac).tolist(), strict=True
            )
        },
        "suspects": [
            {
                "text": one.text,
                "kind": one.kind,
                "names": list(one.names),
                "residual_before": one.residual_before,
                "residual_after": one.residual_after,
                "equal": list(one.equal),
            }
            for one in found.suspects
        ],
    }
