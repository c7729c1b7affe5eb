# SPDX-License-Identifier: MIT
"""``jointbench inspect``: the content of a session or results file."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from jointbench.acquisition.session_file.describe_file import describe_file
from jointbench.station.screen.terminal import console, write_json

INDENT = "  "


def run_inspect(file: Path, *, json_target: str | None) -> None:
    """Show the content of `file` as an indented list, or as JSON."""
    content = describe_file(file)
    screen = console(json_target)
    shown = {key: value for key, value in content.items() if key != "attributes"}
    for line in _lines(shown, ""):
        screen.print(line, soft_wrap=True)
    write_json(json_target, content)


def _lines(content: Mapping[str, object], indent: str) -> Iterator[str]:
    for key, value in content.items():
        if isinstance(value, Mapping) and value:
            yield f"{indent}{key}:"
            yield from _lines(value, indent + INDENT)
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            yield f"{indent}{key}:"
            for item in value:
                yield from _item(item, indent + INDENT)
        elif value not in ("", None, {}, []):
            yield f"{indent}{key}: {_scalar(value)}"


def _item(item: Mapping[str, object], indent: str) -> Iterator[str]:
    """Yield one line for an entry of a list, and its nested content below."""
    flat = {k: v for k, v in item.items() if not _nested(v)}
    yield f"{indent}- {_one_line(flat)}"
    rest = {k: v for k, v in item.items() if _nested(v)}
    yield from _lines(rest, indent + 2 * INDENT)


def _nested(value: object) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)


def _one_line(item: Mapping[str, object]) -> str:
    return ", ".join(
        f"{key} {_scalar(value)}"
        for key, value in item.items()
        if value not in ("", None)
    )


def _scalar(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return f"({_one_line(value)})"
    if isinstance(value, list):
        return ", ".join(_scalar(item) for item in value) or "-"
    return str(value)
