"""The palette of screens and reports: contrast in light and dark.

Source:
    Web Content Accessibility Guidelines 2.2, relative luminance and contrast ratio.
"""

import re
from pathlib import Path

import pytest

PALETTE = Path(__file__).parents[3] / "station" / "screen" / "palette.css"
TEXT, GRAPHICS = 4.5, 3.0
ON_PAPER = ("ink", "soft", "accent", "good-ink", "bad-ink")
BANDS = ("good", "bad", "trial", "warn", "simulated", "accent")
CURVES = tuple(f"curve-{number}" for number in range(1, 7))


def themes() -> dict[str, dict[str, str]]:
    """Return the colours of both themes by name."""
    light, _, dark = PALETTE.read_text(encoding="utf-8").partition("@media")
    find = re.compile(r"--([\w-]+):\s*#([0-9a-f]{6})")
    return {"light": dict(find.findall(light)), "dark": dict(find.findall(dark))}


def luminance(colour: str) -> float:
    """Return the relative luminance of a colour, ``"1c2733"``."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (0, 2, 4)]
    red, green, blue = (
        p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_black_on_white_has_the_contrast_of_the_guideline() -> None:
    """21 to 1 by definition."""
    assert contrast("000000", "ffffff") == pytest.approx(21.0)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_can_be_read_on_its_ground(theme: str) -> None:
    """4.5 to 1 on paper, on the ground and on every band of colour."""
    known = themes()[theme]
    pairs = [(name, place) for name in ON_PAPER for place in ("paper", "ground")]
    pairs += [(f"on-{band}", band) for band in BANDS]
    low = {p: contrast(known[p[0]], known[p[1]]) for p in pairs}
    assert {p: c for p, c in low.items() if c < TEXT} == {}


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_curves_are_seen_on_paper(theme: str) -> None:
    """3 to 1, as for graphics; older hits are dimmer, and seen."""
    known = themes()[theme]
    low = {c: contrast(known[c], known["paper"]) for c in (*CURVES, "curve-old")}
    assert {c: value for c, value in low.items() if value < GRAPHICS} == {}


def test_both_themes_have_the_same_colours() -> None:
    """A colour that one of them lacks would be that of the other."""
    light, dark = themes().values()
    assert light.keys() == dark.keys()
