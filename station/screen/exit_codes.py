# SPDX-License-Identifier: MIT
"""Exit codes of the families of errors, and the one line of each error."""

import sys
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType

import typer
from typer.exceptions import TyperException

from jointbench.acquisition.basics.errors import (
    InstrumentError,
    JointbenchError,
    UsageError,
)
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.screen.interrupt import interruptible

_EXIT_INTERNAL = 1
EXIT_USAGE = 2
EXIT_BAD_DATA = 3
EXIT_INSTRUMENT = 4
EXIT_QUALITY = 5
_EXIT_INTERRUPTED = 130


def exit_code(command: Callable[..., object], *, debug: bool) -> int:
    """Call `command` and turn its result or error into the exit code."""
    with interruptible():
        if debug:
            result = command(standalone_mode=False)
            return result if isinstance(result, int) else 0
        with warnings.catch_warnings():
            # Our own checks report what a library warns of.
            warnings.simplefilter("ignore")
            return _quiet_exit_code(command)


def _quiet_exit_code(command: Callable[..., object]) -> int:
    try:
        result = command(standalone_mode=False)
    except TyperException as error:
        return _fail(usage_words(error), EXIT_USAGE)
    except JointbenchError as error:
        return _fail(str(error), code_of(error))
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted; finished files are complete", _EXIT_INTERRUPTED)
    except OSError as error:
        return _fail(_system_words(error), EXIT_BAD_DATA)
    except Exception as error:  # noqa: BLE001 - one line for the operator
        kind = type(error).__name__
        return _fail(
            f"internal error ({kind}: {error}); run again with --debug and report it",
            _EXIT_INTERNAL,
        )
    return result if isinstance(result, int) else 0


def usage_words(error: TyperException) -> str:
    """Return the line of a usage error: near matches, and where to look.

    Args:
        error: of the command line library.
    """
    near = [f"'{one}'" for one in getattr(error, "possibilities", None) or ()]
    words = str(error.message if near else error.format_message()).rstrip(".")
    if near:
        words += f". Did you mean {' or '.join(near)}?"
    context = getattr(error, "ctx", None)
    if context is None:
        return words
    mark = " See" if words.endswith("?") else "; see"
    return f"{words}{mark} '{context.command_path} --help'"


def _system_words(error: OSError) -> str:
    """Return the reason that the system gives, and the file where it names one."""
    reason = error.strerror or str(error)
    return reason if error.filename is None else f"{reason}: {error.filename}"


def code_of(error: JointbenchError) -> int:
    """Return the exit code of an error's family."""
    if isinstance(error, UsageError):
        return EXIT_USAGE
    return EXIT_INSTRUMENT if isinstance(error, InstrumentError) else EXIT_BAD_DATA


def show_traceback(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Write a traceback for ``--debug``; messages may quote names from files."""
    text = "".join(traceback.format_exception(kind, error, trace))
    sys.stderr.write("".join(f"{visible(line)}\n" for line in text.split("\n")))


def _fail(message: str, code: int) -> int:
    line = visible(" ".join(message.split()))
    with suppress(OSError):  # the terminal may be gone
        sys.stderr.write(f"jointbench: error: {line}\n")
    return code
