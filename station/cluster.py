# SPDX-License-Identifier: MIT
"""Many machines by a Dask scheduler: the same step, in batches; an extra.

Dask sends Python objects that run where they arrive. So a scheduler beyond this
machine must be spoken to by TLS with a certificate on both sides, or not at all.
"""

import ipaddress
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from jointbench.acquisition.errors import InstrumentError, UsageError
from jointbench.station.process_file import Outcome, State, Task, process_task
from jointbench.station.recipe import Recipe

INSTALL = "pip install 'jointbench[cluster]'"
_CONNECT = 20.0
"""How long a scheduler may take to answer [s]."""


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
    """Refuse a scheduler that a stranger could speak for.

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
    batch in its hands, which another one takes over; of a batch that fails as often as
    it may be tried, every file is given up.

    Args:
        tasks: one a file.
        recipe: how to read them.
        settings: of the cluster.

    Raises:
        UsageError: Dask is not installed, or the scheduler is not safe.
        InstrumentError: the scheduler does not answer, or has no worker.
    """
    require_safe(settings)
    client = _connect(settings)
    try:
        yield from _outcomes(client, tasks, recipe, settings)
    finally:
        client.close()


def _outcomes(
    client: Any, tasks: Sequence[Task], recipe: Recipe, settings: ClusterSettings
) -> Iterator[Outcome]:
    as_completed = import_module("distributed").as_completed
    pending: dict[Any, Sequence[Task]] = {}
    tries: dict[Task, int] = {}
    waiting = [
        tasks[i : i + settings.batch] for i in range(0, len(tasks), settings.batch)
    ]
    for batch in waiting:
        pending[_submit(client, batch, recipe, settings)] = batch
    futures = as_completed(list(pending))
    for future in futures:
        batch = pending.pop(future)
        try:
            outcomes = future.result()
        except Exception as error:  # noqa: BLE001 - whatever a cluster may raise
            reason = f"the cluster gave it up: {error}"
            outcomes = tuple(_given_up(task, reason) for task in batch)
        again = []
        for task, outcome in zip(batch, outcomes, strict=True):
            tries[task] = tries.get(task, 0) + 1
            passing = not (outcome.lasting or outcome.unwritable)
            failed = outcome.state is State.FAILED
            if failed and passing and tries[task] <= settings.retries:
                again.append(task)
            else:
                yield outcome
        if again:
            fresh = _submit(client, again, recipe, settings)
            pending[fresh] = again
            futures.add(fresh)


def _submit(
    client: Any, batch: Sequence[Task], recipe: Recipe, settings: ClusterSettings
) -> Any:
    return client.submit(
        process_batch, batch, recipe, retries=settings.retries, pure=False
    )


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
