# SPDX-License-Identifier: MIT
"""Options of a command as the fields of one record, instead of a parameter for each."""

import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Options = TypeVar("Options", bound="DataclassInstance")
Result = TypeVar("Result")


def options_of(
    record: type[Options],
) -> Callable[[Callable[[Options], Result]], Callable[..., Result]]:
    """Return a decorator that shows Typer the fields of a record as options.

    Typer reads the signature of a callback. The decorated function takes one record.
    Typer sees a keyword for each field, with its annotation and default, and the
    callback collects the parsed values in a record.

    Args:
        record: dataclass whose fields are annotated for Typer, in the order of the
            help; defaults are plain values.
    """
    hints = get_type_hints(record, include_extras=True)
    signature = inspect.Signature(
        [
            inspect.Parameter(
                one.name,
                inspect.Parameter.KEYWORD_ONLY,
                default=inspect.Parameter.empty
                if one.default is MISSING
                else one.default,
                annotation=hints[one.name],
            )
            for one in fields(record)
        ]
    )

    def decorate(work: Callable[[Options], Result]) -> Callable[..., Result]:
        def callback(**given: Any) -> Result:
            return work(record(**given))

        # functools.wraps would show Typer the signature of `work`.
        callback.__module__, callback.__name__ = work.__module__, work.__name__
        callback.__doc__ = work.__doc__
        vars(callback)["__signature__"] = signature
        return callback

    return decorate
