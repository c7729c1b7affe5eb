# SPDX-License-Identifier: MIT
"""A session: all raw data of one measurement, without computed results."""

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
    """Set-up of the joint under test; None or empty where not given.

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
        """Check the masses and keep private copies."""
        for name, mass in self.masses.items():
            require_positive(f"mass of {name}", mass)
        object.__setattr__(self, "material", dict(self.material))
        object.__setattr__(self, "masses", dict(self.masses))


@dataclass(frozen=True, slots=True, eq=False)
class Session:
    """Recordings and surfaces of one session, as recorded or imported.

    Attributes:
        uuid: unique name of the session.
        created: time of creation, ISO 8601 in UTC.
        software: name and version of the program that created it.
        simulated: True for simulated hardware.
        operator: name of the person; empty if not stated.
        notes: free text.
        source: of the samples, for example ``"sim:two-body?seed=1"``.
        joint: set-up of the joint, or None.
        recordings: in the order recorded, names unique.
        surfaces: profiles and maps of the joint's contact surfaces, names unique.
        provenance: origin and processing steps.
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
        """Check that every name is unique."""
        for what, records in (
            ("recording", self.recordings),
            ("surface", self.surfaces),
        ):
            names = [record.name for record in records]
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice or "" in names:
                raise ShapeError(
                    f"each {what} of a session needs a unique name, got "
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
    """Create a session with the current time, a unique name and this program's version.

    Args:
        source: of the samples.
        simulated: True for simulated hardware.
        recordings: names unique.
        surfaces: names unique.
        joint: set-up of the joint.
        operator: name of the person.
        notes: free text.
        provenance: origin and processing steps.
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
    """Return name and version of this program, for files."""
    try:
        return f"jointbench {version('jointbench')}"
    except PackageNotFoundError:  # run from a checkout that was never installed
        return "jointbench (not installed)"
