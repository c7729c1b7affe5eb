# SPDX-License-Identifier: MIT
"""The part of a report that names what other packages add to its results."""

from collections.abc import Mapping

from jointbench.station.screen.page_parts import DataTable, Section


def packages_section(packages: Mapping[str, str]) -> Section:
    """Return the effects of other packages that a diagnosis could name.

    Args:
        packages: distribution and version by the name of the effect.
    """
    table = DataTable(
        "Effects that other packages add to the catalogue of this diagnosis.",
        ("effect", "package"),
        tuple(packages.items()),
    )
    return Section("packages", "Effects of other packages", (table,))
