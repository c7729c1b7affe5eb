"""The functions give the numbers of `scipy.stats` to the last bit."""

import math
import subprocess
import sys

import pytest
import scipy.stats

from jointbench.acquisition.basics.tail_probabilities import (
    chi2_above,
    chi2_limit,
    f_above,
    f_limit,
    gamma_above,
    normal_quantile,
    t_quantile,
)


@pytest.mark.parametrize("dof", [0.0, 0.5, 1.0, 7.0, 4000.0])
@pytest.mark.parametrize("value", [0.0, 1e-9, 3.2, 4100.0])
def test_chi2_is_that_of_scipy(dof: float, value: float) -> None:
    """Also without a degree of freedom, where it is not a number."""
    assert chi2_above(value, dof) == pytest.approx(
        float(scipy.stats.chi2.sf(value, dof)), rel=0.0, nan_ok=True
    )
    chance = 1.0 / (2.0 + value)
    assert chi2_limit(chance, dof) == pytest.approx(
        float(scipy.stats.chi2.isf(chance, dof)), rel=0.0, nan_ok=True
    )


@pytest.mark.parametrize(("dof", "below"), [(1.0, 2.0), (2.0, 1.0), (37.5, 812.3)])
@pytest.mark.parametrize("value", [0.0, 0.7, 60.0])
def test_f_is_that_of_scipy(dof: float, below: float, value: float) -> None:
    """For whole and broken degrees of freedom."""
    assert f_above(value, dof, below) == float(scipy.stats.f.sf(value, dof, below))


@pytest.mark.parametrize(("dof", "below"), [(1.0, 2.0), (1.0, 60.0), (37.5, 812.3)])
@pytest.mark.parametrize("chance", [0.05, 1e-3, 1e-9])
def test_the_limit_of_f_is_that_of_scipy(
    chance: float, dof: float, below: float
) -> None:
    """The value that is exceeded with that chance."""
    assert f_limit(chance, dof, below) == pytest.approx(
        float(scipy.stats.f.isf(chance, dof, below)), rel=1e-9
    )


@pytest.mark.parametrize("shape", [1, 12, 400])
@pytest.mark.parametrize("value", [-3.0, 0.0, 5.0, 600.0])
def test_gamma_is_that_of_scipy(value: float, shape: int) -> None:
    """Below 0 every value is exceeded."""
    assert gamma_above(value, shape) == float(scipy.stats.gamma.sf(value, shape))


def test_no_residual_degree_of_freedom_is_not_a_number() -> None:
    """No test is passed by it."""
    assert math.isnan(f_above(2.0, 3.0, 0.0))


@pytest.mark.parametrize("share", [0.025, 0.5, 0.975])
@pytest.mark.parametrize("dof", [1.0, 4.5, 1e6, math.inf])
def test_quantiles_are_those_of_scipy(share: float, dof: float) -> None:
    """Student's t ends in the normal distribution."""
    expected = float(scipy.stats.t.ppf(share, dof))
    assert t_quantile(share, dof) == pytest.approx(expected, rel=1e-12, abs=1e-15)
    assert normal_quantile(share) == float(scipy.stats.norm.ppf(share))


def test_short_commands_import_no_statistics() -> None:
    """`scipy.stats` and `scipy.signal` take half a second, `numba` a quarter.

    Processing needs `numba`, and no statistics.
    """
    modules = [
        f"jointbench.station.commands.{name}_command"
        for name in ("import", "inspect", "calibrate", "record", "verify")
    ]
    code = (
        "import sys\n"
        f"for name in {modules!r}: __import__(name)\n"
        "heavy = {'scipy.stats', 'scipy.signal', 'numba'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "import jointbench.station.commands.process_command\n"
        "heavy = {'scipy.stats', 'scipy.signal'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
