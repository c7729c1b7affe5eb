# SPDX-License-Identifier: MIT
"""Measured bodies and links of a machine file with meshed bodies."""

from collections.abc import Mapping
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.structures.machine.measured_parts import (
    MachineLink,
    MeasuredPart,
)
from jointbench.analysis.structures.measured.coupled_measurements import frf_block
from jointbench.analysis.structures.measured.measured_frfs import fit_twice
from jointbench.signal.frf.frf import Frf
from jointbench.station.files.frf_files import read_frf
from jointbench.station.machine.measured_tables import (
    GROUND,
    BandedBodyTable,
    MeasuredBodyTable,
    MixedLinkTable,
)

_Position = tuple[float, float, float]


def read_body(name: str, one: MeasuredBodyTable, folder: Path) -> Frf:
    """Read the FRFs of a measured body.

    Raises:
        BadData: the files hold none.
    """
    options = FrfOptions(columns=one.columns, averages=one.averages)
    found = read_frf([folder / file for file in one.frfs], options)
    if found is None:
        raise BadData(f"the files of body {name!r} hold no FRFs; give FRFs of it alone")
    return found


def measured_parts(
    tables: Mapping[str, BandedBodyTable], folder: Path
) -> tuple[MeasuredPart, ...]:
    """Read and fit the bodies of a machine that were measured alone.

    Args:
        tables: by name.
        folder: of the files.
    """
    found = []
    for name, one in tables.items():
        block, labels = frf_block(name, read_body(name, one, folder))
        found.append(MeasuredPart(name, fit_twice(block, one.band), labels))
    return tuple(found)


def links_of(
    tables: Mapping[str, MixedLinkTable], bodies: list[str]
) -> tuple[MachineLink, ...]:
    """Return the links between measured bodies and others.

    Args:
        tables: by name.
        bodies: names of the modelled bodies.

    Raises:
        UsageError: a side is neither a point of a measured body nor a modelled one.
    """
    return tuple(_link(name, one, bodies) for name, one in tables.items())


def _link(name: str, one: MixedLinkTable, bodies: list[str]) -> MachineLink:
    first = _measured_side(name, one.between[0])
    text, position = one.between[1], one.position
    second: tuple[str, str] | None = None
    if text in bodies:
        if position is None:
            raise UsageError(f"link {name!r}: give its position on body {text!r}")
        second = (text, "")
    elif text != GROUND:
        second, position = _measured_side(name, text), None
    return MachineLink(
        name,
        first,
        second,
        position if text in bodies else None,
        one.direction,
        (one.stiffness,),
        (one.damping,),
        (one.stiffness_sd, one.damping_sd),
    )


def _measured_side(name: str, text: str) -> tuple[str, str]:
    body, colon, label = text.partition(":")
    if not colon:
        raise UsageError(
            f"link {name!r}: {text!r}; write body:point for the measured body first, "
            f"then another one, a modelled body or {GROUND!r}"
        )
    return body, label
