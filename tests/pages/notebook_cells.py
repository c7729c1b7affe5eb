"""Notebooks from scripts in cells, and their execution without a kernel.

A script is the source: ``# %%`` begins a cell of code, ``# %% [markdown]`` a cell of
text. Editors open it as a notebook. Run this file to write the notebooks and the
tutorial pages with their outputs again:

    python tests/pages/notebook_cells.py
"""

import ast
import contextlib
import io
import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
TUTORIALS: Mapping[str, str] = {
    "hits/first_mode": "tutorial-first-mode",
    "joint/joint_stiffness": "tutorial-joint-stiffness",
    "campaign/what_is_missing": "tutorial-what-is-missing",
    "archive/year": "tutorial-archive",
}
"""Script below `examples` and page below `docs`."""
MARK = "# %%"
TEXT = "# %% [markdown]"
_NAMES = {"name": "python3", "display_name": "Python 3", "language": "python"}


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell.

    Attributes:
        text: of the cell, as the reader sees it.
        code: whether it is run.
    """

    text: str
    code: bool


@dataclass(frozen=True, slots=True)
class Output:
    """What a cell printed, and what its last expression shows.

    Attributes:
        printed: text on standard output.
        shown: the value as text, empty for none.
        html: the value as HTML, empty for none.
    """

    printed: str = ""
    shown: str = ""
    html: str = ""


def cells(script: str) -> Iterator[Cell]:
    """Yield the cells of a script."""
    for block in script.split(f"\n{MARK}"):
        head, _, body = block.removeprefix(MARK).partition("\n")
        if "[markdown]" in head:
            lines = (
                line.removeprefix("#").strip() for line in body.strip().split("\n")
            )
            yield Cell("\n".join(lines), code=False)
        else:
            yield Cell(body.strip(), code=True)


def run_cells(found: list[Cell]) -> list[Output]:
    """Run the cells in one namespace, in the current folder, as a notebook does."""
    names: dict[str, object] = {}
    return [_run(cell.text, names) if cell.code else Output() for cell in found]


def _run(text: str, names: dict[str, object]) -> Output:
    tree = ast.parse(text)
    last = tree.body[-1] if tree.body else None
    shown: object = None
    buffer = io.StringIO()
    with contextlib.redirect_stdout(buffer):
        if isinstance(last, ast.Expr):
            tree.body.pop()
            exec(compile(tree, "cell", "exec"), names)
            shown = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
        else:
            exec(compile(tree, "cell", "exec"), names)
    view = getattr(shown, "_repr_html_", None)
    return Output(
        buffer.getvalue(),
        "" if shown is None else str(shown),
        "" if view is None else str(view()),
    )


def notebook(found: list[Cell], outputs: list[Output]) -> str:
    """Return a notebook of format 4.5 with its outputs."""
    body, count = [], 0
    for number, (cell, output) in enumerate(zip(found, outputs, strict=True)):
        one: dict[str, object] = {
            "id": f"cell-{number}",
            "metadata": {},
            "source": cell.text.splitlines(keepends=True),
        }
        if cell.code:
            count += 1
            one |= {
                "cell_type": "code",
                "execution_count": count,
                "outputs": _outputs(output, count),
            }
        else:
            one |= {"cell_type": "markdown"}
        body.append(one)
    whole = {
        "cells": body,
        "metadata": {"kernelspec": _NAMES, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(whole, indent=1) + "\n"


def _outputs(output: Output, count: int) -> list[dict[str, object]]:
    found: list[dict[str, object]] = []
    if output.printed:
        found.append(
            {"output_type": "stream", "name": "stdout", "text": [output.printed]}
        )
    if output.shown:
        data = {"text/plain": [output.shown]}
        data |= {"text/html": [output.html]} if output.html else {}
        found.append(
            {
                "output_type": "execute_result",
                "execution_count": count,
                "data": data,
                "metadata": {},
            }
        )
    return found


def page(script: str, found: list[Cell], outputs: list[Output]) -> str:
    """Return the tutorial as a page: text, code and what it prints."""
    name = script.rsplit("/", maxsplit=1)[-1]
    blocks = []
    for cell, output in zip(found, outputs, strict=True):
        if not cell.code:
            blocks.append(cell.text)
            continue
        blocks.append(f"```python\n{cell.text}\n```")
        said = (output.printed + output.shown).rstrip()
        if said:
            blocks.append(f"```text\n{said}\n```")
    blocks.append(
        f"As a notebook, with plots: [{name}.ipynb](../examples/{script}.ipynb); "
        f"`jointbench example {script.split('/')[0]}` writes it. Next: "
        "[what to type for what you have](uses.md)."
    )
    return "\n\n".join(blocks) + "\n"


def write(script: str) -> None:
    """Run a tutorial in an empty folder; write its notebook and its page."""
    source = ROOT / "examples" / f"{script}.py"
    found = list(cells(source.read_text(encoding="utf-8")))
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            outputs = run_cells(found)
        finally:
            os.chdir(before)
    source.with_suffix(".ipynb").write_text(notebook(found, outputs), encoding="utf-8")
    text = page(script, found, outputs)
    (ROOT / "docs" / f"{TUTORIALS[script]}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    for one in TUTORIALS:
        write(one)
