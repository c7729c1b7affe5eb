"""The grammar of --columns."""

import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.formats.columns import Column, parse_columns


def test_roles_and_units_are_read_in_order():
    """The plain case of the help text."""
    assert parse_columns("time:s,force:N,acceleration:m/s^2") == (
        Column("time", "s"),
        Column("force", "N"),
        Column("acceleration", "m/s^2"),
    )


def test_label_point_and_sensitivity_are_read():
    """A channel in volts has its sensor's sensitivity after an @."""
    (column,) = parse_columns("acceleration.a1@3:V@10mV/g")
    assert (column.label, column.point) == ("a1", "3")
    assert_allclose(column.factor, 9.80665 / 0.01, rtol=1e-14)


@pytest.mark.parametrize("skipped", ["-", "skip", "_"])
def test_a_column_can_be_skipped(skipped):
    """A dash stands for a column that is not wanted."""
    assert parse_columns(f"time:s,{skipped},force:N")[1].role == "skip"


def test_volts_without_sensitivity_are_refused_with_what_to_type():
    """The message holds an item that the parser accepts."""
    with pytest.raises(UnitError, match="sensitivity") as caught:
        parse_columns("time:s,force:V")
    suggestion = str(caught.value).rsplit(" ", 1)[-1]
    assert_allclose(parse_columns(suggestion)[0].sensitivity, 2.25e-3, rtol=1e-14)


def test_a_missing_unit_is_refused_with_what_to_type():
    """The role alone does not give the size."""
    with pytest.raises(UnitError, match="time:s"):
        parse_columns("time,force:N")


def test_a_misspelled_role_is_answered_with_the_nearest():
    """Near matches help."""
    with pytest.raises(UsageError, match="did you mean 'acceleration'"):
        parse_columns("time:s,aceleration:g")


@pytest.mark.parametrize(
    "spec", ["", ":", "time:s,time:s", "force:N@2mV/N", "z:um!x", "time:s,,force:N"]
)
def test_nonsense_is_refused(spec):
    """One line each, never a traceback from inside."""
    with pytest.raises((UsageError, UnitError)) as caught:
        parse_columns(spec)
    assert "\n" not in str(caught.value)


def test_a_code_for_missing_points_is_read():
    """-25400 is how one scanner writes "no point"."""
    assert parse_columns("x:um,z:um!-25400")[1].code == -25400
