"""Every command of README, pages and examples runs from an empty folder."""

import runpy
import sys
from pathlib import Path

import pytest
from page_commands import ROOT, PageCommand, commands, pages

from jointbench.station.main import app, exit_code

LIST = ROOT / "docs" / "examples.md"
BEGIN, END = "<!-- not run -->\n", "<!-- end of not run -->\n"
_done: set[tuple[str, ...]] = set()
"""Commands that ran on another page: what is there twice runs once."""
QUALITY = 5


@pytest.mark.parametrize(
    "page", pages(), ids=lambda page: page.relative_to(ROOT).as_posix()
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
        if not one.reason:
            run(one, monkeypatch)


def run(one: PageCommand, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a command in this process, so that nothing is imported again."""
    program, *rest = one.words
    if program == "cd":
        monkeypatch.chdir(Path(rest[0]))
    elif program == "python":
        monkeypatch.setattr(sys, "argv", rest)
        runpy.run_path(rest[0], run_name="__main__")
    else:
        assert program == "jointbench", f"no comment says why it is not run: {one.text}"
        monkeypatch.setattr(sys, "argv", one.words)
        code = exit_code(app, debug=True)
        wanted = {QUALITY} if "exit code 5" in one.remark else {0, None}
        assert code in wanted, f"{one.text}: exit code {code}"


def not_run() -> str:
    """Return the table of the commands that are not run, with the reason."""
    rows = {
        (one.text, one.reason)
        for page in pages()
        for one in commands(page)
        if one.reason not in {"", "installs"}
    }
    lines = [f"| `{text.replace('|', ' ')}` | {why} |" for text, why in sorted(rows)]
    return "\n".join(["| command | why |", "|---|---|", *lines, ""])


def test_the_commands_that_are_not_run_are_listed() -> None:
    """Run this file as a script to write the list again."""
    text = LIST.read_text(encoding="utf-8")
    assert text.split(BEGIN)[1].split(END)[0] == not_run()


if __name__ == "__main__":
    before, rest = LIST.read_text(encoding="utf-8").split(BEGIN)
    LIST.write_text(
        f"{before}{BEGIN}{not_run()}{END}{rest.split(END)[1]}", encoding="utf-8"
    )
