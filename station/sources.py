# SPDX-License-Identifier: MIT
"""Open a source of samples by its URL: the one place that knows the simulators."""

from difflib import get_close_matches

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.source import Source

SCHEMES = ("sim",)


def open_source(url: str) -> Source:
    """Open the source that `url` names.

    Args:
        url: ``sim:two-body?seed=1&hits=10`` for the embedded simulated bench.

    Returns:
        A source whose blocks can be recorded.

    Raises:
        UsageError: the scheme is unknown.
    """
    scheme = url.partition(":")[0]
    if scheme == "sim":
        from jointbench.simulators.bench_url import bench_from_url

        return bench_from_url(url)
    near = get_close_matches(scheme, SCHEMES)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(SCHEMES)}"
    raise UsageError(f"source {url!r} has the unknown scheme {scheme!r}; {hint}")
