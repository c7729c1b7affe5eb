# SPDX-License-Identifier: MIT
"""What a file format of FRFs is: a record that each format makes of itself."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.records.frf_functions import FrfFunction


@dataclass(frozen=True, slots=True)
class FrfOptions:
    """What the user states about a file of FRFs.

    Attributes:
        columns: what its columns or variables hold, see `parse_frf_columns`; None if
            not given.
        point: reference degree of freedom where the file names none.
        averages: number of averages where the file does not state it; 0 if not given.
    """

    columns: str | None = None
    point: str = "1"
    averages: int = 0


@dataclass(frozen=True, slots=True)
class FrfFormat:
    """One file format of frequency response functions.

    Attributes:
        name: one word, ``"universal_frfs"``.
        recognise: whether a file holds FRFs of this format, by its content and the
            options; cheap, and raises nothing for files of other formats.
        read: returns the FRFs of a file in SI units, at least one; raises `BadData`.
    """

    name: str
    recognise: Callable[[Path, FrfOptions], bool]
    read: Callable[[Path, FrfOptions], tuple[FrfFunction, ...]]
