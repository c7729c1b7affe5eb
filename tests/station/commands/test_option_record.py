# SPDX-License-Identifier: MIT
"""Options of a command from the fields of one record."""

import inspect
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from jointbench.station.commands.contact_command import contact_command
from jointbench.station.commands.option_record import options_of
from jointbench.station.pipeline.contact_options import ContactOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """Options of a command that no bench has."""

    size: Annotated[float, typer.Option(help="How wide [m].")]
    name: Annotated[list[str] | None, typer.Option(help="May be repeated.")] = None
    out: Annotated[Path, typer.Option("--target", help="Where to.")] = Path("here")
    loud: Annotated[bool, typer.Option("--loud")] = False


SEEN: list[Shape] = []
APP = typer.Typer(rich_markup_mode=None)


@APP.command()
@options_of(Shape)
def draw(given: Shape) -> int:
    """Draw a shape."""
    SEEN.append(given)
    return 3


def plain(
    size: Annotated[float, typer.Option(help="How wide [m].")],
    name: Annotated[list[str] | None, typer.Option(help="May be repeated.")] = None,
    out: Annotated[Path, typer.Option("--target", help="Where to.")] = Path("here"),
    loud: Annotated[bool, typer.Option("--loud")] = False,
) -> int:
    """Draw a shape."""
    return 3


def test_the_command_receives_one_record() -> None:
    """Parsed types, repeated options and defaults included."""
    arguments = ["--size", "2", "--name", "a", "--name", "b"]
    code = typer.main.get_command(APP).main(arguments, standalone_mode=False)
    assert SEEN.pop() == Shape(size=2.0, name=["a", "b"])
    assert code == 3


def test_help_is_that_of_a_callback_with_a_parameter_for_each_option() -> None:
    """To the letter."""
    other = typer.Typer(rich_markup_mode=None)
    other.command(name="draw")(plain)
    runner = CliRunner()
    wanted = runner.invoke(other, ["--help"], prog_name="x").output
    assert "--target" in wanted
    assert runner.invoke(APP, ["--help"], prog_name="x").output == wanted


def test_a_required_field_is_a_required_option() -> None:
    """The record has no default for it."""
    result = CliRunner().invoke(APP, [])
    assert result.exit_code == 2
    assert "--size" in result.output


@pytest.mark.parametrize("name", ["modulus", "hardness"])
def test_contact_takes_each_option_of_its_record_once(name: str) -> None:
    """In their order, which is that of the help; the material alone is required."""
    seen = inspect.signature(contact_command).parameters
    assert list(seen) == [one.name for one in fields(ContactOptions)]
    required = [p.name for p in seen.values() if p.default is p.empty]
    assert name in required
    assert len(required) == 2
