# SPDX-License-Identifier: MIT
"""The width of the output: COLUMNS, else the terminal, else 80 columns."""

import shutil

WIDTH_WITHOUT_TERMINAL = 80
_NARROWEST_HELP, _WIDEST_HELP = 40, 100


def output_width() -> int:
    """Return the width of tables and lines [columns], the same in a pipe.

    The environment variable COLUMNS comes first, the terminal on standard output
    second.
    """
    return shutil.get_terminal_size((WIDTH_WITHOUT_TERMINAL, 24)).columns


def help_width() -> int:
    """Return the width of help [columns]; longer lines are hard to read."""
    return min(max(output_width(), _NARROWEST_HELP), _WIDEST_HELP)
