# SPDX-License-Identifier: MIT
"""Length of the common block of all hits, with a fast FFT."""

from collections.abc import Sequence

import numpy as np

# Segments shorter than this share of the median are padded and cut no others.
_SHORT = 0.5
_FFT_FACTORS = (2, 3, 5, 7)


def choose_block(lengths: Sequence[int]) -> tuple[int, str]:
    """Choose the block that all hits share.

    Cutting beats padding where a response still rings at the end: on the lines of its
    own block a cut decay is a rational function with the same poles, on the lines of a
    padded block it is not. So the block is the shortest segment, rounded down to a fast
    FFT length; only segments far shorter than the median are padded.

    Args:
        lengths: samples of each segment.

    Returns:
        Samples of the block, and the reason as text.
    """
    usual = float(np.median(lengths))
    shortest = min(n for n in lengths if n >= _SHORT * usual)
    block = fast_length(shortest)
    padded = sum(n < block for n in lengths)
    return block, (
        f"{block} samples from segments of {min(lengths)} to {max(lengths)}"
        f" ({padded} padded with zeros)"
    )


def fast_length(most: int) -> int:
    """Return the largest length up to `most` with factors 2, 3, 5 and 7 only."""
    for length in range(most, 1, -1):
        rest = length
        for factor in _FFT_FACTORS:
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
    return most
