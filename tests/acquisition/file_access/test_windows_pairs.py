"""Branches for Windows, run here with stand-ins of the system calls that they use."""

import ctypes
import importlib.util
import os
import signal
import stat
import sys
import types
from collections.abc import Callable
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access import create_netcdf
from jointbench.acquisition.file_access.create_netcdf import new_file
from jointbench.acquisition.file_access.replace_file import replace_file

fcntl = pytest.importorskip("fcntl", reason="stand-ins are made of POSIX calls")
ROOT = Path(__file__).parents[3]
Loader = Callable[..., types.ModuleType]


@pytest.fixture
def on_windows(monkeypatch: pytest.MonkeyPatch) -> Loader:
    """Return a function that loads a module as Windows does, with its `msvcrt`."""

    def load(path: str, **calls: object) -> types.ModuleType:
        system = types.ModuleType("msvcrt")
        vars(system).update(calls)
        monkeypatch.setitem(sys.modules, "msvcrt", system)
        monkeypatch.setattr(sys, "platform", "win32")
        spec = importlib.util.spec_from_file_location("on_windows", ROOT / path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return load


def test_a_lock_is_held_by_one_and_removed_after_it_is_closed(
    tmp_path: Path, on_windows: Loader, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`msvcrt.locking` of the first byte; an open file cannot be removed there."""

    def locking(number: int, how: int, count: int) -> None:
        assert (how, count) == (2, 1)
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)

    locks = on_windows(
        "acquisition/file_access/file_lock.py", locking=locking, LK_NBLCK=2
    )
    session, removed = tmp_path / "s.h5", []
    unlink = Path.unlink

    def closed_only(path: Path, missing_ok: bool = False) -> None:
        removed.append(own.closed)
        unlink(path, missing_ok=missing_ok)

    monkeypatch.setattr(Path, "unlink", closed_only)
    own = locks.hold_lock(session)
    assert locks.is_held(session)
    with pytest.raises(UsageError, match="recorded by another process"):
        locks.hold_lock(session)
    locks.drop_lock(session, own)
    assert removed == [True]
    assert not locks.is_held(session)


def test_keys_are_read_until_none_waits_and_arrows_are_left_out(
    on_windows: Loader,
) -> None:
    """An arrow is two characters, the first of them 0 or 224; letters come through."""
    waiting = list("ah\xe0Hµ1\x00;7\r")
    module = on_windows(
        "station/screen/key_presses.py",
        kbhit=lambda: bool(waiting),
        getwch=lambda: waiting.pop(0),
    )
    with module.keyboard() as poll:
        assert poll() == "ahµ17\r"
        assert poll() == ""


def test_a_file_that_a_view_has_open_is_replaced_when_the_view_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows refuses meanwhile; a refusal that stays is an error, both files stay."""
    new, old = tmp_path / "new", tmp_path / "old"
    new.write_text("new")
    old.write_text("old")
    replace, refusals = os.replace, [PermissionError(13, "denied")] * 3

    def refusing(source: Path, target: Path) -> None:
        if refusals:
            raise refusals.pop()
        replace(source, target)

    monkeypatch.setattr(os, "replace", refusing)
    with pytest.raises(PermissionError):
        replace_file(new, old, patience=0.0)
    assert old.read_text() == "old"
    naps: list[float] = []
    replace_file(new, old, patience=3.0, sleep=naps.append)
    assert old.read_text() == "new"
    assert len(naps) == 2


def test_what_is_flushed_to_the_disk_is_open_for_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows refuses to flush a file that is open for reading; folders it skips."""
    flushed = []

    def fsync(number: int) -> None:
        if not stat.S_ISDIR(os.fstat(number).st_mode):
            flushed.append(fcntl.fcntl(number, fcntl.F_GETFL) & os.O_ACCMODE)

    monkeypatch.setattr(create_netcdf.os, "fsync", fsync)
    with new_file(tmp_path / "s.nc", schema="s/1", title="t", overwrite=False):
        pass
    assert flushed == [os.O_RDWR]


def test_a_closed_window_is_heard_and_ctrl_c_is_left_to_python(
    monkeypatch: pytest.MonkeyPatch, on_windows: Loader
) -> None:
    """The handler is registered for the time of the work, and returns False for 0."""
    registered: list[tuple[Callable[[int], bool], bool]] = []

    class Kernel:
        """The one call that is used."""

        def SetConsoleCtrlHandler(  # noqa: N802
            self, routine: Callable[[int], bool], add: bool
        ) -> None:
            """Keep the routine."""
            registered.append((routine, add))

    windll = types.SimpleNamespace(kernel32=Kernel())
    monkeypatch.setattr(ctypes, "windll", windll, raising=False)
    monkeypatch.setattr(
        ctypes, "WINFUNCTYPE", lambda *kinds: lambda routine: routine, raising=False
    )
    monkeypatch.setattr(signal, "SIGBREAK", signal.SIGTERM, raising=False)
    module = on_windows("station/screen/interrupt.py")
    with module.interruptible():
        assert [add for _, add in registered] == [True]
        assert registered[0][0](0) is False
    assert [add for _, add in registered] == [True, False]
