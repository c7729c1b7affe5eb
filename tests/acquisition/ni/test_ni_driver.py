"""The NI driver with the real client, against a chassis on NI's own servicer."""

import math
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.driver_answers import ConnectionLost, Overrun
from jointbench.acquisition.ni.sensor_calibration import (
    calibration_warning,
)
from jointbench.acquisition.ni.sensors import (
    Axis,
    Sensor,
    require_table,
    table_channels,
)
from jointbench.acquisition.ni.stream import Block, NiStream, StreamGap, StreamSettings
from jointbench.acquisition.records.recordings import Quantity
from jointbench.simulators.chassis.faults import parse_faults
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

GRAVITY = 9.80665
HAMMER = Sensor(
    "force",
    Quantity.FORCE,
    "",
    (Axis("cDAQSim1Mod1/ai0", "+z", 2.25e-3),),
    "N",
    2200.0,
    serial="41230",
    calibrated=date(2026, 3, 2),
)
A1 = Sensor(
    "a1",
    Quantity.ACCELERATION,
    "1",
    (Axis("cDAQSim1Mod1/ai1", "+z", 10.2e-3 / GRAVITY),),
    "g",
    4000.0,
)
SENSORS = (HAMMER, A1)
_PAUSE = threading.Event()


@contextmanager
def chassis(faults: str = "", **changes: object) -> Iterator[Chassis]:
    """Open a client on a simulated chassis that runs as fast as it is read."""
    setup = ChassisSetup(speed=math.inf, faults=parse_faults(faults))
    with SimulatedChassis(replace(setup, **changes)) as server:  # type: ignore[arg-type]
        client = Chassis(server.address)
        yield client
        client.close()


def stream(client: Chassis, *, block: int = 512, **settings: float) -> NiStream:
    """Return a started stream of hammer and one accelerometer."""
    made = NiStream(
        client, SENSORS, StreamSettings(12_800.0, block, sleep=_no_sleep, **settings)
    )
    made.start()
    return made


def _no_sleep(seconds: float) -> None:
    """Come back at once, a little later: the server restarts on its own clock."""
    _PAUSE.wait(min(seconds, 0.02))


def take(made: NiStream, blocks: int) -> list[Block | StreamGap]:
    """Read until so many blocks have come; gaps come on top."""
    items: list[Block | StreamGap] = []
    for item in made.items():
        items.append(item)
        if sum(isinstance(i, Block) for i in items) == blocks:
            return items
    return items


def test_the_chassis_lists_its_module_and_says_that_it_is_simulated() -> None:
    """Name, product, inputs and trigger come through NI's own attributes."""
    with chassis() as client:
        (module,) = client.modules()
    assert module.product == "NI 9234"
    assert module.simulated
    assert module.analogue_trigger
    assert module.inputs[0] == "cDAQSim1Mod1/ai0"


def test_a_teds_says_the_serial_number_of_the_sensor() -> None:
    """An input without a sensor has none."""
    with chassis(modules=2) as client:
        found = client.teds("cDAQSim1Mod1/ai0")
        nothing = client.teds("cDAQSim1Mod2/ai0")
    assert found is not None
    assert found.serial == 41230
    assert nothing is None


def test_a_wrong_teds_differs_from_the_right_one() -> None:
    """The fault swaps the sensor at input 0."""
    with chassis("wrong_teds@0:0") as client:
        found = client.teds("cDAQSim1Mod1/ai0")
    assert found is not None
    assert found.serial != 41230


def test_a_hit_comes_in_newtons_with_its_peak() -> None:
    """The peak of the pulse is that of the stroke, within the sampling error."""
    with chassis() as client:
        made = stream(client)
        client.strike(b'{"point": "1", "level": 200}')
        blocks = [i.samples for i in take(made, 20) if isinstance(i, Block)]
        made.close()
    force = np.hstack(blocks)[0]
    assert force.max() == pytest.approx(200.0, rel=0.3)
    assert abs(np.median(force)) < 0.1


def test_a_wrong_sensitivity_gives_wrong_newtons() -> None:
    """The chassis delivers volts; what the table believes scales them."""
    half = replace(HAMMER, axes=(Axis("cDAQSim1Mod1/ai0", "+z", 4.5e-3),), range=1100.0)
    peaks = []
    for hammer in (HAMMER, half):
        with chassis() as client:
            made = NiStream(client, (hammer, A1), StreamSettings(12_800.0, 512))
            made.start()
            client.strike(b"{}")
            blocks = [i.samples for i in take(made, 20) if isinstance(i, Block)]
            made.close()
        peaks.append(np.hstack(blocks)[0].max())
    assert peaks[1] == pytest.approx(0.5 * peaks[0], rel=1e-3)


def test_samples_do_not_depend_on_the_size_of_a_block() -> None:
    """Sample k is the same number, bit for bit, read by 512 or by 768."""
    streams = []
    for block in (512, 768):
        with chassis() as client:
            made = stream(client, block=block)
            client.strike(b'{"point": "3"}')
            items = take(made, 6144 // block)
            made.close()
        streams.append(np.hstack([i.samples for i in items if isinstance(i, Block)]))
    np.testing.assert_array_equal(streams[0], streams[1])


def test_the_device_says_at_which_rate_it_really_runs() -> None:
    """The module divides 51.2 kHz by whole numbers: 20 kHz asked gives 25.6 kHz."""
    with chassis() as client:
        made = NiStream(client, SENSORS, StreamSettings(20_000.0, 512))
        made.start()
        made.close()
    assert made.sample_rate == 25_600.0


def test_a_rate_above_the_modules_is_refused_with_nis_number() -> None:
    """-200077 comes through with NI's words, on one error."""
    with chassis() as client:
        made = NiStream(client, SENSORS, StreamSettings(102_400.0, 512))
        with pytest.raises(InstrumentError, match="-200077"):
            made.start()


def test_a_channel_that_does_not_exist_is_refused_by_name() -> None:
    """-200170 names the input."""
    with chassis("refuse@0:1") as client:
        made = NiStream(client, SENSORS, StreamSettings(12_800.0, 512))
        with pytest.raises(InstrumentError, match=r"-200170[\s\S]*ai1"):
            made.start()


def test_counter_and_file_agree_on_an_undisturbed_stream() -> None:
    """Acquired, less what still waits, less what was read, is nothing."""
    with chassis() as client:
        made = stream(client)
        take(made, 10)
        made.count()
        made.close()
    assert made.counters.delivered == 5120
    assert made.counters.lost == 0


def test_an_overrun_is_a_gap_of_known_size_and_the_stream_goes_on() -> None:
    """A genuine -200279: 3000 samples overwritten at the device are counted as lost."""
    with chassis("overrun@2048:3000") as client:
        made = stream(client)
        items = take(made, 8)
        made.count()
        made.close()
    (gap,) = [i for i in items if isinstance(i, StreamGap)]
    after = items[items.index(gap) + 1]
    assert gap.kind == "overrun"
    assert "-200279" in gap.words
    assert isinstance(after, Block)
    assert after.first == gap.first + gap.samples
    assert gap.samples >= 3000
    assert made.counters.lost == gap.samples


def test_a_bare_read_of_overwritten_samples_raises_overrun() -> None:
    """The task itself does not hide it."""
    with chassis("overrun@0:2000") as client:
        task = client.task("t", SENSORS)
        task.start(12_800.0, buffer=20_000)
        with pytest.raises(Overrun, match="-200279"):
            task.read(512, timeout=1.0)
        task.close()


def test_a_dropped_server_ends_a_segment_and_the_next_one_begins() -> None:
    """Lost and back are distinguished, and the new task counts from zero."""
    with chassis("drop@1024:0.1") as client:
        made = stream(client)
        items = take(made, 6)
        made.close()
    kinds = [i.kind for i in items if isinstance(i, StreamGap)]
    last = items[-1]
    assert kinds == ["lost", "back"]
    assert isinstance(last, Block)
    assert last.segment == 1
    assert last.first < 6 * 512


def test_a_server_that_stays_away_ends_in_one_line() -> None:
    """Patience runs out; the message says that what was recorded is safe."""
    with chassis("drop@512:60") as client:
        made = stream(client, patience=0.05)
        with pytest.raises(InstrumentError, match=r"gave up.*safe"):
            take(made, 4)


def test_no_answer_at_the_address_is_a_lost_connection() -> None:
    """Port 9 of this computer serves nothing."""
    client = Chassis("127.0.0.1:9")
    with pytest.raises(ConnectionLost, match="does not answer"):
        client.modules()
    client.close()


def test_a_computer_without_the_driver_says_what_to_install() -> None:
    """`ni:` needs NI-DAQmx; without it the way out is in the message."""
    client = Chassis(None)
    with pytest.raises(InstrumentError, match=r"ni\.com|NI-DAQmx"):
        client.modules()


def test_an_open_sensor_loop_is_reported_by_channel() -> None:
    """The fault opens input 1; the device's attribute shows it."""
    with chassis("open@512:1") as client:
        made = stream(client)
        take(made, 1)
        before = made.open_loops()
        take(made, 2)
        after = made.open_loops()
        made.close()
    assert before == ()
    assert after == ("a1",)


def test_the_hardware_trigger_stands_exactly_where_it_was_asked_for() -> None:
    """A finite block: the sample at the pre-trigger count is the first at the level."""
    with chassis() as client:
        task = client.task("t", SENSORS)
        task.start_triggered(
            12_800.0, samples=1024, source="force", before=100, level=20.0
        )
        client.strike(b"{}")
        samples = task.read(1024, timeout=10.0)
        task.close()
    assert samples[0, 99] < 20.0 <= samples[0, 100]


def test_a_module_without_a_trigger_refuses_it() -> None:
    """`anlg_trig_supported` shows it beforehand, -200077 afterwards."""
    with chassis(analogue_trigger=False) as client:
        assert not client.modules()[0].analogue_trigger
        task = client.task("t", SENSORS)
        with pytest.raises(InstrumentError, match="-200077"):
            task.start_triggered(
                12_800.0, samples=1024, source="force", before=100, level=20.0
            )
        task.close()


def test_a_triaxial_sensor_is_one_sensor_with_three_channels() -> None:
    """Its channels carry its name and their direction."""
    axes = tuple(Axis(f"M/ai{n}", d, 1e-3) for n, d in enumerate(("+x", "+y", "-z"), 1))
    sensor = Sensor("a3", Quantity.ACCELERATION, "3", axes, "g", 500.0)
    channels = table_channels((HAMMER, sensor))
    assert [c.name for c in channels] == ["force", "a3x", "a3y", "a3z"]
    assert channels[3].direction == "-z"


def test_an_input_that_is_used_twice_is_refused() -> None:
    """Two sensors cannot share a plug."""
    device = replace(A1, name="a2", axes=(Axis("cDAQSim1Mod1/ai1", "+z", 1e-3),))
    with pytest.raises(UsageError, match="used twice"):
        require_table((HAMMER, A1, device))


@pytest.mark.parametrize(
    ("today", "warns"), [(date(2027, 3, 2), False), (date(2027, 3, 3), True)]
)
def test_an_expired_calibration_warns_from_the_day_after(
    today: date, warns: bool
) -> None:
    """Calibrated on 2 March 2026 for twelve months."""
    assert (calibration_warning(HAMMER, today) is not None) is warns


def test_a_task_left_by_a_lost_connection_is_closed_before_the_next() -> None:
    """A server that stays up keeps the task, and with it the module (-50103)."""
    with chassis() as client:
        client.task("first", SENSORS).start(12_800.0, buffer=20_000)
        other = client.task("second", SENSORS)
        with pytest.raises(InstrumentError, match=r"-50103[\s\S]*holds the module"):
            other.start(12_800.0, buffer=20_000)
        client._left.append("first")  # noqa: SLF001
        task = client.task("third", SENSORS)
        assert task.start(12_800.0, buffer=20_000) == 12_800.0
        task.close()


def test_a_task_that_cannot_be_closed_is_noted() -> None:
    """The server is away when the task is to be closed."""
    with SimulatedChassis(ChassisSetup(speed=math.inf)) as server:
        client = Chassis(server.address)
        task = client.task("first", SENSORS)
        server.drop(60.0)
        task.close()
        assert client._left == ["first"]  # noqa: SLF001
        client.close()


def test_a_task_of_a_killed_program_is_replaced() -> None:
    """It has the same name, is running, and its program will not stop it."""
    with SimulatedChassis(ChassisSetup(speed=math.inf)) as server:
        killed, client = Chassis(server.address), Chassis(server.address)
        killed.task("jointbench-0", SENSORS).start(12_800.0, buffer=20_000)
        killed.close()
        made = stream(client)
        assert made.sample_rate == 12_800.0
        made.close()
        client.close()


@contextmanager
def late_greeting(address: str, seconds: float) -> Iterator[str]:
    """Pass a connection on to a server, as one whose computer answers late [s]."""
    host, port = address.split(":")
    listener = socket.create_server(("127.0.0.1", 0))

    def pass_on(source: socket.socket, target: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(65536):
                target.sendall(data)
            target.shutdown(socket.SHUT_RDWR)

    def accept() -> None:
        near, _ = listener.accept()
        with near, socket.create_connection((host, int(port))) as far:
            back = threading.Thread(target=pass_on, args=(near, far), daemon=True)
            back.start()
            time.sleep(seconds)
            pass_on(far, near)

    passing = threading.Thread(target=accept)
    passing.start()
    with listener:
        yield f"127.0.0.1:{listener.getsockname()[1]}"
    passing.join(10.0)


def test_a_server_that_answers_late_is_waited_for() -> None:
    """Its computer is busy: a second and a half pass before its greeting."""
    with (
        SimulatedChassis(ChassisSetup(speed=math.inf)) as server,
        late_greeting(server.address, 1.5) as address,
    ):
        client = Chassis(address)
        assert client.modules()
        client.close()
