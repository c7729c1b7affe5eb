# SPDX-License-Identifier: MIT
"""The text of ``--help``: commands by group, options with values, units and examples.

The layout of the library cuts the summaries of commands and writes types of Python
where a user expects the name of a value.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from typer.core import TyperCommand, TyperGroup

from jointbench.station.screen.help_text import (
    command_line,
    command_text,
    definitions,
    names_width,
    wrapped,
)
from jointbench.station.screen.text_width import help_width

QUANTITY = "QUANTITY"
QUANTITY_HELP = (
    "QUANTITY is a number with its unit, in quotes: '25 kN', '4.8 mm', '30 %'."
)
_COMMON = ("force", "json", "debug", "help")
"""Options of nearly every command; they stand last."""
_LIBRARY_HELP = {
    "help": "Show this help and exit.",
    "install_completion": "Install tab completion for the shell in use and exit.",
    "show_completion": "Print the completion script of the shell in use and exit.",
}
"""The texts of options that the library adds, in our own words."""


class HelpCommand(TyperCommand):
    """A command whose help has a description, the options and examples."""

    def get_help(self, ctx: Any) -> str:
        """Return the text; it is complete at any width.

        Args:
            ctx: context of the call, as the library gives it.
        """
        width, text = help_width(), command_text(self.help)
        parameters = [one for one in self.get_params(ctx) if not _hidden(one)]
        usage = f"Usage: {ctx.command_path} [OPTIONS] {' '.join(_usage(parameters))}"
        blocks = [wrapped(one, width) for one in (usage, text.summary, *text.details)]
        blocks += _sections(parameters, width)
        if any(value_name(one).startswith(QUANTITY) for one in parameters):
            blocks.append(wrapped(QUANTITY_HELP, width))
        return "\n\n".join([*blocks, *_examples(text.examples, width)])


class HelpGroup(TyperGroup):
    """The command line itself: its commands by group."""

    def get_help(self, ctx: Any) -> str:
        """Return the text: every command with its whole summary.

        Args:
            ctx: context of the call, as the library gives it.
        """
        width, text = help_width(), command_text(self.help)
        usage = f"Usage: {ctx.command_path} COMMAND [OPTIONS]"
        blocks = [wrapped(one, width) for one in (usage, text.summary)]
        names = names_width(self.commands, width)
        for heading, commands in command_groups(self).items():
            rows = [(one.name or "", summary_of(one)) for one in commands]
            blocks.append(f"{heading}:\n{definitions(rows, names, width)}")
        parameters = [one for one in self.get_params(ctx) if not _hidden(one)]
        blocks += _sections(parameters, width)
        blocks += [wrapped(one, width) for one in text.details]
        return "\n\n".join([*blocks, *_examples(text.examples, width)])


def command_groups(group: TyperGroup) -> dict[str, list[TyperCommand]]:
    """Return the commands of each group, in the order of their registration."""
    groups: dict[str, list[TyperCommand]] = {}
    for command in group.commands.values():
        if isinstance(command, TyperCommand) and not command.hidden:
            groups.setdefault(command.rich_help_panel or "Commands", []).append(command)
    return groups


def summary_of(command: TyperCommand) -> str:
    """Return the line of a command in the list of commands."""
    return command_text(command.help).summary


def value_name(parameter: Any) -> str:
    """Return the name of a parameter's value; empty for an option without one."""
    if parameter.param_type_name == "argument":
        return f"{parameter.metavar or parameter.name.upper()}{_dots(parameter)}"
    return "" if parameter.is_flag else parameter.metavar or "TEXT"


def _dots(parameter: Any) -> str:
    return "..." if parameter.nargs != 1 else ""


def _hidden(parameter: Any) -> bool:
    return bool(getattr(parameter, "hidden", False))


def _usage(parameters: Iterable[Any]) -> Iterator[str]:
    for one in parameters:
        if one.param_type_name == "argument":
            yield value_name(one) if one.required else f"[{value_name(one)}]"


def _sections(parameters: Iterable[Any], width: int) -> list[str]:
    """Return arguments and options under their headings."""
    found: dict[str, list[tuple[str, str]]] = {}
    for one in parameters:
        name = value_name(one)
        if one.param_type_name == "option":
            name = f"{', '.join(one.opts)} {name}".rstrip()
        found.setdefault(_heading(one), []).append((name, _meaning(one)))
    names = names_width((name for rows in found.values() for name, _ in rows), width)
    return [
        f"{heading}:\n{definitions(rows, names, width)}"
        for heading, rows in found.items()
    ]


def _heading(parameter: Any) -> str:
    if parameter.param_type_name == "argument":
        return "Arguments"
    if parameter.name in _COMMON:
        return "Common options"
    return str(parameter.rich_help_panel or "Options")


def _meaning(parameter: Any) -> str:
    text = _LIBRARY_HELP.get(parameter.name, parameter.help or "")
    remarks = "; ".join(_remarks(parameter))
    return f"{text} [{remarks}]" if remarks else text


def _remarks(parameter: Any) -> Iterator[str]:
    """Yield what the library knows of a parameter: default, range, repetition."""
    low, high = parameter.min, parameter.max
    if low is not None and high is not None:
        yield f"{low:g} to {high:g}"
    elif low is not None:
        yield f"at least {low:g}"
    if getattr(parameter, "multiple", False):
        yield "may be repeated"
    if parameter.required:
        yield "required"
    elif parameter.show_default and isinstance(parameter.default, str | int | Path):
        if not isinstance(parameter.default, bool):
            yield f"default: {parameter.default}"
    elif parameter.show_default and isinstance(parameter.default, float):
        yield f"default: {parameter.default:g}"


def _examples(examples: tuple[str, ...], width: int) -> list[str]:
    if not examples:
        return []
    heading = "Examples:" if len(examples) > 1 else "Example:"
    return ["\n".join([heading, *(command_line(one, width) for one in examples)])]
