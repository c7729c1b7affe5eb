"""What is done about NI's errors, each raised at NI's own client by its code."""

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from nidaqmx.error_codes import DAQmxErrors

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.ni import error_codes
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.driver_answers import (
    ConnectionLost,
    NotYet,
    Overrun,
    Stopped,
)
from jointbench.acquisition.ni.error_codes import Remedy, remedy
from jointbench.acquisition.ni.sensors import Axis, Sensor, excitation_current
from jointbench.acquisition.ni.stream import (
    Block,
    NiStream,
    StreamGap,
    StreamSettings,
    Waiting,
)
from jointbench.acquisition.records.recordings import Quantity
from jointbench.simulators.chassis.faults import parse_faults
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

ROOT = Path(__file__).parents[3]
RATE, BLOCK = 12_800.0, 512
HAMMER = Sensor(
    "force", Quantity.FORCE, "", (Axis("cDAQSim1Mod1/ai0", "+z", 2.25e-3),), "N", 2200.0
)
A1 = Sensor(
    "a1",
    Quantity.ACCELERATION,
    "1",
    (Axis("cDAQSim1Mod1/ai1", "+z", 1.04e-3),),
    "m/s^2",
    4000.0,
)
# What each number means is in NI's own table of errors.
SORTED = {
    Remedy.RETRY: (-200284, -200279, -200560),
    Remedy.REARM: (-200361, -200222, -200283, -88709, -200010, -209829, -200019),
    Remedy.REOPEN: (
        -200045,
        -201390,
        -201250,
        -201252,
        -201253,
        -201003,
        -200088,
        -200220,
    ),
    Remedy.TELL: (-200077, -200170, -200478, -200022, -1),
}
NO_TEDS = (-200709, -200741, -200742, -200743, -200753, -200754, -200766, -200826)


@contextmanager
def chassis(faults: str = "", **changes: object) -> Iterator[Chassis]:
    """Open a client on a simulated chassis that runs as fast as it is read."""
    setup = ChassisSetup(speed=math.inf, faults=parse_faults(faults))
    with SimulatedChassis(replace(setup, **changes)) as server:  # type: ignore[arg-type]
        client = Chassis(server.address)
        yield client
        client.close()


def take(
    client: Chassis, blocks: int, **settings: float
) -> tuple[list[Block | StreamGap | Waiting], NiStream]:
    """Read until so many blocks have come; return everything, and the stream."""
    made = NiStream(client, (HAMMER, A1), StreamSettings(RATE, BLOCK, **settings))
    made.start()
    items: list[Block | StreamGap | Waiting] = []
    for item in made.items():
        items.append(item)
        if sum(isinstance(i, Block) for i in items) == blocks:
            break
    made.count()
    made.close()
    return items, made


@pytest.mark.parametrize(
    ("code", "wanted"), [(c, helps) for helps, codes in SORTED.items() for c in codes]
)
def test_each_error_is_sorted_by_what_helps(code: int, wanted: Remedy) -> None:
    """Wait, restart, reopen, or report."""
    assert remedy(code) is wanted


def test_no_error_is_in_two_groups() -> None:
    """What helps is one thing."""
    groups = (error_codes.RETRY, error_codes.REARM, error_codes.REOPEN)
    assert sum(map(len, groups)) == len(frozenset().union(*groups))
    assert not error_codes.NO_TEDS & frozenset().union(*groups)


@pytest.mark.parametrize("room", ["acquisition/ni", "simulators/chassis"])
def test_no_code_is_typed_in(room: str) -> None:
    """Every negative number of five digits or more has NI's name instead."""
    for path in (ROOT / room).glob("*.py"):
        typed = re.findall(r"(?<![\w.])-\d{5,}", path.read_text(encoding="utf-8"))
        assert not typed, path.name


@pytest.mark.parametrize("code", SORTED[Remedy.REARM])
def test_a_device_that_stopped_is_started_again_without_a_connection_lost(
    code: int,
) -> None:
    """A gap reports it, the next block is the first of a new segment."""
    with chassis(f"error@1024:{-code}") as client:
        items, made = take(client, 4)
    (gap,) = [i for i in items if isinstance(i, StreamGap)]
    after = items[items.index(gap) + 1]
    assert gap.kind == "rearmed"
    assert str(code) in gap.words
    assert isinstance(after, Block)
    assert (after.segment, after.first) == (1, 0)
    assert made.counters.lost == gap.samples


@pytest.mark.parametrize("code", SORTED[Remedy.REOPEN])
def test_a_device_that_went_away_is_waited_for(code: int) -> None:
    """Lost and back, as with a server that does not answer."""
    with chassis(f"error@1024:{-code}") as client:
        items, _ = take(client, 4)
    assert [i.kind for i in items if isinstance(i, StreamGap)] == ["lost", "back"]


@pytest.mark.parametrize("code", [-200284, -200560])
def test_samples_that_are_late_are_waited_for_in_the_same_task(code: int) -> None:
    """No gap, no new segment, no sample lost: a time-out alone opens nothing."""
    with chassis(f"error@1024:{-code}") as client:
        items, made = take(client, 4)
    assert not [i for i in items if isinstance(i, StreamGap)]
    assert [i for i in items if isinstance(i, Waiting)] == [Waiting(0)]
    blocks = [i for i in items if isinstance(i, Block)]
    assert [(b.segment, b.first) for b in blocks] == [(0, BLOCK * n) for n in range(4)]
    assert made.counters.lost == 0


def test_a_device_that_makes_no_sample_for_too_long_is_reported() -> None:
    """A clock that never ticks ends in one line, once patience is over."""
    faults = ",".join(["error@1024:200284"] * 3)
    with chassis(faults) as client, pytest.raises(InstrumentError, match="no sample"):
        take(client, 4, patience=-1.0)


@pytest.mark.parametrize("code", [c for c in SORTED[Remedy.TELL] if c != -1])
def test_an_error_that_nothing_helps_against_ends_the_stream_with_its_number(
    code: int,
) -> None:
    """It is none of those after which the stream continues."""
    with (
        chassis(f"error@1024:{-code}") as client,
        pytest.raises(InstrumentError, match=str(code)) as raised,
    ):
        take(client, 4)
    others = (ConnectionLost, NotYet, Overrun, Stopped)
    assert not isinstance(raised.value, others)


@pytest.mark.parametrize("code", NO_TEDS)
def test_a_module_without_a_readable_teds_has_none(code: int) -> None:
    """A plan that states serial numbers is measured nevertheless."""
    with chassis(f"teds_error@0:{-code}") as client:
        assert client.teds("cDAQSim1Mod1/ai0") is None


@pytest.mark.parametrize(
    "name",
    [
        "LINES_USED_FOR_HANDSHAKING_INPUT_NOT_FOR_STATIC_INPUT",
        "PROPERTY_NOT_SUPPORTED_FOR_TIMING_SRC",
    ],
)
def test_an_error_that_is_not_about_teds_is_reported(name: str) -> None:
    """Two numbers once stood for "no TEDS" by mistake."""
    code = int(DAQmxErrors[name])
    with (
        chassis(f"teds_error@0:{-code}") as client,
        pytest.raises(InstrumentError, match=str(code)),
    ):
        client.teds("cDAQSim1Mod1/ai0")


def test_a_sensor_gets_the_current_that_its_module_offers() -> None:
    """An NI 9234 has 2 mA and refuses 4 mA; a module with a choice gives the least."""
    with chassis() as client:
        items, _ = take(client, 1)
    assert len(items) == 1
    with chassis(currents=(0.004, 0.010)) as client:
        items, _ = take(client, 1)
    assert len(items) == 1


def test_a_current_that_the_module_does_not_offer_is_refused_with_what_it_does() -> (
    None
):
    """The plan's own words, and the way out."""
    stated = replace(HAMMER, excitation=0.004)
    with (
        chassis() as client,
        pytest.raises(UsageError, match=r"'force'.*4 mA.*offers 2 mA"),
    ):
        client.task("t", (stated, A1))


def test_a_module_without_a_current_is_reported_unless_the_sensor_needs_none() -> None:
    """`iepe = '0 mA'` is for a sensor with a supply of its own."""
    own = tuple(replace(sensor, excitation=0.0) for sensor in (HAMMER, A1))
    with chassis(currents=()) as client:
        with pytest.raises(UsageError, match="offers no current"):
            client.task("t", (HAMMER, A1))
        client.task("t", own).close()


def test_a_current_of_2_mA_may_be_2_1_on_the_module() -> None:  # noqa: N802
    """NI's dynamic signal analysers name the current that they really give."""
    stated = replace(HAMMER, excitation=0.002)
    assert excitation_current(stated, HAMMER.axes[0], (0.0021,)) == 0.0021


@pytest.mark.parametrize("lost", [1, 3000])
def test_after_an_overrun_only_what_was_overwritten_is_missing(lost: int) -> None:
    """The oldest sample still in the buffer comes next, to the sample."""
    with chassis(f"overrun@2048:{lost}") as client:
        items, made = take(client, 40, buffer=2.0)
    (gap,) = [i for i in items if isinstance(i, StreamGap)]
    after = items[items.index(gap) + 1]
    assert isinstance(after, Block)
    assert (gap.kind, gap.samples) == ("overrun", lost)
    assert (gap.first, after.first) == (2048, 2048 + lost)
    assert made.counters.lost == lost


def test_samples_after_an_overrun_are_those_of_an_undisturbed_stream() -> None:
    """Sample k of the device is sample k of the stream, before the gap and after."""
    with chassis() as client:
        whole, _ = take(client, 40)
    with chassis("overrun@2048:700") as client:
        torn, _ = take(client, 30, buffer=0.5)
    samples = np.hstack([i.samples for i in whole if isinstance(i, Block)])
    for block in torn:
        if isinstance(block, Block):
            own = samples[:, block.first : block.first + block.samples.shape[1]]
            np.testing.assert_array_equal(block.samples, own)


def test_a_reader_that_was_held_up_takes_all_that_waits() -> None:
    """A second of signal waits: the next read empties the buffer, block by block."""
    with chassis(speed=4.0) as client:
        made = NiStream(client, (HAMMER, A1), StreamSettings(RATE, BLOCK))
        made.start()
        items = made.items()
        next(items)
        _asleep(made, 1.0)
        block = next(items)
        task = made._task  # noqa: SLF001 - what the driver still holds
        assert task is not None
        assert task.available() < 0.5 * RATE
        assert isinstance(block, Block)
        assert (block.first, block.samples.shape[1]) == (BLOCK, BLOCK)
        made.close()


def test_a_stream_in_real_time_loses_little_more_than_was_overwritten() -> None:
    """A reader 30 s late with a buffer of 20 s loses 10 s and reads the rest."""
    rests: list[float] = []
    with chassis(speed=20.0) as client:
        made = NiStream(client, (HAMMER, A1), StreamSettings(RATE, BLOCK, buffer=20.0))
        made.start()
        gaps: list[StreamGap] = []
        for item in made.items():
            if isinstance(item, StreamGap):
                gaps.append(item)
                task = made._task  # noqa: SLF001 - the device's own counter
                assert task is not None
                rests.append((task.acquired() - item.first - item.samples) / RATE)
            elif not gaps:
                _asleep(made, 30.0)
            elif gaps:
                break
        made.count()
        made.close()
    (gap,) = gaps
    assert made.counters.lost == gap.samples
    # Twenty times as fast as life, what is overwritten between look and read is more.
    assert rests[0] > 10.0


def _asleep(made: NiStream, seconds: float) -> None:
    """Read nothing until the device is so far ahead [s of signal]."""
    task = made._task  # noqa: SLF001 - the device's own counter
    assert task is not None
    while task.available() < seconds * RATE:
        pass


def test_a_stream_that_is_paused_in_the_middle_of_what_was_read_goes_on_anew() -> None:
    """Samples read and not yielded are unwanted, and counted as such."""
    with chassis("overrun@2048:1") as client:
        made = NiStream(client, (HAMMER, A1), StreamSettings(RATE, BLOCK, buffer=2.0))
        made.start()
        segments = []
        for item in made.items():
            if isinstance(item, Block):
                segments.append(item.segment)
                if len(segments) == 10:
                    made.pause()
                    made.resume()
            if len(segments) == 20:
                break
        made.count()
        made.close()
    assert segments == [0] * 10 + [1] * 10
    assert made.counters.lost == 1
    assert made.counters.unwanted > 0
