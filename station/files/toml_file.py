# SPDX-License-Identifier: MIT
"""Read a TOML file into a pydantic model; what is wrong is one line with its key."""

import typing
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    ValidationError,
    ValidationInfo,
)

from jointbench.acquisition.basics.errors import BadData, UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.file_access.quoting import named, visible
from jointbench.station.files.toml_text import load_toml

_Model = TypeVar("_Model", bound=BaseModel)
AUTO, NONE = "auto", "none"
IN_SI = {"si": True}
"""Context of a validation whose numbers are in SI units already: stored content."""


_WAY_OUT = "mend it there, or give the TOML file in its place"


class StrictTable(BaseModel):
    """A table of a TOML file: no other keys than its own, and nothing changes later."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def with_unit(kind: str, *words: str) -> BeforeValidator:
    """Return what reads a number with its unit, written as text, into SI.

    Args:
        kind: quantity that the unit must be of, see `parse_value`.
        words: that may stand in its place: "auto" for None, "none" for 0.
    """

    def parse(value: object, info: ValidationInfo) -> float | None:
        if info.context == IN_SI and isinstance(value, int | float | None):
            return value
        if isinstance(value, str) and value in words:
            return None if value == AUTO else 0.0
        if not isinstance(value, str):
            # pydantic turns a ValueError, not a TypeError, into a named problem.
            raise ValueError(  # noqa: TRY004
                f"write the number with its unit, as text: '{value} ...'"
            )
        try:
            return parse_value(value, kind)
        except UnitError as error:
            also = f"; or {' or '.join(map(repr, words))}" if words else ""
            raise ValueError(f"{error}{also}") from error

    return BeforeValidator(parse)


def read_toml(path: Path, model: type[_Model]) -> _Model:
    """Read `path` as `model`.

    Raises:
        BadData: the file is missing, too large, not TOML, or breaks a rule; the
            message names the file, the key, the value and the rule.
    """
    shown = visible(str(path))
    try:
        return model.model_validate(load_toml(path))
    except FileNotFoundError as error:
        raise BadData(f"{shown}: no such file; check the path") from error
    except OSError as error:
        raise BadData(f"{named(path)} cannot be read: {error.strerror}") from error
    except ValidationError as error:
        raise BadData(f"{shown}: {first_problem(error, model)}") from error
    except UnicodeDecodeError as error:
        place = f"byte {error.start + 1} is no UTF-8 text"
        raise BadData(f"{shown}: not a TOML file ({place}); {_WAY_OUT}") from error
    except (ValueError, RecursionError) as error:  # TOMLDecodeError is a ValueError
        raise BadData(f"{shown}: not a TOML file ({error}); {_WAY_OUT}") from error


def first_problem(error: ValidationError, model: type[BaseModel]) -> str:
    """Return the first broken rule: key, value, rule, and how many more."""
    problems = error.errors(include_url=False)
    problem = problems[0]
    key = ".".join(str(part) for part in problem["loc"]) or "(top level)"
    # A list with a broken entry is also reported as too short: one mistake, not two.
    inside = {tuple(one["loc"][:-depth]) for one in problems for depth in (1, 2)}
    more = sum(
        not (one["type"] == "too_short" and one["loc"] in inside)
        for one in problems[1:]
    )
    also = f" (and {more} more)" if more else ""
    if problem["type"] == "missing":  # its input is the table around it
        return f"key {key!r} is missing; add it{also}"
    value = repr(problem["input"])
    shown = value if len(value) <= 60 else value[:57] + "..."
    rule = problem["msg"].removeprefix("Value error, ")
    if problem["type"] == "extra_forbidden":
        rule = unknown_key(model, problem["loc"])
    if problem["type"] == "model_type":
        rule = "write a table of keys there"
    return f"key {key!r}, value {shown}: {rule}{also}"


def unknown_key(model: type[BaseModel], key: Sequence[int | str]) -> str:
    """Say that there is no such key, and which one may be meant.

    Args:
        model: of the whole file.
        key: where it stands, from the outermost table inwards.
    """
    tables: list[type[BaseModel]] = [model]
    for part in key[:-1]:
        below = [
            found
            for table in tables
            if part in table.model_fields
            for found in _tables(table.model_fields[str(part)].annotation)
        ]
        tables = below or tables
    known = [name for table in tables for name in table.model_fields]
    near = get_close_matches(str(key[-1]), known, n=1)
    if near:
        return f"there is no such key; {near[0]!r} is meant?"
    return f"there is no such key; there are {', '.join(known)}"


def _tables(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in typing.get_args(annotation):
        yield from _tables(inner)
