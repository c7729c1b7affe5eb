# SPDX-License-Identifier: MIT
"""Trial hits propose the settings of a session, each with its reason."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.signal.hits.hit_verdicts import noise_level
from jointbench.signal.hits.live_hits import CutHit

_NOISE_FACTOR = 10.0
"""Trigger level in standard deviations of the force noise [-]."""
_WEAK_SHARE = 0.03
"""Trigger level as a share of a usual hit [-]; weak hits must fire, to be called so."""
_DECAYED = 0.003
"""Share of its peak to which a response should fall within a block [-]."""
_HEADROOM = 2.0
"""Range over the largest value of a trial hit [-]."""
_DROP_DB = 20.0
"""Fall of the force spectrum that ends the usable band [dB]."""
SHORTEST, LONGEST = 0.25, 8.0
"""Of a block [s]."""


@dataclass(frozen=True, slots=True)
class Proposal:
    """One setting.

    Attributes:
        name: of the setting, with its unit: ``"trigger_n"``.
        value: proposed.
        reason: one line.
    """

    name: str
    value: float
    reason: str


def propose_trigger(force: FloatArray, channel: Channel) -> Proposal:
    """Propose a trigger level from quiet force samples, before anybody has hit.

    Args:
        force: of the quiet hammer [N], shape (n,).
        channel: of the hammer.
    """
    noise = noise_level(force)
    # Below a thousandth of the range a touch of the cable would fire.
    least = 1e-3 * (channel.range or 0.0)
    level = max(_NOISE_FACTOR * noise, least)
    reason = f"{_NOISE_FACTOR:g} x the noise of {noise:.3g} N, at least {least:.3g} N"
    return Proposal("trigger_n", level, reason)


def propose_settings(
    cuts: Sequence[CutHit],
    channels: Sequence[Channel],
    *,
    sample_rate: float,
    trigger: Proposal,
) -> tuple[Proposal, ...]:
    """Propose trigger, block length, windows, band and ranges from trial hits.

    Args:
        cuts: the trial hits, at least one.
        channels: of their rows.
        sample_rate: [Hz].
        trigger: level that they fired at.
    """
    row = next(i for i, c in enumerate(channels) if c.quantity is Quantity.FORCE)
    peaks = [float(cut.samples[row].max()) for cut in cuts]
    usual = float(np.median(peaks))
    level = max(trigger.value, min(_WEAK_SHARE * usual, 0.5 * min(peaks)))
    length, decay = _length(cuts, row, sample_rate)
    band = float(np.median([_band(c.samples[row], sample_rate) for c in cuts]))
    pulse = float(np.median([_pulse(c.samples[row]) for c in cuts])) / sample_rate
    return (
        Proposal(
            "trigger_n",
            level,
            f"{100 * level / usual:.2g} % of the usual {usual:.4g} N; {trigger.reason}",
        ),
        Proposal("length_s", length, decay),
        Proposal(
            "force_window_s",
            3 * pulse,
            f"three times the pulse of {1e3 * pulse:.3g} ms",
        ),
        Proposal(
            "decay_rate_per_s",
            0.0 if length < LONGEST else -np.log(0.01) / LONGEST,
            "no exponential window: the response dies within the block"
            if length < LONGEST
            else "an exponential window to 1 %: the response outlasts the block",
        ),
        Proposal(
            "band_hz",
            band,
            f"the force spectrum falls by {_DROP_DB:g} dB at {band:.0f} Hz",
        ),
        *(
            _range(channel, max(float(np.abs(c.samples[i]).max()) for c in cuts))
            for i, channel in enumerate(channels)
        ),
    )


def _length(cuts: Sequence[CutHit], row: int, rate: float) -> tuple[float, str]:
    """Return the time in which the slowest response decays, and how that was seen."""
    longest = 0.0
    for cut in cuts:
        for i, samples in enumerate(cut.samples):
            if i != row:
                longest = max(longest, _decay(samples, cut.trigger, rate))
    length = float(np.clip(np.ceil(1.2 * longest * 20) / 20, SHORTEST, LONGEST))
    return length, (
        f"1.2 x {longest:.3g} s, in which the slowest response falls to "
        f"{100 * _DECAYED:g} % or into its noise"
    )


def _decay(samples: FloatArray, trigger: int, rate: float) -> float:
    """Return when the envelope was last above its limit, after the trigger [s]."""
    centred = samples - np.median(samples)
    floor = 6 * noise_level(centred[: max(8, trigger)])
    limit = max(_DECAYED * float(np.abs(centred).max()), floor)
    above = np.flatnonzero(np.abs(centred) > limit)
    return float(max(0, above[-1] - trigger)) / rate if above.size else 0.0


def _band(force: FloatArray, rate: float) -> float:
    """Return where the force spectrum has fallen for good below its plateau [Hz]."""
    power = np.abs(np.fft.rfft(force - np.median(force))) ** 2
    frequency = np.fft.rfftfreq(force.size, 1 / rate)
    width = max(3, round(20.0 / frequency[1]))
    smooth = np.convolve(power, np.ones(width) / width, mode="same")
    below = np.flatnonzero(smooth < smooth[: 4 * width].max() * 10 ** (-_DROP_DB / 10))
    return float(frequency[below[0]] if below.size else frequency[-1])


def _pulse(force: FloatArray) -> int:
    """Return how many samples the pulse is above a tenth of its peak."""
    return int(np.count_nonzero(force > 0.1 * force.max()))


def _range(channel: Channel, largest: float) -> Proposal:
    name = f"range_{channel.name}"
    wanted = _HEADROOM * largest
    if channel.range is None or wanted <= channel.range:
        verdict = (
            f"{_HEADROOM:g} x {largest:.4g}; the table's {channel.range:g} holds it"
        )
    else:
        verdict = (
            f"{_HEADROOM:g} x {largest:.4g} exceeds the table's {channel.range:g}: hit "
            "softer, or take a less sensitive sensor"
        )
    return Proposal(name, wanted, verdict)
