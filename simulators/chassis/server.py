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
from jointbench.simulators.chassis.faults import Fault, FaultKind
from jointbench.simulators.chassis.inventory import CURRENTS, Inventory
from jointbench.simulators.chassis.protocol import add_servicer
from jointbench.simulators.chassis.reading import ReadingService
from jointbench.simulators.chassis.specimen import StreamedSpecimen
from jointbench.simulators.chassis.task import Pace, SimulatedTask
from jointbench.simulators.plates.plates_bench import (
    LivePlates,
    PlannedStroke,
    PlatesBench,
    PluggedSensor,
)

HAND_SERVICE = "jointbench.Hand"
# Every open event stream of a client occupies a worker.
_WORKERS = 24
_OPTIONS = (
    ("grpc.max_receive_message_length", -1),
    ("grpc.max_send_message_length", -1),
    ("grpc.so_reuseport", 0),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChassisSetup:
    """Set-up of the simulated bench.

    Attributes:
        bench: specimen, operator and sensors; or a source of samples, whose channels
            are connected in order.
        speed: seconds of signal per second; infinite for as fast as it is read.
        modules: of four inputs each.
        top_rate: highest samples per second and channel [Hz].
        analogue_trigger: whether the modules can trigger on a signal.
        currents: available for IEPE sensors [A]; empty for none.
        faults: script of faults.
        port: to listen on; 0 for any free one.
    """

    bench: PlatesBench | Source = field(default_factory=PlatesBench)
    speed: float = 1.0
    modules: int = 1
    top_rate: float = 51_200.0
    analogue_trigger: bool = True
    currents: tuple[float, ...] = CURRENTS
    faults: tuple[Fault, ...] = ()
    port: int = 0


class SimulatedChassis:
    """A server that can be started, stopped and restarted on the same port."""

    def __init__(self, setup: ChassisSetup) -> None:
        self._setup = setup
        self._pace = Pace(speed=setup.speed)
        self._live: LivePlates | StreamedSpecimen = (
            LivePlates(setup.bench)
            if isinstance(setup.bench, PlatesBench)
            else StreamedSpecimen(setup.bench)
        )
        self._faults = list(setup.faults)
        self._delivered = 0
        self._lock = threading.Lock()
        self._server: grpc.Server | None = None
        self._service: ReadingService | None = None
        self._restart: threading.Timer | None = None
        self.port = setup.port

    @property
    def address(self) -> str:
        """Host and port, as given to a client."""
        return f"127.0.0.1:{self.port}"

    @property
    def history(self) -> tuple[PlannedStroke, ...]:
        """Strokes so far; empty without an operator."""
        live = self._live
        return tuple(live.history) if isinstance(live, LivePlates) else ()

    @property
    def delivered(self) -> int:
        """Samples per channel delivered over all streams."""
        return self._delivered if self._service is None else self._service.delivered

    @property
    def sensors(self) -> tuple[PluggedSensor, ...]:
        """Sensors at the first inputs."""
        return self._live.sensors

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
        server = grpc.server(ThreadPoolExecutor(_WORKERS), options=_OPTIONS)
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
            self._delivered = self._service.delivered
            self._faults = [f for f in self._faults if f.at > self._service.reached]

    def _new_service(self) -> ReadingService:
        setup = self._setup
        service = ReadingService(
            _inventory(setup, self._live.sensors),
            lambda name: SimulatedTask(name, self._pace, self._live.volts),
            begin=self._live.begin,
            pace=self._pace,
            faults=tuple(f for f in self._faults if f.kind not in _FROM_THE_START),
            drop=self.drop,
        )
        service.delivered = self._delivered
        return service


_FROM_THE_START = (FaultKind.REFUSE, FaultKind.WRONG_TEDS, FaultKind.TEDS_ERROR)


def _inventory(setup: ChassisSetup, sensors: tuple[PluggedSensor, ...]) -> Inventory:
    def inputs(kind: FaultKind) -> frozenset[int]:
        return frozenset(int(f.value) for f in setup.faults if f.kind is kind)

    return Inventory(
        modules=setup.modules,
        top_rate=setup.top_rate,
        analogue_trigger=setup.analogue_trigger,
        currents=setup.currents,
        teds_error=next((-f for f in inputs(FaultKind.TEDS_ERROR)), 0),
        sensors=sensors,
        missing=inputs(FaultKind.REFUSE),
        swapped_teds=inputs(FaultKind.WRONG_TEDS),
    )


def _clock_handler(pace: Pace) -> grpc.RpcMethodHandler:
    """Return what states whether the chassis has a clock of its own."""
    clock = b"none" if math.isinf(pace.speed) else b"own"
    return grpc.unary_unary_rpc_method_handler(lambda request, context: clock)


def _strike_handler(live: LivePlates, service: ReadingService) -> grpc.RpcMethodHandler:
    def strike(request: bytes, context: grpc.ServicerContext) -> bytes:
        changes: dict[str, Any] = json.loads(request)
        try:
            live.place(**changes)
        except (UsageError, TypeError) as error:
            context.abort(grpc.StatusCode.INVALID_ARGUMENT, str(error))
        planned = live.strike(position=service.latest())
        return json.dumps(asdict(planned)).encode()

    return grpc.unary_unary_rpc_method_handler(strike)
