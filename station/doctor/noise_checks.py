# SPDX-License-Identifier: MIT
"""Some seconds of noise of every channel: against its data sheet, mains, and rest."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.ni.sensors import Sensor, table_channels
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.station.doctor.bench_finding import BenchFinding, bad, good, look

STATED_RATIO = 3.0
"""Noise over that of the data sheet from which it is looked at [-]."""
RANGE_SHARE = 1e-3
"""Noise over the range from which it is looked at without a data sheet [-]."""
DEAD_SHARE = 1e-9
"""Noise over the range below which an input is dead [-]."""
FULL_SHARE = 0.9
"""Offset over the range from which an input is at its stop [-]."""
HUM_SHARE = 0.5
"""Share of the noise power in mains lines from which it is hum [-]."""
_MAINS = (50.0, 60.0)
_HARMONICS = 5


@dataclass(frozen=True, slots=True)
class Quiet:
    """What a quiet channel showed.

    Attributes:
        rms: without its mean [SI unit].
        mean: [SI unit].
        hum: share of the power in lines of the mains [-].
        mains: their frequency [Hz].
    """

    rms: float
    mean: float
    hum: float
    mains: float


def noise_findings(
    samples: FloatArray, sensors: Sequence[Sensor], *, sample_rate: float
) -> Iterator[BenchFinding]:
    """Yield a finding on the noise of each channel.

    Args:
        samples: of a quiet bench, SI units, shape (n_channels, n).
        sensors: the channel table.
        sample_rate: [Hz].
    """
    stated_noises = [sensor.noise for sensor in sensors for _ in sensor.axes]
    for channel, row, stated in zip(
        table_channels(sensors), samples, stated_noises, strict=True
    ):
        yield _finding(channel, quiet(row, sample_rate=sample_rate), stated)


def quiet(samples: FloatArray, *, sample_rate: float) -> Quiet:
    """Return noise, offset and hum of one channel, shape (n,)."""
    mean = float(samples.mean())
    window = np.hanning(samples.size)
    power = np.abs(np.fft.rfft((samples - mean) * window)) ** 2
    frequency = np.fft.rfftfreq(samples.size, 1 / sample_rate)
    total = float(power.sum()) or 1.0
    width = 3 * sample_rate / samples.size
    shares = []
    for mains in _MAINS:
        lines = mains * np.arange(1, _HARMONICS + 1)
        near = np.min(np.abs(frequency[:, None] - lines), axis=1) <= width
        shares.append(float(power[near].sum()) / total)
    most = int(np.argmax(shares))
    return Quiet(float(samples.std()), mean, shares[most], _MAINS[most])


def _finding(channel: Channel, found: Quiet, stated: float | None) -> BenchFinding:
    full = channel.range or 1.0
    unit = example_unit(channel.quantity)
    if channel.quantity is Quantity.TACHO:
        return good("noise", channel.name, f"pulses of {found.rms:.3g} V rms")
    seen = f"noise {found.rms:.3g} {unit} rms, {found.rms / full:.1e} of the range"
    if abs(found.mean) > FULL_SHARE * full:
        return bad(
            "noise",
            channel.name,
            f"stands at {found.mean:.3g} {unit}, the end of its range",
            "the loop is open or shorted: check cable, sensor and current",
        )
    if found.rms < DEAD_SHARE * full:
        return bad(
            "noise",
            channel.name,
            f"{seen}: an input that is connected is never so quiet",
            "check cable, sensor and input",
        )
    if found.hum > HUM_SHARE and found.rms > _limit(full, stated):
        return look(
            "noise",
            channel.name,
            f"{seen}, {found.hum:.0%} of it at {found.mains:g} Hz and its multiples",
            "mains hum: ground at one place only, keep cables away from drives",
        )
    if found.rms > _limit(full, stated):
        against = "" if stated is None else f", data sheet {stated:.3g} {unit}"
        return look(
            "noise",
            channel.name,
            f"{seen}{against}",
            "is the bench at rest? then check mounting, cable and range",
        )
    against = "" if stated is None else f", data sheet {stated:.3g} {unit}"
    return good("noise", channel.name, seen + against)


def _limit(full: float, stated: float | None) -> float:
    return RANGE_SHARE * full if stated is None else STATED_RATIO * stated
