"""Files of a user of an earlier version are opened, verified and processed as then."""

import json
from pathlib import Path
from typing import Any

import pytest
from frozen_numbers import CASES, FROZEN, copied

KEPT = json.loads((FROZEN / "numbers.json").read_text(encoding="utf-8"))
CLOSE = 1e-6
"""Relative: what another number of threads may change in a sum."""
FLAT = 1e-12


def differences(at: str, kept: Any, now: Any) -> list[str]:
    """Return where numbers differ from those that were kept; more may be there."""
    if isinstance(kept, dict):
        pairs = [(k, v, now.get(k)) for k, v in kept.items()]
    elif isinstance(kept, list):
        if len(kept) != len(now or []):
            return [f"{at}: {len(kept)} kept, {len(now or [])} now"]
        pairs = [(str(k), a, b) for k, (a, b) in enumerate(zip(kept, now, strict=True))]
    else:
        same = now == kept
        if not isinstance(kept, str):
            same = now == pytest.approx(kept, rel=CLOSE, abs=FLAT, nan_ok=True)
        return [] if same else [f"{at}: {kept} kept, {now} now"]
    return [x for k, a, b in pairs for x in differences(f"{at}/{k}", a, b)]


def test_every_case_has_its_numbers() -> None:
    """Whoever adds a case freezes its numbers by the version that wrote the files."""
    assert set(KEPT) == set(CASES)


@pytest.mark.parametrize("name", CASES)
def test_what_was_written_comes_to_the_same_numbers(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sessions, live files, results, ledgers, plans, models, recipes, exports."""
    copied(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert differences(name, KEPT[name], CASES[name]()) == []


def test_a_number_that_moved_is_named_by_its_path() -> None:
    """The comparison sees a change of 2e-6, a lost mode and a lost key."""
    kept = {"a": [1.0, 2.0], "b": 3.0}
    assert differences("x", kept, {"a": [1.0, 2.000004], "b": 3.0}) == [
        "x/a/1: 2.0 kept, 2.000004 now"
    ]
    assert differences("x", kept, {"a": [1.0]})[0] == "x/a: 2 kept, 1 now"
    assert len(differences("x", kept, {})) == 2
