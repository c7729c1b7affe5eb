"""Under model error the family of a law is named, and linear effects are not."""

from functools import cache

import gap_bench as made
import numpy as np
import pytest

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.model.partial_records import (
    PartialExplanation,
    partial_json,
)
from jointbench.analysis.gap.model_error.discrepancy import (
    Discrepancy,
    estimate_discrepancy,
    whitening,
)
from jointbench.analysis.gap.model_error.explain_mostly import explain_mostly
from jointbench.analysis.gap.model_error.free_law import FREE_LAW
from jointbench.analysis.gap.model_error.spectral_frame import spectral_frame
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench

LINEAR = [
    ("hidden_mode", "body:m2", [0.02, 700.0, 0.01]),
    ("gain_error", "channel:a0", [0.01]),
]
"""Linear effects that the model lacks: they are the model error."""
CUBIC = ("cubic_stiffness", "link:joint", [1.5e16])
SOFTENING = ("cubic_stiffness", "link:joint", [-4e15])
SLIDER = ("jenkins", "link:joint", [1e7, 5e-6, 20.0])
SPRINGS = frozenset({"cubic_stiffness", "quadratic_stiffness"})


@cache
@one_thread()
def explained(*laws: str, without: frozenset[str] = frozenset()) -> PartialExplanation:
    """Return what a law explains in a campaign with model error."""
    known = {"cubic_stiffness": CUBIC, "softening": SOFTENING, "slider": SLIDER}
    campaign = made.made_campaign([*LINEAR, *(known[name] for name in laws)])
    bench, base = fit_base(make_bench(campaign, without=without))
    assert isinstance(bench, LumpedBench)
    found = explain_mostly(bench, base, lambda line: None)
    assert found is not None
    return found


def test_the_family_of_a_law_is_named_beside_an_unknown_mode_and_a_wrong_gain() -> None:
    """Cubic stiffness with two linear effects that are not in the model."""
    found = explained("cubic_stiffness")
    assert found.named
    assert (found.family, found.site) == ("stiffness", "link:joint")
    assert found.share > 0.5
    assert all(r.standard_errors > 3.0 for r in found.rivals)
    assert {r.family for r in found.rivals} == {"contact", "friction", "damping"}
    assert partial_json(found)["family"] == "stiffness"
    assert found.explained > 0.5
    assert found.beside is not None
    assert found.beside.share < 0.03


def test_a_law_that_stands_in_for_another_is_seen_by_a_shape_beside_it() -> None:
    """Without springs a stop stands in: an odd power explains what it leaves."""
    found = explained("cubic_stiffness", without=SPRINGS)
    assert found.family == "contact"
    assert found.beside is not None
    assert found.beside.share > 0.03


def test_linear_effects_alone_are_a_discrepancy_and_no_law() -> None:
    """The mode is found where it is: in its band, on its body."""
    found = explained()
    assert not found.named
    assert not found.nonlinear
    largest = max(found.linear, key=lambda row: row.coherent)
    assert largest.low < 800.0
    assert largest.high > 600.0


def test_a_family_that_is_not_in_the_catalogue_is_not_replaced() -> None:
    """Without springs no other family is named."""
    assert not explained("cubic_stiffness", without=SPRINGS).named


def test_a_softening_spring_is_not_called_friction() -> None:
    """Without elastic laws friction leads all others, but not a free spring."""
    found = explained("softening", without=SPRINGS | {"gap"})
    assert found.family == "friction"
    assert found.nonlinear
    assert not found.named
    assert found.rivals[0].rival == FREE_LAW
    assert found.rivals[0].standard_errors < 0.0
    assert FREE_LAW in found.reason


def test_a_slider_leads_a_free_spring_and_damper() -> None:
    """Its stiffness and loss are no powers of the motion."""
    found = explained("slider", without=SPRINGS)
    assert (found.named, found.family) == (True, "friction")
    (free,) = (r for r in found.rivals if r.rival == FREE_LAW)
    assert (free.family, free.site) == ("", "link:joint")
    assert free.standard_errors > 3.0


def test_where_the_catalogue_has_a_spring_that_is_the_rival_of_friction() -> None:
    """No free spring is fitted beside a spring of the catalogue."""
    found = explained("slider")
    assert (found.named, found.family) == (True, "friction")
    assert "stiffness" in {r.family for r in found.rivals}
    assert FREE_LAW not in {r.rival for r in found.rivals}


def test_the_discrepancy_of_made_residuals_is_found() -> None:
    """A common error of 5 % and an own one of 2 % are estimated within a third."""
    campaign = made.made_campaign([], noise=0.01)
    bench = make_bench(campaign)
    frame = spectral_frame(bench)
    rng = np.random.default_rng(5)

    def draw(*shape: int) -> ComplexArray:
        pairs = rng.standard_normal((*shape, 2)) / np.sqrt(2.0)
        return np.asarray(pairs[..., 0] + 1j * pairs[..., 1])

    records, channels, _ = frame.signal.shape
    lines = frame.band.size
    truth = Discrepancy(
        np.full((2, channels, frame.edges.size - 1), 0.05**2),
        np.full((channels, frame.edges.size - 1), 0.02**2),
    )
    at = whitening(frame, truth)
    common = draw(2, channels, lines)[frame.point]
    own = draw(records, channels, lines) / np.where(at.weight > 0, at.weight, np.inf)
    shared = at.common * np.sqrt(at.strength * 0.05**2) * common
    spectrum = own + shared / np.where(at.weight > 0, at.weight, np.inf)
    found = estimate_discrepancy(frame, spectrum)
    heard = frame.counted.all(axis=0) & (frame.count > 20)
    assert np.median(found.incoherent[heard]) == pytest.approx(0.02**2, rel=0.33)
    assert np.median(found.coherent[:, heard]) == pytest.approx(0.05**2, rel=0.33)
    white = whitening(frame, found).white(spectrum)
    power = frame.in_bands(np.abs(white) ** 2)[frame.counted]
    assert np.median(power) == pytest.approx(1.0, abs=0.15)
