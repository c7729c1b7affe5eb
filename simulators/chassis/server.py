# SPDX-License-Identifier: MIT
"""The simulated chassis as a server on the loopback interface.

Besides NI's service it has a second, small one for its clock, and for the position and
the strokes of the hammer. A real server does not have it, and no measuring program
depends on it.
"""

import json
import math
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from types import TracebackType
from typing import Any

import grpc

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.records.source import Source
from jointbench.simulators.chassis.calls.scripted_faults import ScriptedFaults
from jointbench.simulators.chassis.calls.service import ChassisService
from jointbench.simulators.chassis.faults import Fault, FaultKind
from jointbench.simulators.chassis.limits import Limits
from jointbench.simulators.chassis.modules.inventory import (
    DEFAULT_MODULE,
    Inventory,
    changed,
    devices,
    module_list,
)
from jointbench.simulators.chassis.modules.lookup import described
from jointbench.simulators.chassis.protocol import add_servicer
from jointbench.simulators.chassis.specimen import MachineSpecimen, StreamedSpecimen
from jointbench.simulators.chassis.tasks.acquisition import Pace
from jointbench.simulators.chassis.tasks.signals import (
    Signals,
    SineSignals,
    SpecimenSignals,
)
from jointbench.simulators.chassis.tasks.task import SharedBench, SimulatedTask
from jointbench.simulators.machines.running_machine import RunningMachine
from jointbench.simulators.plates.plates_bench import (
    LivePlates,
    PlannedStroke,
    PlatesBench,
    PluggedSensor,
)

HAND_SERVICE = "jointbench.Hand"
LOOPBACK = "127.0.0.1"
# Requests are short, answers are not.
_OPTIONS = (
    ("grpc.max_send_message_length", -1),
    ("grpc.so_reuseport", 0),
    ("grpc.keepalive_time_ms", 10_000),
    ("grpc.keepalive_timeout_ms", 20_000),
    ("grpc.http2.min_ping_interval_without_data_ms", 5_000),
    ("grpc.keepalive_permit_without_calls", 1),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChassisSetup:
    """Set-up of the simulated bench.

    Attributes:
        bench: specimen, operator and sensors; or a source of samples, whose channels
            are connected in order; or None for a sine in the limits of each channel,
            as NI's own simulated devices give.
        speed: seconds of signal per second; infinite for as fast as it is read.
        module: type of the modules, ``"9234"``; or of each, ``"9234,9250"``.
        modules: number of modules of one type.
        name: of the chassis.
        names: of the modules, instead of those made from the name of the chassis.
        top_rate: of an external clock: highest samples per second and channel [Hz];
            None for the clock of the modules.
        analogue_trigger: whether modules that can trigger on a signal do so.
        currents: for IEPE sensors instead of those of the modules [A].
        faults: script of faults.
        port: to listen on; 0 for any free one.
        host: address to listen on; the loopback interface unless stated.
        limits: of each client.
    """

    bench: PlatesBench | Source | None = field(default_factory=PlatesBench)
    speed: float = 1.0
    module: str = DEFAULT_MODULE
    modules: int = 1
    name: str = "cDAQSim1"
    names: tuple[str, ...] = ()
    top_rate: float | None = None
    analogue_trigger: bool = True
    currents: tuple[float, ...] | None = None
    faults: tuple[Fault, ...] = ()
    port: int = 0
    host: str = LOOPBACK
    limits: Limits = field(default_factory=Limits)


class SimulatedChassis:
    """A server that can be started, stopped and restarted on the same port."""

    def __init__(self, setup: ChassisSetup) -> None:
        self._setup = setup
        self._pace = Pace(speed=setup.speed)
        self._live = _specimen(setup.bench)
        self._signals: Signals = (
            SineSignals() if self._live is None else SpecimenSignals(self._live)
        )
        self._faults = list(setup.faults)
        self._delivered = 0
        self._lock = threading.Lock()
        self._server: grpc.Server | None = None
        self._service: ChassisService | None = None
        self._restart: threading.Timer | None = None
        self.port = setup.port

    @property
    def address(self) -> str:
        """Host and port, as given to a client."""
        return f"{self._setup.host}:{self.port}"

    @property
    def history(self) -> tuple[PlannedStroke, ...]:
        """Strokes so far; empty without an operator."""
        live = self._live
        return tuple(live.history) if isinstance(live, LivePlates) else ()

    @property
    def delivered(self) -> int:
        """Samples per channel delivered over all streams."""
        return (
            self._delivered if self._service is None else self._service.faults.delivered
        )

    @property
    def sensors(self) -> tuple[PluggedSensor, ...]:
        """Sensors at the first inputs."""
        return () if self._live is None else self._live.sensors

    def described(self) -> list[str]:
        """Return a line for each module: its inputs, range, currents and rates."""
        return [described(each) for each in devices(_inventory(self._setup, ()))]

    def __enter__(self) -> "SimulatedChassis":
        """Start listening."""
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Stop for good."""
        self.close()

    def start(self) -> None:
        """Listen, without a task.

        Raises:
            InstrumentError: the port is taken.
        """
        workers = ThreadPoolExecutor(self._setup.limits.workers)
        server = grpc.server(workers, options=_OPTIONS)
        try:
            self.port = server.add_insecure_port(self.address)
        except RuntimeError as error:
            raise InstrumentError(
                f"port {self.port} of this computer is taken; choose another --port"
            ) from error
        self._service = self._new_service()
        add_servicer(self._service, server)
        methods = {"Clock": _clock_handler(self._pace)}
        if isinstance(self._live, LivePlates):
            methods["Strike"] = _strike_handler(self._live, self._service)
        server.add_generic_rpc_handlers(
            (grpc.method_handlers_generic_handler(HAND_SERVICE, methods),)
        )
        server.start()
        self._server = server

    def drop(self, away: float) -> None:
        """Stop without a message, and restart after a time [s]."""
        with self._lock:
            if self._server is None:
                return
            self._remember()
            self._server.stop(None)
            self._server = None
            self._restart = threading.Timer(away, self.start)
            self._restart.daemon = True
            self._restart.start()

    def close(self) -> None:
        """Stop for good, within half a second."""
        if self._restart is not None:
            self._restart.cancel()
        if self._server is not None:
            self._server.stop(None).wait(0.5)
            self._server = None

    def wait(self) -> None:
        """Serve until interrupted."""
        threading.Event().wait()

    def _remember(self) -> None:
        """Keep the delivered samples and applied faults over a restart."""
        if self._service is not None:
            script = self._service.faults
            self._delivered = script.delivered
            self._faults = [f for f in self._faults if f.at > script.reached]

    def _new_service(self) -> ChassisService:
        setup = self._setup
        inventory = _inventory(setup, self.sensors)
        bench = SharedBench(self._pace, self._signals, devices(inventory))
        script = ScriptedFaults(
            tuple(f for f in self._faults if f.kind not in _FROM_THE_START),
            open_inputs=bench.open_inputs,
            drop=self.drop,
        )
        script.delivered = self._delivered
        return ChassisService(
            inventory,
            lambda name: SimulatedTask(name, bench),
            faults=script,
            limits=setup.limits,
        )


def _specimen(
    bench: PlatesBench | Source | None,
) -> LivePlates | StreamedSpecimen | None:
    if bench is None:
        return None
    if isinstance(bench, PlatesBench):
        return LivePlates(bench)
    if isinstance(bench, RunningMachine):
        return MachineSpecimen(bench)
    return StreamedSpecimen(bench)


_FROM_THE_START = (FaultKind.REFUSE, FaultKind.WRONG_TEDS, FaultKind.TEDS_ERROR)


def _inventory(setup: ChassisSetup, sensors: tuple[PluggedSensor, ...]) -> Inventory:
    def inputs(kind: FaultKind) -> frozenset[int]:
        return frozenset(int(f.value) for f in setup.faults if f.kind is kind)

    return Inventory(
        name=setup.name,
        names=setup.names,
        modules=changed(
            module_list(setup.module, setup.modules),
            top_rate=setup.top_rate,
            analogue_trigger=setup.analogue_trigger,
            currents=setup.currents,
        ),
        teds_error=next((-f for f in inputs(FaultKind.TEDS_ERROR)), 0),
        sensors=sensors,
        missing=inputs(FaultKind.REFUSE),
        swapped_teds=inputs(FaultKind.WRONG_TEDS),
    )


def _clock_handler(pace: Pace) -> grpc.RpcMethodHandler:
    """Return what states whether the chassis has a clock of its own."""
    clock = b"none" if math.isinf(pace.speed) else b"own"
    return grpc.unary_unary_rpc_method_handler(lambda request, context: clock)


def _strike_handler(live: LivePlates, service: ChassisService) -> grpc.RpcMethodHandler:
    def strike(request: bytes, context: grpc.ServicerContext) -> bytes:
        changes: dict[str, Any] = json.loads(request)
        try:
            live.place(**changes)
        except (UsageError, TypeError) as error:
            context.abort(grpc.StatusCode.INVALID_ARGUMENT, str(error))
        planned = live.strike(position=service.latest())
        return json.dumps(asdict(planned)).encode()

    return grpc.unary_unary_rpc_method_handler(strike)
