# SPDX-License-Identifier: MIT
"""The FRF record and H1 over hammer hits."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import (
    ChannelMissing,
    NoHitFound,
    SamplingError,
    ShapeError,
)
from jointbench.acquisition.records.recordings import Quantity, Recording, Verdict
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.frf.frf import Frf, FrfKind, estimate_frf
from jointbench.signal.hits.block_length import choose_block, fast_length
from jointbench.signal.hits.find_hits import find_hits
from jointbench.signal.hits.windows import HammerWindow


def band(frf: Frf, low: float, high: float) -> np.ndarray:
    """Return which lines lie in a band."""
    return (frf.frequency >= low) & (frf.frequency <= high)


def test_h1_of_clean_hits_is_the_frf_of_the_structure(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """To 1e-3 of its level: the response is cut off at half the sample rate."""
    truth = structure((300.0, 700.0), (0.02, 0.03))
    frf = estimate_frf(hammered(truth, peaks=(100.0, 80.0)))
    lines = band(frf, 50.0, 1500.0)
    exact = truth.response(frf.frequency[lines], 2)
    assert frf.kind is FrfKind.ACCELERANCE
    assert np.allclose(frf.response[:, :, lines], exact, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(
    ("quantity", "kind", "order"),
    [
        (Quantity.DISPLACEMENT, FrfKind.RECEPTANCE, 0),
        (Quantity.VELOCITY, FrfKind.MOBILITY, 1),
    ],
)
def test_the_kind_follows_the_response(
    hammered: Callable[..., Recording],
    structure: Callable[..., Any],
    quantity: Quantity,
    kind: FrfKind,
    order: int,
) -> None:
    """Displacement gives receptance, velocity mobility, in their own units."""
    truth = structure((300.0,), (0.02,))
    frf = estimate_frf(hammered(truth, quantity=quantity))
    assert frf.kind is kind
    line = int(np.argmin(np.abs(frf.frequency - 300.0)))
    exact = truth.response(frf.frequency[[line]], order)
    assert frf.response[0, 0, line] == pytest.approx(exact[0, 0, 0], rel=1e-3)


def test_hits_at_two_points_are_two_inputs(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Their columns carry the points' names and are those of two structures."""
    one, two = structure((300.0,), (0.02,)), structure((300.0,), (0.02,), (0.5,))
    frf = estimate_frf(
        [
            hammered(one, point="left", name="l"),
            hammered(two, point="right", name="r"),
        ]
    )
    assert frf.inputs == ("left", "right")
    assert frf.outputs == ("a1@1",)
    peak = int(np.argmax(np.abs(frf.response[0, 0])))
    assert frf.response[0, 1, peak] / frf.response[0, 0, peak] == pytest.approx(0.5)


def test_one_stream_and_separate_files_agree(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """The same three hits, cut differently."""
    truth = structure((300.0,), (0.03,))
    stream = estimate_frf(hammered(truth, peaks=(90.0, 100.0, 80.0)))
    files = estimate_frf(
        [hammered(truth, peaks=(p,), name=str(p)) for p in (90.0, 100.0, 80.0)]
    )
    assert stream.averages == files.averages == 3
    f = np.arange(100.0, 1000.0, 10.0)
    both = [
        np.interp(f, r.frequency, np.abs(r.response[0, 0])) for r in (stream, files)
    ]
    assert np.allclose(*both, rtol=2e-2)


def test_rejected_hits_do_not_enter_the_average(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Two of three hits rejected by hand."""
    record = find_hits(hammered(structure((300.0,), (0.03,)), peaks=(90.0, 80.0, 70.0)))
    hits = tuple(replace(h, verdict=Verdict.OPERATOR) for h in record.hits[:2])
    frf = estimate_frf(replace(record, hits=(*hits, record.hits[2])))
    assert frf.averages == 1
    assert frf.coherence is None
    assert frf.variance is None


def test_the_variance_from_the_scatter_is_that_of_the_added_noise(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """White noise of sd s on n samples at rate r, over the force: s^2 n / r^2 / |F|^2.

    Twelve hits and hundreds of lines: the mean ratio is known to about 2 %.
    """
    truth = structure((300.0,), (0.03,))
    record = hammered(truth, peaks=(100.0,) * 12)
    sd = 0.002 * np.abs(record.samples[1]).max()
    rng = np.random.default_rng(5)
    samples = record.samples + np.array([[0.0], [sd]]) * rng.normal(size=(2, 12 * 8192))
    frf = estimate_frf(replace(record, samples=samples))
    lines = band(frf, 100.0, 1200.0)
    assert frf.variance is not None
    error = np.abs(
        frf.response[0, 0, lines] - truth.response(frf.frequency[lines], 2)[0, 0]
    )
    assert np.mean(error**2 / frf.variance[0, 0, lines]) == pytest.approx(1.0, rel=0.15)


def test_coherence_falls_where_noise_rises(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Near 1 at the resonance; lower off it, where the noise is unchanged."""
    record = hammered(structure((300.0,), (0.01,)), peaks=(100.0,) * 6, noise=0.01)
    frf = estimate_frf(record)
    assert frf.coherence is not None
    line = int(np.argmin(np.abs(frf.frequency - 300.0)))
    assert frf.coherence[0, 0, line] > 0.999
    assert frf.coherence[0, 0, band(frf, 20.0, 60.0)].mean() < 0.9


def test_the_exponential_window_moves_the_axis_of_the_laplace_plane(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """What is measured is H(j omega + rate): compare with a structure so damped."""
    truth = structure((300.0,), (0.02,))
    frf = estimate_frf(hammered(truth, first=20), window=HammerWindow(decay_rate=20.0))
    s = 2j * np.pi * frf.frequency + 20.0
    pole, residue = truth.poles[0], truth.residues()[0, 0, 0]
    exact = s**2 * (residue / (s - pole) + residue.conj() / (s - pole.conj()))
    lines = band(frf, 200.0, 400.0)
    assert frf.added_decay_rate == 20.0
    assert np.allclose(frf.response[0, 0, lines], exact[lines], rtol=1e-4)


def test_the_excited_band_ends_where_the_force_has_fallen_by_20_db(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Spectrum of a half sine of length T: cos(pi f T) / (1 - (2 f T)^2)."""
    width = 16 / 8192.0
    frf = estimate_frf(hammered(structure((100.0,), (0.05,)), width=width))
    f = np.arange(1.3, 4000.0)
    spectrum = np.abs(np.cos(np.pi * f * width) / (1.0 - (2.0 * f * width) ** 2))
    edge = f[np.argmax(spectrum < 0.1)]
    assert frf.usable_band is not None
    assert frf.usable_band[1] == pytest.approx(edge, rel=0.1)


def test_recordings_of_different_sample_rates_are_refused(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """An average needs one sample rate."""
    truth = structure((300.0,), (0.03,))
    with pytest.raises(SamplingError, match="8192"):
        estimate_frf([hammered(truth), hammered(truth, sample_rate=4096.0, name="b")])


def test_a_pair_that_was_never_measured_is_named(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """Two recordings with other accelerometers and other hit points."""
    record = hammered(structure((300.0,), (0.03,)))
    other = replace(
        record,
        name="b",
        channels=tuple(replace(c, point="9") for c in record.channels),
    )
    with pytest.raises(ChannelMissing, match="never measured"):
        estimate_frf([record, other])


def test_no_accepted_hit_says_why_the_first_was_rejected(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """The message carries the verdict."""
    record = find_hits(hammered(structure((300.0,), (0.03,))))
    bad = tuple(replace(h, verdict=Verdict.DOUBLE) for h in record.hits)
    with pytest.raises(NoHitFound, match="double"):
        estimate_frf(replace(record, hits=bad))


def test_the_block_is_the_shortest_segment_at_a_length_the_fft_likes() -> None:
    """997 is prime and 980 = 2^2 5 7^2; a far shorter segment is padded instead."""
    assert fast_length(997) == 980
    assert choose_block([1100, 997, 1050])[0] == 980
    block, reason = choose_block([1000, 1000, 1000, 100])
    assert block == 1000
    assert "1 padded" in reason


def test_a_record_of_the_wrong_shape_is_refused() -> None:
    """Ten lines of response for nine frequencies."""
    with pytest.raises(ShapeError, match="response"):
        Frf(np.arange(9.0), np.ones((1, 1, 10), complex), FrfKind.MOBILITY)


def test_labels_are_numbered_where_none_are_given() -> None:
    """So that every table can name its columns."""
    frf = Frf(np.arange(9.0), np.ones((2, 1, 9), complex), FrfKind.MOBILITY)
    assert (frf.outputs, frf.inputs) == (("1", "2"), ("1",))


def test_the_provenance_names_the_estimator_and_its_bias(
    hammered: Callable[..., Recording], structure: Callable[..., Any]
) -> None:
    """H2 is above H1 by what coherence says, and both are written down."""
    record = hammered(structure((300.0,), (0.03,)), peaks=(100.0,) * 4, noise=0.003)
    h1, h2 = (estimate_frf(record, estimator=e) for e in (Estimator.H1, Estimator.H2))
    detail = dict(h2.provenance[-1].detail)
    assert detail["estimator"] == "H2"
    assert "high" in str(detail["bias"])
    assert 0.0 < float(detail["h1_below_h2_median"]) < 1.0
    assert h1.coherence is not None
    lines = band(h1, 100.0, 1000.0)
    ratio = np.abs(h1.response / h2.response)[0, 0, lines]
    assert np.allclose(ratio, h1.coherence[0, 0, lines])
