# SPDX-License-Identifier: MIT
"""Open a simulated bench by its URL, ``sim:two-body?seed=3&hits=10``."""

import difflib
from collections.abc import Iterable
from dataclasses import fields
from urllib.parse import parse_qsl, urlsplit

from jointbench.acquisition.errors import UsageError
from jointbench.simulators.bench import TwoBodyBench

_SPECIMEN = "two-body"


def bench_from_url(url: str) -> TwoBodyBench:
    """Make the bench that a URL describes.

    Args:
        url: ``sim:two-body`` and any attribute of `TwoBodyBench` as a query.

    Returns:
        The bench; nothing runs before its blocks are asked for.

    Raises:
        UsageError: another scheme or specimen, an unknown key, or a value that is
            no number.
    """
    parts = urlsplit(url)
    if parts.scheme != "sim":
        raise UsageError(f"{url!r} is no simulated source; type sim:{_SPECIMEN}?seed=1")
    if parts.path != _SPECIMEN:
        raise UsageError(
            f"unknown specimen {parts.path!r} in {url!r}; there is sim:{_SPECIMEN}"
        )
    values: dict[str, int | float | str] = {}
    for key, text in parse_qsl(parts.query, keep_blank_values=True):
        if key in values:
            raise UsageError(f"{key!r} is given twice in {url!r}; give it once")
        values[key] = _value(key, text)
    return TwoBodyBench(**values)  # type: ignore[arg-type]


def _value(key: str, text: str) -> int | float | str:
    """Read one value of the query as the type its field has."""
    kinds = {field.name: field.type for field in fields(TwoBodyBench)}
    if key not in kinds:
        raise UsageError(f"unknown key {key!r} of sim:{_SPECIMEN}; {_near(key, kinds)}")
    if kinds[key] is str:
        return text
    number = int if kinds[key] is int else float
    try:
        return number(text)
    except ValueError:
        raise UsageError(
            f"{key} is {text!r}, it must be "
            f"{'a whole number' if number is int else 'a number'}, e.g. {key}=3"
        ) from None


def _near(key: str, known: Iterable[str]) -> str:
    matches = difflib.get_close_matches(key, known, n=3, cutoff=0.5)
    if matches:
        return f"did you mean {' or '.join(matches)}?"
    return f"known are {', '.join(known)}"
