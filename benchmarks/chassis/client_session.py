"""NI's client with the simulated chassis in place of the driver of this computer."""

import builtins
import contextlib
import time
from collections.abc import Iterator
from typing import Any

import grpc
import nidaqmx
import nidaqmx.system
import nidaqmx.task


@contextlib.contextmanager
def session(address: str, *, enter: float = 1.0) -> Iterator[None]:
    """Give every task and system of the client a session at an address.

    Args:
        address: of the device server.
        enter: time after which `input` returns [s].
    """
    task, local, typed = nidaqmx.Task, nidaqmx.system.System.local, builtins.input
    with grpc.insecure_channel(address) as channel:

        def options(name: str) -> nidaqmx.GrpcSessionOptions:
            return nidaqmx.GrpcSessionOptions(channel, name)

        class RemoteTask(task):  # type: ignore[misc, valid-type]
            """A task on the chassis."""

            def __init__(self, new_task_name: str = "") -> None:
                super().__init__(new_task_name, grpc_options=options(new_task_name))

        def system() -> Any:
            return nidaqmx.system.System.remote(options(""))

        def press_enter(prompt: str = "") -> str:
            time.sleep(enter)
            return ""

        builtins.input = press_enter
        nidaqmx.Task = nidaqmx.task.Task = RemoteTask  # type: ignore[misc]
        nidaqmx.system.System.local = staticmethod(system)  # type: ignore[method-assign]
        try:
            yield
        finally:
            nidaqmx.Task = nidaqmx.task.Task = task  # type: ignore[misc]
            builtins.input = typed
            nidaqmx.system.System.local = local  # type: ignore[method-assign]
