"""Every `sim:` source comes through NI's client from a simulated chassis."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.simulators.chassis.server import SimulatedChassis
from jointbench.simulators.two_body.bench import TwoBodyBench
from jointbench.station.sources.chassis_source import ChassisRun, ChassisSource
from jointbench.station.sources.open_source import open_runs, open_source
from jointbench.station.sources.record_source import record

COUNT = 5.0 / 2**23  # [V] of the chassis


def test_samples_arrive_as_the_bench_made_them_within_one_count_of_the_converter() -> (
    None
):
    """Force and accelerations, first sample to last, clipped crests included."""
    bench = TwoBodyBench(seed=3, hits=2, overload_rate=0.5)
    through = record(open_source(bench.name))
    direct = np.hstack(list(bench.blocks()))
    steps = [COUNT / (c.sensitivity or 0.0) for c in through.channels]
    assert through.samples.shape == direct.shape
    worst = np.abs(through.samples - direct).max(axis=1)
    assert (worst <= steps).all()


def test_a_sensor_too_sensitive_for_the_input_is_replaced() -> None:
    """9 kN at 2.25 mV/N would be 20 V; what is connected gives 5 V, and states it."""
    bench = TwoBodyBench(seed=3, hits=1, force_range=9000.0)
    source = ChassisSource(bench, samples=bench.samples)
    assert source.channels[0].sensitivity == pytest.approx(5.0 / 9000.0)
    assert record(source).samples[0].max() > 100.0


def test_the_runs_of_a_campaign_come_through_the_chassis() -> None:
    """Each as long as it was, under its own preload."""
    recorded = open_runs("sim:two-body-campaign?seed=2&grid=small")
    run = recorded.runs[3]
    assert isinstance(run, ChassisRun)
    recorded = record(run)
    np.testing.assert_allclose(recorded.samples, run.run.samples, atol=2e-3)  # type: ignore[attr-defined]
    assert run.preload == run.run.preload


def test_a_chassis_that_goes_away_in_the_middle_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A recording never pretends to be continuous where it is not."""
    started: list[SimulatedChassis] = []
    start = SimulatedChassis.start

    def note(server: SimulatedChassis) -> None:
        started.append(server)
        start(server)

    monkeypatch.setattr(SimulatedChassis, "start", note)
    bench = TwoBodyBench(seed=3, hits=2)
    blocks = ChassisSource(bench, samples=bench.samples).blocks()
    next(blocks)
    started[0].drop(60.0)
    with pytest.raises(InstrumentError, match="lost"):
        list(blocks)
