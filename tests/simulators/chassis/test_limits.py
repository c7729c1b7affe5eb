"""What a client may occupy, and that another one is served beside it."""

import socket
import time
from collections.abc import Iterator

import grpc
import nidaqmx
import pytest
from nidaqmx._stubs import nidaqmx_pb2  # noqa: PLC2701
from nidaqmx.constants import AcquisitionType
from nidaqmx.error_codes import DAQmxErrors

from jointbench.simulators.chassis.limits import Limits
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

LIMITS = Limits(workers=8, waiting=6, waiting_each=3, tasks=20, tasks_each=10)


@pytest.fixture
def server() -> Iterator[SimulatedChassis]:
    """Return a small server in real time."""
    setup = ChassisSetup(bench=None, module="9234,9215", limits=LIMITS)
    with SimulatedChassis(setup) as running:
        yield running


def task_on(channel: grpc.Channel, where: str, name: str = "") -> nidaqmx.Task:
    """Return a task that runs without an end."""
    options = nidaqmx.GrpcSessionOptions(channel, name)
    task = nidaqmx.Task(name, grpc_options=options)
    task.ai_channels.add_ai_voltage_chan(where, min_val=-5.0, max_val=5.0)
    task.timing.cfg_samp_clk_timing(12_800.0, sample_mode=AcquisitionType.CONTINUOUS)
    return task


def serve_another_client(server: SimulatedChassis) -> float:
    """Return how long a client needs to read ten samples [s]."""
    since = time.monotonic()
    own = (("grpc.use_local_subchannel_pool", 1),)
    with grpc.insecure_channel(server.address, own) as channel:
        task = task_on(channel, "cDAQSim1Mod2/ai0")
        assert len(task.read(10)) == 10
        task.close()
    return time.monotonic() - since


def test_waiting_calls_tasks_and_garbage_leave_room_for_another_client(
    server: SimulatedChassis,
) -> None:
    """Event streams and endless waits up to the limit, tasks up to the limit.

    Without room the client would wait without limit; a busy machine serves all slowly.
    """
    undisturbed = serve_another_client(server)
    own = (("grpc.use_local_subchannel_pool", 1),)
    with (
        socket.create_connection(("127.0.0.1", server.port)) as rubbish,
        grpc.insecure_channel(server.address, own) as channel,
    ):
        rubbish.sendall(b"\x00\xff" * 5000)
        task = task_on(channel, "cDAQSim1Mod1/ai0")
        task.register_done_event(lambda *_: 0)
        task.start()
        stub = task._interpreter._client  # noqa: SLF001

        wait = nidaqmx_pb2.WaitUntilTaskDoneRequest(
            task=task._handle,  # noqa: SLF001
            time_to_wait=-1.0,
        )
        calls = [stub.WaitUntilTaskDone.future(wait) for _ in range(12)]
        with pytest.raises(nidaqmx.DaqError) as refused:
            for n in range(30):
                task._interpreter.create_task(f"t{n}")  # noqa: SLF001
        assert refused.value.error_code == DAQmxErrors.PAL_MEMORY_FULL
        assert serve_another_client(server) < 1.0 + 10.0 * undisturbed
        refusals = [call for call in calls if call.done()]
        assert len(refusals) >= 9
        assert all(
            call.code() is grpc.StatusCode.RESOURCE_EXHAUSTED for call in refusals
        )
        for call in calls:
            call.cancel()
        task.close()


def test_a_client_that_dies_frees_its_workers(server: SimulatedChassis) -> None:
    """The next one gets all of them."""
    own = (("grpc.use_local_subchannel_pool", 1),)
    for n in range(3):
        channel = grpc.insecure_channel(server.address, own)
        task = task_on(channel, "cDAQSim1Mod1/ai0", name=f"dies{n}")
        stub = task._interpreter._client  # noqa: SLF001

        request = nidaqmx_pb2.RegisterDoneEventRequest(task=task._handle)  # noqa: SLF001
        stub.RegisterDoneEvent(request).initial_metadata()
        task._handle = None  # dead: it never clears its task  # noqa: SLF001
        channel.close()
    waiters = server._service.waiters  # type: ignore[union-attr]  # noqa: SLF001
    until = time.monotonic() + 60.0
    while waiters._counts.total() and time.monotonic() < until:  # noqa: SLF001
        time.sleep(0.02)
    assert waiters._counts.total() == 0  # noqa: SLF001


def test_the_server_listens_on_this_computer_alone_unless_a_host_is_stated() -> None:
    """The loopback interface by default."""
    assert ChassisSetup().host == "127.0.0.1"
