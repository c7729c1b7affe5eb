# SPDX-License-Identifier: MIT
"""Read `two-body-campaign/1` files: hits on two bodies, and nominal parameters."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_array, read_attribute
from jointbench.acquisition.file_access.quoting import named, shown, visible
from jointbench.analysis.gap.intake.intake_settings import INTAKE
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.stated_scatter import (
    NOTHING_STATED,
    SCATTER_KEYS,
    StatedScatter,
)
from jointbench.analysis.gap.model.two_body_model import two_body_model

SCHEMA = "two-body-campaign/1"
MAX_RECORDS = INTAKE.most_records
MAX_SAMPLES = INTAKE.most_samples
MIN_SAMPLES = INTAKE.least_samples
DEFAULT_PRELOAD = INTAKE.default_preload
BODIES = 2
NOMINAL_KEYS = ("m1", "m2", "k0", "kj", "c0", "cj")

_Record = tuple[str, h5py.Group]
"""Name of a record in messages, and the record."""


def read_campaign(path: Path) -> Campaign:
    """Read a campaign file.

    Args:
        path: HDF5 file of schema ``two-body-campaign/1``.

    Raises:
        FormatError: the file has another format, or a part is missing or malformed.
        HostileFile: the file claims more records or samples than a campaign can have.
        BadData: the file cannot be opened, a sample is not finite, the records are too
            short, or a nominal value is not positive.
    """
    with open_guarded(path) as file:
        try:
            return _campaign(path, file)
        except (OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
            raise FormatError(
                f"{named(path)} cannot be read as {SCHEMA} ({shown(error)}); "
                "give a complete campaign file"
            ) from error


def _campaign(path: Path, file: h5py.File) -> Campaign:
    """Read a campaign; samples are read last, after all other parts are checked."""
    where = named(path)
    _require_schema(where, file)
    records = _records(where, file)
    _require_length(where, _lengths(records))
    nominal, spread = (
        _nominal_attribute(where, file, name)
        for name in ("nominal", "nominal_rel_sigma")
    )
    reference = DEFAULT_PRELOAD
    if "preload_ref_N" in file.attrs:
        reference = _positive(where, file, "preload_ref_N")
    return Campaign(
        name=path.stem,
        sample_rate=_positive(where, file, "fs_hz"),
        hit=np.array([_hit(*record) for record in records]),
        level=np.array([_positive(*record, "level_N") for record in records]),
        preload=np.array([_positive(*record, "preload_N") for record in records]),
        order=np.array([_finite(*record, "order") for record in records]),
        preload_reference=reference,
        model=two_body_model(nominal, spread),
        force=_samples(records, "force"),
        response=_samples(records, "accel"),
        scatter=_scatter(where, file),
    )


def _require_schema(where: str, file: h5py.File) -> None:
    schema = read_attribute(file, "schema")
    if schema != SCHEMA:
        raise FormatError(
            f"{where} has schema {shown(schema or 'none')}, not {SCHEMA!r}; "
            "`jointbench inspect` shows its contents"
        )


def _records(where: str, file: h5py.File) -> list[_Record]:
    """Return the records, in the order of their names."""
    group = file.get("records")
    if not isinstance(group, h5py.Group):
        raise FormatError(
            f"{where} has no group 'records'; give a complete campaign file"
        )
    if not 1 <= len(group) <= MAX_RECORDS:
        raise HostileFile(
            f"{where} holds {len(group)} records, 1 to {MAX_RECORDS} are read"
        )
    records = [
        (f"{where} record {visible(name)}", group[name]) for name in sorted(group)
    ]
    for place, record in records:
        if not isinstance(record, h5py.Group):
            raise FormatError(
                f"{place} is not a group; store 'force' and 'accel' in a group"
            )
    return records


def _lengths(records: list[_Record]) -> list[int]:
    """Return the different lengths of the records, after a check of all shapes."""
    lengths = set()
    for place, record in records:
        force = _dataset(place, record, "force")
        if force.ndim != 1:
            raise FormatError(
                f"{place} has 'force' of shape {force.shape}, one axis is required; "
                "store the samples of one hit"
            )
        wanted = (BODIES, force.size)
        accel = _dataset(place, record, "accel")
        if accel.shape != wanted:
            raise FormatError(
                f"{place} has 'accel' of shape {accel.shape}, {wanted} is required; "
                "store a row for each body, as long as 'force'"
            )
        lengths.add(int(force.size))
    return sorted(lengths)


def _dataset(place: str, record: h5py.Group, name: str) -> h5py.Dataset:
    found = record.get(name)
    if not isinstance(found, h5py.Dataset) or found.dtype.kind not in "iuf":
        raise FormatError(
            f"{place} has no dataset {name!r} of numbers; give a complete campaign file"
        )
    return found


def _require_length(where: str, lengths: list[int]) -> None:
    if len(lengths) != 1:
        raise FormatError(
            f"{where} has records of lengths {', '.join(map(str, lengths[:8]))}; cut "
            "all to one"
        )
    (length,) = lengths
    if length > MAX_SAMPLES:
        raise HostileFile(
            f"{where} has records of {length} samples, at most {MAX_SAMPLES} are read"
        )
    if length < MIN_SAMPLES:
        raise BadData(
            f"{where} has {length} samples a record, at least {MIN_SAMPLES} "
            "are needed; record longer or sample faster"
        )


def _samples(records: list[_Record], name: str) -> FloatArray:
    return np.stack([_finite_samples(place, record[name]) for place, record in records])


def _finite_samples(place: str, dataset: h5py.Dataset) -> FloatArray:
    samples = read_array(dataset)
    if not np.all(np.isfinite(samples)):
        raise BadData(
            f"{place} holds NaN or infinite samples; "
            "leave the record out or record it again"
        )
    return samples


def _scatter(where: str, file: h5py.File) -> StatedScatter:
    """Return the scatter of the hits that the file states, all in SI units."""
    if "scatter_sd" not in file.attrs:
        return NOTHING_STATED
    stated = _json_object(where, file, "scatter_sd", SCATTER_KEYS)
    unknown = sorted(set(stated) - set(SCATTER_KEYS))
    if unknown:
        raise FormatError(
            f"{where} has 'scatter_sd' with the key {visible(unknown[0])!r}; its keys "
            f"are {', '.join(SCATTER_KEYS)}"
        )
    place = f"{where} in 'scatter_sd'"
    return StatedScatter(**{k: _number(place, k, v) for k, v in stated.items()})


def _nominal_attribute(where: str, file: h5py.File, name: str) -> dict[str, float]:
    """Return the numbers of a JSON attribute; the model checks for missing ones."""
    found = _json_object(where, file, name, NOMINAL_KEYS)
    return {
        key: _number(f"{where} in {name!r}", key, found[key])
        for key in NOMINAL_KEYS
        if key in found
    }


def _json_object(
    where: str, file: h5py.File, name: str, keys: Sequence[str]
) -> dict[str, Any]:
    """Return the object of a JSON attribute, which should have some of the keys."""
    text = read_attribute(file, name)
    try:
        found = json.loads(str(text))
    except (ValueError, RecursionError) as error:
        raise FormatError(
            f"{where} has no {name!r} that is JSON ({shown(error)}); "
            "give a complete campaign file"
        ) from error
    if not isinstance(found, dict):
        raise FormatError(
            f"{where} has {name!r} of {shown(text)}, a JSON object is required; "
            f"write it with the keys {', '.join(keys)}"
        )
    return found


def _hit(place: str, record: h5py.Group) -> int:
    number = _finite(place, record, "hit_dof")
    if number not in range(BODIES):
        raise FormatError(
            f"{place} has 'hit_dof' of {number:g}, 0 or 1 is required; "
            "write 0 for a hit on m1, 1 for one on m2"
        )
    return int(number)


def _positive(place: str, target: h5py.Group, name: str) -> float:
    number = _finite(place, target, name)
    if number <= 0:
        raise FormatError(
            f"{place} has {name!r} of {number:g}, it must be above zero; "
            "write the right one"
        )
    return number


def _finite(place: str, target: h5py.Group, name: str) -> float:
    number = _number(place, name, read_attribute(target, name))
    if not np.isfinite(number):
        raise FormatError(
            f"{place} has {name!r} of {number:g}, it must be finite; "
            "write the right one"
        )
    return number


def _number(place: str, name: str, value: Any) -> float:
    if value is None:
        raise FormatError(
            f"{place} lacks {name!r}, one number is required; "
            "give a complete campaign file"
        )
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise FormatError(
            f"{place} has {name!r} of {shown(value)}, a number is required; "
            "write it without a unit"
        ) from error
