# SPDX-License-Identifier: MIT
"""Limits of the data for any fit: record length, sample rate, decay, time scale.

Every function returns sentences for the operator, none where there is no problem. A
block of T seconds resolves frequencies 1/T apart; a response that has not decayed
within it has no measurable damping; there is no data above half the sample rate.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.records.recordings import Recording
from jointbench.signal.hits.find_hits import accepted_hits
from jointbench.signal.hits.windows import left_at_end
from jointbench.signal.modal.modal_model import ModalModel

_FEW_LINES = 200
"""Lines in the band below which resolution limits what can be found."""
_RESOLVED = 2.0
"""Least distance in lines of two modes that can be resolved."""
_PERIODS = 3.0
"""Periods of a mode that a block must hold."""
_RINGS_ON = 0.3
"""Share of its start at the end of the block from which a response is cut off [-]."""
_DECAYED = 0.03
_TIME_CONSTANTS = 0.5
"""Time constants of a mode that a block must hold for its damping."""
_ALIAS_FREE = 1.0 / 2.56


def block_words(
    recordings: Sequence[Recording], lines: int | None = None
) -> tuple[str, ...]:
    """Report what block length and decay prevent from being found.

    Args:
        recordings: with judged hits.
        lines: in the fitted band, or None without a fit.
    """
    length = block_length(recordings)
    if length is None:
        return ()
    words = []
    count = lines if lines is not None else _FEW_LINES - 1
    if count < _FEW_LINES:
        known = "" if lines is None else f" ({lines} lines in the band)"
        words.append(
            f"a block of {_seconds(length)} has lines {1.0 / length:.3g} Hz "
            f"apart{known}: modes closer than {_RESOLVED / length:.3g} Hz to each "
            f"other and modes below {_PERIODS / length:.3g} Hz cannot be found in it; "
            "record longer after each hit"
        )
    left = max(left_at_end(r, h) for r in recordings for h in accepted_hits(r))
    if left > _RINGS_ON:
        words.append(
            f"the response is still at {100 * left:.0f} % of its start when the block "
            f"of {_seconds(length)} ends: damping, and modes that overlap, are "
            f"uncertain; record {_decay_time(left, length)}"
        )
    return tuple(words)


def requested_band_words(
    recordings: Sequence[Recording], band: tuple[float, float] | None
) -> tuple[str, ...]:
    """Report the part of a requested band that the data cannot contain.

    Args:
        recordings: with judged hits.
        band: requested lowest and highest frequency [Hz], or None.
    """
    length = block_length(recordings)
    if band is None or length is None:
        return ()
    rate = recordings[0].sample_rate
    words = []
    if band[0] < _PERIODS / length and band[0] > 0.0:
        words.append(
            f"the band begins at {band[0]:g} Hz, but a block of {_seconds(length)} "
            f"holds {_PERIODS:g} periods only from {_PERIODS / length:.3g} Hz on"
        )
    if band[1] > 0.5 * rate:
        words.append(
            f"the band ends at {band[1]:g} Hz, but at {rate:g} Hz sample rate nothing "
            f"above {0.5 * rate:g} Hz is in the record; sample faster"
        )
    elif band[1] > _ALIAS_FREE * rate:
        words.append(
            f"the band ends at {band[1]:g} Hz; above {_ALIAS_FREE * rate:g} Hz (sample "
            "rate / 2.56) the anti-alias filters of usual converters act, and "
            "lines there may be aliases"
        )
    return tuple(words)


def mode_words(recordings: Sequence[Recording], model: ModalModel) -> tuple[str, ...]:
    """Report the modes for which the blocks are too short.

    Args:
        recordings: with judged hits.
        model: the modes.
    """
    length = block_length(recordings)
    if length is None:
        return ()
    frequency, ratio = model.natural_frequency, model.damping_ratio
    slow = np.flatnonzero(frequency * length < _PERIODS) + 1
    ringing = np.flatnonzero(2.0 * np.pi * frequency * ratio * length < _TIME_CONSTANTS)
    words = []
    if slow.size:
        words.append(
            f"{_modes(slow)}: fewer than {_PERIODS:g} periods in a block of "
            f"{_seconds(length)}"
        )
    if ringing.size:
        words.append(
            f"{_modes(ringing + 1)}: hardly decays within {_seconds(length)}, so its "
            "damping is not in the data"
        )
    return tuple(words)


def block_length(recordings: Sequence[Recording]) -> float | None:
    """Return the shortest time from trigger to end of an accepted hit [s], or None."""
    return min(
        (
            (hit.stop - hit.trigger) / recording.sample_rate
            for recording in recordings
            for hit in accepted_hits(recording)
        ),
        default=None,
    )


def _decay_time(left: float, length: float) -> str:
    needed = np.log(_DECAYED) / np.log(left) if left < 1.0 else np.inf
    if needed > 10.0:
        return "more than ten times as long"
    return f"about {_seconds(needed * length)}"


def _seconds(time: float) -> str:
    return f"{time:.3g} s" if time >= 0.1 else f"{1e3 * time:.3g} ms"


def _modes(numbers: IntArray) -> str:
    return f"mode{'s' * (numbers.size > 1)} {', '.join(map(str, numbers.tolist()))}"
