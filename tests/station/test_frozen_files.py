"""Files of earlier versions are opened, verified and processed; see docs/migration.md.

The numbers of the present version are exact but for rounding. What it makes of the
files of an earlier version is that version's numbers where nothing is estimated, and
within the statistical limits below where samples are processed again.
"""

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from frozen_numbers import CASES, SD, frozen, numbers

PRESENT = list(CASES)[-1]
EARLIER = list(CASES)[:-1]
CLOSE = 1e-6
"""Relative: what another number of threads may change in a sum."""
ROUNDING = 0.05
"""Of a standard deviation: what the kernels of BLAS for another processor may change.

A sum in another order changes the last digit. Where a background is fitted, or a
neighbour that may be missing enters an interval, that digit is amplified: by up to 0.02
sd, and an sd itself by 1 % (docs/decisions/0377).
"""
FLAT = 1e-12
COVERED, FARTHEST = 1.96, 3.0
"""Standard deviations of the earlier version: of its 95 % interval, and the limit."""
SD_CLOSE = 0.1
"""Largest relative decrease of a standard deviation; it may grow, since intervals now
include neighbours that may be missing."""


class Leaf(NamedTuple):
    """A number or word of an earlier version beside that of today."""

    at: str
    kept: Any
    now: Any
    deviation: float | None


def of_version(version: str, name: str) -> dict[str, Any]:
    """Return a JSON file of a frozen set, empty where it has none."""
    path = frozen(version) / name
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def made_by(version: str, of: str) -> dict[str, Any]:
    """Return the numbers that a version makes of the files of one."""
    own = version == of
    return of_version(version, "numbers.json" if own else f"numbers-of-{of}.json")


def leaves(at: str, kept: Any, now: Any, deviation: Any = None) -> Iterator[Leaf]:
    """Yield what was kept, beside that of today; more may be there today."""
    if isinstance(kept, dict):
        for key, value in kept.items():
            sd = deviation.get(key) if isinstance(deviation, dict) else None
            yield from leaves(f"{at}/{key}", value, (now or {}).get(key), sd)
    elif _are_modes(kept) and deviation is not None and len(deviation) == len(kept):
        for number, (mode, sd) in enumerate(zip(kept, deviation, strict=True)):
            near = min(now or [[]], key=lambda one: abs(one[0] - mode[0]), default=[])
            yield from leaves(f"{at}/{number}", mode, near, sd)
    elif isinstance(kept, list) and len(kept) == len(now or []):
        of_each = deviation or [None] * len(kept)
        for number, three in enumerate(zip(kept, now, of_each, strict=True)):
            yield from leaves(f"{at}/{number}", *three)
    else:
        yield Leaf(at, kept, now, deviation)


def _are_modes(values: Any) -> bool:
    return isinstance(values, list) and bool(values) and isinstance(values[0], list)


def same(leaf: Leaf, close: float = CLOSE) -> bool:
    """Return whether the value of today is the kept one."""
    if isinstance(leaf.kept, str | list):
        return bool(leaf.now == leaf.kept)
    return leaf.now == pytest.approx(leaf.kept, rel=close, abs=FLAT, nan_ok=True)


def rounded(leaf: Leaf) -> bool:
    """Return whether the kept value was estimated and differs by rounding at most."""
    if leaf.deviation is None or isinstance(leaf.kept, str | list):
        return False
    return bool(abs(leaf.now - leaf.kept) <= ROUNDING * leaf.deviation)


def differences(at: str, kept: Any, now: Any, deviation: Any = None) -> list[str]:
    """Return where numbers differ from those that were kept by more than rounding."""
    return [
        f"{x.at}: {x.kept} kept, {x.now} now"
        for x in leaves(at, kept, now, deviation)
        if not same(x) and not rounded(x)
    ]


def distances(found: list[Leaf]) -> dict[str, float]:
    """Return how far processed numbers moved, in earlier standard deviations."""
    return {
        x.at: abs(x.now - x.kept) / x.deviation
        for x in found
        if x.deviation is not None
    }


def test_the_present_version_and_its_cases_are_frozen() -> None:
    """Whoever adds a case freezes its numbers; a new version has a new set."""
    project = Path(__file__).parents[2] / "pyproject.toml"
    assert tomllib.loads(project.read_text())["project"]["version"] == PRESENT
    for version, cases in CASES.items():
        assert set(made_by(version, version)) == set(cases)
        assert set(made_by(PRESENT, version)) == set(cases)


@pytest.mark.parametrize(
    ("version", "case"),
    [(version, case) for version in CASES for case in CASES[version]],
)
def test_what_was_written_comes_to_the_same_numbers(
    version: str, case: str, tmp_path: Path
) -> None:
    """Sessions, live files, results, ledgers, plans, models, recipes, exports."""
    kept, now = made_by(PRESENT, version)[case], numbers(version, case, tmp_path)
    deviation = now.pop(SD, None)
    assert differences(f"{version}/{case}", kept, now, deviation) == []


@pytest.mark.parametrize("version", EARLIER)
def test_numbers_of_an_earlier_version_moved_within_its_intervals(version: str) -> None:
    """At least 95 % within its 95 % intervals, none beyond 3 sd; all else the same."""
    deviations = of_version(version, "deviations.json")
    kept, now = made_by(version, version), made_by(PRESENT, version)
    found = list(leaves(version, kept, now, deviations))
    far = distances(found)
    assert len(far) >= 50
    assert {at: sd for at, sd in far.items() if sd > FARTHEST} == {}
    assert sum(sd <= COVERED for sd in far.values()) >= 0.95 * len(far)
    exact = [x for x in found if x.deviation is None]
    sds = [x for x in exact if x.at.endswith("/sd")]
    assert [x.at for x in sds if x.now < (1.0 - SD_CLOSE) * x.kept] == []
    assert [x.at for x in exact if x not in sds and not same(x, CLOSE)] == []


def test_a_number_that_moved_is_named_by_its_path() -> None:
    """The comparison sees a change of 2e-6, a lost mode and a lost key."""
    kept = {"a": [1.0, 2.0], "b": 3.0}
    assert differences("x", kept, {"a": [1.0, 2.000004], "b": 3.0}) == [
        "x/a/1: 2.0 kept, 2.000004 now"
    ]
    assert differences("x", kept, {"a": [1.0]})[0] == "x/a: [1.0, 2.0] kept, [1.0] now"
    assert len(differences("x", kept, {})) == 2


def test_rounding_is_a_twentieth_of_a_standard_deviation() -> None:
    """A lost mode and a move of a tenth of a deviation are seen, a hundredth is not."""
    kept, sd = {"m": [[10.0, 0.01], [20.0, 0.02]]}, {"m": [[0.01, 1e-3], [0.01, 1e-3]]}
    near = {"m": [[10.0001, 0.01], [20.0, 0.02001]]}
    assert differences("x", kept, near, sd) == []
    assert len(differences("x", kept, near)) == 2
    assert len(differences("x", kept, {"m": [[10.001, 0.01], [20.0, 0.02]]}, sd)) == 1
    assert len(differences("x", kept, {"m": [[10.0, 0.01]]}, {"m": [[0.1, 0.1]]})) == 1


def test_a_mode_is_compared_with_the_nearest_of_today() -> None:
    """A new mode between two does not hide that one moved by ten deviations."""
    kept, now = [[10.0, 0.01], [20.0, 0.02]], [[10.1, 0.01], [15.0, 0.5], [20.0, 0.02]]
    found = leaves("m", kept, now, [[0.01, 1e-3], [0.01, 1e-3]])
    moved = {at: round(sd, 6) for at, sd in distances(list(found)).items()}
    assert moved == {"m/0/0": 10.0, "m/0/1": 0.0, "m/1/0": 0.0, "m/1/1": 0.0}
