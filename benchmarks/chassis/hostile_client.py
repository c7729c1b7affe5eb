"""Serve an ordinary client while another one is hostile.

    python benchmarks/chassis/hostile_client.py > docs/chassis-hostile.md

The chassis runs in a process of its own, as `jointbench simulate` does. The ordinary
client connects, makes a task, reads a block of a second and leaves; its time is taken
alone, and beside each kind of attack, all of them from one hostile process.
"""

import argparse
import contextlib
import multiprocessing
import os
import socket
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from multiprocessing.synchronize import Event

import grpc
import nidaqmx
from nidaqmx._stubs import nidaqmx_pb2, nidaqmx_pb2_grpc  # noqa: PLC2701
from nidaqmx.constants import AcquisitionType

from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

RATE = 12_800.0
OWN = (("grpc.use_local_subchannel_pool", 1),)


def serve(port: int, ready: Event) -> None:
    """Serve a sine at two modules in real time."""
    with SimulatedChassis(ChassisSetup(bench=None, module="9234,9234", port=port)):
        ready.set()
        time.sleep(600)


def ordinary(address: str, samples: int) -> float:
    """Return the time for a task, beyond that of its samples [s]."""
    since = time.monotonic()
    with grpc.insecure_channel(address, OWN) as channel:
        task = running_task(channel, "cDAQSim1Mod2/ai0")
        assert len(task.read(samples)) == samples
        task.close()
    return time.monotonic() - since - samples / RATE


def running_task(channel: grpc.Channel, where: str, name: str = "") -> nidaqmx.Task:
    """Return a started task without an end, or the one of that name."""
    task = nidaqmx.Task(name, grpc_options=nidaqmx.GrpcSessionOptions(channel, name))
    if task.channel_names:
        # An earlier client of the same kind was killed, and its task runs on.
        return task
    task.ai_channels.add_ai_voltage_chan(where, min_val=-5.0, max_val=5.0)
    task.timing.cfg_samp_clk_timing(RATE, sample_mode=AcquisitionType.CONTINUOUS)
    task.start()
    return task


def garbage(address: str) -> None:
    """Send bytes that are no protocol, again and again, on fifty sockets."""
    host, port = address.split(":")
    while True:
        for _ in range(50):
            with (
                contextlib.suppress(OSError),
                socket.create_connection((host, int(port)), timeout=1.0) as stream,
            ):
                stream.sendall(bytes(range(256)) * 64)
        time.sleep(0.05)


def thousand_tasks(address: str) -> None:
    """Make a thousand tasks, and continue to ask."""
    with grpc.insecure_channel(address, OWN) as channel:
        stub = nidaqmx_pb2_grpc.NiDAQmxStub(channel)
        number = 0
        while True:
            number += 1
            request = nidaqmx_pb2.CreateTaskRequest(session_name=f"t{number}")
            with contextlib.suppress(grpc.RpcError):
                stub.CreateTask(request)
            if number > 1000:
                time.sleep(0.01)


def event_streams(address: str) -> None:
    """Open thirty streams of events."""
    with grpc.insecure_channel(address, OWN) as channel:
        stub = nidaqmx_pb2_grpc.NiDAQmxStub(channel)
        streams = []
        for number in range(30):
            task = nidaqmx_pb2.CreateTaskRequest(session_name=f"e{number}")
            made = stub.CreateTask(task).task
            request = nidaqmx_pb2.RegisterDoneEventRequest(task=made)
            streams.append(stub.RegisterDoneEvent(request))
        time.sleep(600)


def endless_waits(address: str) -> None:
    """Wait without a limit for the end of a task that has none, a hundred times."""
    with grpc.insecure_channel(address, OWN) as channel:
        task = running_task(channel, "cDAQSim1Mod1/ai0", "endless")
        stub = nidaqmx_pb2_grpc.NiDAQmxStub(channel)
        request = nidaqmx_pb2.WaitUntilTaskDoneRequest(
            task=task._handle,  # noqa: SLF001
            time_to_wait=-1.0,
        )
        calls = [stub.WaitUntilTaskDone.future(request) for _ in range(100)]
        time.sleep(600)
        del calls


@contextlib.contextmanager
def attacked(address: str, attack: Callable[[str], None] | None) -> Iterator[None]:
    """Run an attack beside what is done meanwhile."""
    if attack is None:
        yield
        return
    child = multiprocessing.Process(target=attack, args=(address,))
    child.start()
    try:
        yield
        # An attack that has ended by itself proves nothing.
        assert child.is_alive(), attack.__doc__
    finally:
        child.terminate()
        child.join()


def row(words: str, taken: list[float]) -> str:
    """Return a row of the table."""
    return f"| {words} | {statistics.median(taken):.3f} | {max(taken):.3f} |"


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10, help="ordinary tasks each")
    parser.add_argument("--port", type=int, default=31_788)
    arguments = parser.parse_args()
    multiprocessing.set_start_method("spawn")
    address = f"127.0.0.1:{arguments.port}"
    ready = multiprocessing.Event()
    server = multiprocessing.Process(target=serve, args=(arguments.port, ready))
    server.start()
    ready.wait(60)
    lines = [
        "# An ordinary client beside a hostile one",
        "Time that a client needs to connect, make a task, read 0.1 s and leave, "
        "beyond the 0.1 s. The chassis and each attack are processes of their own, on "
        f"a computer with two cores and a load of {os.getloadavg()[0]:.0f}. Bar: 1 s. "
        "Written by `benchmarks/chassis/hostile_client.py`.",
        "",
        "| beside | median [s] | longest [s] |",
        "|---|---|---|",
    ]
    attacks = (None, garbage, thousand_tasks, event_streams, endless_waits)
    try:
        for attack in attacks:
            words = "nothing" if attack is None else str(attack.__doc__).rstrip(".")
            with attacked(address, attack):
                # The attack has begun when its process has imported what it needs.
                time.sleep(0.0 if attack is None else 4.0)
                taken = [ordinary(address, 1280) for _ in range(arguments.count)]
            sys.stderr.write(f"{words}: {taken}\n")
            lines.append(row(words, taken))
        with contextlib.ExitStack() as stack:
            for attack in attacks[1:]:
                stack.enter_context(attacked(address, attack))
            time.sleep(6.0)
            taken = [ordinary(address, 1280) for _ in range(arguments.count)]
        sys.stderr.write(f"all: {taken}\n")
        lines.append(row("all of them at once", taken))
    finally:
        server.terminate()
        server.join()
    print("\n".join(lines))


if __name__ == "__main__":
    main()
