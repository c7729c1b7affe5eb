"""Small sessions in closed form, for the tests of offline work."""

import signal
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import typer

from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import JointSetup, Session
from jointbench.acquisition.session_file.store import write_session
from jointbench.signal.hits.find_hits import find_hits

RATE = 2048.0
FREQUENCY, DAMPING = np.array([150.0, 420.0]), np.array([0.01, 0.012])
Maker = Callable[..., Path]


@pytest.fixture(autouse=True, scope="session")
def heard_signals() -> Iterator[None]:
    """Let children hear Ctrl-C and SIGHUP, even in a shell's background or nohup."""
    wanted = {signal.SIGINT: signal.default_int_handler}
    if hasattr(signal, "SIGHUP"):
        wanted[signal.SIGHUP] = signal.SIG_DFL
    before = {number: signal.signal(number, how) for number, how in wanted.items()}
    yield
    for number, how in before.items():
        signal.signal(number, how)


@pytest.fixture(autouse=True, scope="session")
def commands_made_once() -> Iterator[None]:
    """Make the commands of an app once; Typer makes all of them for each call."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(typer.main, "get_command", cache(typer.main.get_command))
        yield


def ringing(seed: int, *, hits: int = 2, bounce: float = 0.0) -> Recording:
    """Hits on two modes, one a second, the first with a second pulse if reported."""
    time = np.arange(int(hits * RATE)) / RATE
    rng = np.random.default_rng(seed)
    force = rng.normal(0.0, 1e-3, time.size)
    rings = rng.normal(0.0, 1e-3, time.size)
    blows = [(0.1 + k, 50.0) for k in range(hits)] + [(0.14, 50.0 * bounce)]
    omega = 2.0 * np.pi * FREQUENCY[:, None]
    for begin, peak in blows:
        since = time - begin
        on = (since >= 0.0) & (since < 0.003)
        force[on] += peak * np.sin(np.pi * since[on] / 0.003)
        late = np.maximum(since - 0.0015, 0.0)
        decay = np.exp(-DAMPING[:, None] * omega * late) * (since > 0.0015)
        rings += peak / 50.0 * np.sum(decay * np.sin(omega * late), axis=0)
    channels = (
        Channel("force", Quantity.FORCE, point="1", unit="N"),
        Channel("a1", Quantity.ACCELERATION, point="1", unit="g"),
    )
    return Recording("stream", np.array([force, rings]), RATE, channels)


@pytest.fixture
def make_session(tmp_path: Path) -> Maker:
    """Return a function that writes a small session below the test's folder."""

    def make(name: str, *, seed: int = 1, torque: float = 20.0, **how: float) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        session = Session(
            uuid=f"0000-{seed}",
            created="2025-03-01T12:00:00+00:00",
            software="jointbench 0.1.0",
            simulated=True,
            notes=f"specimen: P{seed % 2}",
            joint=JointSetup(torque=torque),
            recordings=(find_hits(ringing(seed, **how)),),  # type: ignore[arg-type]
        )
        write_session(session, path)
        return path

    return make
