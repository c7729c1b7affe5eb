# SPDX-License-Identifier: MIT
"""Recordings under several preloads: each preload has modes of its own."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.records.recordings import Recording, Verdict


def by_preload(
    recordings: Sequence[Recording],
) -> tuple[tuple[float | None, tuple[Recording, ...]], ...]:
    """Part recordings by the preload of the joint: each has modes of its own.

    Args:
        recordings: of one session or of several files.

    Returns:
        Preload [N] and its recordings, in the order met. All in one where there are
        not two preloads among those with an accepted hit; else recordings without a
        preload or without an accepted hit are left out.
    """
    groups: dict[float | None, list[Recording]] = {}
    for recording in recordings:
        if any(hit.verdict is Verdict.OK for hit in recording.hits):
            groups.setdefault(recording.preload, []).append(recording)
    if len(groups) < 2:
        return ((next(iter(groups), None), tuple(recordings)),)
    return tuple((preload, tuple(group)) for preload, group in groups.items())


def preload_sd(recordings: Sequence[Recording]) -> float | None:
    """Return the standard uncertainty of the preload of recordings [N].

    The largest of them; None where none was measured.
    """
    known = [r.preload_sd for r in recordings if r.preload_sd is not None]
    return max(known, default=None)


def preload_words(preload: float | None, recordings: Sequence[Recording]) -> str:
    """Return the preload of recordings as it is shown, with its sd where measured."""
    if preload is None:
        return "Preload not stated"
    deviation = preload_sd(recordings)
    if deviation is None:
        return f"Preload {preload:.6g} N"
    return f"Preload {preload:.6g} N, measured (sd {deviation:.2g} N)"


def at_words(preload: float | None) -> str:
    """Return " at ..." for a preload; empty where it is not known."""
    return "" if preload is None else f" at {preload:g} N"


def of_preload(target: Path, preload: float | None) -> Path:
    """Return where the results at one of several preloads go."""
    word = "no-preload" if preload is None else f"{preload:g}N"
    stem, dot, kind = target.name.partition(".")
    return target.with_name(f"{stem}.{word}{dot}{kind}")


def join_pages(
    preloads: Sequence[float | None], pages: Sequence[dict[str, object]]
) -> dict[str, object]:
    """Return the JSON of one preload, or of all with their modes in one list."""
    if len(pages) == 1:
        return pages[0]
    modes: list[object] = []
    for preload, page in zip(preloads, pages, strict=True):
        own = page["modes"]
        assert isinstance(own, list)
        modes += [{**mode, "preload_n": preload} for mode in own]
    preload_pages = [
        {"preload_n": preload, **page}
        for preload, page in zip(preloads, pages, strict=True)
    ]
    return pages[0] | {"modes": modes, "preloads": preload_pages}
