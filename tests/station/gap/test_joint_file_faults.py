"""Joint files with faults: one line each that names the file and the way out."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.contact_bench.contact_bench import make_contact_bench
from jointbench.station.joint_states.joint_state_files import read_joint
from jointbench.station.joint_states.joint_state_tables import (
    read_covariance,
    read_state_table,
)

JOINT = """
table = "states.csv"
[joint]
diameter = "16 mm"
area = "200 cm^2"
nut_factor_sd = "0 %"
torque_scatter = "0 %"
[bodies]
modulus = "55 GPa"
[law]
family = "linear"
rms_height = "1 um"
"""
TABLE = "torque:N m,kn:N/m\n10,1e9\n20,2e9\n40,4e9\n"


def _file(folder: Path, text: str, table: str = TABLE) -> Path:
    (folder / "states.csv").write_text(table, encoding="utf-8")
    path = folder / "joint.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("torque:N m;kn:N/m\n5,9;1e9\n", "semicolons"),
        ("torque:N m,kn:N/m\n5,9,1e9\n", "3 cells below 2 columns"),
        ("torque:N m,kn:N/m\n5\n", "1 cells below 2 columns"),
        ("torque:N m,kn:N/m,kn:N/m\n5,1e9,1\n", "more than one column 'kn'"),
        ("torque:N m,assembly\n5,\u00b2\n", "assembly"),
        (f"torque:N m,assembly\n5,{'9' * 5000}\n", "assembly"),
        (f"torque:N m,kn:N/m\n5,{'1' * 200_000}\n", "no table in CSV"),
    ],
)
def test_a_table_of_states_with_a_fault_is_refused(
    tmp_path: Path, table: str, said: str
) -> None:
    """Semicolons, decimal commas, lost cells, columns twice, odd digits, huge cells."""
    _file(tmp_path, JOINT, table)
    with pytest.raises(BadData, match=said):
        read_state_table(tmp_path / "states.csv")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1,0.5\n0,1\n", "not symmetric"),
        ("nan,0\n0,1\n", "nan or inf"),
        ("1,0\n", "shape"),
        ("1;0\n0;1\n", "separated by commas"),
    ],
)
def test_a_covariance_with_a_fault_is_refused(
    tmp_path: Path, text: str, said: str
) -> None:
    """Both triangles, finite, of the right size."""
    path = tmp_path / "c.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadData, match=said):
        read_covariance(path, 2)


def test_a_covariance_may_have_spaces_and_comments(tmp_path: Path) -> None:
    """As spreadsheets and numpy write it."""
    path = tmp_path / "c.csv"
    path.write_text("# of ln k\n1, 0.5\n0.5, 1\n", encoding="utf-8")
    np.testing.assert_array_equal(read_covariance(path, 2), [[1, 0.5], [0.5, 1]])


@pytest.mark.parametrize("area", ["200", "'inf cm^2'", "'two cm^2'"])
def test_an_area_needs_a_number_and_a_unit(tmp_path: Path, area: str) -> None:
    """A bare number could be of any unit."""
    with pytest.raises(BadData, match=r"joint\.area"):
        read_joint(_file(tmp_path, JOINT.replace('"200 cm^2"', area)))


def test_too_many_states_are_refused(tmp_path: Path) -> None:
    """Ten thousand states have a covariance beyond the memory of a computer."""
    rows = "".join(f"{5 + k},1e9\n" for k in range(201))
    path = _file(tmp_path, JOINT, f"torque:N m,kn:N/m\n{rows}")
    with pytest.raises(BadData, match="at most 200"):
        read_joint(path)


def test_a_value_has_no_correlation_with_itself(tmp_path: Path) -> None:
    """It would replace the variance."""
    state = "[[states]]\ntorque = '5 N m'\nkn = '1e9 N/m'\ncorrelation = {kn_kn = 0.5}"
    text = JOINT.replace('table = "states.csv"', "") + state
    with pytest.raises(BadData, match="one twice"):
        read_joint(_file(tmp_path, text))


def test_exactly_known_facts_stay_in_the_fit(tmp_path: Path) -> None:
    """An sd of 0 of the nut factor and of the torque leaves all slopes finite."""
    joint = read_joint(_file(tmp_path, JOINT))
    bench = make_contact_bench(joint.data, joint.law)
    assert np.all(bench.base_sd > 0)
