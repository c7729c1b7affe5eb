# SPDX-License-Identifier: MIT
"""Surfaces, joint setup and provenance as groups of a session file.

::

    /surfaces/<surface>  heights and valid on x (a profile) or on y, x (a map)
    /setup               preload, torque, masses and material, where stated
    /provenance          one row a step: whose it is, its name, its details as JSON
"""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.hdf5_layout import find_group
from jointbench.acquisition.file_access.memory_room import require_short_json
from jointbench.acquisition.file_access.netcdf_encodings import write_flags, write_texts
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_flags,
    read_texts,
    require_rows,
)
from jointbench.acquisition.file_access.netcdf_write import (
    write_attributes,
    write_axis,
    write_variable,
)
from jointbench.acquisition.records.provenance import Provenance, Step
from jointbench.acquisition.records.session import JointSetup, Session
from jointbench.acquisition.records.surfaces import (
    Areal,
    Profile,
    Surface,
    SurfaceInstrument,
)
from jointbench.acquisition.session_file.record_groups import (
    free_name,
    narrowest,
    number,
)

_OWNERS = ("session", "recording", "surface")
_INSTRUMENT_NUMBERS = (
    "stylus_radius",
    "numerical_aperture",
    "cutoff_short",
    "cutoff_long",
)
_Owner = tuple[str, str]


def write_surface(file: h5py.File, surface: Surface, position: int) -> None:
    """Write a profile or a map with its mask.

    Raises:
        BadData: it holds no points, or a text that cannot be stored.
    """
    if surface.heights.size == 0:
        raise BadData(f"surface {surface.name!r} holds no points; leave it out")
    surfaces = file.require_group("surfaces")
    group = surfaces.create_group(free_name(surface.name, surfaces))
    write_attributes(group, {"name": surface.name, "position": position})
    _write_instrument(group, surface.instrument)
    steps = surface.spacing if isinstance(surface, Areal) else (float(surface.spacing),)
    dims = ("y", "x")[-len(steps) :]
    for dim, size, spacing in zip(dims, surface.heights.shape, steps, strict=True):
        write_attributes(group, {f"spacing_{dim}": float(spacing)})
        words = f"place along {dim}"
        write_axis(group, dim, size, step=spacing, units="m", long_name=words)
    write_variable(
        group,
        "heights",
        narrowest(surface.heights),
        dims,
        units="m",
        long_name="height, without meaning where valid is 0",
        attributes={"ancillary_variables": "valid"},
    )
    write_flags(
        group,
        "valid",
        surface.valid,
        dims,
        meanings=("missing", "measured"),
        long_name="whether the point was measured",
    )


def surface_from_group(group: h5py.Group, provenance: Provenance) -> Surface:
    """Read a profile or a map, bit for bit as written."""
    common: dict[str, Any] = {
        "name": str(read_attribute(group, "name")),
        "heights": read_array(group["heights"]),
        "valid": np.asarray(group["valid"][...], dtype=np.bool_),
        "instrument": read_instrument(group),
        "provenance": provenance,
    }
    spacing = read_spacing(group)
    if len(spacing) == 1:
        return Profile(spacing=spacing[0], **common)
    return Areal(spacing=(spacing[0], spacing[1]), **common)


def read_spacing(group: h5py.Group) -> tuple[float, ...]:
    """Return the spacing of a stored surface [m]: of x, or of y and x."""
    dims = ("y", "x") if "spacing_y" in group.attrs else ("x",)
    return tuple(float(number(group, f"spacing_{dim}")) for dim in dims)


def read_instrument(group: h5py.Group) -> SurfaceInstrument:
    """Return the stored data of the instrument of a surface."""
    numbers = {
        key: float(number(group, key))
        for key in _INSTRUMENT_NUMBERS
        if key in group.attrs
    }
    return SurfaceInstrument(name=str(read_attribute(group, "instrument")), **numbers)


def _write_instrument(group: h5py.Group, instrument: SurfaceInstrument) -> None:
    write_attributes(group, {"instrument": instrument.name})
    for key in _INSTRUMENT_NUMBERS:
        value = getattr(instrument, key)
        write_attributes(group, {key: None if value is None else float(value)})


def write_setup(file: h5py.File, joint: JointSetup | None) -> None:
    """Write the set-up of the joint; nothing if not given."""
    if joint is None:
        return
    group = file.create_group("setup")
    for name, value, units, words in (
        ("preload", joint.preload, "N", "normal force that clamps the joint"),
        ("torque", joint.torque, "N m", "tightening torque of each bolt"),
    ):
        if value is not None:
            write_variable(group, name, float(value), (), units=units, long_name=words)
    _write_mapping(group, "body", "mass", joint.masses, "kg")
    _write_mapping(group, "property", "material", joint.material, None)


def read_setup(file: h5py.File) -> JointSetup | None:
    """Return the set-up of the joint, or None if not given."""
    group = find_group(file, "setup")
    if group is None:
        return None
    return JointSetup(
        preload=float(group["preload"][()]) if "preload" in group else None,
        torque=float(group["torque"][()]) if "torque" in group else None,
        masses=_read_mapping(group, "body", "mass"),
        material=_read_mapping(group, "property", "material"),
    )


def _write_mapping(
    group: h5py.Group,
    dim: str,
    name: str,
    values: Mapping[str, float],
    units: str | None,
) -> None:
    if values:
        words = f"{dim} that {name} belongs to"
        write_texts(group, f"{dim}_name", list(values), dim, long_name=words)
        numbers = [float(value) for value in values.values()]
        words = f"{name} of each {dim}, in SI"
        write_variable(group, name, numbers, (dim,), units=units, long_name=words)


def _read_mapping(group: h5py.Group, dim: str, name: str) -> dict[str, float]:
    if name not in group:
        return {}
    names = read_texts(group[f"{dim}_name"])
    return dict(zip(names, read_array(group[name]).tolist(), strict=True))


def write_provenance(file: h5py.File, session: Session) -> None:
    """Write the steps of the session, its recordings and its surfaces as one table."""
    rows = list(_all_steps(session))
    if not rows:
        return
    group = file.create_group("provenance")
    write_flags(
        group,
        "owner_kind",
        [_OWNERS.index(owner[0]) for owner, _ in rows],
        ("step",),
        meanings=_OWNERS,
        long_name="what the step belongs to",
    )
    for name, long_name, texts in (
        ("owner", "name of what it belongs to", [owner[1] for owner, _ in rows]),
        ("step_name", "what was done", [step.name for _, step in rows]),
        ("detail", "parameters and reasons, JSON", [_detail(step) for _, step in rows]),
    ):
        write_texts(group, name, texts, "step", long_name=long_name)


def read_provenance(file: h5py.File) -> dict[_Owner, Provenance]:
    """Return the steps by their owner, for example ("recording", "hit 1").

    Raises:
        FormatError: the details are not those of `write_provenance`.
    """
    group = find_group(file, "provenance")
    if group is None:
        return {}
    steps: dict[_Owner, list[Step]] = {}
    require_rows(group["owner_kind"])
    details = read_texts(group["detail"])
    require_short_json(*details)
    for kind, owner, name, detail in zip(
        read_flags(group["owner_kind"]),
        read_texts(group["owner"]),
        read_texts(group["step_name"]),
        details,
        strict=True,
    ):
        steps.setdefault((kind, owner), []).append(Step(name, _parse_detail(detail)))
    return {owner: tuple(found) for owner, found in steps.items()}


def _all_steps(session: Session) -> Iterator[tuple[_Owner, Step]]:
    for step in session.provenance:
        yield ("session", ""), step
    for recording in session.recordings:
        for step in recording.provenance:
            yield ("recording", recording.name), step
    for surface in session.surfaces:
        for step in surface.provenance:
            yield ("surface", surface.name), step


def _detail(step: Step) -> str:
    """Return details as a JSON list of pairs, which keeps their order and types."""
    pairs = [[key, _plain(value)] for key, value in step.detail]
    text = json.dumps(pairs, ensure_ascii=False)
    if any("\ud800" <= letter <= "\udfff" for letter in text):
        # Half a pair of a foreign terminal is no Unicode; a session never ends for it.
        return json.dumps(pairs)
    return text


def _plain(value: str | float | int | bool) -> str | float | int | bool:
    plain: str | float | int | bool = (
        value.item() if isinstance(value, np.generic) else value
    )
    return plain


def _parse_detail(text: str) -> tuple[tuple[str, str | float | int | bool], ...]:
    pairs = json.loads(text)
    if not isinstance(pairs, list) or not all(
        isinstance(pair, list)
        and len(pair) == 2
        and isinstance(pair[0], str)
        and isinstance(pair[1], str | int | float)
        for pair in pairs
    ):
        raise FormatError("a step of the provenance is not a list of names and values")
    return tuple((key, value) for key, value in pairs)
