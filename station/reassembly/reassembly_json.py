# SPDX-License-Identifier: MIT
"""A joint over its assemblies as plain numbers."""

import math
from typing import Any

from jointbench.analysis.gap.contact_bench.joint_states import ContactQuantity
from jointbench.analysis.gap.reassembly.changed_joint import (
    QuantityOverAssemblies,
    Reassembly,
)
from jointbench.station.reassembly.reassembly_text import level_unit, unit_of


def reassembly_json(found: Reassembly) -> dict[str, Any]:
    """Return verdict, scatter, the latest assembly and the next one."""
    return {
        "verdict": found.change.value,
        "reassembled": found.reassembled,
        "level_unit": level_unit(found),
        "quantities": {
            name.value: _quantity(name, one) for name, one in found.quantities.items()
        },
    }


def _quantity(name: ContactQuantity, one: QuantityOverAssemblies) -> dict[str, Any]:
    latest = one.latest
    middle, low, high = one.next_assembly
    return {
        "unit": unit_of(name),
        "assemblies": int(one.rows.assemblies.size),
        "scatter_between_assemblies": _ends(one.scatter.interval("between")),
        "scatter_between_tightenings": _ends(one.scatter.interval("within")),
        "latest": {
            "verdict": latest.change.value,
            "ratio": latest.ratio if math.isfinite(latest.ratio) else None,
            "interval_95_if_unchanged": [
                end if math.isfinite(end) else None for end in latest.interval
            ],
            "detectable_factor": (
                latest.detectable if math.isfinite(latest.detectable) else None
            ),
            "offset_probability": latest.offset_probability,
            "shape_probability": latest.shape_probability,
        },
        "next_assembly": {
            "level": one.level.tolist(),
            "median": middle.tolist(),
            "low_95": low.tolist(),
            "high_95": high.tolist(),
        },
    }


def _ends(ends: tuple[float, float, float]) -> dict[str, Any]:
    return {"median": ends[0], "interval_95": [ends[1], ends[2]]}
