# SPDX-License-Identifier: MIT
"""What readers of results need and nothing more: layouts, and a row of numbers.

An archive is read from its index in seconds; the stages that computed it would take
longer to load.
"""

from dataclasses import dataclass

MODAL_SCHEMA = "jointbench-results/1"
PROCESSED_SCHEMA = "jointbench-results/2"
OF_EACH_ROW = "see the variable unit"
"""In place of the unit of a column whose rows have their own."""
NAN = float("nan")


@dataclass(frozen=True, slots=True)
class ResultQuantity:
    """One number of a result.

    Attributes:
        part: ``hits``, ``modes``, ``surface``, ``contact``, ``joint`` or ``gap``.
        item: which mode, surface, link; empty where there is but one.
        name: of the quantity, for example ``natural_frequency``.
        unit: SI; ``1`` for a plain number.
        value: [unit]; NaN where there is a word in its place.
        sd: its standard deviation [unit]; NaN where none is known.
        word: a verdict, where the quantity is one.
        preload: at which it was found [N]; NaN where not given.
    """

    part: str
    item: str
    name: str
    unit: str
    value: float = NAN
    sd: float = NAN
    word: str = ""
    preload: float = NAN
