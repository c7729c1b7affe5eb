"""Numbers as people read them."""

import pytest

from jointbench.station.screen.value_text import engineering, with_sd


@pytest.mark.parametrize(
    ("value", "sd", "text"),
    [
        (810.2314, 0.021, "810.231 ± 0.021"),
        (6.2e7, 1.1e6, "(6.20 ± 0.11)e+07"),
        (-4.2e-4, 1e-5, "(-4.20 ± 0.10)e-04"),
        (3.0, None, "3"),
        (3.0, 0.0, "3"),
        (1234.5, 678.0, "1230 ± 680"),
        (0.0, 0.5, "0.00 ± 0.50"),
    ],
)
def test_a_value_shows_as_many_digits_as_it_deserves(
    value: float, sd: float | None, text: str
) -> None:
    """Two digits of the standard deviation set the last digit of the value."""
    assert with_sd(value, sd) == text


@pytest.mark.parametrize(
    ("value", "text"), [(3.2e-9, "3.2 nm"), (0.0, "0 m"), (1500.0, "1.5 km")]
)
def test_engineering_prefixes(value: float, text: str) -> None:
    """Powers of a thousand carry their prefix."""
    assert engineering(value, "m") == text
