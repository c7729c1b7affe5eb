# SPDX-License-Identifier: MIT
"""Text of the help: docstrings split into parts, lines wrapped."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from inspect import cleandoc

INDENT = "  "
_GAP = "  "
_WIDEST_NAMES = 28
_NAMES_SHARE = 0.4
"""Largest fraction of a line that the names in a list take [-]."""
# A quoted quantity and a remark in brackets stay in one line, and so do an option and
# its value.
_WORD = re.compile(r"'[^']*'\S*|\[[^\]]*\]\S*|\S+")
_PART = re.compile(r"[^\s,]+,?")
_OPTION = re.compile(r"--\S+ (?:'[^']*'|[^-\s]\S*)|'[^']*'|\S+")
_EXAMPLES = re.compile(r"^Examples?:\s*$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class CommandText:
    """The parts of the docstring of a command.

    Attributes:
        summary: its first paragraph, the line in the list of commands.
        details: the paragraphs after it.
        examples: command lines, each a text without line ends.
    """

    summary: str
    details: tuple[str, ...]
    examples: tuple[str, ...]


def command_text(docstring: str | None) -> CommandText:
    """Split the docstring of a command into its parts.

    Examples follow the heading ``Examples:``. Each begins with ``jointbench`` and may
    continue on the next lines.
    """
    prose, *rest = _EXAMPLES.split(cleandoc(docstring or ""), maxsplit=1)
    paragraphs = [" ".join(p.split()) for p in prose.split("\n\n") if p.strip()]
    lines = " ".join(rest[0].split()) if rest else ""
    examples = [one.strip() for one in re.split(r"(?=\bjointbench )", lines)]
    summary, *details = paragraphs or [""]
    return CommandText(summary, tuple(details), tuple(filter(None, examples)))


def wrapped(text: str, width: int, indent: str = "") -> str:
    """Return a paragraph in lines of at most `width` columns."""
    return "\n".join(f"{indent}{one}" for one in _lines(text, width - len(indent)))


def command_line(text: str, width: int, indent: str = INDENT) -> str:
    """Return a command in lines that a shell reads as one."""
    lines = _lines(text, width - len(indent) - len(INDENT) - len(" \\"), _OPTION)
    return f" \\\n{indent}{INDENT}".join([indent + lines[0], *lines[1:]])


def names_width(names: Iterable[str], width: int) -> int:
    """Return the width of the column of names; longer names take a line of their own.

    Args:
        names: of the commands.
        width: of the lines [columns].
    """
    limit = min(_WIDEST_NAMES, int(width * _NAMES_SHARE))
    return max((len(name) for name in names if len(name) <= limit), default=limit)


def definitions(rows: Sequence[tuple[str, str]], names: int, width: int) -> str:
    """Return names and their meanings in two columns.

    Args:
        rows: name and meaning.
        names: width of the column of names [columns].
        width: of the lines [columns].
    """
    return "\n".join(_definition(name, text, names, width) for name, text in rows)


def _definition(name: str, text: str, names: int, width: int) -> str:
    edge = f"{INDENT}{'':{names}}{_GAP}"
    lines = wrapped(text, width, edge).split("\n")
    if len(name) > names:
        return "\n".join([INDENT + name, *lines])
    return "\n".join([f"{INDENT}{name:{names}}{_GAP}{lines[0].lstrip()}", *lines[1:]])


def _lines(text: str, width: int, pattern: re.Pattern[str] = _WORD) -> list[str]:
    lines = [""]
    for word in _words(text, width, pattern):
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append(word)
        else:
            lines[-1] = f"{lines[-1]} {word}".lstrip()
    return lines


def _words(text: str, width: int, pattern: re.Pattern[str]) -> Iterator[str]:
    """Yield words that are not broken; words longer than a line are split."""
    for word in pattern.findall(text):
        if len(word) <= width:
            yield word
        elif word.startswith("--"):
            yield from word.split(" ", maxsplit=1)
        elif pattern is _WORD:
            yield from _PART.findall(word)
        else:
            yield word
