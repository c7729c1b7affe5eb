# SPDX-License-Identifier: MIT
"""Run CalculiX where it is installed."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.analysis.structures.exchange.calculix_joint import read_frequencies

PROGRAM = "ccx"
_SECONDS = 1800


def require_calculix() -> None:
    """Raise `UsageError` where CalculiX is not installed."""
    if shutil.which(PROGRAM) is None:
        raise UsageError(
            f"--check needs CalculiX, and there is no program {PROGRAM!r}: install "
            "calculix-ccx, or leave --check out"
        )


def calculix_frequencies(text: str) -> FloatArray:
    """Return the natural frequencies that CalculiX finds for a model [Hz].

    Args:
        text: of the input deck.

    Raises:
        FormatError: it found none.
    """
    threads = dict.fromkeys(("OMP_NUM_THREADS", "CCX_NPROC_STIFFNESS"), "1")
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder) / "model.inp"
        deck.write_text(text, encoding="utf-8")
        done = subprocess.run(
            [PROGRAM, "-i", "model"],
            cwd=folder,
            env=os.environ | threads,
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
        result = deck.with_suffix(".dat")
        if not result.is_file() or not result.stat().st_size:
            _, found, words = done.stdout.partition("*ERROR")
            said = " ".join(words.split())[:200] if found else "nothing"
            raise FormatError(f"CalculiX wrote no eigenvalues; its message: {said}")
        return read_frequencies(result.read_text(encoding="utf-8"))
