# SPDX-License-Identifier: MIT
"""Read `two-body-campaign/1` files: hits on two bodies, with a nominal sheet."""

import json
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.errors import BadData, FormatError, HostileFile
from jointbench.analysis.gap.model import LumpedModel, two_body_model

SCHEMA = "two-body-campaign/1"
MAX_RECORDS = 1024
MAX_SAMPLES = 1 << 20
MIN_SAMPLES = 512
DEFAULT_PRELOAD = 4000.0
TAIL = 64
"""Last samples without weight: a channel's filter acts on a cut record there."""


@dataclass(frozen=True, slots=True, eq=False)
class Campaign:
    """Hits under known conditions, and the model that should explain them.

    Attributes:
        name: as the user knows it.
        sample_rate: [Hz].
        force: hammer force [N], shape (n_records, n_samples).
        response: shape (n_records, n_channels, n_samples), in the model's output.
        hit: index of the body that was hit, shape (n_records,).
        level: nominal peak force [N], shape (n_records,).
        preload: [N], shape (n_records,).
        order: rank in time, shape (n_records,).
        preload_reference: preload the nominal sheet belongs to [N].
        model: bodies, links and their priors.
        lead: first samples without weight: the bench was not at rest before them.
        continuous: True where the excitation never ends (a shaker), so that no
            hit can be cut out of it and no level spans the campaign.
        repeatability: relative, from the sheet [-]; None to take it from repeats.
    """

    name: str
    sample_rate: float
    force: FloatArray
    response: FloatArray
    hit: IntArray
    level: FloatArray
    preload: FloatArray
    order: FloatArray
    preload_reference: float
    model: LumpedModel
    lead: int = 0
    continuous: bool = False
    repeatability: float | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "force", "response", "hit", "level", "preload", "order")


def read_campaign(path: Path) -> Campaign:
    """Read a campaign file.

    Args:
        path: HDF5 file of schema ``two-body-campaign/1``.

    Raises:
        FormatError: it is not such a file, or a part is missing or malformed.
        HostileFile: it claims more records or samples than a campaign can have.
        BadData: a sample is not finite, or the records are too short.
    """
    try:
        with h5py.File(path, "r") as file:
            return _campaign(path, file)
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        raise FormatError(
            f"'{path.name}' cannot be read as {SCHEMA} ({error}); "
            "give a complete campaign file"
        ) from error


def _campaign(path: Path, file: h5py.File) -> Campaign:
    schema = file.attrs.get("schema", "none")
    if schema != SCHEMA:
        raise FormatError(f"'{path.name}' has schema {schema!r}, not {SCHEMA!r}")
    names = sorted(file["records"])
    if not 1 <= len(names) <= MAX_RECORDS:
        raise HostileFile(
            f"'{path.name}' holds {len(names)} records, 1 to {MAX_RECORDS} are read"
        )
    records = [file["records"][name] for name in names]
    length = _length(path, records)
    force = np.stack([np.asarray(r["force"], dtype=float) for r in records])
    response = np.stack([np.asarray(r["accel"], dtype=float) for r in records])
    if response.shape != (len(names), 2, length):
        raise FormatError(
            f"'{path.name}' has accelerations of shape {response.shape[1:]}, "
            f"(2, {length}) is wanted"
        )
    _require_finite(path, names, force, response)
    nominal = json.loads(file.attrs["nominal"])
    spread = json.loads(file.attrs["nominal_rel_sigma"])
    return Campaign(
        name=path.stem,
        sample_rate=float(file.attrs["fs_hz"]),
        force=force,
        response=response,
        hit=_hits(path, records),
        level=np.array([float(r.attrs["level_N"]) for r in records]),
        preload=np.array([float(r.attrs["preload_N"]) for r in records]),
        order=np.array([float(r.attrs["order"]) for r in records]),
        preload_reference=float(file.attrs.get("preload_ref_N", DEFAULT_PRELOAD)),
        model=two_body_model(nominal, spread),
    )


def _length(path: Path, records: list[h5py.Group]) -> int:
    lengths = {int(r["force"].shape[0]) for r in records}
    length = max(lengths)
    if len(lengths) != 1:
        raise FormatError(f"'{path.name}' has records of lengths {sorted(lengths)}")
    if length > MAX_SAMPLES:
        raise HostileFile(f"'{path.name}' has records of {length} samples")
    if length < MIN_SAMPLES:
        raise BadData(
            f"'{path.name}' has {length} samples a record, at least {MIN_SAMPLES} "
            "are needed; record longer or sample faster"
        )
    return length


def _require_finite(
    path: Path, names: list[str], force: FloatArray, response: FloatArray
) -> None:
    for name, f, y in zip(names, force, response, strict=True):
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(y))):
            raise BadData(
                f"'{path.name}' record {name} holds NaN or infinite samples; "
                "leave the record out or record it again"
            )


def _hits(path: Path, records: list[h5py.Group]) -> IntArray:
    hits = np.array([int(r.attrs["hit_dof"]) for r in records])
    if not set(hits.tolist()) <= {0, 1}:
        raise FormatError(f"'{path.name}' has hit_dof {sorted(set(hits.tolist()))}")
    return hits
