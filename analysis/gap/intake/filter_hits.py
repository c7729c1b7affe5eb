# SPDX-License-Identifier: MIT
"""From raw hits to filtered records: bad hits left out, one filter for all channels."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.intake.intake_settings import HITS
from jointbench.analysis.gap.intake.mains_hum import mains_hum
from jointbench.analysis.gap.intake.raw_hits import (
    QuietHit,
    bad_hit,
    band_of,
    contact_samples,
    make_filter,
    quieted,
)
from jointbench.analysis.gap.structure_response.hit_campaign import (
    HitRecords,
    RejectedHit,
)


@dataclass(frozen=True, slots=True, eq=False)
class RawHit:
    """One record as stored.

    Attributes:
        name: of the record.
        counts: shape (1 + n_channels, n_samples).
        point: index of the hammer point.
        torque: of the bolts [N m].
        aimed: peak force of the plan [N].
    """

    name: str
    counts: FloatArray
    point: int
    torque: float
    aimed: float


@dataclass(frozen=True, slots=True, eq=False)
class RawHits:
    """All records of a campaign as stored.

    Attributes:
        where: of the file, for messages.
        sample_rate: [Hz].
        full_scale: of the converters [V].
        quiet: samples before the trigger.
        volts: volts per count of each row [V], shape (1 + n_channels,).
        units: physical unit per count of each row, shape (1 + n_channels,).
        hits: the records.
    """

    where: str
    sample_rate: float
    full_scale: float
    quiet: int
    volts: FloatArray
    units: FloatArray
    hits: tuple[RawHit, ...]


def filter_hits(raw: RawHits, highest: float) -> HitRecords:
    """Leave out bad hits, cut out the contacts, and filter force and responses alike.

    Args:
        raw: records as stored.
        highest: frequency up to which the model holds [Hz]; it bounds the band.

    Raises:
        BadData: fewer than two hits can be used.
    """
    quiet = raw.quiet - HITS.trigger_margin
    starts = [hit.counts[:, :quiet] for hit in raw.hits]
    hum = mains_hum(np.concatenate(starts), raw.sample_rate)
    good: list[tuple[RawHit, QuietHit]] = []
    rejected = []
    for hit in raw.hits:
        values = quieted(hit.counts * raw.units[:, None], hum)
        volts = hit.counts * raw.volts[:, None]
        reason = bad_hit(values, volts, raw.full_scale, hit.aimed)
        if reason:
            rejected.append(RejectedHit(hit.name, reason))
        else:
            good.append((hit, values))
    if len(good) < 2:
        raise BadData(
            f"{raw.where} has {len(good)} hits that can be used, 2 or more are "
            f"required; {rejected[0].reason if rejected else 'record more hits'}"
        )
    found = _filtered(raw, highest, good, tuple(rejected))
    start = raw.hits[0].counts.shape[1] - found.raw_force.shape[1]
    kept = start + found.filter.step * np.arange(found.force.shape[1])
    gain = float(np.linalg.norm(found.filter.kernel))
    return replace(found, hum_left=hum.left(kept.astype(float)) / gain)


def _filtered(
    raw: RawHits,
    highest: float,
    good: list[tuple[RawHit, QuietHit]],
    rejected: tuple[RejectedHit, ...],
) -> HitRecords:
    force = np.stack([h.values[0] for _, h in good])
    found = [contact_samples(h.values[0], float(h.noise[0])) for _, h in good]
    contacts = np.stack(found)
    force = np.where(contacts, force, 0.0)
    band = min(band_of(force, raw.sample_rate), highest)
    decimate = make_filter(band, raw.sample_rate)
    first = int(np.flatnonzero(contacts.any(axis=0))[0])
    start = max(first - decimate.half, 0)
    samples = force.shape[1]
    # What the filter would see after the end of a record is not recorded.
    end = samples - min(decimate.half, int(HITS.most_trimmed * samples))
    count = -(-(end - start) // decimate.step)
    noise = np.stack([h.noise[1:] for _, h in good])
    response = [decimate(h.values[1:], start)[:, :count] for _, h in good]
    return HitRecords(
        names=tuple(hit.name for hit, _ in good),
        sample_rate=raw.sample_rate / decimate.step,
        force=decimate(force, start)[:, :count],
        response=np.stack(response),
        noise=noise * float(np.linalg.norm(decimate.kernel)),
        point=np.array([hit.point for hit, _ in good]),
        torque=np.array([hit.torque for hit, _ in good]),
        level=np.array([hit.aimed for hit, _ in good]),
        lead=(first - start) // decimate.step,
        band=band,
        raw_force=force[:, start:],
        filter=decimate,
        rejected=rejected,
    )
