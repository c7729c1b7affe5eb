"""The bench model file: strict, with units, one line for each mistake."""

import re
from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.gap.model.stated_scatter import StatedScatter
from jointbench.analysis.lumped.identified import identification_json
from jointbench.analysis.lumped.identify_links import identify_links
from jointbench.analysis.lumped.lumped_matrices import incidence
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.station.files.toml_file import read_toml
from jointbench.station.pipeline.link_stage import mode_model
from jointbench.station.schemas.bench_model import BenchModel, lumped_model
from jointbench.station.schemas.gap_model import nominal_parameters

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


PRIORS = """\
[bodies.base]
mass = "9 kg"
mass_sd = "9 g"
channel = "a0"
[bodies.top]
mass = "4600 g"
mass_sd = "4.6 g"
channel = "a1"
[links.feet]
between = ["base", "ground"]
stiffness = "30 N/um"
stiffness_sd = "6 N/um"
damping = "200 N s/m"
damping_sd = "50 N s/m"
[links.bolts]
between = ["base", "top"]
joint = true
stiffness = "60 N/um"
stiffness_sd = "6 N/um"
damping = "100 N s/m"
damping_sd = "50 N s/m"
"""


def test_identify_and_gap_take_one_and_the_same_model(tmp_path: Path) -> None:
    """Values in SI, priors relative, the ground below whatever stands on it."""
    bench = read(tmp_path, PRIORS)
    model = lumped_model(bench)
    assert nominal_parameters(bench).model == model
    assert model.spread == pytest.approx([1e-3, 1e-3, 0.2, 0.1, 0.25, 0.5])
    assert (model.ends(0), model.ends(1)) == ((-1, 0), (0, 1))
    assert incidence(model).tolist() == [[1.0, 0.0], [-1.0, 1.0]]
    assert model.first_joint == 1


def test_the_scatter_to_expect_is_stated_with_units(tmp_path: Path) -> None:
    """Shares and times become SI; what is not stated stays open."""
    table = '[gap.scatter]\nchannel_gain = "0.5 %"\nforce_delay = "1 us"\n'
    stated = nominal_parameters(read(tmp_path, PRIORS + table)).scatter
    assert stated.channel_gain == pytest.approx(0.005)
    assert stated.force_delay == pytest.approx(1e-6)
    assert stated.force_gain is None
    assert nominal_parameters(read(tmp_path, PRIORS)).scatter == StatedScatter()


@pytest.mark.parametrize(
    ("lines", "word"),
    [
        ('[gap.scatter]\nchannel_gain = "0.5"\nforce_delay = "1"\n', "unit"),
        ('[gap.scatter]\njoint_stiffness = "0 %"\n', "greater than 0"),
        ('[gap.scatter]\nforce_delay = "2 ms"\n', "less than 0.001"),
        ('[gap.scatter]\nforce_gains = "1 %"\n', "'force_gain' is meant"),
        (
            '[gap]\nrepeatability = "1 %"\n[gap.scatter]\nforce_gain = "1 %"\n',
            "not both",
        ),
    ],
)
def test_an_impossible_scatter_is_refused(
    lines: str, word: str, tmp_path: Path
) -> None:
    """With its key and the rule."""
    with pytest.raises(BadData, match=r"bench\.toml.*gap") as caught:
        read(tmp_path, PRIORS + lines)
    assert word in str(caught.value)


def test_a_missing_prior_is_none_for_modes_and_refused_by_gap(tmp_path: Path) -> None:
    """What was weighed and no more is exact; the gap engine must weigh everything."""
    bench = read(tmp_path, PRIORS.replace('mass_sd = "9 g"\n', ""))
    model = lumped_model(bench)
    assert model.bodies[0].mass_spread == 0.0
    with pytest.raises(UsageError, match=r"prior sd of base is 0\.0"):
        _ = model.spread
    with pytest.raises(BadData, match=r"bodies\.base\.mass_sd is missing"):
        nominal_parameters(bench)


def test_modes_weigh_damping_by_what_was_measured_alone(tmp_path: Path) -> None:
    """A stated damping is a start of the search, not a measurement."""
    stated, plain = (
        read(tmp_path, text) for text in (PRIORS, re.sub(r"damping_sd.*\n", "", PRIORS))
    )
    modes = MeasuredModes(
        natural_frequency=np.array([250.0, 700.0]),
        frequency_sd=np.array([0.1, 0.2]),
        damping_ratio=np.array([0.01, 0.02]),
        damping_ratio_sd=np.array([0.002, 0.004]),
    )
    first, second = (
        identify_links(mode_model(bench), modes) for bench in (stated, plain)
    )
    assert identification_json(first) == identification_json(second)
