# SPDX-License-Identifier: MIT
"""Bodies of boxes and cylinders, added and cut, meshed by gmsh (tet10).

gmsh runs in a process of its own: its licence (GPL) and its signal handlers stay
apart, and the system can end it. It is an extra, `jointbench[mesh]`.
"""

import importlib.util
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh

_Point = tuple[float, float, float]
# Longest time for one body [s]; 300,000 nodes take about a minute.
_WALL = 600.0
# gmsh numbers the last two midside nodes of a tetrahedron the other way round.
_TET10_ORDER = (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)
_CODE = """
import json, sys
import gmsh, numpy
wanted = json.load(open(sys.argv[1], encoding="utf-8"))
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("General.NumThreads", 1)
occ = gmsh.model.occ
def shape(one):
    if one["radius"] is None:
        return (3, occ.addBox(*one["origin"], *one["size"]))
    return (3, occ.addCylinder(*one["origin"], *one["size"], one["radius"]))
body = []
for one in wanted["shapes"]:
    new = [shape(one)]
    if not body:
        body = new
    elif one["cut"]:
        body, _ = occ.cut(body, new)
    else:
        body, _ = occ.fuse(body, new)
occ.synchronize()
if len(gmsh.model.getEntities(3)) != 1:
    sys.exit(f"the shapes make {len(gmsh.model.getEntities(3))} solids")
gmsh.option.setNumber("Mesh.MeshSizeMax", wanted["element"])
gmsh.option.setNumber("Mesh.MeshSizeMin", wanted["element"] / 4)
gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.option.setNumber("Mesh.SecondOrderLinear", 1)
gmsh.option.setNumber("Mesh.RandomSeed", 1)
gmsh.model.mesh.generate(3)
number, place, _ = gmsh.model.mesh.getNodes()
_, cells = gmsh.model.mesh.getElementsByType(11)
numpy.savez(sys.argv[2], number=number, place=place, cells=cells)
"""


@dataclass(frozen=True, slots=True)
class SolidShape:
    """A box, or a cylinder.

    Attributes:
        origin: lowest corner of a box; centre of the base of a cylinder [m].
        size: edges of a box; axis of a cylinder, from base to top [m].
        radius: of a cylinder [m]; None for a box.
        cut: the shape is cut from those before it, not added to them.
    """

    origin: _Point
    size: _Point
    radius: float | None = None
    cut: bool = False

    def __post_init__(self) -> None:
        """Check that the shape has a volume."""
        if self.radius is not None:
            require_positive("radius", self.radius)
        no_box = self.radius is None and min(self.size) <= 0
        if no_box or not any(self.size):
            raise BadData(
                f"a shape of size {self.size} m has no volume; edges of a box must be "
                "above zero, and a cylinder needs an axis"
            )


def mesh_shapes(shapes: Sequence[SolidShape], element: float) -> Mesh:
    """Mesh a body made of shapes with tet10 elements.

    Args:
        shapes: in order; the first one is added, later ones are added or cut.
        element: largest edge [m]; holes get at least twelve edges around. Edges are
            straight, so that joints on the faces have exact areas.

    Returns:
        The mesh.

    Raises:
        BadData: the shapes do not make one solid, or gmsh cannot mesh it.
        UsageError: gmsh is not installed.

    Source:
        Geuzaine and Remacle 2009, Int. J. Numer. Meth. Eng. 79, 1309-1331.
    """
    require_positive("element", element)
    if not shapes or shapes[0].cut:
        raise BadData("the first shape of a body is cut; begin with what is added")
    if importlib.util.find_spec("gmsh") is None:
        raise UsageError("shapes need gmsh: pip install 'jointbench[mesh]'")
    with tempfile.TemporaryDirectory() as folder:
        request, out = Path(folder) / "shapes.json", Path(folder) / "mesh.npz"
        content = {"shapes": [asdict(one) for one in shapes], "element": element}
        request.write_text(json.dumps(content), encoding="utf-8")
        _run([sys.executable, "-c", _CODE, str(request), str(out)])
        with np.load(out, allow_pickle=False) as found:
            return _mesh(found["number"], found["place"], found["cells"])


def _run(words: list[str]) -> None:
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, timeout=_WALL, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise BadData(
            f"gmsh took longer than {_WALL:g} s for one body; choose larger elements"
        ) from error
    if done.returncode:
        printed = (done.stderr.strip() or done.stdout.strip() or "nothing").split("\n")
        raise BadData(
            f"gmsh made no mesh ({printed[-1][:200]}); check that shapes overlap and "
            "that no thin piece is left"
        )


def _mesh(
    number: np.ndarray[tuple[int, ...], np.dtype[np.uint64]],
    place: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    cells: np.ndarray[tuple[int, ...], np.dtype[np.uint64]],
) -> Mesh:
    if not cells.size:
        raise BadData("gmsh made no tetrahedron; choose smaller elements")
    row = np.zeros(int(number.max()) + 1, np.int64)
    row[number.astype(np.int64)] = np.arange(number.size)
    tets = row[cells.astype(np.int64)].reshape(-1, 10)[:, _TET10_ORDER]
    used, tets = np.unique(tets, return_inverse=True)
    nodes = place.reshape(-1, 3)[used]
    return Mesh(nodes, tets.reshape(-1, 10).astype(np.int64), ElementKind.TET10)
