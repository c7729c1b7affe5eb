# SPDX-License-Identifier: MIT
"""Provenance: the steps of processing that a record has been through."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Step:
    """One step of processing, as provenance keeps it.

    Attributes:
        name: what was done, for example ``"import"`` or ``"force_window"``.
        detail: the parameters and reasons, by name; plain text, numbers or flags.
    """

    name: str
    detail: tuple[tuple[str, str | float | int | bool], ...] = ()


Provenance = tuple[Step, ...]


def step(name: str, /, **detail: str | float | int | bool) -> Step:
    """Make a `Step` from keyword details."""
    return Step(name, tuple(detail.items()))
