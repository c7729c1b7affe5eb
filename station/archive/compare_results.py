# SPDX-License-Identifier: MIT
"""Two recipes or versions side by side: what moved beyond its uncertainty, and why.

The same samples read in two ways share their noise, so their difference is surer than
either: a quantity has moved if the difference exceeds the larger of the two standard
deviations, whoever is right. Of different samples both variances count.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.errors import BadData
from jointbench.station.pipeline.stage_store import differing
from jointbench.station.results.result_rows import ResultQuantity
from jointbench.station.results.results_read import StoredResult, without_copies

MOVED = 2.0
"""Standard deviations beyond which a quantity has moved."""
STAGES_OF_PART = {
    "modes": ("hits", "frf", "modes", "fill", "amplitude"),
    "surface": ("structure", "surface"),
    "contact": ("structure", "surface", "contact"),
    "joint": ("hits", "frf", "modes", "fill", "joint"),
    "gap": ("hits", "gap"),
}
"""Stages that each part of a result depends on, in order of execution."""
_CHOSEN, _ABSENT = "chosen by the data", "-"
SAME_MODE = 0.1
"""Relative distance of two frequencies that may be one mode [-]."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One quantity in both results; NaN and empty where one has none.

    Attributes:
        file: name of the session.
        quantity: part, item and name.
        unit: of the values.
        before: in the first result [unit].
        before_sd: its standard deviation.
        after: in the second result [unit].
        after_sd: its standard deviation.
        words: verdicts before and after, where it is one.
        moved: by how many standard deviations; infinite for a verdict that changed or
            a quantity that only one has; NaN where it changed and
            no deviation is known.
        since: first stage it depends on that differs; empty for none.
    """

    file: str
    quantity: str
    unit: str
    before: float
    before_sd: float
    after: float
    after_sd: float
    words: tuple[str, str]
    moved: float
    since: str = ""


@dataclass(frozen=True, slots=True)
class ResultComparison:
    """Two sets of results side by side.

    Attributes:
        pairs: sessions that are in both.
        only_before: sessions that are in the first alone.
        only_after: sessions that are in the second alone.
        differences: every quantity of every pair.
        causes: settings and versions that are not the same, by how many sessions.
        stages: stages whose keys differ, by how many sessions.
    """

    pairs: int
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]
    differences: tuple[Difference, ...]
    causes: Mapping[str, int]
    stages: Mapping[str, int]

    @property
    def moved(self) -> tuple[Difference, ...]:
        """Those beyond their uncertainty, furthest first; then what came and went."""
        far = [one for one in self.differences if one.moved > MOVED]
        return tuple(sorted(far, key=lambda one: (math.isinf(one.moved), -one.moved)))

    @property
    def unjudged(self) -> tuple[Difference, ...]:
        """Those that changed and have no standard deviation to hold that against."""
        return tuple(one for one in self.differences if math.isnan(one.moved))


def compare_results(
    before: Sequence[StoredResult], after: Sequence[StoredResult]
) -> ResultComparison:
    """Lay results of the same sessions side by side.

    Args:
        before: one result a session.
        after: likewise; sessions are paired by the digest of their file.

    Raises:
        BadData: no session is in both, or one is twice in one of them.
    """
    first, second = (_by_input(without_copies(group)[0]) for group in (before, after))
    both = [digest for digest in first if digest in second]
    if not both:
        raise BadData(
            "no session is in both: results are paired by the digest of their input; "
            "compare results of the same files"
        )
    stages: Counter[str] = Counter()
    causes: Counter[str] = Counter()
    differences: list[Difference] = []
    for digest in both:
        one, other = first[digest], second[digest]
        apart = differing(one.stages, other.stages)
        differences += [
            replace(found, since=_since(found, apart) if found.moved != 0 else "")
            for found in _differences(one, other)
        ]
        stages.update(apart)
        causes.update(_causes(one, other))
    return ResultComparison(
        len(both),
        tuple(first[d].facts["input_file"] for d in first if d not in second),
        tuple(second[d].facts["input_file"] for d in second if d not in first),
        tuple(differences),
        causes,
        stages,
    )


def _since(found: Difference, apart: Sequence[str]) -> str:
    """Return the first differing stage that a quantity depends on."""
    part = found.quantity.split(maxsplit=1)[0]
    for stage in STAGES_OF_PART.get(part, ()):
        if any(name == stage or name.startswith(f"{stage} ") for name in apart):
            return stage
    return ""


def _by_input(results: Sequence[StoredResult]) -> dict[str, StoredResult]:
    found: dict[str, StoredResult] = {}
    for result in results:
        digest = result.facts["input_sha256"]
        other = found.setdefault(digest, result)
        if other is not result:
            raise BadData(
                f"'{other.path}' and '{result.path}' are results of the same file; "
                "name one recipe's, for example 'archive/**/*.narrow.results.h5'"
            )
    return found


def _differences(one: StoredResult, other: StoredResult) -> list[Difference]:
    file = one.facts["input_file"]
    pairs = [
        *_same_names(one.quantities, other.quantities),
        *_same_modes(one.quantities, other.quantities),
    ]
    return [_difference(file, a, b) for a, b in pairs if _one_of(a, b).part != "hits"]


def _one_of(a: ResultQuantity | None, b: ResultQuantity | None) -> ResultQuantity:
    there = a or b
    assert there is not None
    return there


Pairs = list[tuple[ResultQuantity | None, ResultQuantity | None]]


def _same_names(
    one: Sequence[ResultQuantity], other: Sequence[ResultQuantity]
) -> Pairs:
    def named(rows: Sequence[ResultQuantity]) -> dict[object, ResultQuantity]:
        return {
            (q.part, q.item, q.name, f"{q.preload:g}"): q
            for q in rows
            if q.part != "modes"
        }

    first, second = named(one), named(other)
    return [(first.get(k), second.get(k)) for k in dict.fromkeys([*first, *second])]


def _same_modes(
    one: Sequence[ResultQuantity], other: Sequence[ResultQuantity]
) -> Pairs:
    """Pair modes by frequency, at each preload: their numbers shift with each other.

    Where each has modes at one preload only, it is the same, whoever wrote it down.
    """
    first, second = _modes(one), _modes(other)
    if len(first) == len(second) == 1:
        second = dict(zip(first, second.values(), strict=True))
    pairs: Pairs = []
    for preload in dict.fromkeys([*first, *second]):
        left, right = first.get(preload, []), second.get(preload, [])
        partner = match_modes(
            [mode["natural_frequency"].value for mode in left],
            [mode["natural_frequency"].value for mode in right],
        )
        for index, mode in enumerate(left):
            match = right[partner[index]] if index in partner else {}
            pairs += [(mode[name], match.get(name)) for name in mode]
        for index, mode in enumerate(right):
            if index not in partner.values():
                pairs += [(None, quantity) for quantity in mode.values()]
    return pairs


def _modes(
    rows: Sequence[ResultQuantity],
) -> dict[str, list[dict[str, ResultQuantity]]]:
    found: dict[str, dict[str, dict[str, ResultQuantity]]] = {}
    for one in rows:
        if one.part == "modes":
            at = found.setdefault(f"{one.preload:g}", {})
            at.setdefault(one.item, {})[one.name] = one
    return {preload: list(modes.values()) for preload, modes in found.items()}


def match_modes(before: Sequence[float], after: Sequence[float]) -> dict[int, int]:
    """Pair modes whose frequencies are nearest, each with one at the most.

    Args:
        before: frequencies [Hz].
        after: frequencies [Hz].

    Returns:
        Index in `after` by index in `before`, for pairs within a tenth.
    """
    if not before or not after:
        return {}
    ratio = np.abs(np.log(np.array(after)[None, :] / np.array(before)[:, None]))
    cost = np.minimum(ratio, SAME_MODE)
    rows, columns = linear_sum_assignment(cost)
    return {
        int(i): int(j)
        for i, j in zip(rows, columns, strict=True)
        if ratio[i, j] < SAME_MODE
    }


def _difference(
    file: str, a: ResultQuantity | None, b: ResultQuantity | None
) -> Difference:
    there = _one_of(a, b)
    sides = [(q.value, q.sd, q.word) if q else (math.nan, math.nan, "") for q in (a, b)]
    (before, before_sd, old), (after, after_sd, new) = sides
    sd = max((s for s in (before_sd, after_sd) if not math.isnan(s)), default=math.nan)
    if a is None or b is None or old != new:
        moved = math.inf
    elif there.word or before == after:
        moved = 0.0
    else:
        moved = abs(after - before) / sd if sd > 0 else math.nan
    at = "" if math.isnan(there.preload) else f" at {there.preload:g} N"
    name = f"{there.part} {there.item} {there.name}{at}".replace("  ", " ")
    words = (old, new)
    return Difference(
        file, name, there.unit, before, before_sd, after, after_sd, words, moved
    )


def _causes(one: StoredResult, other: StoredResult) -> list[str]:
    """Say in which settings and versions two results differ."""
    causes = [
        f"{name.replace('_', ' ')}: {one.facts[name] or '-'} -> "
        f"{other.facts[name] or '-'}"
        for name in ("software", "recipe_name")
        if one.facts[name] != other.facts[name]
    ]
    first, second = _flat(one.recipe), _flat(other.recipe)
    if not (first and second):  # `jointbench modal` works without one
        return causes
    for key in dict.fromkeys([*first, *second]):
        words = _word(first, key), _word(second, key)
        if len({*words, _ABSENT, _CHOSEN}) > 2 and words[0] != words[1]:
            causes.append(f"{key}: {words[0]} -> {words[1]}")
    return causes


def _word(tree: Mapping[str, object], key: str) -> str:
    value = tree.get(key, _ABSENT)
    return _CHOSEN if value is None else str(value)


def _flat(tree: Mapping[str, Any], prefix: str = "") -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in tree.items():
        if isinstance(value, Mapping):
            flat |= _flat(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = value
    return flat
