# SPDX-License-Identifier: MIT
"""Types of modules, read from one file each, with NI's published figures."""

import tomllib
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.chassis.modules.clock_rates import ClockRates


@dataclass(frozen=True, slots=True, kw_only=True)
class ModuleType:
    """Published properties of a module or device.

    Attributes:
        source: where the figures are published.
        product: name as NI-DAQmx reports it.
        category: name in `nidaqmx.constants.ProductCategory`.
        connector: of the inputs.
        inputs: analogue inputs.
        bits: of the converter, sign included.
        ranges: of the input, either sign, ascending [V].
        couplings: offered, ``AC`` and ``DC``.
        currents: of the supply for IEPE sensors [A]; empty for none.
        terminals: configurations of an input, the usual one first.
        teds: whether it reads the TEDS of a sensor.
        analogue_trigger: whether a task on it can be triggered by a signal.
        overload_detection: whether it reports overloaded channels.
        simultaneous: one converter for each input.
        rates: of its sample clock.
        standalone: a device of its own, not in a chassis.
        digital_lines: inputs for digital triggers.
        filter_delay: of its anti-alias filter [samples].
    """

    source: str
    product: str
    category: str
    connector: str
    inputs: int
    bits: int
    ranges: tuple[float, ...]
    couplings: tuple[str, ...]
    currents: tuple[float, ...]
    terminals: tuple[str, ...]
    teds: bool
    analogue_trigger: bool
    overload_detection: bool
    simultaneous: bool
    rates: ClockRates
    standalone: bool = False
    digital_lines: int = 0
    filter_delay: float = 0.0

    def range_for(self, low: float, high: float) -> float | None:
        """Return the smallest range that holds two limits [V], None for none."""
        need = max(abs(low), abs(high)) * (1 - 1e-6)
        return next((half for half in self.ranges if half >= need), None)


@cache
def module_types() -> dict[str, ModuleType]:
    """Return all types by the digits of their names, for example ``"9234"``."""
    folder = resources.files(__package__ or "")
    files = (item for item in folder.iterdir() if item.name.endswith(".toml"))
    return {
        item.name.removesuffix(".toml").rpartition("_")[2]: _read(item.read_text())
        for item in sorted(files, key=lambda item: item.name)
    }


def module_type(name: str) -> ModuleType:
    """Return a type by its name: ``9234``, ``NI 9234``, ``USB-4431``.

    Raises:
        UsageError: no such module is simulated.
    """
    known = module_types()
    digits = "".join(letter for letter in name if letter.isdigit())
    if digits not in known:
        raise UsageError(
            f"module {name!r} is not simulated; choose one of {', '.join(known)}"
        )
    return known[digits]


def _read(text: str) -> ModuleType:
    table = tomllib.loads(text)
    rates = ClockRates(**_tuples(table.pop("rates")))
    known = {field.name for field in fields(ModuleType)}
    assert set(table) <= known, f"unknown keys {set(table) - known}"
    return ModuleType(rates=rates, **_tuples(table))


def _tuples(table: dict[str, Any]) -> dict[str, Any]:
    return {k: tuple(v) if isinstance(v, list) else v for k, v in table.items()}
