# SPDX-License-Identifier: MIT
"""meshio in a separate process: its parsers have no bound on time or memory.

An endless line of a gmsh file kept one of them busy for minutes. The system can limit a
child's time and memory (on Windows only its time).
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import VARIABLE, room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.analysis.structures.matrices.abaqus_text import copy_solids

CPU = 10
"""[s]"""
_OURS = 150 * 10**6
"""Memory limit of the child for a file [bytes]."""
_WALL = 120.0
"""Longest wait on a loaded machine [s]."""
_CODE = """
import sys
path, out, cpu, memory = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
import meshio, numpy
try:
    import resource
except ImportError:
    pass
else:
    resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu))
    resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
found = meshio.read(path)
cells = {f"{i} {b.type}": b.data for i, b in enumerate(found.cells)}
numpy.savez(out, points=found.points, **cells)
"""


def read_with_meshio(path: Path) -> tuple[FloatArray, list[tuple[str, IntArray]]]:
    """Return the nodes of a mesh file, shape (n, 3), and its cells, block by block.

    Args:
        path: of the file; meshio recognises its format by the suffix.

    Returns:
        Nodes in the unit of the file, and for each block the type of its elements and
        their nodes, shape (n_elements, n_nodes).

    Raises:
        FormatError: meshio cannot read it.
        HostileFile: reading takes more time or memory than allowed for the file.
    """
    with tempfile.TemporaryDirectory() as folder:
        out, source = Path(folder) / "mesh.npz", path
        if path.suffix.lower() == ".inp":
            source = Path(folder) / "solids.inp"
            copy_solids(path, source)
        limits = str(CPU), str(room(file_size(path)) - _OURS)
        words = [sys.executable, "-c", _CODE, str(source), str(out), *limits]
        try:
            done = subprocess.run(
                words, capture_output=True, text=True, timeout=_WALL, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise _too_much(path) from error
        printed = (done.stderr.strip() or done.stdout.strip() or "nothing").splitlines()
        if done.returncode < 0 or printed[-1].startswith("MemoryError"):
            raise _too_much(path)
        if done.returncode or not out.exists():
            raise FormatError(
                f"{named(path)}: meshio cannot read it ({shown(printed[-1])})"
            )
        with np.load(out, allow_pickle=False) as arrays:
            blocks = [
                (name.partition(" ")[2], np.asarray(arrays[name], np.int64))
                for name in arrays.files
                if name != "points"
            ]
            return np.asarray(arrays["points"], np.float64), blocks


def _too_much(path: Path) -> HostileFile:
    return HostileFile(
        f"{named(path)} takes meshio more than {CPU} s or "
        f"{room(file_size(path)) / 1e6:.0f} MB; thin the mesh, save it in a binary "
        f"format, or allow more by {VARIABLE}"
    )
