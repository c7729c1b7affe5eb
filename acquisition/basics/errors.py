# SPDX-License-Identifier: MIT
"""The errors a user can meet: one base class, one name for each cause.

A message says what was wrong, the value met, the rule and the way out, in one line.
The command line turns a family into an exit code: `BadData` 3, `InstrumentError` 4.
"""


class JointbenchError(Exception):
    """Base of every error that jointbench raises on purpose."""


class BadData(JointbenchError):
    """A file, table or record that cannot be used as it is."""


class InstrumentError(JointbenchError):
    """An instrument that does not answer, refuses, or is lost."""


class UsageError(JointbenchError):
    """A request that makes no sense, whatever the data."""


class UnitError(BadData):
    """A unit that is missing, unknown, or of the wrong quantity."""


class FormatError(BadData):
    """A file that is not what it says it is, or is cut short."""


class HostileFile(BadData):
    """A file that asks for more than a measurement would: refused unread."""


class CorruptedFile(FormatError):
    """A file whose content is not what its own digest says."""


class SamplingError(BadData):
    """Time stamps that jump, run backwards, or do not match between channels."""


class ChannelMissing(BadData):
    """A recording without a channel of the quantity that was asked for."""


class NoHitFound(BadData):
    """No force sample reaches the trigger level."""


class NoModeFound(BadData):
    """No stable pole in the band."""


class ShapeError(ValueError, JointbenchError):
    """An array of the wrong shape, order or type was handed to a record."""
