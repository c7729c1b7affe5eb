"""The tutorials run, and their notebooks and pages hold the same cells."""

import json
from pathlib import Path

import pytest
from notebook_cells import ROOT, TUTORIALS, cells, run_cells


def script(name: str) -> str:
    """Return the source of a tutorial."""
    return (ROOT / "examples" / f"{name}.py").read_text(encoding="utf-8")


@pytest.mark.heavy(reason="a diagnosis of a whole campaign, an archive of a year")
@pytest.mark.parametrize("name", TUTORIALS)
def test_a_tutorial_runs_from_an_empty_folder(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every cell, in one namespace; the last one of each has an output."""
    monkeypatch.chdir(tmp_path)
    outputs = run_cells(list(cells(script(name))))
    assert any(output.html for output in outputs)


@pytest.mark.parametrize("name", TUTORIALS)
def test_notebook_and_page_have_the_cells_of_the_script(name: str) -> None:
    """Run `python tests/pages/notebook_cells.py` after a change of a script."""
    found = list(cells(script(name)))
    stored = json.loads((ROOT / "examples" / f"{name}.ipynb").read_text("utf-8"))
    assert [
        ("".join(c["source"]), c["cell_type"] == "code") for c in stored["cells"]
    ] == [(cell.text, cell.code) for cell in found]
    page = (ROOT / "docs" / f"{TUTORIALS[name]}.md").read_text(encoding="utf-8")
    assert all(cell.text in page for cell in found)
