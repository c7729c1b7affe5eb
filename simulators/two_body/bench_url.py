# SPDX-License-Identifier: MIT
"""Open a simulated bench by its URL, ``sim:two-body?seed=3&hits=10``."""

import difflib
from collections.abc import Iterable
from dataclasses import fields
from urllib.parse import parse_qsl, urlsplit

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.two_body.bench import TwoBodyBench
from jointbench.simulators.two_body.bolted_blocks import BoltedBlocks
from jointbench.simulators.two_body.campaign_bench import CampaignBench

Specimen = type[TwoBodyBench] | type[CampaignBench] | type[BoltedBlocks]
SPECIMENS: dict[str, Specimen] = {
    "two-body": TwoBodyBench,
    "two-body-campaign": CampaignBench,
    "bolted-blocks": BoltedBlocks,
}


def specimen_from_url(url: str) -> TwoBodyBench | CampaignBench | BoltedBlocks:
    """Return the simulated bench of a URL, of any kind.

    Args:
        url: ``sim:two-body`` with any attribute of `TwoBodyBench` as a query,
            ``sim:two-body-campaign`` with any of `CampaignBench`, or
            ``sim:bolted-blocks`` with any of `BoltedBlocks`.

    Returns:
        The bench; nothing is simulated before its samples are requested.

    Raises:
        UsageError: another scheme or specimen, an unknown key, or a value that is not a
            number.
    """
    parts = urlsplit(url)
    if parts.scheme != "sim":
        raise UsageError(f"{url!r} is no simulated source; type sim:two-body?seed=1")
    specimen = SPECIMENS.get(parts.path)
    if specimen is None:
        known = ", ".join(f"sim:{name}" for name in SPECIMENS)
        raise UsageError(
            f"unknown specimen {parts.path!r} in {url!r}; there are {known}"
        )
    values: dict[str, int | float | str] = {}
    for key, text in parse_qsl(parts.query, keep_blank_values=True):
        if key in values:
            raise UsageError(f"{key!r} is given twice in {url!r}; give it once")
        values[key] = _value(specimen, parts.path, key, text)
    return specimen(**values)  # type: ignore[arg-type]


def bench_from_url(url: str) -> TwoBodyBench:
    """Return the bench of one stream of a URL.

    Args:
        url: ``sim:two-body`` and any attribute of `TwoBodyBench` as a query.

    Returns:
        The bench; nothing is simulated before its blocks are requested.

    Raises:
        UsageError: another scheme or specimen, an unknown key, or a value that is not a
            number.
    """
    bench = specimen_from_url(url)
    if not isinstance(bench, TwoBodyBench):
        raise UsageError(
            f"{url!r} is a campaign of many runs, no single stream; for one stream "
            "type "
            "sim:two-body?seed=1"
        )
    return bench


def _value(specimen: Specimen, name: str, key: str, text: str) -> int | float | str:
    """Read one value of the query as the type its field has."""
    kinds = {field.name: field.type for field in fields(specimen)}
    if key not in kinds:
        raise UsageError(f"unknown key {key!r} of sim:{name}; {_near(key, kinds)}")
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
