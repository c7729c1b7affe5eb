# SPDX-License-Identifier: MIT
"""Provenance: the processing steps of a record."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Step:
    """One processing step of a provenance.

    Attributes:
        name: of the operation, for example ``"import"`` or ``"force_window"``.
        detail: the parameters and reasons, by name; plain text, numbers or flags.
    """

    name: str
    detail: tuple[tuple[str, str | float | int | bool], ...] = ()


Provenance = tuple[Step, ...]


def step(name: str, /, **detail: str | float | int | bool) -> Step:
    """Make a `Step` from keyword details."""
    return Step(name, tuple(detail.items()))
