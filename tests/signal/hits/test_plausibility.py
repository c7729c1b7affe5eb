"""What cannot be right in imported hits is reported with what to pass instead."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.signal.hits.plausibility import plausibility_words, struck_mass

RATE, COUNT = 10_000.0, 6000
TIME = np.arange(COUNT) / RATE
MASS = 4.0


def pulse() -> FloatArray:
    """Return a half sine of 2 ms and 200 N."""
    force = np.zeros(COUNT)
    force[100:120] = 200.0 * np.sin(np.pi * (np.arange(20) + 0.5) / 20)
    return force


def answer() -> FloatArray:
    """Return the acceleration of a mass that then rings at 150 Hz [m/s^2]."""
    after = np.where(TIME > 0.012, TIME - 0.012, 0.0)
    ringing = -8.0 * np.exp(-9.0 * after) * np.sin(2 * np.pi * 150.0 * after)
    return np.asarray(pulse() / MASS + ringing)


def recording(force: FloatArray, motion: FloatArray, unit: str = "m/s^2") -> Recording:
    """Return a hit at point 1, with the sensor there."""
    channels = (
        Channel("force", Quantity.FORCE, "1"),
        Channel("a1", Quantity.ACCELERATION, "1", unit=unit),
    )
    return Recording("r", np.array([force, motion]), RATE, channels)


def test_swapped_columns_are_found_in_a_record_that_is_mostly_quiet() -> None:
    """The decay takes a small share of it, and swings where a hammer only pushes."""
    quiet = np.zeros(9 * COUNT)
    rings = answer() - pulse() / MASS
    pushed, rang = (np.concatenate([one, quiet]) for one in (pulse(), rings))
    assert plausibility_words([recording(pushed, rang)]) == ()
    (line,) = plausibility_words([recording(rang, pushed)])
    assert "columns swapped" in line


def test_a_plausible_hit_brings_no_line() -> None:
    """The mass is that of the struck body."""
    good = recording(pulse(), answer())
    assert plausibility_words([good]) == ()
    mass = struck_mass(good)
    assert mass is not None
    assert mass.mass == pytest.approx(MASS, rel=0.02)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (recording(answer() - pulse() / MASS, pulse()), "columns swapped"),
        (recording(-pulse(), answer()), "'force:-N'"),
        (recording(pulse(), -answer()), "moves against the hit"),
        (recording(pulse(), answer() / 9.80665 + 1.0), "pass 'acceleration:g'"),
        (
            recording(pulse(), 9.80665 * (answer() + 9.80665), "g"),
            "pass 'acceleration:m/s^2'",
        ),
        (recording(pulse(), 1e5 * answer(), "g"), "which no accelerometer measures"),
        (replace(recording(pulse(), answer()), sample_rate=10.0), "'time:ms'"),
        (
            replace(
                recording(pulse(), answer()),
                sample_rate=10.0,
                provenance=(step("import", rate_stated=10.0),),
            ),
            "another --rate",
        ),
    ],
)
def test_what_cannot_be_right_is_named_with_what_to_pass(
    wrong: Recording, words: str
) -> None:
    """One line each."""
    (line,) = plausibility_words([wrong, wrong])
    assert words in line
    assert "\n" not in line
