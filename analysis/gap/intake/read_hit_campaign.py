# SPDX-License-Identifier: MIT
"""Read `campaign/1` files: raw hits on bolted bodies, with modes of the free bodies."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.quoting import named, shown, visible
from jointbench.analysis.gap.intake.filter_hits import RawHit, RawHits, filter_hits
from jointbench.analysis.gap.intake.free_modes import PlannedPoint, read_bodies
from jointbench.analysis.gap.intake.intake_settings import HITS
from jointbench.analysis.gap.intake.typed_hdf5 import (
    finite_array,
    finite_number,
    positive_number,
    require_group,
)
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.jointed_bodies import NominalBench

HIT_SCHEMA = "campaign/1"
FORCE, ACCELERATION = "force", "acceleration"


@dataclass(frozen=True, slots=True)
class RawChannel:
    """One row of the data.

    Attributes:
        name: of the channel.
        quantity: force or acceleration.
        volts: per count [V].
        sensitivity: [V per unit].
        body: index of the body that it sits on.
        position: [m], or None for the hammer.
        direction: unit vector, or None for the hammer.
    """

    name: str
    quantity: str
    volts: float
    sensitivity: float
    body: int
    position: tuple[float, ...] | None
    direction: tuple[float, ...] | None


def read_hit_campaign(
    path: Path, nominal: NominalBench, points: dict[str, PlannedPoint]
) -> HitCampaign:
    """Read a campaign of hits on bolted bodies.

    Args:
        path: HDF5 file of schema ``campaign/1``.
        nominal: nominal parameters.
        points: hammer points by name.

    Raises:
        FormatError: the file has another format, or a part is missing or malformed.
        HostileFile: the file claims more records or samples than a campaign can have.
        BadData: a sample is not finite, or too few hits can be used.
    """
    with open_guarded(path) as file, _complete(path):
        return _campaign(path, file, nominal, points)


def read_raw_hits(
    path: Path, points: Sequence[str]
) -> tuple[RawHits, tuple[RawChannel, ...]]:
    """Read the raw hits of a campaign, without the modal tables.

    Args:
        path: HDF5 file of schema ``campaign/1``.
        points: names of the hammer points, in the order of the model.

    Returns:
        The hits, and the rows of their data: the hammer first.

    Raises:
        FormatError: the file has another format, or a part is missing or malformed.
        HostileFile: the file claims more records or samples than a campaign can have.
        BadData: a sample is not finite.
    """
    with open_guarded(path) as file, _complete(path):
        channels = _channels(named(path), file)
        return _raw_hits(named(path), file, channels, tuple(points)), channels


@contextmanager
def _complete(path: Path) -> Iterator[None]:
    """Turn what a damaged file causes into one line that names it."""
    try:
        yield
    except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise FormatError(
            f"{named(path)} cannot be read as {HIT_SCHEMA} ({shown(error)}); "
            "give a complete campaign file"
        ) from error


def _campaign(
    path: Path,
    file: h5py.File,
    nominal: NominalBench,
    points: dict[str, PlannedPoint],
) -> HitCampaign:
    where = named(path)
    schema = read_attribute(file, "schema")
    if schema != HIT_SCHEMA:
        raise FormatError(
            f"{where} has schema {shown(schema or 'none')}, not {HIT_SCHEMA!r}; "
            "`jointbench inspect` shows its contents"
        )
    channels = _channels(where, file)
    raw = _raw_hits(where, file, channels, tuple(points))
    sensors = [(c.name, c.body, c.position, c.direction) for c in channels[1:]]
    rigid = np.isinf(nominal.stiffness)
    bodies = read_bodies(where, file, sensors, points, rigid)
    highest = HITS.band_of_table * float(bodies.omega.max()) / (2 * np.pi)
    hits = filter_hits(raw, highest)
    return HitCampaign(path.stem, bodies, nominal, hits)


def _channels(where: str, file: h5py.File) -> tuple[RawChannel, ...]:
    """Return the rows of the data: the hammer first, then accelerometers."""
    text = read_attribute(file, "channels")
    try:
        listed = json.loads(str(text))
    except (ValueError, RecursionError) as error:
        raise FormatError(
            f"{where} has no 'channels' that is JSON ({shown(error)}); give a complete "
            "campaign file"
        ) from error
    if not isinstance(listed, list) or not 2 <= len(listed) <= HITS.most_channels:
        raise FormatError(
            f"{where} has 'channels' of {shown(text)}, a list of 2 to "
            f"{HITS.most_channels} channels is required; write one entry for each row"
        )
    found = tuple(_channel(where, k, one) for k, one in enumerate(listed))
    kinds = [c.quantity for c in found]
    if kinds[0] != FORCE or any(kind != ACCELERATION for kind in kinds[1:]):
        raise FormatError(
            f"{where} has channels of {shown(', '.join(kinds))}; the first row must be "
            f"{FORCE!r}, every other one {ACCELERATION!r}"
        )
    names = [c.name for c in found]
    if len(set(names)) < len(names):
        raise FormatError(f"{where} names a channel twice; give each a name of its own")
    return found


def _channel(where: str, index: int, entry: Any) -> RawChannel:
    if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
        raise FormatError(
            f"{where} has channel {index} of {shown(entry)}, an object with a 'name' "
            "is required; write one object for each row"
        )
    place = f"{where} channel {visible(entry['name'])}"
    body = entry.get("body", 0)
    if body not in (0, 1):
        raise FormatError(
            f"{place} sits on body {shown(body)}; write 0 for the bottom, 1 for the top"
        )
    return RawChannel(
        name=entry["name"],
        quantity=str(entry.get("quantity")),
        volts=positive_number(place, "counts_to_V", entry.get("counts_to_V")),
        sensitivity=positive_number(
            place, "sensitivity_V_per_unit", entry.get("sensitivity_V_per_unit")
        ),
        body=int(body),
        position=_vector(place, "position_m", entry.get("position_m")),
        direction=_vector(place, "direction", entry.get("direction")),
    )


def _vector(place: str, name: str, value: Any) -> tuple[float, ...] | None:
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 3:
        raise FormatError(
            f"{place} has {name!r} of {shown(value)}, three numbers are required; "
            "write x, y and z"
        )
    return tuple(finite_number(place, name, one) for one in value)


def _raw_hits(
    where: str, file: h5py.File, channels: Sequence[RawChannel], points: tuple[str, ...]
) -> RawHits:
    """Return the raw records; samples are read after all other parts are checked."""
    group = require_group(where, file, "records")
    if not 1 <= len(group) <= HITS.most_records:
        raise HostileFile(
            f"{where} holds {len(group)} records, 1 to {HITS.most_records} are read"
        )
    quiet = finite_number(
        where, "pretrigger_samples", read_attribute(file, "pretrigger_samples")
    )
    shapes = {
        name: _shape(f"{where} record {visible(name)}", group[name], len(channels))
        for name in sorted(group)
    }
    if len(set(shapes.values())) > 1:
        raise FormatError(
            f"{where} has records of lengths {sorted(set(shapes.values()))[:8]}; cut "
            "all to one"
        )
    count = next(iter(shapes.values()))
    if not HITS.least_pretrigger <= quiet < count:
        raise BadData(
            f"{where} has {quiet:g} samples before the hits, {HITS.least_pretrigger} "
            f"or more and less than {count} are required; record a longer quiet start"
        )
    return RawHits(
        where=where,
        sample_rate=_positive(where, file, "fs_hz"),
        full_scale=_positive(where, file, "full_scale_V"),
        quiet=int(quiet),
        volts=np.array([c.volts for c in channels]),
        units=np.array([c.volts / c.sensitivity for c in channels]),
        hits=tuple(
            _hit(f"{where} record {visible(name)}", name, group[name], points)
            for name in shapes
        ),
    )


def _shape(place: str, record: Any, channels: int) -> int:
    """Return the samples of a record after a check of its shape."""
    data = record.get("data") if isinstance(record, h5py.Group) else None
    if not isinstance(data, h5py.Dataset) or data.dtype.kind not in "iuf":
        raise FormatError(
            f"{place} has no dataset 'data' of numbers; give a complete campaign file"
        )
    if data.ndim != 2 or data.shape[0] != channels:
        raise FormatError(
            f"{place} has 'data' of shape {data.shape}, a row for each of {channels} "
            "channels is required; store channels by samples"
        )
    samples = int(data.shape[1])
    if not HITS.least_samples <= samples <= HITS.most_samples:
        raise HostileFile(
            f"{place} has {samples} samples, {HITS.least_samples} to "
            f"{HITS.most_samples} are read"
        )
    return samples


def _hit(place: str, name: str, record: h5py.Group, points: tuple[str, ...]) -> RawHit:
    point = read_attribute(record, "point")
    if point not in points:
        raise FormatError(
            f"{place} was hit at {shown(point)}, the nominal parameters have "
            f"{visible(', '.join(points))}; add the point to the nominal parameters"
        )
    return RawHit(
        name=name,
        counts=finite_array(place, record, "data"),
        point=points.index(str(point)),
        torque=_positive(place, record, "torque_Nm"),
        aimed=_positive(place, record, "aimed_peak_N"),
    )


def _positive(place: str, target: h5py.Group, name: str) -> float:
    return positive_number(place, name, read_attribute(target, name))
