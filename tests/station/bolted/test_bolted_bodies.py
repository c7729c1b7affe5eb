"""Bodies by K and M on bolted areas: a hundred nodes as few relative motions."""

from pathlib import Path

import numpy as np
import pytest
import scipy.io
from bolted_plates import MODEL, FullPlates, write_hits, write_model

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.session_file.store import read_session
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.structure_bench.make_structure_bench import (
    make_structure_bench,
)
from jointbench.analysis.gap.structure_response.base_layout import base_layout
from jointbench.analysis.gap.structure_response.closed_response import close
from jointbench.analysis.gap.structure_response.joint_state import state_of
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.station.bolted.bolted_campaign import bolted_campaign
from jointbench.station.bolted.free_bodies import (
    BoltedModel,
    bolted_model,
    gap_table,
)
from jointbench.station.bolted.nominal_values import nominal_bench
from jointbench.station.gap.run_gap import run_gap
from jointbench.station.gap.session_hits import judged_recordings, with_preloads
from jointbench.station.joints.structure_model import StructureModel

LINES = 30.0 + 2j * np.pi * np.array([150.0, 600.0, 1100.0, 1900.0])


def _closed(
    model: StructureModel, found: BoltedModel, bodies: JointedBodies
) -> ComplexArray:
    """Return sensors per hit at nominal values, shape (n_lines, 3, 2)."""
    nominal = nominal_bench(gap_table(model), found.areas, 1.0)
    layout = base_layout(bodies, nominal)
    state = state_of(bodies, nominal, layout, np.zeros(layout.sd.size))
    columns = np.stack([p.direction @ p.rows for p in bodies.points])
    return close(bodies, state, LINES, columns)


def test_few_relative_motions_have_the_response_of_the_full_matrices(
    tmp_path: Path,
) -> None:
    """Lines from 150 to 1900 Hz within 0.2 % of the full mesh with even springs."""
    _, model = write_model(tmp_path)
    found = bolted_model(model, tmp_path)
    response = _closed(model, found, found.bodies)
    wanted = FullPlates(model, {}).response(LINES)
    error = np.linalg.norm(response - wanted, axis=(1, 2))
    assert np.all(error < 2e-3 * np.linalg.norm(wanted, axis=(1, 2)))
    assert found.bodies.joints == {"left": (0,), "right": (1, 2)}
    assert found.bodies.bolt_names == ("left", "right 1", "right 2")


def test_another_thickness_has_the_response_of_a_body_meshed_anew(
    tmp_path: Path,
) -> None:
    """A plate of 11.3 in place of 10 mm, sensors and hits on its surface: 0.3 %."""
    _, model = write_model(tmp_path)
    thin = bolted_model(model, tmp_path)
    text = MODEL.replace('"80 mm", "10 mm"]', '"80 mm", "11.3 mm"]')
    text = text.replace('"22 mm"]', '"23.3 mm"]').replace('"17 mm"]', '"17.65 mm"]')
    _, thicker = write_model(tmp_path, text)
    wanted = _closed(thicker, thin, bolted_model(thicker, tmp_path).bodies)
    response = _closed(model, thin, thin.bodies.thickness["upper"](1.13))
    plain = _closed(model, thin, thin.bodies)
    error = np.linalg.norm(response - wanted, axis=(1, 2))
    assert np.all(error < 3e-3 * np.linalg.norm(wanted, axis=(1, 2)))
    assert np.linalg.norm(plain - wanted) > 0.1 * np.linalg.norm(wanted)


def test_matrices_of_another_program_keep_the_order_of_their_mesh(
    tmp_path: Path,
) -> None:
    """K and M with rows in the file's order of nodes: the same modes as the box."""
    meshio = pytest.importorskip("meshio")
    _, model = write_model(tmp_path)
    box = bolted_model(model, tmp_path)
    body = box.structure.bodies[1]
    count = len(body.mesh.nodes)
    order = np.random.default_rng(1).permutation(count)
    rows = (3 * order[:, None] + np.arange(3)).ravel()
    number = np.argsort(order)
    mesh = meshio.Mesh(
        body.mesh.nodes[order], {"hexahedron20": number[body.mesh.cells]}
    )
    mesh.write(tmp_path / "upper.vtu")
    for word, matrix in (("k", body.stiffness), ("m", body.mass)):
        scipy.io.mmwrite(tmp_path / f"{word}.mtx", matrix[rows][:, rows])
    start = MODEL.index('box = ["160 mm"')
    end = MODEL.index("[joints.left]")
    files = 'mesh = "upper.vtu"\nstiffness = "k.mtx"\nmass = "m.mtx"\n'
    _, foreign = write_model(tmp_path, MODEL[:start] + files + MODEL[end:])
    found = bolted_model(foreign, tmp_path).bodies
    assert set(found.thickness) == {"lower"}
    low = box.bodies.omega < 2 * np.pi * 2000
    np.testing.assert_allclose(found.omega[low], box.bodies.omega[low], rtol=1e-6)


def test_hits_of_a_session_are_explained_by_the_joint_that_is_loose(
    tmp_path: Path,
) -> None:
    """With the left joint at a fifth, that effect leaves a thousandth of chi2."""
    path, model = write_model(tmp_path)
    write_hits(tmp_path / "hits.h5", FullPlates(model, {"left": 0.2}))
    remarks: list[str] = []
    session = read_session(tmp_path / "hits.h5")
    recordings = judged_recordings(with_preloads(session, None), remarks)
    made = bolted_campaign("plates", recordings, path).campaign
    bench = make_structure_bench(made)
    loose = {c.site.name: c for c in bench.candidates if c.effect.name == "loose_bolt"}
    friction = {str(c.site) for c in bench.candidates if c.effect.name == "microslip"}
    assert friction == {"bolts:all", "joint:left", "joint:right"}
    base = np.zeros(bench.base_sd.size)
    own = Term(loose["left"], np.array([-np.log(0.2)]))
    costs = [
        float(np.sum(bench.residual(base, terms, FULL) ** 2)) for terms in ((), (own,))
    ]
    assert costs[1] < 1e-3 * costs[0]


def test_the_command_finds_nothing_missing_where_nothing_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`gap session.h5 --model model.toml` with a model of meshed bodies."""
    path, model = write_model(tmp_path)
    write_hits(tmp_path / "hits.h5", FullPlates(model, {}))
    found = run_gap(
        tmp_path / "hits.h5", model=path, without=None, report=None, json_target=None
    )
    assert found.verdict is Finding.NONE
    assert "verdict: none" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "error", "words"),
    [
        ("[gap]\n", "[gap]\ninterface_share = 2\n", BadData, "interface_share"),
        ('normal = "100 MN/m"\n', "", BadData, "gap.bolt.normal"),
    ],
)
def test_a_model_that_lacks_something_is_refused(
    tmp_path: Path, old: str, new: str, error: type[Exception], words: str
) -> None:
    """One line with the key."""
    with pytest.raises(error, match=words):
        write_model(tmp_path, MODEL.replace(old, new))


def test_bodies_that_nothing_holds_are_refused(tmp_path: Path) -> None:
    """The message names the table to add."""
    _, model = write_model(tmp_path)
    gap = gap_table(model).model_copy(update={"feet": None})
    with pytest.raises(UsageError, match=r"\[gap.feet\]"):
        bolted_model(model.model_copy(update={"gap": gap}), tmp_path)
