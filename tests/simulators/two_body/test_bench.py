"""The simulated bench as a source of samples, and its URL."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Quantity, Verdict
from jointbench.acquisition.records.source import Source
from jointbench.simulators.two_body.bench import TwoBodyBench
from jointbench.simulators.two_body.bench_url import bench_from_url
from jointbench.simulators.two_body.bolts import bolt_preload


def _stream(bench):
    return np.hstack(list(bench.blocks()))


def test_the_bench_is_a_source():
    """It has what the protocol asks for, and says that it is simulated."""
    source: Source = TwoBodyBench(hits=1)
    assert source.simulated
    assert [c.quantity for c in source.channels] == [
        Quantity.FORCE,
        Quantity.ACCELERATION,
        Quantity.ACCELERATION,
    ]


def test_the_samples_do_not_depend_on_the_block_size():
    """Sample k is the same number in blocks of 1,000 and of 4,096."""
    bench = TwoBodyBench(hits=1, seed=4)
    small, large = replace(bench, block=1000), replace(bench, block=4096)
    assert np.array_equal(_stream(small), _stream(large))


def test_blocks_have_the_stated_size_and_end():
    """All but the last block are full; together they make the stream."""
    bench = TwoBodyBench(hits=1, block=3000)
    sizes = [block.shape for block in bench.blocks()]
    assert set(sizes[:-1]) == {(3, 3000)}
    assert sum(size[1] for size in sizes) == bench.samples


def test_another_seed_gives_other_hits_on_the_same_structure():
    """Seeds belong to the hammer and the noise, not to the specimen."""
    one, two = TwoBodyBench(seed=1).truth, TwoBodyBench(seed=2).truth
    assert one.natural_frequency == two.natural_frequency
    assert one.hits != two.hits


def test_the_truth_finds_every_hit_in_the_force():
    """The force is above 10 N right after each stated sample and quiet before."""
    bench = TwoBodyBench(hits=3, seed=2)
    force = _stream(bench)[0]
    for hit in bench.truth.hits:
        assert force[hit.sample : hit.sample + 20].max() > 10
        # The linear-phase filter rings a little before the touch.
        assert np.abs(force[hit.sample - 4000 : hit.sample - 40]).max() < 0.1


def test_the_peak_force_is_the_stated_one():
    """Band limit and samples take less than 2 % off the peak."""
    bench = TwoBodyBench(hits=2, double_rate=0.0, overload_rate=0.0)
    force = _stream(bench)[0]
    for hit in bench.truth.hits:
        peak = force[hit.sample : hit.sample + 60].max()
        assert_allclose(peak, hit.peak_force, rtol=0.02)


def test_an_overload_is_clipped_at_the_range():
    """Every hit too strong: the force stops at its range."""
    bench = TwoBodyBench(hits=1, double_rate=0.0, overload_rate=1.0)
    assert bench.truth.hits[0].verdict is Verdict.OVERLOAD
    assert_allclose(_stream(bench)[0].max(), bench.force_range, rtol=1e-6)


def test_a_bounce_strikes_again_after_the_stated_delay():
    """The second touch is in the force, where the truth says."""
    bench = TwoBodyBench(hits=1, double_rate=1.0, overload_rate=0.0)
    hit = bench.truth.hits[0]
    assert hit.bounce_delay is not None
    again = hit.sample + int(hit.bounce_delay * bench.sample_rate)
    force = _stream(bench)[0]
    assert force[again : again + 30].max() > 0.1 * hit.peak_force


def test_the_free_response_rings_at_the_modes_of_the_truth():
    """The two highest spectral peaks lie within a line of the natural frequencies."""
    bench = TwoBodyBench(hits=1, double_rate=0.0, overload_rate=0.0)
    start = bench.truth.hits[0].sample
    ring = _stream(bench)[1, start : start + 16384]
    spectrum = np.abs(np.fft.rfft(ring))
    resolution = bench.sample_rate / 16384
    for expected in bench.truth.natural_frequency:
        line = round(expected / resolution)
        near = spectrum[line - 30 : line + 31]
        assert abs(int(np.argmax(near)) - 30) <= 1


def test_frf_at_rest_equals_the_closed_form_of_the_two_bodies():
    """Acceleration over force of one hit against the 2x2 receptance by hand."""
    bench = TwoBodyBench(
        hits=1, double_rate=0, overload_rate=0, noise=1e-9, force_noise=1e-9
    )
    stream = np.pad(_stream(bench), ((0, 0), (0, 16384)))
    spectrum = np.fft.rfft(stream)
    frequency = np.fft.rfftfreq(stream.shape[1], 1 / bench.sample_rate)
    band = (frequency > 300) & (frequency < 900)
    s = 2j * np.pi * frequency[band]
    joint = bench.kj + bench.cj * s
    top = bench.m2 * s**2 + joint
    base = bench.m1 * s**2 + bench.k0 + bench.c0 * s + joint
    exact = s**2 * base / (top * base - joint**2)
    measured = spectrum[2, band] / spectrum[0, band]
    # The hit misses the direction by 5e-4, 2.5 sigma at most.
    assert_allclose(measured, exact, rtol=3e-3)


def test_torque_sets_the_preload_and_the_preload_the_stiffness():
    """Half the torque is half the preload and 1/sqrt(2) of the stiffness."""
    truth = TwoBodyBench(torque=10.0).truth
    assert_allclose(truth.preload, bolt_preload(10.0))
    assert_allclose(truth.preload, 12_500.0)
    assert_allclose(truth.kj, 6.0e7 / np.sqrt(2))


def test_torque_and_preload_together_are_refused():
    """One follows from the other."""
    with pytest.raises(UsageError, match="give one of them"):
        TwoBodyBench(torque=10.0, preload=4000.0)


def test_a_url_opens_the_bench_it_names():
    """Whole numbers, numbers and words arrive as such."""
    bench = bench_from_url("sim:two-body?seed=3&hits=12&point=1&kj=5e7")
    assert bench == TwoBodyBench(seed=3, hits=12, point="1", kj=5e7)


def test_the_name_of_a_bench_opens_the_same_bench():
    """What the session file calls the source is its URL."""
    bench = TwoBodyBench(seed=7, hits=3, torque=12.5, noise=0.02)
    assert bench_from_url(bench.name) == bench


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("sim:two-body?hitz=3", "did you mean hits"),
        ("sim:two-body?hits=many", "must be a whole number"),
        ("sim:two-body?kj=stiff", "must be a number"),
        ("sim:two-body?kj=nan", "finite and positive"),
        ("sim:two-body?hits=3&hits=4", "given twice"),
        ("sim:plates", "unknown specimen"),
        ("ni:cDAQ1", "no simulated source"),
        ("sim:two-body?point=3", "point=1"),
    ],
)
def test_a_url_that_makes_no_sense_is_refused_with_a_way_out(url, message):
    """One line with the correct input."""
    with pytest.raises(UsageError, match=message):
        bench_from_url(url)
