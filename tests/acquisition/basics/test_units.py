"""Units as people write them."""

import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_sensitivity, parse_value, to_si


@pytest.mark.parametrize(
    ("unit", "kind", "factor"),
    [
        ("um", "length", 1e-6),
        ("\u00b5m", "length", 1e-6),
        ("\u03bcm", "displacement", 1e-6),
        ("in", "length", 0.0254),
        ("ms", "time", 1e-3),
        ("kN", "force", 1e3),
        ("mN", "force", 1e-3),
        ("lbf", "force", 4.4482216152605),
        ("m/s^2", "acceleration", 1.0),
        ("m/s2", "acceleration", 1.0),
        ("m/s\u00b2", "acceleration", 1.0),
        ("g", "acceleration", 9.80665),
        ("gn", "acceleration", 9.80665),
        ("g", "mass", 1e-3),
        ("N m", "torque", 1.0),
        ("N\u00b7m", "torque", 1.0),
        ("lbf ft", "torque", 1.3558179483314004),
        ("GPa", "pressure", 1e9),
        ("N/um", "stiffness", 1e6),
    ],
)
def test_a_unit_is_turned_into_its_si_factor(unit, kind, factor):
    """The exact factors of the definitions, however the unit is spelled."""
    assert_allclose(to_si(unit, kind), factor, rtol=1e-14)


def test_a_unit_of_another_quantity_is_refused_with_the_ones_that_fit():
    """The message names the quantity it belongs to and those of the one wanted."""
    with pytest.raises(UnitError, match=r"'N' is a unit of force, not of accel.*m/s2"):
        to_si("N", "acceleration")


def test_case_matters_where_it_changes_the_size():
    """MN is a million newtons and mN a thousandth; MS is no time at all."""
    assert to_si("MN", "force") == 1e9 * to_si("mN", "force")
    with pytest.raises(UnitError, match="'MS' is not a unit of time"):
        to_si("MS", "time")


@pytest.mark.parametrize("text", ["2.5 um", "2.5um", " 2.5e0 \u00b5m "])
def test_a_value_is_read_with_its_unit(text):
    """Blank or no blank between number and unit."""
    assert_allclose(parse_value(text, "length"), 2.5e-6, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "hint"), [("2.5", "has no unit"), ("um", "does not begin with a number")]
)
def test_a_value_without_number_or_unit_is_refused(text, hint):
    """Nothing is guessed."""
    with pytest.raises(UnitError, match=hint):
        parse_value(text, "length")


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("2.248mV/N", "force", 2.248e-3),
        ("10 mV/g", "acceleration", 1e-2 / 9.80665),
        ("100mV/(m/s^2)", "acceleration", 0.1),
        ("100 mV/m/s2", "acceleration", 0.1),
    ],
)
def test_a_sensitivity_is_read_as_volts_per_si_unit(text, kind, expected):
    """The quantity's own unit is converted too."""
    assert_allclose(parse_sensitivity(text, kind), expected, rtol=1e-14)


@pytest.mark.parametrize("text", ["2.248", "2.248 mV", "0 mV/N", "1 mV/g", "1 N/V"])
def test_a_sensitivity_that_is_none_is_refused(text):
    """Volts, a slash and a unit of the measured quantity are needed."""
    with pytest.raises(UnitError):
        parse_sensitivity(text, "force")
