"""The page of all commands, in step with the command line.

Run this file to write the page again.
"""

from pathlib import Path

import typer
from typer.core import TyperGroup

from jointbench.station.main import app
from jointbench.station.screen.help_page import command_groups, summary_of
from jointbench.station.screen.help_text import command_line, command_text

PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"
HEAD, TAIL = "<!-- commands -->\n", "<!-- end of commands -->\n"
WIDTH = 100


def commands() -> str:
    """Return the commands by group, each with its summary and first example."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    lines = []
    for heading, members in command_groups(group).items():
        lines.append(f"\n### {heading}\n")
        for one in members:
            example = command_line(command_text(one.help).examples[0], WIDTH, "")
            lines.append(f"`{one.name}`: {summary_of(one)}\n```sh\n{example}\n```")
    return "\n".join([*lines, ""])


def in_step(text: str) -> str:
    """Return a page with the commands of today between its marks."""
    before, rest = text.split(HEAD)
    return f"{before}{HEAD}{commands()}{TAIL}{rest.split(TAIL)[1]}"


def test_the_page_lists_the_commands_of_the_command_line() -> None:
    """Run this file as a script after a change of a summary or an example."""
    text = PAGE.read_text(encoding="utf-8")
    assert text == in_step(text)


if __name__ == "__main__":
    PAGE.write_text(in_step(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
