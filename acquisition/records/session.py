# SPDX-License-Identifier: MIT
"""A session: everything that one visit to the bench recorded, and nothing computed."""

import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.errors import ShapeError
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.surfaces import Surface


@dataclass(frozen=True, slots=True)
class JointSetup:
    """How the joint under test was set up; None and empty where nobody said.

    Attributes:
        preload: normal force that clamps the joint [N].
        torque: tightening torque of each bolt [N m].
        material: properties by name, in SI: ``{"youngs_modulus": 2.06e11}``.
        masses: mass of each body by its name [kg].
    """

    preload: float | None = None
    torque: float | None = None
    material: Mapping[str, float] = field(default_factory=dict)
    masses: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the masses and keep copies that no caller holds."""
        for name, mass in self.masses.items():
            require_positive(f"mass of {name}", mass)
        object.__setattr__(self, "material", dict(self.material))
        object.__setattr__(self, "masses", dict(self.masses))


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """Recordings and surfaces of one session, as recorded or imported.

    Attributes:
        uuid: unique name of the session.
        created: time of its making, ISO 8601 in UTC.
        software: name and version of the program that made it.
        simulated: True where no hardware was behind it.
        operator: who measured; empty if not stated.
        notes: free text.
        source: what the samples came from, for example ``"sim:two-body?seed=1"``.
        joint: how the joint was set up, or None.
        recordings: in the order recorded, names unique.
        surfaces: profiles and maps of the joint's faces, names unique.
        provenance: how the session came about.
    """

    uuid: str
    created: str
    software: str
    simulated: bool
    operator: str = ""
    notes: str = ""
    source: str = ""
    joint: JointSetup | None = None
    recordings: tuple[Recording, ...] = ()
    surfaces: tuple[Surface, ...] = ()
    provenance: Provenance = ()

    def __post_init__(self) -> None:
        """Check that every name is there once."""
        for what, records in (
            ("recording", self.recordings),
            ("surface", self.surfaces),
        ):
            names = [record.name for record in records]
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice or "" in names:
                raise ShapeError(
                    f"each {what} of a session needs a name of its own, got "
                    f"{twice[0] if twice else ''!r} {'twice' if twice else ''}".rstrip()
                )


def new_session(
    *,
    source: str,
    simulated: bool,
    recordings: Sequence[Recording] = (),
    surfaces: Sequence[Surface] = (),
    joint: JointSetup | None = None,
    operator: str = "",
    notes: str = "",
    provenance: Provenance = (),
) -> Session:
    """Make a session of now, with a name of its own and this program's version.

    Args:
        source: what the samples came from.
        simulated: True where no hardware was behind it.
        recordings: names unique.
        surfaces: names unique.
        joint: how the joint was set up.
        operator: who measured.
        notes: free text.
        provenance: how the session came about.
    """
    return Session(
        uuid=str(uuid.uuid4()),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        software=software_version(),
        simulated=simulated,
        operator=operator,
        notes=notes,
        source=source,
        joint=joint,
        recordings=tuple(recordings),
        surfaces=tuple(surfaces),
        provenance=provenance,
    )


def software_version() -> str:
    """Return name and version of this program, as files state it."""
    try:
        return f"jointbench {version('jointbench')}"
    except PackageNotFoundError:  # run from a checkout that was never installed
        return "jointbench (not installed)"
