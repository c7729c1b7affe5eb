"""Every command of README, pages and examples runs from an empty folder."""

import re
import runpy
import sys
from pathlib import Path

import pytest
from page_commands import (
    GENERATED,
    OF_COMMANDS,
    ROOT,
    PageCommand,
    commands,
    not_run,
    pages,
)

from jointbench.station.main import app, exit_code

LIST = ROOT / "docs" / "examples.md"
BEGIN, END = "<!-- not run -->\n", "<!-- end of not run -->\n"
COSTLY = ("jointbench gap session.h5", "jointbench machine")
"""What takes seconds runs on one page, where several have the same command."""
_done: set[str] = set()
QUALITY = 5


@pytest.mark.heavy(reason="the commands of a page use each other's results")
@pytest.mark.parametrize(
    "page",
    [page for page in pages() if page != GENERATED],
    ids=lambda page: page.relative_to(ROOT).as_posix(),
)
def test_the_commands_of_a_page_run_in_their_order(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A page brings its data by `jointbench example`; a README lies beside its own."""
    monkeypatch.chdir(tmp_path)
    if page.parent.parent.name == "examples":
        run(PageCommand(f"jointbench example {page.parent.name}", ""), monkeypatch)
        monkeypatch.chdir(tmp_path / page.parent.name)
    for one in commands(page):
        if not one.reason and one.text not in _done:
            run(one, monkeypatch)
            _done.update({one.text} if one.text.startswith(COSTLY) else ())


def run(one: PageCommand, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a command in this process, so that nothing is imported again."""
    program, *rest = one.words
    if program == "cd":
        monkeypatch.chdir(Path(rest[0]))
    elif program == "python":
        monkeypatch.setattr(sys, "argv", rest)
        runpy.run_path(rest[0], run_name="__main__")
    else:
        assert program == "jointbench", f"give the reason in a comment: {one.text}"
        monkeypatch.setattr(sys, "argv", one.words)
        code = exit_code(app, debug=True)
        wanted = {QUALITY} if "exit code 5" in one.remark else {0, None}
        assert code in wanted, f"{one.text}: exit code {code}"


def test_the_first_examples_of_the_help_run_on_some_page() -> None:
    """The page of all commands has their first examples; other pages bring the data."""
    others = [page for page in pages() if page != GENERATED]
    elsewhere = {c.text for page in others for c in commands(page) if not c.reason}
    known = elsewhere | {c.text for c in commands(GENERATED) if c.reason}
    missing = [
        one.text
        for one in commands(GENERATED)
        if one.text not in known and one.words[1] not in OF_COMMANDS
    ]
    assert not missing


def test_blocks_of_commands_are_marked_as_such() -> None:
    """A block without a language would never be run."""
    plain = re.compile(r"^```\n(?:python |\.?venv|jointbench )", re.MULTILINE)
    for path in (ROOT / "docs").glob("*.md"):
        blocks = re.split(r"^```", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
        begun = [f"```{one}" for one in blocks[1::2]]
        assert not [one for one in begun if plain.match(one)], path.name


def table() -> str:
    """Return the table of the commands that are not run, with the reason."""
    rows = {row for page in pages() for row in not_run(page)}
    lines = [f"| `{text.replace('|', ' ')}` | {why} |" for text, why in sorted(rows)]
    return "\n".join(["| command | why |", "|---|---|", *lines, ""])


def test_the_commands_that_are_not_run_are_listed() -> None:
    """Run this file as a script to write the list again."""
    text = LIST.read_text(encoding="utf-8")
    assert text.split(BEGIN)[1].split(END)[0] == table()


if __name__ == "__main__":
    before, rest = LIST.read_text(encoding="utf-8").split(BEGIN)
    LIST.write_text(
        f"{before}{BEGIN}{table()}{END}{rest.split(END)[1]}", encoding="utf-8"
    )
