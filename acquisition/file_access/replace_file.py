# SPDX-License-Identifier: MIT
"""Give a file the name of another, also where that is open for a moment.

Windows refuses to replace a file that any program has open, such as a view of the
session or a virus scanner; elsewhere the name changes at once.
"""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

PATIENCE = 3.0 if sys.platform == "win32" else 0.0
"""Time in which a reader of the old file is waited for [s]; views look for 0.1 s."""
_RETRY = 0.05  # [s]


def replace_file(
    source: Path,
    target: Path,
    *,
    patience: float = PATIENCE,
    sleep: Callable[[float], None] = time.sleep,
) -> None:
    """Rename a file, replacing what has the name.

    Args:
        source: file to rename.
        target: its new name, in the same folder.
        patience: time in which a refusal is taken for a reader that will leave [s].
        sleep: function that waits [s].

    Raises:
        OSError: the system refuses; both files are as they were.
    """
    waited = 0.0
    while True:
        try:
            os.replace(source, target)  # noqa: PTH105 - replaces on Windows too
        except PermissionError:
            if waited >= patience:
                raise
            waited += _RETRY
            sleep(_RETRY)
        else:
            return
