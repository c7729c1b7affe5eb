# SPDX-License-Identifier: MIT
"""What a serial instrument is: a record that each driver makes of itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from jointbench.acquisition.basics.errors import ShapeError
from jointbench.acquisition.records.surfaces import Profile
from jointbench.acquisition.serial_lines.line import Line

Answer = Callable[[bytes], tuple[int, bytes] | None]
"""From bytes received to how many of them were used and what is sent back; None while
the request is not whole."""


@dataclass(frozen=True, slots=True)
class Reading:
    """One reading.

    Attributes:
        value: in SI [N m or N].
        kind: ``"torque"`` or ``"force"``.
        raw: as the instrument sent it.
    """

    value: float
    kind: str
    raw: str


@dataclass(frozen=True, slots=True)
class ProfileOptions:
    """What the user says about the profile that is fetched.

    Attributes:
        name: of the profile.
        traverse: length that was traced [m], None if not given.
        filtered: the roughness profile instead of the one as traced.
        signed: whether heights are signed.
    """

    name: str
    traverse: float | None = None
    filtered: bool = False
    signed: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class SerialInstrument:
    """One instrument on a serial line: a torque tester, a roughness tester, or both.

    Attributes:
        name: one word, as in plans and commands.
        title: name in messages.
        baud: bits per second of its line, unless the user says otherwise.
        read_torque: returns what a torque tester shows; None where it is none.
        read_profile: returns the last profile of a roughness tester; None where it is
            none. A profile that breaks off is a `ProfileBroken`.
        needs_traverse: whether the user must say the length of a profile.
        simulate: returns the answers of a simulated instrument, opened as
            ``sim:NAME?key=value``, from the keys and values; raises `UsageError` for
            an unknown key. None where there is no simulator, or `simulators` has it.
    """

    name: str
    title: str
    baud: int
    read_torque: Callable[[Line], Reading] | None = None
    read_profile: Callable[[Line, ProfileOptions], Profile] | None = None
    needs_traverse: bool = False
    simulate: Callable[[Mapping[str, str]], Answer] | None = None

    def __post_init__(self) -> None:
        """Refuse an instrument that measures nothing."""
        if self.read_torque is None and self.read_profile is None:
            raise ShapeError(
                f"instrument {self.name!r} has neither read_torque nor read_profile; "
                "give one"
            )
