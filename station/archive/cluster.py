# SPDX-License-Identifier: MIT
"""Many machines by a Dask scheduler: the same step, in batches; an extra.

Dask sends Python objects that run where they arrive. So a scheduler beyond this
machine must be spoken to by TLS with a certificate on both sides, or not at all.
"""

import ipaddress
import logging
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.station.archive.process_file import Outcome, State, Task, process_task
from jointbench.station.schemas.recipe import Recipe

INSTALL = "pip install 'jointbench[cluster]'"
_CONNECT = 20.0
"""How long a scheduler may take to answer [s]."""
_LOGS = ("distributed", "distributed.client", "tornado.application", "asyncio")
_LOOK = 2.0
"""How often scheduler and workers are looked at while nothing finishes [s]."""
_DESERTED = 60.0
"""How long a scheduler may be without workers; a nanny needs some to start one [s]."""


@dataclass(frozen=True, slots=True)
class ClusterSettings:
    """How a cluster is reached and used.

    Attributes:
        scheduler: ``tcp://127.0.0.1:8786`` or ``tls://host:8786``.
        batch: files a task; a task costs 5 to 10 ms by itself.
        retries: how often a batch is tried again.
        authority: certificate of the authority that both sides trust (PEM).
        certificate: of this side (PEM).
        private_key: of this side (PEM).
    """

    scheduler: str
    batch: int = 16
    retries: int = 2
    authority: Path | None = None
    certificate: Path | None = None
    private_key: Path | None = None


def require_safe(settings: ClusterSettings) -> None:
    """Refuse a scheduler that another host could impersonate.

    Raises:
        UsageError: it is beyond this machine without TLS, TLS lacks a file, or the
            address makes no sense.
    """
    parts = urlsplit(settings.scheduler)
    if parts.scheme not in {"tcp", "tls"} or not parts.hostname:
        raise UsageError(
            f"--scheduler is {settings.scheduler!r}; write tcp://127.0.0.1:8786, or "
            "tls://host:8786 beyond this machine"
        )
    if parts.scheme == "tcp" and not _is_loopback(parts.hostname):
        raise UsageError(
            f"--scheduler {settings.scheduler!r} is beyond this machine and not "
            "encrypted; anyone on the way could run programs on the workers: write "
            "tls:// with --tls-ca, --tls-cert and --tls-key"
        )
    if parts.scheme == "tls":
        _require_certificates(settings)


def _require_certificates(settings: ClusterSettings) -> None:
    for option, path in (
        ("--tls-ca", settings.authority),
        ("--tls-cert", settings.certificate),
        ("--tls-key", settings.private_key),
    ):
        if path is None:
            raise UsageError("tls:// needs --tls-ca, --tls-cert and --tls-key")
        if not path.is_file():
            raise UsageError(f"{option} is '{path}'; there is no such file")


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def process_batch(tasks: Sequence[Task], recipe: Recipe) -> tuple[Outcome, ...]:
    """Process a few files; what a cluster's worker is sent."""
    return tuple(process_task(task, recipe) for task in tasks)


def run_cluster(
    tasks: Sequence[Task], recipe: Recipe, settings: ClusterSettings
) -> Iterator[Outcome]:
    """Process files on a cluster; yield what became of each.

    All machines must see the files under the same names. A worker that dies costs the
    batch in progress, which another one takes over; of a batch that fails as often as
    it may be tried, every file is given up.

    Args:
        tasks: one a file.
        recipe: how to read them.
        settings: of the cluster.

    Raises:
        UsageError: Dask is not installed, or the scheduler is not safe.
        InstrumentError: the scheduler does not answer, has no worker, or either is
            lost on the way; what was done until then is whole.
    """
    require_safe(settings)
    client = _connect(settings)
    with _own_words():
        try:
            yield from _outcomes(_Cluster(client, recipe, settings), tasks)
        finally:
            client.close()


@contextmanager
def _own_words() -> Iterator[None]:
    """Keep Dask's account of a lost connection off the screen; ours is one line.

    Dask sets its own levels when it is imported: enter this afterwards.
    """
    logs = [logging.getLogger(name) for name in _LOGS]
    before = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for log, level in zip(logs, before, strict=True):
            log.setLevel(level)


@dataclass(slots=True)
class _Cluster:
    """A connection, and what is in work through it."""

    client: Any
    recipe: Recipe
    settings: ClusterSettings
    pending: dict[Any, Sequence[Task]] = field(default_factory=dict)
    deserted: float | None = None

    def submit(self, batch: Sequence[Task]) -> None:
        """Send a batch.

        Raises:
            InstrumentError: the scheduler is gone.
        """
        self.require_scheduler()
        retries = self.settings.retries
        try:
            future = self.client.submit(
                process_batch, batch, self.recipe, retries=retries, pure=False
            )
        except Exception as error:
            self.require_scheduler(error)
            raise
        self.pending[future] = batch

    def finished(self) -> list[Any]:
        """Wait for batches that are finished; none after a while without.

        Raises:
            InstrumentError: the scheduler is gone, or has had no worker for long.
        """
        distributed = import_module("distributed")
        try:
            done = distributed.wait(
                list(self.pending), timeout=_LOOK, return_when="FIRST_COMPLETED"
            ).done
        except TimeoutError:
            done = set()
        except Exception as error:
            self.require_scheduler(error)
            # A connection that came back has let go of what was asked through it.
            done = {future for future in self.pending if future.done()}
            if not done:
                raise
        self.require_scheduler()
        if not done:
            self._require_workers()
        return [future for future in self.pending if future in done]

    def require_scheduler(self, cause: Exception | None = None) -> None:
        """Raise `InstrumentError` if the connection is not what it was."""
        if self.client.status != "running":
            raise self._lost(
                "stopped answering", "start it and its workers again"
            ) from cause

    def _require_workers(self) -> None:
        """Raise `InstrumentError` if there has been no worker for long.

        A worker that is started again by its nanny is missed for a few seconds.
        """
        try:
            alone = not self.client.scheduler_info()["workers"]
        except Exception as error:
            self.require_scheduler(error)
            raise
        now = time.monotonic()
        if not alone:
            self.deserted = None
        elif self.deserted is None:
            self.deserted = now
        elif now - self.deserted > _DESERTED:
            raise self._lost(f"has had no worker for {_DESERTED:g} s", "start workers")

    def _lost(self, what: str, way_out: str) -> InstrumentError:
        return InstrumentError(
            f"scheduler {self.settings.scheduler!r} {what}; results until then are "
            f"whole: {way_out}, then repeat the same command to continue"
        )


def _outcomes(cluster: _Cluster, tasks: Sequence[Task]) -> Iterator[Outcome]:
    size = cluster.settings.batch
    tries: dict[Task, int] = {}
    for first in range(0, len(tasks), size):
        cluster.submit(tasks[first : first + size])
    while cluster.pending:
        for future in cluster.finished():
            again = []
            batch = cluster.pending.pop(future)
            for task, outcome in zip(
                batch, _result(cluster, future, batch), strict=True
            ):
                tries[task] = tries.get(task, 0) + 1
                if _may_pass(outcome) and tries[task] <= cluster.settings.retries:
                    again.append(task)
                else:
                    yield outcome
            if again:
                cluster.submit(again)


def _result(
    cluster: _Cluster, future: Any, batch: Sequence[Task]
) -> tuple[Outcome, ...]:
    """Return what became of a batch; a cluster that is gone gave nothing up.

    Raises:
        InstrumentError: the scheduler is gone, and with it the answer.
    """
    try:
        outcomes: tuple[Outcome, ...] = future.result(timeout=_CONNECT)
    except Exception as error:  # noqa: BLE001 - whatever a cluster may raise
        cluster.require_scheduler(error)
        reason = f"the cluster gave it up: {error}"
        return tuple(_given_up(task, reason) for task in batch)
    return outcomes


def _may_pass(outcome: Outcome) -> bool:
    """Return whether another attempt may succeed after a failure."""
    lasting = outcome.lasting or outcome.unwritable
    return outcome.state is State.FAILED and not lasting


def _given_up(task: Task, reason: str) -> Outcome:
    words = " ".join(reason.split())
    return Outcome(task.path, task.result, State.FAILED, reason=words)


def _connect(settings: ClusterSettings) -> Any:
    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise UsageError(f"--scheduler needs Dask; type {INSTALL}") from error
    security = None
    if settings.scheduler.startswith("tls:"):
        security = distributed.Security(
            tls_ca_file=str(settings.authority),
            tls_client_cert=str(settings.certificate),
            tls_client_key=str(settings.private_key),
            require_encryption=True,
        )
    try:
        client: Any = distributed.Client(
            settings.scheduler, timeout=_CONNECT, security=security
        )
    except (OSError, TimeoutError) as error:
        raise InstrumentError(
            f"scheduler {settings.scheduler!r} does not answer ({error}); start it "
            "with `dask scheduler` and `dask worker --nthreads 1`"
        ) from error
    if not client.scheduler_info()["workers"]:
        client.close()
        raise InstrumentError(
            f"scheduler {settings.scheduler!r} has no worker; start some with "
            "`dask worker --nthreads 1`"
        )
    return client
