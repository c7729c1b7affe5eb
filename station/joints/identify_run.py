# SPDX-License-Identifier: MIT
"""The joints of a meshed structure from sessions: the work, without the output."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.analysis.contact.surface import ContactSurface
from jointbench.analysis.contact.torque_to_preload import Preload
from jointbench.analysis.structures.identification.identify_structure import (
    StructureSearch,
    identify_structure,
)
from jointbench.analysis.structures.identification.joint_result import (
    StructureIdentification,
)
from jointbench.analysis.structures.identification.sensor_masses import (
    SensorMasses,
    sensor_masses,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.identification.weigh_hypotheses import (
    StateHypotheses,
    weigh_hypotheses,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.body_moduli import with_moduli
from jointbench.analysis.structures.reduction.mounted_sensors import (
    MountedSensor,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import ReducedModel
from jointbench.analysis.structures.reduction.reduction_cache import cached, content_key
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.contact_comparison import (
    against_theory,
    identified_states,
    known_preloads,
)
from jointbench.station.joints.identify_checks import (
    SPARE_MODES,
    check_measured,
    check_request,
    known_priors,
    known_values,
    mode_counts,
)
from jointbench.station.joints.structure_contact import joint_of, theory_surface
from jointbench.station.joints.structure_model import (
    StructureModel,
    masses_of,
    sensors_of,
    structure_of,
)
from jointbench.station.joints.structure_states import (
    MEASURED_LABEL,
    MeasuredState,
    all_evidence,
    measured_states,
)
from jointbench.station.joints.theory_records import TheoryRow
from jointbench.station.screen.terminal import working

RIGID_MODES = 6


@dataclass(frozen=True, slots=True, eq=False)
class IdentifiedStructure:
    """A structure with its identified joints.

    Attributes:
        structure: bodies and joints on their meshes.
        reduced: the same in few coordinates.
        result: parameters with intervals, solutions and checks.
        measured: what the sessions say, by state.
        theory: each joint beside the contact law; empty without a table [contact].
        hypotheses: what else could explain each state; empty if not asked for.
    """

    structure: Structure
    reduced: ReducedModel
    result: StructureIdentification
    measured: Mapping[str, MeasuredState]
    theory: tuple[TheoryRow, ...]
    hypotheses: tuple[StateHypotheses, ...] = ()


def identified_structure(
    model: Path,
    sessions: Sequence[Path],
    *,
    band: str | None = None,
    cache: Path | None = None,
    surfaces: Sequence[Path] = (),
    options: FrfOptions | None = None,
    search: StructureSearch | None = None,
) -> IdentifiedStructure:
    """Identify the joints of a structure.

    With a table [contact] they are compared with the contact law.

    Args:
        model: the structure as TOML.
        sessions: measured, or files of FRFs; none where the model names measured modes.
        band: of the modes, as typed.
        cache: folder that keeps reduced models.
        surfaces: files of the contact surfaces.
        options: what the user states about files that are no sessions.
        search: settings, None for the defaults; masses of sensors are those of the
            model.

    Raises:
        BadData: the model or a session cannot be used.
        UsageError: a request that cannot be met.
    """
    settings = read_toml(model, StructureModel)
    with working("meshing"):
        structure = structure_of(settings, model.parent)
    check_request(settings, structure, sessions)
    surface = _surface(settings, model, surfaces, sessions)
    band = band or settings.identify.band_words
    measured = measured_states(sessions, band, options or FrfOptions())
    check_measured(settings, structure, measured)
    preloads = _preloads(settings, measured)
    sensors = {**sensors_of(settings.hits), **sensors_of(settings.sensors)}
    with working("reducing, identifying joints"):
        reduced = _reduced(structure, settings, measured, sensors, cache)
        evidence = all_evidence(structure, reduced, settings, measured)
        result = identify_structure(
            reduced,
            evidence,
            known=known_values(settings.identify, reduced.names),
            sought=settings.identify.sought,
            shared=settings.identify.shared,
            priors=known_priors(settings.identify),
            search=replace(
                search or StructureSearch(),
                masses=_masses(settings, structure, reduced),
            ),
            structure=structure,
        )
    rows = _theory(settings, surface, preloads, result)
    tried = _hypotheses(settings, structure, reduced, evidence, result)
    return IdentifiedStructure(structure, reduced, result, measured, rows, tried)


def _hypotheses(
    settings: StructureModel,
    structure: Structure,
    reduced: ReducedModel,
    evidence: Sequence[StructureEvidence],
    result: StructureIdentification,
) -> tuple[StateHypotheses, ...]:
    """Try what else could explain the measurement, unless the model says not to."""
    table = settings.identify
    if not table.hypotheses:
        return ()
    with working("trying hypotheses"):
        return weigh_hypotheses(
            reduced,
            evidence,
            known=known_values(table, reduced.names),
            sought=table.sought,
            priors=known_priors(table),
            structure=structure,
            start=result.solutions[0].parameters,
        )


def _surface(
    settings: StructureModel,
    model: Path,
    surfaces: Sequence[Path],
    sessions: Sequence[Path],
) -> ContactSurface | None:
    """Return the contact surface where the model has a table [contact]."""
    if settings.contact is None:
        if surfaces:
            raise UsageError(
                "--surface needs a table [contact] in the model: modulus, hardness and "
                "the joint with these surfaces"
            )
        return None
    with working("fitting surfaces"):
        return theory_surface(
            settings.contact, model.parent, list(surfaces), list(sessions)
        )


def _preloads(
    settings: StructureModel, measured: dict[str, MeasuredState]
) -> dict[str, Preload]:
    """Return the preload of each state where the model has a table [contact]."""
    if settings.contact is None:
        return {}
    found: dict[str, tuple[float | None, float | None]] = {}
    if settings.measured is not None:
        found[MEASURED_LABEL] = None, None
    for label, state in measured.items():
        found[label] = state.preload, state.preload_sd
    return known_preloads(settings.contact, found)


def _theory(
    settings: StructureModel,
    surface: ContactSurface | None,
    preloads: dict[str, Preload],
    result: StructureIdentification,
) -> tuple[TheoryRow, ...]:
    table, joints = settings.contact, settings.parametric_joints
    if table is None or surface is None:
        return ()
    states = identified_states(result, joint_of(table, joints), preloads, joints)
    return against_theory(states, surface, table)


def _reduced(
    structure: Structure,
    settings: StructureModel,
    measured: dict[str, MeasuredState],
    sensors: dict[str, MountedSensor],
    cache: Path | None,
) -> ReducedModel:
    most = max(mode_counts(settings, measured).values())
    modes = settings.identify.modes or RIGID_MODES + most + SPARE_MODES
    box = settings.identify.stiffness_box
    loads = sensor_rows(structure, list(sensors.values())) if sensors else None
    key = content_key(structure, modes, box, sorted(map(repr, sensors.values())))
    model = cached(
        cache,
        key,
        lambda: reduce_structure(structure, modes=modes, box=box, loads=loads),
    )
    return with_moduli(model, list(settings.identify.modulus_sd))


def _masses(
    settings: StructureModel, structure: Structure, reduced: ReducedModel
) -> SensorMasses | None:
    """Return the masses of sensors that are unknown."""
    unknown = settings.identify.mass_sd
    if not unknown:
        return None
    return sensor_masses(structure, reduced, masses_of(settings), unknown)
