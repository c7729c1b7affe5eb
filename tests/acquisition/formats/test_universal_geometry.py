"""Geometry of universal files: nodes, lines and units, and shapes drawn on it."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.formats.universal_geometry import read_universal_geometry
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.station.schemas.geometry_file import draw_shapes, read_geometry

DATA = Path(__file__).parents[4] / "shared" / "data" / "pyuff"
UNITS = [
    f"{10:10d}{'mm (newton)':20s}{2:10d}",
    "  1.00000000000000000D+03  1.00000000000000000D+00  1.00000000000000000D+00",
    "  2.73149999999999977D+02",
]
NODES_15 = [
    f"{k:10d}{1:10d}{0:10d}{8:10d}{x:13.5E}{y:13.5E}{-250.0:13.5E}"
    for k, x, y in ((1, -100.0, -50.0), (2, 100.0, -50.0), (3, 100.0, 50.0))
]
NODES_2411 = [
    row
    for k in (1, 2, 3)
    for row in (
        f"{k:10d}{1:10d}{1:10d}{11:10d}",
        "".join(f"{100.0 * k * i:25.16E}".replace("E", "D") for i in (1, 2, 3)),
    )
]
TRACE = [f"{1:10d}{5:10d}{7:10d}", "edge", "".join(f"{n:10d}" for n in (1, 2, 0, 2, 3))]
ELEMENTS = [
    "".join(f"{n:10d}" for n in (1, 11, 2, 1, 7, 2)),
    "".join(f"{n:10d}" for n in (0, 1, 1)),
    "".join(f"{n:10d}" for n in (1, 2)),
    "".join(f"{n:10d}" for n in (2, 41, 2, 1, 7, 3)),
    "".join(f"{n:10d}" for n in (1, 2, 3)),
]


def write(path: Path, **sets: list[str]) -> Path:
    """Write data sets, ``n15=[...]``."""
    rows = []
    for name, lines in sets.items():
        rows += ["    -1", f"{int(name[1:]):6d}", *lines, "    -1"]
    path.write_text("\n".join(rows) + "\n", encoding="ascii")
    return path


def test_nodes_lines_and_units_are_read(tmp_path: Path) -> None:
    """Millimetres become metres; numbers without blanks between them are read."""
    path = write(tmp_path / "g.uff", n164=UNITS, n15=NODES_15, n82=TRACE)
    found = read_universal_geometry(path)
    assert found.points["1"] == pytest.approx((-0.1, -0.05, -0.25))
    assert found.lines == (("1", "2"), ("2", "3"))
    assert found.units_stated


def test_edges_of_elements_are_lines(tmp_path: Path) -> None:
    """A beam and a triangle; without data set 164 the unit is not stated."""
    path = write(tmp_path / "g.unv", n2411=NODES_2411, n2412=ELEMENTS)
    found = read_universal_geometry(path)
    assert found.points["2"] == pytest.approx((200.0, 400.0, 600.0))
    assert found.lines == (("1", "2"), ("2", "3"), ("3", "1"))
    assert not found.units_stated
    assert read_geometry(path).unit == "unit not stated"


def test_what_cannot_be_drawn_rightly_is_refused(tmp_path: Path) -> None:
    """Local coordinate systems, damaged sets, and files without a node."""
    turned = [row[:10] + f"{5:10d}" + row[20:] for row in NODES_15]
    with pytest.raises(FormatError, match="coordinate system 5"):
        read_universal_geometry(write(tmp_path / "a.uff", n15=turned))
    with pytest.raises(FormatError, match="data set 2411 is damaged"):
        read_universal_geometry(write(tmp_path / "b.uff", n2411=NODES_2411[:-1]))
    with pytest.raises(FormatError, match="no nodes"):
        read_universal_geometry(write(tmp_path / "c.uff", n82=TRACE))


def test_shapes_of_frfs_move_their_nodes(tmp_path: Path) -> None:
    """Output ``2-x`` is node 2 against x; a node that is not there is refused."""
    geometry = read_geometry(write(tmp_path / "g.uff", n164=UNITS, n15=NODES_15))
    one, pair = np.ones(1), np.ones((1, 3, 1), complex)
    shapes = np.array([[1.0 + 0j, 0.5, 0.25]])
    model = ModalModel(
        100.0 * one,
        one,
        0.01 * one,
        0.001 * one,
        pair,
        pair,
        shapes,
        0.01 * shapes,
        np.ones((1, 1), complex),
        one,
        one,
        np.ones(1, int),
        np.zeros(1, bool),
        outputs=("1+z", "2-x", "plate:3:+Y"),
        inputs=("1+z",),
    )
    drawn = draw_shapes(model, geometry)
    np.testing.assert_allclose(
        drawn.motion[0].real, [[0, 0, 1], [-0.5, 0, 0], [0, 0.25, 0]]
    )
    assert drawn.unit == "m"
    other = read_geometry(write(tmp_path / "h.uff", n15=NODES_15[:2]))
    with pytest.raises(BadData, match="no point"):
        draw_shapes(model, other)


@pytest.mark.skipif(not DATA.exists(), reason="the files of pyuff are not here")
@pytest.mark.parametrize(
    "name",
    ["groups_test", "mesh_Oros-modal_uff15_uff2412", "mesh_test_uff2412_mixed"],
)
def test_nodes_are_those_that_pyuff_reads(name: str) -> None:
    """Every node of the files of pyuff, by another reader."""
    import pyuff

    path = DATA / f"{name}.uff"
    file = pyuff.UFF(str(path))
    found = read_universal_geometry(path)
    for number, kind in enumerate(map(int, file.get_set_types())):
        if kind in (15, 2411):
            one = file.read_sets(number)
            rows = zip(one["node_nums"], one["x"], one["y"], one["z"], strict=True)
            assert found.points == {
                str(int(node)): (float(x), float(y), float(z)) for node, x, y, z in rows
            }
    assert found.lines
