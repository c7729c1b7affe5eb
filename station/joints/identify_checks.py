# SPDX-License-Identifier: MIT
"""What a structure model asks for, checked before anything slow.

Modes of sessions and the reduction of a structure take minutes; wrong names do not.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.identification.stiffness_problem import Prior
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import (
    is_modulus,
    modulus_name,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.rigid_motions import (
    joint_strains,
    unstrained,
    unstrained_bodies,
)
from jointbench.analysis.structures.reduction.structure_bodies import body_ranges
from jointbench.station.joints.structure_model import (
    StructureModel,
    masses_of,
    sensors_of,
)
from jointbench.station.joints.structure_states import (
    MEASURED_LABEL,
    MeasuredState,
    require_named,
)
from jointbench.station.joints.structure_tables import IdentifyTable

SPARE_MODES = 4
"""Predicted modes beyond the measured ones, so that each finds its partner."""


def check_request(
    settings: StructureModel, structure: Structure, sessions: Sequence[object]
) -> None:
    """Check what [identify] names, before sessions are read.

    Raises:
        BadData: a direction, body or sensor does not exist, or a direction is neither
            sought nor known.
        UsageError: there is no measurement, or the box is empty.
    """
    table = settings.identify
    if not sessions and settings.measured is None:
        raise UsageError(
            "no measurement: give a session, or a table [measured] in the model"
        )
    low, high = table.stiffness_box
    if not 0 < low < high:
        raise UsageError(
            f"identify.stiffness_box is from {low:g} to {high:g} N/m; give a low end "
            'above zero and below the high one, e.g. ["1 MN/m", "100 GN/m"]'
        )
    names = structure.parameter_names
    bodies = tuple(one.name for one in body_ranges(structure))
    moduli = tuple(map(modulus_name, table.modulus_sd))
    masses = tuple(masses_of(settings))
    _require("sought", table.sought or (), names)
    _require("shared", table.shared, (*names, *moduli))
    _require("priors", tuple(table.priors), names)
    _require("modulus_sd", tuple(table.modulus_sd), bodies)
    _require("mass_sd", tuple(table.mass_sd), masses)
    known_values(table, names)
    known_priors(table)


def check_measured(
    settings: StructureModel,
    structure: Structure,
    measured: Mapping[str, MeasuredState],
) -> None:
    """Check the modes and channels of sessions, before the structure is reduced.

    Raises:
        BadData: more modes were measured than are predicted, or a channel has no place.
    """
    if settings.identify.data != "frequencies":
        for state in measured.values():
            frf = state.chain.frf
            require_named(frf.outputs, sensors_of(settings.sensors), "sensors")
            if settings.identify.data == "frf":
                hits = {**sensors_of(settings.sensors), **sensors_of(settings.hits)}
                require_named(frf.inputs, hits, "hits")
    asked = settings.identify.modes
    if asked is None:
        return
    rigid = _rigid_count(structure)
    for label, count in mode_counts(settings, measured).items():
        if count > asked - rigid and not _frf_alone(settings, label):
            raise BadData(
                f"identify.modes is {asked}, {rigid} of them rigid, but {count} modes "
                f"of {label!r} were measured; leave identify.modes out, or write "
                f"modes = {rigid + count + SPARE_MODES}, or measure fewer with --band"
            )


def mode_counts(
    settings: StructureModel, measured: Mapping[str, MeasuredState]
) -> dict[str, int]:
    """Return the number of measured modes of each state."""
    counts = {
        label: int(state.chain.result.model.natural_frequency.size)
        for label, state in measured.items()
    }
    if settings.measured is not None:
        counts[MEASURED_LABEL] = len(settings.measured.frequencies)
    return counts


def known_values(table: IdentifyTable, names: Sequence[str]) -> JointValues | None:
    """Return the stiffness of the directions that are not sought, undamped.

    Args:
        table: of the model.
        names: of the parameters, with or without those of moduli.

    Raises:
        BadData: one of them is not given, or a name does not exist.
    """
    if table.sought is None and not table.known:
        return None
    for name in table.known:
        if name not in names or name in (table.sought or names):
            raise BadData(
                f"identify.known: {name!r} is no joint direction that is left out of "
                f"identify.sought; there are {list(names)}"
            )
    open_ = {*(table.sought or names), *table.known}
    left = [n for n in names if n not in open_ and not is_modulus(n)]
    if left:
        values = ", ".join(f'"{name}" = "500 MN/m"' for name in left)
        raise BadData(
            f"{left} are neither sought nor known; add them to identify.sought, or "
            f"give their stiffness, for example known = {{ {values} }}"
        )
    stiffness = np.array([table.known.get(name, 1.0) for name in names])
    return JointValues(stiffness, np.zeros(len(names)))


def known_priors(table: IdentifyTable) -> dict[str, Prior]:
    """Return the priors of joints and of moduli by the name of the parameter."""
    joints = {name: Prior(*one) for name, one in table.priors.items()}
    moduli = {modulus_name(n): Prior(1.0, sd) for n, sd in table.modulus_sd.items()}
    return joints | moduli


def _require(key: str, given: Sequence[str], known: Sequence[str]) -> None:
    """Refuse names that do not exist."""
    for name in given:
        if name not in known:
            raise BadData(
                f"identify.{key}: there is no {name!r}; write one of {list(known)}"
            )


def _frf_alone(settings: StructureModel, label: str) -> bool:
    return settings.identify.data == "frf" and label != MEASURED_LABEL


def _rigid_count(structure: Structure) -> int:
    """Return the number of motions without strain if no joint is at zero."""
    strains = joint_strains(structure, unstrained_bodies(structure))
    return unstrained(strains, np.ones(len(structure.spread), bool))[1]
