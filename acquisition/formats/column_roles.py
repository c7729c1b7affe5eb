# SPDX-License-Identifier: MIT
"""Roles that columns of hits have, and which of them follow --columns."""

import re

from jointbench.acquisition.records.recordings import Quantity

QUANTITY_NAMES = tuple(quantity.value for quantity in Quantity)
RATE_EXAMPLE = "--columns 'force:N,acceleration:m/s^2' --rate '10 kHz'"


def roles_named(columns: str | None) -> frozenset[str]:
    """Return the roles that follow --columns; nothing is checked."""
    return frozenset(
        re.split(r"[.@:]", item.strip(), maxsplit=1)[0]
        for item in (columns or "").split(",")
        if item.strip()
    )
