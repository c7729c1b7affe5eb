"""Words about the scatter of the hits: numbers with two digits, or nothing."""

import pytest

from jointbench.analysis.gap.model.scatter_found import (
    DirectionFound,
    HitFound,
    ScatterFound,
    hit_words,
)


@pytest.mark.parametrize(
    ("size", "words"),
    [(2.34e-5, "0.0023 %"), (0.0016, "0.16 %"), (0.031, "3.1 %"), (1.34, "134 %")],
)
def test_a_size_has_two_digits_and_is_never_zero_percent(
    size: float, words: str
) -> None:
    """From the smallest that is significant to more than the signal itself."""
    found = ScatterFound((DirectionFound("force gain", size, "-"),), 0.0, ())
    assert found.words == f"hits scatter in force gain {words}"


def test_a_delay_is_in_microseconds() -> None:
    """1.2 nanoseconds are 0.0012 us."""
    found = ScatterFound((DirectionFound("force delay", 1.2e-9, "s"),), 0.0, ())
    assert found.words == "hits scatter in force delay 0.0012 us"


def test_sizes_below_the_noise_are_left_out() -> None:
    """A size of 0 is no statement that the hits repeat to within 0 %."""
    sizes = (DirectionFound("force gain", 0.0, "-"), DirectionFound("x", 0.0, "s"))
    words = ScatterFound(sizes, 0.0, ()).words
    assert words == "hits do not scatter beyond the noise"


def test_a_hit_is_shown_with_its_sign() -> None:
    """A hit that was 8 % too weak, and one that was late by 12.3 us."""
    weak = HitFound(3, "force gain", -0.08, 0.01)
    late = HitFound(4, "force delay", 12.3e-6, 1e-6, "s")
    assert hit_words(weak) == "record 3 (force gain -8.0 %)"
    assert hit_words(late) == "record 4 (force delay +12 us)"
