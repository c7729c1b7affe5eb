"""Verdicts on simulated surfaces: names, summaries, waves that were held out."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.special import ndtr
from scipy.stats import kurtosis

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.analysis.gap.law_diagnosis.surface_diagnosis import diagnose_surface
from jointbench.analysis.gap.model.diagnosis_record import Finding
from jointbench.analysis.gap.surface_bench.rounded_bends import (
    rounded_bend_kurtosis,
)
from jointbench.signal.fractal.verdict_records import SurfaceVerdict

sys.path.insert(0, str(Path(__file__).parents[4] / "benchmarks" / "gap"))
from surface_maker import make_surface


def test_a_self_affine_line_lacks_nothing() -> None:
    """H is right within three sd, and held-out waves are inside their intervals."""
    made = make_surface(3, "")
    done = diagnose_surface(made.surface)
    assert done.found.verdict is Finding.NONE
    assert done.summary is SurfaceVerdict.FRACTAL
    hurst = done.found.base[0]
    assert abs(hurst.value - made.facts["hurst"]) < 3 * hurst.sd
    assert done.before.share_inside > 0.85


@pytest.mark.parametrize(
    ("name", "parameter", "fact", "within"),
    [
        ("noise", "sd", "sd", 0.2),
        ("blur", "sigma", "sigma", 0.2),
        ("tip", "radius", "radius", 0.6),
        ("tool_marks", "wavelength", "period", 0.01),
    ],
)
def test_an_effect_is_named_with_its_size(
    name: str, parameter: str, fact: str, within: float
) -> None:
    """The effect is named alone, and its size is near what was drawn."""
    made = make_surface(0, name)
    done = diagnose_surface(made.surface)
    assert done.found.verdict is Finding.NAMED
    assert [e.name for e in done.found.effects] == [name]
    values = {p.name: p.value for p in done.found.effects[0].parameters}
    wanted = made.facts[fact]
    if fact == "period":
        wanted *= made.facts["pitch"]
    assert values[parameter] == pytest.approx(wanted, rel=within)
    assert done.after.gap < 0.5 * done.before.gap


def test_a_cut_surface_is_named_with_the_share_of_its_plateaus() -> None:
    """Smooth valleys under a finish: no tip or noise beside it, and the right level."""
    made = make_surface(520148, "plateau")
    done = diagnose_surface(made.surface)
    (effect,) = done.found.effects
    assert effect.name == "plateau"
    values = {p.name: p.value for p in effect.parameters}
    wanted = float(ndtr(-made.facts["level"]))
    assert values["plateau_share"] == pytest.approx(wanted, abs=0.06)
    assert done.after.gap < 0.2 * done.before.gap


@pytest.mark.parametrize("name", ["outliers", "quantisation", "missing_points"])
def test_faults_are_named(name: str) -> None:
    """A fault of the measurement makes the summary instrument-limited."""
    done = diagnose_surface(make_surface(0, name).surface)
    assert [e.name for e in done.found.effects] == [name]
    assert done.summary is SurfaceVerdict.INSTRUMENT


def test_without_its_name_no_other_one_is_given() -> None:
    """Spikes are not explained by noise: the verdict is unknown."""
    made = make_surface(0, "outliers")
    done = diagnose_surface(made.surface, without=frozenset({"outliers", "plateau"}))
    assert done.found.verdict is Finding.UNKNOWN


def test_an_unknown_name_is_refused() -> None:
    """The message lists the names there are."""
    line = np.cumsum(np.random.default_rng(0).standard_normal(300))
    made = Profile("walk", line, 1e-6, all_valid(line))
    with pytest.raises(UsageError, match="rolloff"):
        diagnose_surface(made, without=frozenset({"roll"}))


@pytest.mark.parametrize("correlation", [-0.3, 0.0, 0.6])
@pytest.mark.parametrize("step", [1.0, 4.0])
def test_kurtosis_of_rounded_bends_is_that_of_a_long_line(
    correlation: float, step: float
) -> None:
    """Mean squares of a rounded line determine its fourth moment.

    Without it, coarse steps are explained by outliers beside them.
    """
    rng = np.random.default_rng(5)
    slope = lfilter([1.0], [1.0, -correlation], rng.standard_normal(200_000))
    heights = step * np.round(np.cumsum(slope / slope.std()) / step)
    measured = kurtosis(np.diff(heights, 2))
    assert rounded_bend_kurtosis(heights[None], step) == pytest.approx(
        measured, abs=0.05 + 0.05 * abs(measured)
    )
