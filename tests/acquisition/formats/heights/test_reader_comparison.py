"""Two readers of a vendor file: every disagreement is found, with its factor."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.formats.heights.reader_comparison import compare_readers
from jointbench.station.roughness.reader_words import reader_lines

SURFACES = Path(__file__).parents[5] / "shared" / "data" / "surfaces"
needs_readers = pytest.mark.skipif(
    not SURFACES.is_dir(), reason="shared data are not available"
)


def compared(name):
    pytest.importorskip("SurfaceTopography")
    pytest.importorskip("surfalize")
    return compare_readers(SURFACES / name)


@needs_readers
@pytest.mark.parametrize(
    ("name", "said"),
    [
        # Code 1 of the resolution is 32768, eight times what surfalize divides by.
        ("various/metropro-1.dat", "0.125 times those of surfalize"),
        # The file states 159.7 um.
        ("various/nms-1.nms", "1e+06 times that of surfalize"),
        # Two numbers of the header are read as heights.
        ("various/plu-1.plu", "shifted by 2 points"),
        ("cyberoptics/SCR_3D1A.ASC", "finds no unit"),
    ],
)
def test_a_disagreement_is_named_with_its_factor(name, said):
    assert said in " ".join(reader_lines(compared(name)))


@needs_readers
@pytest.mark.parametrize("name", ["sdf-1.sdf", "sur-2.sur", "x3p-2.x3p"])
def test_readers_that_agree_have_no_disagreement(name):
    found = compared(f"various/{name}")
    assert found.compared
    assert found.disagreements == ()
    assert found.missing[0] == found.missing[1]


@needs_readers
def test_a_file_of_one_reader_has_the_reason():
    found = compared("various/opdx-3.opdx")
    assert not found.compared
    assert "surfalize reads maps only" in found.reason


def test_missing_readers_name_the_extra(tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    file = tmp_path / "map.x3p"
    file.write_bytes(np.zeros(3).tobytes())
    assert "jointbench[readers]" in compare_readers(file).reason
