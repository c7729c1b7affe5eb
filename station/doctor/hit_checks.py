# SPDX-License-Identifier: MIT
"""One hit: its verdict, its use of the range, and whether every response saw it."""

from collections.abc import Iterator, Sequence

import numpy as np

from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Verdict,
)
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.doctor.bench_finding import BenchFinding, bad, good, look

SEEN = 10.0
"""Peak of a response over its noise from which it saw a hit [-]."""
LEAST_SHARE = 0.02
"""Peak over the range below which a range is too large [-]."""

_UNMOVED = (Quantity.VOLTAGE, Quantity.TEMPERATURE, Quantity.TACHO)
"""What a hit does not change: load washers, thermometers, the pulses of a tacho."""


def hit_findings(
    cut: CutHit, hit: Hit, channels: Sequence[Channel]
) -> Iterator[BenchFinding]:
    """Yield findings on one hit.

    Args:
        cut: its samples.
        hit: as judged.
        channels: of the rows.
    """
    if hit.verdict is Verdict.OK:
        yield good("hit", "hammer", f"{hit.peak_force:.4g} N, {hit.reason}")
    else:
        yield look(
            "hit",
            "hammer",
            f"{hit.verdict.value}: {hit.reason}",
            "strike again, once and squarely; a tip that is too soft strikes twice",
        )
    for channel, row in zip(channels, cut.samples, strict=True):
        if channel.quantity not in _UNMOVED:
            yield from _channel(channel, row, cut.trigger)


def no_hit(seconds: float) -> BenchFinding:
    """Return the finding that the hammer was not heard."""
    return bad(
        "hit",
        "hammer",
        f"no hit in {seconds:g} s",
        "strike the structure; if you did, check cable and input of the hammer, or "
        "lower trigger in [hits]",
    )


def _channel(channel: Channel, row: np.ndarray, trigger: int) -> Iterator[BenchFinding]:
    before = row[: max(2, trigger - 2)]
    peak = float(np.abs(row - before.mean()).max())
    noise = float(before.std())
    share = peak / channel.range if channel.range else 0.0
    if channel.quantity.is_motion and peak < SEEN * noise:
        yield bad(
            "hit",
            channel.name,
            f"saw {peak:.3g}, {peak / noise if noise else 0.0:.1f} times its noise",
            "check mounting, cable and input, and that it senses this direction",
        )
    elif share >= 1.0:
        yield bad(
            "hit",
            channel.name,
            f"{100 * share:.0f} % of its range",
            "strike more softly, take a larger range or a less sensitive sensor",
        )
    elif channel.range and share < LEAST_SHARE:
        yield look(
            "hit",
            channel.name,
            f"{100 * share:.2f} % of its range",
            "write a smaller range, or take a more sensitive sensor",
        )
    else:
        yield good("hit", channel.name, f"{100 * share:.1f} % of its range")
