# SPDX-License-Identifier: MIT
"""The errors for users: one base class, one subclass for each cause.

A message states the problem, the value, the rule and the remedy, in one line. The
command line maps a family to an exit code: `BadData` 3, `InstrumentError` 4.
"""


class JointbenchError(Exception):
    """Base of every error that jointbench raises on purpose."""


class BadData(JointbenchError):
    """A file, table or record that cannot be used as it is."""


class InstrumentError(JointbenchError):
    """An instrument that does not answer, refuses, or is lost."""


class UsageError(JointbenchError):
    """A request that is invalid for any data."""


class UnitError(BadData):
    """A unit that is missing, unknown, or of the wrong quantity."""


class FormatError(BadData):
    """A file of another format than stated, or a truncated one."""


class HostileFile(BadData):
    """A file that claims more resources than a measurement: refused unread."""


class CorruptedFile(FormatError):
    """A file whose content does not match its digest."""


class SamplingError(BadData):
    """Time stamps that jump, run backwards, or do not match between channels."""


class ChannelMissing(BadData):
    """A recording without a channel of the requested quantity."""


class NoHitFound(BadData):
    """No force sample reaches the trigger level."""


class NoModeFound(BadData):
    """No stable pole in the band."""


class ShapeError(ValueError, JointbenchError):
    """An array of the wrong shape, order or type was passed to a record."""
