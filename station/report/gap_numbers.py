# SPDX-License-Identifier: MIT
"""Numbers of a diagnosis in words: never rounded up to the whole or to certainty."""

_NOT_WHOLE = 0.9995
"""Shrink above which a percentage would round to a hundred."""
_NEARLY_SURE = 0.994


def percent(share: float) -> str:
    """Return a share, never rounded up to the whole.

    >>> percent(0.9721), percent(0.99999), percent(1.0)
    ('97.2 %', 'over 99.9 %', '100 %')
    """
    if share >= 1.0:
        return "100 %"
    return "over 99.9 %" if share > _NOT_WHOLE else f"{100 * share:.1f} %"


def short(value: float) -> str:
    """Write a number in few characters, without an exponent where it can be.

    >>> short(1.234), short(190.4), short(20312.0)
    ('1.23', '190', '20312')
    """
    return f"{value:.3g}" if abs(value) < 1e3 or abs(value) >= 1e6 else f"{value:.0f}"


def sure(confidence: float) -> str:
    """Return a confidence, never rounded up to certainty.

    >>> sure(0.981), sure(0.9999)
    ('98 %', 'over 99 %')
    """
    return "over 99 %" if confidence > _NEARLY_SURE else f"{100 * confidence:.0f} %"
