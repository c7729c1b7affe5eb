# SPDX-License-Identifier: MIT
"""Options of modal extraction, as typed, turned into settings of the chain."""

from collections.abc import Sequence
from math import inf

from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.frf.estimators import Estimator
from jointbench.signal.modal.manual_selection import Choices
from jointbench.signal.modal.modes import ModalSettings
from jointbench.station.pipeline.chain import (
    ChainSettings,
)


def modal_settings(
    band: str | None,
    order: int | None,
    estimator: str,
    keep: Sequence[float],
    drop: Sequence[float],
) -> ChainSettings:
    """Return the settings that the options stand for.

    Raises:
        UsageError: an option is not what it should be.
    """
    names = {e.value.lower(): e for e in Estimator}
    if estimator.lower() not in names:
        raise UsageError(f"--estimator is {estimator!r}; write H1, H2 or Hv")
    for option, frequency in (
        *(("--keep", f) for f in keep),
        *(("--drop", f) for f in drop),
    ):
        if not 0.0 < frequency < inf:
            raise UsageError(f"{option} is {frequency:g}; write a frequency in Hz")
    return ChainSettings(
        estimator=names[estimator.lower()],
        modal=ModalSettings(
            band=parse_band(band),
            highest_order=order,
            choices=Choices(tuple(keep), tuple(drop)),
        ),
    )


def parse_band(text: str | None) -> tuple[float, float] | None:
    """Read ``"50:5000"`` as a band in hertz.

    Raises:
        UsageError: it is no such pair, or runs backwards.
    """
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise UsageError(
            f"--band is {text!r}; write lowest and highest frequency in Hz, as 50:5000"
        ) from None
    if not 0 <= low < high < inf:
        raise UsageError(
            f"--band is {text!r}; write two frequencies in Hz, the lower one first"
        )
    return low, high
