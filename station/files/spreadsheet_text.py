# SPDX-License-Identifier: MIT
"""Cells of tables that no spreadsheet takes for a formula."""

from jointbench.acquisition.file_access.quoting import visible

_FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")


def escaped(cell: str) -> str:
    """Return a cell that shows all of itself and that no spreadsheet calculates.

    Source:
        OWASP, CSV Injection: a cell must not begin with ``= + - @``, tab or return;
        spreadsheets of East Asian languages take the wide forms of these as well.
    """
    seen = visible(cell)
    return f"'{seen}" if cell.lstrip().startswith(_FORMULA) else seen
