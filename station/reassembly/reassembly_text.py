# SPDX-License-Identifier: MIT
"""A joint over its assemblies in words and rows."""

from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    UNITS,
    ContactQuantity,
)
from jointbench.analysis.gap.reassembly.changed_joint import (
    JointChange,
    LatestAssembly,
    QuantityOverAssemblies,
    Reassembly,
)

SCATTER_COLUMNS = (
    "quantity",
    "assembly to assembly, 95 %",
    "tightening to tightening, 95 %",
    "latest over expected",
    "if unchanged, 95 %",
    "change seen from",
    "verdict",
)
_SHAPE = 3.0
"""The course over the levels has changed if it is this much less probable."""


def headline(found: Reassembly) -> str:
    """Return the verdict as one sentence."""
    count = max(one.rows.assemblies.size for one in found.quantities.values())
    head = f"{count} assemblies: "
    if not found.reassembled:
        head += "not opened before the latest states; "
    if found.change is JointChange.CHANGED:
        words = [
            f"{name} {_changed(one.latest)}"
            for name, one in found.quantities.items()
            if one.latest.change is JointChange.CHANGED
        ]
        return f"{head}the joint has changed: {', '.join(words)}"
    if found.change is JointChange.SCATTER:
        return f"{head}the latest values lie within the scatter of the joint"
    return f"{head}whether the joint has changed cannot be determined"


def remedy(found: Reassembly) -> str:
    """Return what would decide, or nothing."""
    if found.change is not JointChange.OPEN:
        return ""
    return (
        "the scatter hides a change by a factor of 2; measure further assemblies or "
        "more torques, or state the scatter that is known: reassembly, torque_scatter"
    )


def _changed(latest: LatestAssembly) -> str:
    low, high = latest.interval
    if latest.offset_probability < _SHAPE * latest.shape_probability:
        return (
            f"is {latest.ratio:.2f} times that expected, {low:.2f} to {high:.2f} if "
            "unchanged"
        )
    return "follows another course over the levels"


def scatter_rows(found: Reassembly) -> list[tuple[str, ...]]:
    """Return a row for each quantity."""
    return [_scatter_row(name, one) for name, one in found.quantities.items()]


def _scatter_row(name: ContactQuantity, one: QuantityOverAssemblies) -> tuple[str, ...]:
    latest = one.latest
    low, high = latest.interval
    return (
        name.value,
        _percent(one.scatter.interval("between")),
        _percent(one.scatter.interval("within")),
        f"{latest.ratio:.2f}",
        f"{low:.2f} to {high:.2f}",
        f"a factor of {latest.detectable:.2f}",
        latest.change.value,
    )


def _percent(ends: tuple[float, float, float]) -> str:
    middle, low, high = (100.0 * end for end in ends)
    return f"{middle:.2g} % ({low:.2g} to {high:.2g})"


def next_columns(found: Reassembly) -> tuple[str, ...]:
    """Return the heads of the table of the next assembly."""
    names = [f"{name} [{unit_of(name)}]" for name in found.quantities]
    return (f"level [{level_unit(found)}]", *names)


def next_rows(found: Reassembly) -> list[tuple[str, ...]]:
    """Return a row for each level: median and 95 % interval of each quantity."""
    levels = sorted({float(x) for one in found.quantities.values() for x in one.level})
    return [
        (f"{level:.4g}", *(_at(one, level) for one in found.quantities.values()))
        for level in levels
    ]


def _at(one: QuantityOverAssemblies, level: float) -> str:
    for k, own in enumerate(one.level):
        if own == level:
            middle, low, high = one.next_assembly[:, k]
            return f"{middle:.3g} ({low:.3g} to {high:.3g})"
    return ""


def unit_of(name: ContactQuantity) -> str:
    """Return the SI unit of a quantity."""
    return UNITS[QUANTITIES.index(name)]


def level_unit(found: Reassembly) -> str:
    """Return the unit of the levels."""
    return "N m" if found.by_torque else "N"
