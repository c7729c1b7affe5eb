"""Rounded stamps are even, gaps are not."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import SamplingError
from jointbench.acquisition.formats.even_steps import fit_even_steps, roundest


def fit(stamps, **options):
    return fit_even_steps(
        np.asarray(stamps, dtype=float),
        what="time",
        unit="s",
        where=lambda i: f"line {i + 1}",
        **options,
    )


def printed(rate, count, form, offset=0.0):
    return np.array([float(form % (offset + i / rate)) for i in range(count)])


@pytest.mark.parametrize(
    ("rate", "count", "form"),
    [
        (4000.0, 4000, "%.2E"),  # at the end four stamps in a row look the same
        (25600.0, 25600, "%.4f"),  # coarser than the step
        (25600.0, 2000, "%.6f"),
        (1024.0, 1000, "%.3f"),
        (51200.0, 5000, "%.3e"),
        (48000.0, 4800, "%.5f"),
        (1000.0, 500, "%.3f"),
        (4096.0, 4096, "%.17g"),
    ],
)
def test_rounded_stamps_give_the_rate_they_were_made_with(rate, count, form):
    """The true step lies within the bounds, and the roundest rate in them is it."""
    steps = fit(printed(rate, count, form))
    assert steps.low * (1 - 1e-12) <= 1 / rate <= steps.high * (1 + 1e-12)
    assert_allclose(roundest(1 / steps.high, 1 / steps.low), rate, rtol=1e-12)


def test_single_precision_stamps_are_even():
    """1000 s into a session, single precision jumps by more than a step."""
    stamps = (1000 + np.arange(20000) / 25600).astype(np.float32).astype(float)
    steps = fit(stamps)
    assert steps.low <= 1 / 25600 <= steps.high


def test_stamps_of_a_clock_with_an_odd_rate_keep_it():
    """Unrounded stamps are not rounded to a round rate: 25599.87 Hz stays."""
    steps = fit(np.arange(1000) / 25599.87)
    assert_allclose(1 / steps.step, 25599.87, rtol=1e-9)


def test_the_printed_digits_are_asked_for_where_values_alone_do_not_explain_them():
    """A file that begins with two digits and continues with five."""
    exact = np.arange(400) / 400
    stamps = np.array([float(f"{t:.1E}") for t in exact[:100]] + list(exact[100:]))
    units = np.concatenate((np.full(100, 1e-2), np.full(300, 1e-4)))
    with pytest.raises(SamplingError):
        fit(stamps)
    assert_allclose(fit(stamps, printed=lambda: units).step, 1 / 400, rtol=1e-6)


@pytest.mark.parametrize("form", ["%.3f", "%.6f", "%.17g", "%.4e"])
@pytest.mark.parametrize("row", [1, 37, 250, 498])
def test_one_lost_sample_is_found_by_its_line(form, row):
    """1 kHz, one row taken out: the message names the row after the gap."""
    stamps = np.delete(printed(1000.0, 500, form), row)
    with pytest.raises(SamplingError, match=f"^line {row + 1}: .*usual step is 0.001"):
        fit(stamps)


@pytest.mark.parametrize("lost", [[100, 101, 102], [50, 300], [10, 200, 201, 440]])
def test_several_lost_samples_are_refused(lost):
    """Stamps in whole milliseconds leave one unit of rounding for each step."""
    with pytest.raises(SamplingError, match="evenly spaced"):
        fit(np.delete(printed(1000.0, 500, "%.3f"), lost))


def test_a_row_written_twice_is_refused():
    """The same stamp twice among equal steps."""
    stamps = np.insert(printed(1000.0, 500, "%.3f"), 100, 0.1)
    with pytest.raises(SamplingError, match=r"from 0\.1 to 0\.1 s"):
        fit(stamps)


def test_time_that_runs_backwards_is_refused_by_its_line():
    """Two records glued together."""
    stamps = np.concatenate((np.arange(50), np.arange(50))) / 1000
    with pytest.raises(
        SamplingError, match=r"line 51: time runs backwards, from 0\.049"
    ):
        fit(stamps)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_stamp_that_is_no_number_is_refused_by_its_line(bad):
    """Every row needs its time."""
    stamps = np.arange(50.0)
    stamps[7] = bad
    with pytest.raises(SamplingError, match="line 8: time is"):
        fit(stamps)


def test_time_that_stands_still_is_refused():
    """A constant column is not the time."""
    with pytest.raises(SamplingError, match="is constant"):
        fit(np.full(50, 3.0))


def test_steps_that_grow_are_refused():
    """A logarithmic axis is no sampling."""
    with pytest.raises(SamplingError, match="evenly spaced"):
        fit(np.geomspace(1, 100, 50))
