"""The help of all commands: complete at any width, with units and valid examples."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.core import TyperCommand, TyperGroup

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.station.main import COMMANDS, app
from jointbench.station.pipeline.contact_request import parse_hardness
from jointbench.station.screen.help_page import summary_of, value_name
from jointbench.station.screen.help_text import command_text

GROUP = typer.main.get_command(app)
assert isinstance(GROUP, TyperGroup)
NAMES = list(GROUP.commands)
QUANTITIES = {"QUANTITY", "NUMBER", "LOW:HIGH", "FREQUENCY", "ANGLE", "LIMIT", "GAMMA"}
QUANTITIES |= {"NAME:FROM:TO:N", "ROLE:UNIT,...", "HEIGHT:PITCH"}
OTHERS = {"PATH", "FOLDER", "URL", "NAME", "NAME,...", "TERM,...", "N"}
KINDS = ("force", "length", "mass", "pressure", "ratio", "frequency", "stiffness")
KINDS += ("torque", "time")
MOST_SUMMARY = 60


def command(name: str) -> TyperCommand:
    """Return a command of the application."""
    assert isinstance(GROUP, TyperGroup)
    found = GROUP.commands[name]
    assert isinstance(found, TyperCommand)
    return found


def page(*words: str, columns: int, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return the help of a command at a width, as a pipe receives it."""
    monkeypatch.setenv("COLUMNS", str(columns))
    context = GROUP.make_context("jointbench", [*words], resilient_parsing=True)
    if words:
        context = command(words[0]).make_context(
            words[0], [], parent=context, resilient_parsing=True
        )
    return context.get_help()


def options() -> Iterator[tuple[str, Any]]:
    """Yield each option with a value, with its command."""
    for name in NAMES:
        for one in command(name).params:
            if one.param_type_name == "option" and value_name(one):
                yield name, one


def run(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run ``python -m jointbench`` in a process of its own."""
    surroundings = {k: v for k, v in os.environ.items() if k != "COLUMNS"}
    return subprocess.run(
        [sys.executable, "-m", "jointbench", *words],
        capture_output=True,
        text=True,
        check=False,
        env=surroundings | environment,
    )


@pytest.mark.parametrize("columns", [80, 60])
@pytest.mark.parametrize("name", ["", *NAMES])
def test_help_fits_the_width_and_cuts_nothing(
    name: str, columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No line is too long and no text is shortened with dots."""
    words = [name] if name else []
    lines = page(*words, columns=columns, monkeypatch=monkeypatch).split("\n")
    assert max(map(len, lines)) <= columns
    cut = [line for line in lines if re.search(r"[a-z]\.\.\.$|…", line)]
    assert not cut


@pytest.mark.parametrize("name", NAMES)
def test_no_word_of_a_help_text_is_lost_at_40_columns(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The narrow page has the words of the wide one."""
    narrow, wide = (
        page(name, columns=columns, monkeypatch=monkeypatch).replace("\\\n", "")
        for columns in (40, 100)
    )
    assert "".join(narrow.split()) == "".join(wide.split())


def test_the_list_of_commands_shows_each_whole_summary_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At 80 columns, each under its group."""
    lines = page(columns=80, monkeypatch=monkeypatch).split("\n")
    for group, members in COMMANDS.items():
        start = lines.index(f"{group}:")
        shown = lines[start + 1 : start + 1 + len(members)]
        assert [line.split()[0] for line in shown] == list(members)
        for line, name in zip(shown, members, strict=True):
            assert line.endswith(summary_of(command(name)))


@pytest.mark.parametrize("name", NAMES)
def test_a_summary_is_a_short_sentence(name: str) -> None:
    """At most 60 characters, with a full stop."""
    summary = summary_of(command(name))
    assert summary.endswith(".")
    assert len(summary) <= MOST_SUMMARY


@pytest.mark.parametrize("name", NAMES)
def test_each_command_has_examples_that_parse(name: str) -> None:
    """The parser of the command accepts options, values and arguments."""
    examples = command_text(command(name).help).examples
    assert examples
    for example in examples:
        program, typed, *words = shlex.split(example)
        assert (program, typed) == ("jointbench", name)
        context = command(name).make_context(name, words)
        assert context.params


@pytest.mark.parametrize("name", NAMES)
def test_the_examples_survive_the_wrapping(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A shell reads the lines of the page as the commands of the docstring."""
    shown = page(name, columns=60, monkeypatch=monkeypatch)
    block = re.split(r"^Examples?:\n", shown, flags=re.MULTILINE)[1]
    lines = block.replace("\\\n", "").split("\n")
    examples = command_text(command(name).help).examples
    assert [shlex.split(line) for line in lines] == [*map(shlex.split, examples)]


@pytest.mark.parametrize(("name", "option"), list(options()))
def test_an_option_names_its_value(name: str, option: Any) -> None:
    """By a known word, or by its alternatives."""
    word = value_name(option)
    assert word in QUANTITIES | OTHERS or "|" in word, f"{name} {option.opts}: {word}"
    kind = option.type_descriptor.annotation
    assert kind is not float or word in QUANTITIES


@pytest.mark.parametrize(
    ("name", "option"), [one for one in options() if value_name(one[1]) in QUANTITIES]
)
def test_an_option_that_takes_a_quantity_shows_unit_and_example(
    name: str, option: Any
) -> None:
    """A unit in brackets with an example or a default, or a quoted quantity."""
    text = option.help
    if value_name(option) == "QUANTITY":
        quoted = re.findall(r"'([^']+)'", text)
        assert quoted, f"{name} {option.opts}: {text}"
        assert all(map(readable, quoted)), f"{name} {option.opts}: {text}"
    elif value_name(option) == "ROLE:UNIT,...":
        assert re.search(r"'x:um,z:um'", text)
    else:
        assert re.search(r"\[[^\]]+\]", text), f"{name} {option.opts}: no unit: {text}"
        assert "for example" in text or option.default is not None


def readable(text: str) -> bool:
    """Return whether the product reads a text as a quantity with a unit."""
    for kind in KINDS:
        try:
            parse_value(text, kind)
        except UnitError:
            continue
        return True
    return parse_hardness(text) > 0


@pytest.mark.parametrize("words", [("demo", "--help"), ("--help",)])
def test_help_in_a_pipe_takes_its_width_from_columns(words: tuple[str, ...]) -> None:
    """COLUMNS counts without a terminal; without both, there are 80 columns."""
    narrow, wide = run(*words, COLUMNS="50").stdout, run(*words).stdout
    assert max(map(len, narrow.split("\n"))) <= 50
    assert 50 < max(map(len, wide.split("\n"))) <= 80


def test_version_lists_the_product_python_and_the_libraries() -> None:
    """By ``python -m jointbench``, one line each."""
    done = run("--version")
    assert done.returncode == 0, done.stderr
    shown = dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
    assert list(shown) == ["jointbench", "python", "numpy", "scipy", "h5py", "nidaqmx"]
    assert shown["numpy"] == version("numpy")
    assert sys.version.startswith(shown["python"])


def test_version_imports_no_library() -> None:
    """It reads the metadata of the installed packages."""
    code = (
        "import sys\n"
        "from jointbench.station.main import app, exit_code\n"
        "sys.argv = ['jointbench', '--version']\n"
        "assert exit_code(app, debug=False) == 0\n"
        "heavy = {'numpy', 'scipy', 'h5py', 'nidaqmx'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)


def test_the_package_root_holds_the_library_and_nothing_else() -> None:
    """Its import loads no library; all else belongs to a folder of its own."""
    root = Path(__file__).parents[2] / "library"
    assert {one.name for one in root.iterdir() if one.is_file()} == {
        "__init__.py",
        "__main__.py",
        "py.typed",
    }


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell", "pwsh"])
def test_each_shell_has_a_completion_script(shell: str) -> None:
    """The script names the command that it completes."""
    done = run(_JOINTBENCH_COMPLETE=f"source_{shell}")
    assert done.returncode == 0, done.stderr
    assert "jointbench" in done.stdout
    assert "_JOINTBENCH_COMPLETE" in done.stdout


@pytest.mark.parametrize(
    ("typed", "position", "expected"),
    [
        ("jointbench mo", "1", ["modal"]),
        (
            "jointbench re",
            "1",
            ["record", "report", "reprocess", "reassembly", "recover"],
        ),
        ("jointbench modal --ba", "2", ["--band"]),
    ],
)
def test_bash_completes_commands_and_options(
    typed: str, position: str, expected: list[str]
) -> None:
    """Commands in the order of the help."""
    done = run(
        _JOINTBENCH_COMPLETE="complete_bash", COMP_WORDS=typed, COMP_CWORD=position
    )
    assert done.stdout.split() == expected


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["modl", "x.h5"], "'modal'"),
        (["modal", "--jsom", "x.json", "x.h5"], "'--json'"),
        (["--versoin"], "'--version'"),
    ],
)
def test_a_misspelt_word_is_answered_with_the_near_match(
    words: list[str], near: str
) -> None:
    """One line, exit code two, and the help that lists the right ones."""
    done = run(*words)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert f"Did you mean {near}?" in line
    assert "--help'" in line
