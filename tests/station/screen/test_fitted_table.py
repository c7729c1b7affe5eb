"""Tables in the width of the terminal or of COLUMNS."""

import os
import subprocess
import sys

import pytest

from jointbench.station.screen.fitted_table import fitted_widths
from jointbench.station.screen.text_width import output_width

HEADS = ("mode", "natural frequency [Hz]", "verdict")
ROWS = [("1", "197.969061 ± 0.000038", "accepted"), ("2", "722.49 ± 0.01", "doubtful")]
CODE = (
    "from jointbench.station.screen.terminal import console, table\n"
    f"console().print(table('Modes', {HEADS!r}, {ROWS!r}))\n"
)


def shown(columns: int | None) -> list[str]:
    """Print the table into a pipe and return its lines."""
    environment = {k: v for k, v in os.environ.items() if k != "COLUMNS"}
    if columns is not None:
        environment["COLUMNS"] = str(columns)
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        capture_output=True,
        text=True,
        check=True,
        env=environment | {"PYTHONIOENCODING": "utf-8"},
        encoding="utf-8",
    )
    return [line.rstrip() for line in done.stdout.split("\n")]


@pytest.mark.parametrize(
    ("width", "expected"),
    [
        (80, (4, 22, 8)),
        (38, (4, 22, 8)),
        (37, (4, 21, 8)),
        (36, (4, 20, 8)),
        (26, (4, 10, 8)),
        (25, None),
    ],
)
def test_heads_narrow_first_then_cells_down_to_their_longest_word(
    width: int, expected: tuple[int, ...] | None
) -> None:
    """Two blanks separate columns: 34 + 4 columns take the table as it is."""
    assert fitted_widths(HEADS, ROWS, width) == expected


def test_a_table_without_rows_has_the_widths_of_its_heads() -> None:
    """And one without columns has none."""
    assert fitted_widths(HEADS, [], 80) == (4, 22, 7)
    assert fitted_widths((), [], 80) == ()


@pytest.mark.parametrize("columns", [None, 120, 80, 40, 26, 24])
def test_every_word_is_shown_within_the_width(columns: int | None) -> None:
    """Below the longest words each row becomes a block of lines."""
    lines = shown(columns)
    assert max(map(len, lines)) <= (columns or 80)
    words = " ".join(lines).replace(":", " ").split()
    for cell in (*HEADS, *(cell for row in ROWS for cell in row)):
        assert set(cell.split()) <= set(words)


def test_without_terminal_and_columns_the_width_is_80(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And COLUMNS, where it is set."""
    monkeypatch.setenv("COLUMNS", "97")
    assert output_width() == 97
    monkeypatch.delenv("COLUMNS")
    monkeypatch.setattr(sys, "__stdout__", None)
    assert output_width() == 80
