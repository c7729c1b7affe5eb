# SPDX-License-Identifier: MIT
"""Description of a file as plain data, for users and for JSON; samples are not read."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.hdf5_layout import (
    dimension_names,
    is_dimension_only,
)
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import Hit
from jointbench.acquisition.session_file.record_groups import in_order, number
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import SESSION_SCHEMA, damage_named
from jointbench.acquisition.session_file.streams import (
    read_channels,
    read_hits,
    read_preload,
)
from jointbench.acquisition.session_file.surfaces_and_setup import (
    read_instrument,
    read_provenance,
    read_setup,
    read_spacing,
)

Description = dict[str, object]


def describe_file(path: Path | str) -> Description:
    """Describe the content of a session file, a results file or another HDF5 file.

    Args:
        path: of the file.

    Returns:
        Plain data that JSON can hold (numbers that are not finite become None).
        Always: ``file``, ``schema``, ``attributes``. A session has ``uuid``,
        ``created``, ``software``, ``simulated``, ``operator``, ``notes``, ``source``,
        ``joint``, ``recordings``, ``surfaces`` and ``provenance``; any other file has
        ``groups`` with their variables, dimensions and units.

    Raises:
        BadData: it cannot be opened, is damaged, or exceeds the limits of a
            measurement.
    """
    with open_guarded(path, limits=SESSION_LIMITS) as file, damage_named(path):
        found: Description = {
            "file": Path(path).name,
            "schema": read_attribute(file, "schema"),
            "attributes": _attributes(file),
        }
        if found["schema"] == SESSION_SCHEMA:
            found |= _session(file)
        else:
            found["groups"] = list(_groups(file))
    return {key: _plain(value) for key, value in found.items()}


def _session(file: h5py.File) -> Description:
    joint = read_setup(file)
    texts = ("uuid", "created", "software", "operator", "notes", "source")
    return {
        **{name: read_attribute(file, name) for name in texts},
        "simulated": bool(read_attribute(file, "simulated")),
        "joint": None
        if joint is None
        else {
            "preload_n": joint.preload,
            "torque_n_m": joint.torque,
            "masses_kg": dict(joint.masses),
            "material_si": dict(joint.material),
        },
        "recordings": [_recording(file, g) for g in in_order(file, "stream")],
        "surfaces": [_surface(group) for group in in_order(file, "surfaces")],
        "provenance": [
            {"of": kind, "name": name, **step}
            for (kind, name), steps in read_provenance(file).items()
            for step in _steps(steps)
        ],
    }


def _recording(file: h5py.File, group: h5py.Group) -> Description:
    rate = number(group, "sample_rate")
    start = number(group, "start_time")
    channels = read_channels(group)
    samples = _count_samples(group, len(channels), rate, start)
    hits = read_hits(file, group)
    verdicts = [hit.verdict.value for hit in hits]
    return {
        "name": read_attribute(group, "name"),
        "group": group.name,
        "sample_rate_hz": rate,
        "samples": samples,
        "duration_s": samples / rate,
        "start_time_s": start,
        "preload_n": read_preload(group),
        "preload_sd_n": read_preload(group, "preload_sd"),
        "channels": [
            {
                "name": channel.name,
                "quantity": channel.quantity.value,
                "point": channel.point,
                "direction": channel.direction,
                "unit": channel.unit,
                "si_unit": example_unit(channel.quantity),
                "sensitivity_v_per_si": channel.sensitivity,
                "range_si": channel.range,
            }
            for channel in channels
        ],
        "verdicts": {word: verdicts.count(word) for word in dict.fromkeys(verdicts)},
        "hits": [_hit(hit, rate, start) for hit in hits],
    }


def _count_samples(
    group: h5py.Group, n_channels: int, rate: float, start: float
) -> int:
    """Return the samples per channel, after the checks of `read_session`."""
    if not (math.isfinite(rate) and rate > 0 and math.isfinite(start)):
        raise FormatError(
            f"{group.name!r} is damaged: sample_rate is {rate:g} Hz and start_time "
            f"{start:g} s, a rate must be finite and positive, a time finite"
        )
    samples = group["samples"]
    whole = isinstance(samples, h5py.Dataset) and samples.dtype.kind in "fiu"
    if not whole or samples.ndim != 2 or samples.shape[0] != n_channels:
        raise FormatError(
            f"{group.name!r} is damaged: its samples must be real numbers of shape "
            f"({n_channels}, n), one row per channel"
        )
    return int(samples.shape[1])


def _hit(hit: Hit, rate: float, start: float) -> Description:
    return {
        "time_s": start + hit.trigger / rate,
        "start": hit.start,
        "trigger": hit.trigger,
        "stop": hit.stop,
        "point": hit.point,
        "peak_force_n": hit.peak_force,
        "verdict": hit.verdict.value,
        "measure": hit.measure,
        "reason": hit.reason,
        "temperature_degc": hit.temperature,
    }


def _surface(group: h5py.Group) -> Description:
    instrument = read_instrument(group)
    heights = group["heights"]
    valid = np.asarray(group["valid"][...], dtype=np.bool_)
    return {
        "name": read_attribute(group, "name"),
        "group": group.name,
        "kind": "profile" if heights.ndim == 1 else "areal",
        "shape": list(heights.shape),
        "spacing_m": list(read_spacing(group)),
        "points": int(valid.size),
        "missing": int(valid.size - np.count_nonzero(valid)),
        "instrument": {
            "name": instrument.name,
            "stylus_radius_m": instrument.stylus_radius,
            "numerical_aperture": instrument.numerical_aperture,
            "cutoff_short_m": instrument.cutoff_short,
            "cutoff_long_m": instrument.cutoff_long,
        },
    }


def _steps(steps: Provenance) -> Iterator[Description]:
    for step in steps:
        yield {"step": step.name, "detail": dict(step.detail)}


def _groups(group: h5py.Group) -> Iterator[Description]:
    """Yield each group that holds variables or attributes, the root first."""
    children = [group[key] for key in group]
    variables = [
        _variable(child)
        for child in children
        if isinstance(child, h5py.Dataset) and not is_dimension_only(child)
    ]
    attributes = {} if group.name == "/" else _attributes(group)
    if variables or attributes:
        yield {"group": group.name, "attributes": attributes, "variables": variables}
    for child in children:
        if isinstance(child, h5py.Group):
            yield from _groups(child)


def _variable(dataset: h5py.Dataset) -> Description:
    described: Description = {
        "name": str(dataset.name).rsplit("/", 1)[-1],
        "dims": list(dimension_names(dataset)),
        "shape": list(dataset.shape),
        "type": str(dataset.dtype),
        "units": read_attribute(dataset, "units"),
        "long_name": read_attribute(dataset, "long_name"),
    }
    if dataset.ndim == 0 and dataset.dtype.kind in "fiu":
        described["value"] = dataset[()].item()
    return described


def _attributes(target: h5py.Group) -> Description:
    found = {name: read_attribute(target, name) for name in target.attrs}
    return {name: value for name, value in found.items() if value is not None}


def _plain(value: Any) -> object:
    """Return data that strict JSON can hold."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
