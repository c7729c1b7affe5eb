"""The bench model file: strict, with units, one line for each mistake."""

from pathlib import Path

import pytest

from jointbench.acquisition.errors import BadData
from jointbench.station.bench_model import BenchModel
from jointbench.station.toml_file import read_toml

GOOD = """\
[bodies.base]
mass = "9 kg"
[bodies.top]
mass = "4600 g"
[links.joint]
between = ["base", "top"]
stiffness = "60 N/um"
"""


def read(folder: Path, text: str) -> BenchModel:
    """Write and read a model."""
    path = folder / "bench.toml"
    path.write_text(text, encoding="utf-8")
    return read_toml(path, BenchModel)


def test_units_are_turned_into_si(tmp_path: Path) -> None:
    """4600 g are 4.6 kg, 60 N/um are 6e7 N/m."""
    model = read(tmp_path, GOOD)
    assert model.bodies["top"].mass == pytest.approx(4.6)
    assert model.links["joint"].stiffness == pytest.approx(6e7)


@pytest.mark.parametrize(
    ("wrong", "right", "word"),
    [
        ('"9 kg"', "9.0", "unit"),
        ('"9 kg"', '"9 N"', "'N'"),
        ('"9 kg"', '"-9 kg"', "greater than 0"),
        ('"top"]', '"lid"]', "lid"),
        ("stiffness", "stifness", "stifness"),
        ("[bodies.base]", "[bodies.base", "TOML"),
    ],
)
def test_a_mistake_is_named_with_its_key(
    wrong: str, right: str, word: str, tmp_path: Path
) -> None:
    """File, key, value, rule: enough to mend it."""
    with pytest.raises(BadData, match=r"bench\.toml") as caught:
        read(tmp_path, GOOD.replace(wrong, right, 1))
    assert word in str(caught.value)


def test_a_missing_model_is_bad_data(tmp_path: Path) -> None:
    """The line names the path."""
    with pytest.raises(BadData, match="gone"):
        read_toml(tmp_path / "gone.toml", BenchModel)
