# SPDX-License-Identifier: MIT
"""What a file format of samples is: a record that each format makes of itself."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import ShapeError
from jointbench.acquisition.records.recordings import Recording


@dataclass(frozen=True, slots=True)
class SampleOptions:
    """What the user says about a file of samples.

    Attributes:
        columns: what its channels hold, see `parse_columns`; None if not given.
        point: where the hammer struck.
        full_scale: value of the largest number of a file of whole numbers, in the
            unit of `columns`; None if not given.
        rate: sample rate of a file without times [Hz]; None if not given.
    """

    columns: str | None = None
    point: str = "1"
    full_scale: float | None = None
    rate: float | None = None


@dataclass(frozen=True, slots=True)
class SampleFormat:
    """One file format of samples.

    Attributes:
        name: one word, ``"wave"``.
        suffixes: endings of its files, in lower case with the dot; none where the
            content alone decides.
        read: returns the recordings of a file, one for each stream; raises `BadData`.
        recognise: whether a file of such an ending has this format; None where the
            ending decides.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[[Path, SampleOptions], tuple[Recording, ...]]
    recognise: Callable[[Path], bool] | None = None

    def __post_init__(self) -> None:
        """Refuse a format that would take every file."""
        if not self.suffixes and self.recognise is None:
            raise ShapeError(
                f"sample format {self.name!r} has neither suffixes nor recognise; give "
                "one, or it takes every file"
            )

    def takes(self, path: Path) -> bool:
        """Return whether a file has this format."""
        if self.suffixes and path.suffix.lower() not in self.suffixes:
            return False
        return self.recognise is None or self.recognise(path)
