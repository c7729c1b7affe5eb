# SPDX-License-Identifier: MIT
"""Open a flexible bench by its URL, ``sim:bolted-plates?seed=3&hide=loose_bolt``."""

from dataclasses import dataclass, fields
from difflib import get_close_matches
from types import MappingProxyType
from urllib.parse import parse_qsl, urlsplit

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.flexible.draw_flexible_bench import draw_bench
from jointbench.simulators.flexible.flexible_bench import FlexibleBench

FLEXIBLE_BENCHES = MappingProxyType(
    {"bolted-plates": "plates", "lap-beam": "lap-beam", "column-on-bed": "column"}
)
"""Kind of specimen by the path of the URL."""
_EXAMPLE = "sim:bolted-plates?seed=3&hide=loose_bolt"


@dataclass(frozen=True, slots=True)
class FlexibleQuery:
    """Parameters of the URL.

    Attributes:
        seed: of all draws.
        hide: names of effects, separated by commas.
        world: ``exact`` or ``life``, which the modal table is.
        beyond: modes that the bodies have and the table lacks.
        margin: 1 to add the margin of each effect to the truth.
    """

    seed: int = 1
    hide: str = ""
    world: str = "exact"
    beyond: int = 0
    margin: int = 0


def is_flexible_url(url: str) -> bool:
    """Return whether a URL names a flexible bench."""
    parts = urlsplit(url)
    return parts.scheme == "sim" and parts.path in FLEXIBLE_BENCHES


def flexible_query(url: str) -> FlexibleQuery:
    """Return the parameters of a URL, as `bench_of_flexible_url` reads them."""
    return FlexibleQuery(**_values(url, urlsplit(url).query))  # type: ignore[arg-type]


def bench_of_flexible_url(url: str) -> FlexibleBench:
    """Return the bench of a URL.

    Args:
        url: ``sim:bolted-plates``, ``sim:lap-beam`` or ``sim:column-on-bed`` with any
            attribute of `FlexibleQuery`.

    Raises:
        UsageError: an unknown specimen, key, world or effect, or no whole number.
    """
    parts = urlsplit(url)
    if not is_flexible_url(url):
        raise UsageError(f"{url!r} is no flexible bench; write {_EXAMPLE}")
    query = flexible_query(url)
    names = tuple(name for name in query.hide.split(",") if name)
    return draw_bench(
        query.seed,
        kind=FLEXIBLE_BENCHES[parts.path],
        world=query.world,
        effects=names,
        beyond=query.beyond,
    )


def _values(url: str, query: str) -> dict[str, int | str]:
    kinds = {field.name: field.type for field in fields(FlexibleQuery)}
    found: dict[str, int | str] = {}
    for key, text in parse_qsl(query, keep_blank_values=True):
        if key not in kinds:
            near = get_close_matches(key, kinds)
            hint = f"did you mean {near[0]!r}?" if near else f"use {', '.join(kinds)}"
            raise UsageError(f"unknown key {key!r} in {url!r}; {hint}")
        if key in found:
            raise UsageError(f"{key!r} is given twice in {url!r}; give it once")
        if kinds[key] is int and not text.isdecimal():
            raise UsageError(f"{key} is {text!r}, it must be a whole number")
        found[key] = int(text) if kinds[key] is int else text
    return found
