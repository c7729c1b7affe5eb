# SPDX-License-Identifier: MIT
"""What goes wrong on a serial line: silence, a break, noise, half a profile."""

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    FormatError,
    InstrumentError,
)


class LineBroken(InstrumentError):
    """A line that went silent or was unplugged in the middle of an answer.

    Attributes:
        received: what had arrived of that answer; nothing of it is lost.
    """

    def __init__(self, message: str, received: bytes) -> None:
        super().__init__(message)
        self.received = received


class LineSilent(LineBroken):
    """A line that is there, but on which an answer stops short: bytes were lost."""


class Unreadable(FormatError):
    """An answer that noise has made into something else; asked again, it may do."""


class ProfileBroken(LineBroken):
    """A line that broke in the middle of a profile.

    Attributes:
        heights: of the points that had arrived, from the first on [m].
        spacing: between them, as far as it is known [m].
    """

    def __init__(
        self, message: str, received: bytes, heights: FloatArray, spacing: float | None
    ) -> None:
        super().__init__(message, received)
        self.heights, self.spacing = heights, spacing


class ProfileSilent(ProfileBroken, LineSilent):
    """A profile that stops short on a line that is there."""
