# SPDX-License-Identifier: MIT
"""The simulated chassis by its URL, ``sim:plates?seed=3&faults=drop@90000:0.5``."""

import math
from collections.abc import Callable
from dataclasses import replace
from urllib.parse import parse_qsl, urlsplit

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.chassis.faults import parse_faults
from jointbench.simulators.chassis.modules.inventory import (
    DEFAULT_MODULE,
    module_list,
)
from jointbench.simulators.chassis.server import LOOPBACK, ChassisSetup
from jointbench.simulators.machines.running_machine import RunningMachine
from jointbench.simulators.measuring.operator import Fate, SimulatedOperator
from jointbench.simulators.plates.calibration_mass import CalibrationMass
from jointbench.simulators.plates.plates_bench import PlatesBench

_KEYS = (
    "seed, speed, level, interval, fates, faults, module, modules, name, top_rate, "
    "trigger, port, host; sim:plates has washers, thermometer; sim:mass also has "
    "mass, hammer, response; sim:spindle has "
    "rpm, sim:shaker has signal"
)
_SIGNALS = ("random", "sweep")
_MACHINES = ("spindle", "shaker")
_SPECIMENS = ("plates", "mass", "sine", *_MACHINES)
_INPUTS = "3"  # modules of four inputs that the machine needs


def is_plates_url(url: str) -> bool:
    """Return whether a URL names a chassis with plates, a mass or a sine."""
    parts = urlsplit(url)
    return parts.scheme == "sim" and parts.path in _SPECIMENS


def chassis_from_url(url: str) -> ChassisSetup:
    """Read a set-up.

    Args:
        url: ``sim:plates``, ``sim:mass`` for a mass to calibrate on, or ``sim:sine``
            for a sine in the limits of each channel, ``sim:spindle`` for a machine
            that runs, ``sim:shaker`` for one on a shaker, and, as a query, any of:
            ``seed``; ``speed``, seconds of signal per second or ``max``; ``level``,
            usual peak force [N]; ``interval``, between unrequested strokes [s];
            ``fates`` of the strokes in turn, for example ``good,double*2,weak``;
            ``faults`` as `parse_faults` reads them; ``module``, for example ``9231``,
            or one for each slot, ``9234,9250``; ``modules``, how many; ``name`` of the
            chassis; ``top_rate`` of an external clock [Hz]; ``trigger``, 0 for modules
            without an analogue trigger; ``port``; ``host``, the loopback interface
            unless stated. The mass has ``mass`` [kg], and ``hammer`` and ``response``,
            true sensitivity over the usual one. The spindle has ``rpm``, the shaker
            ``signal``, ``random`` or ``sweep``.

    Raises:
        UsageError: an unknown key, or an invalid value.
    """
    values = dict(parse_qsl(urlsplit(url).query, keep_blank_values=True))

    def take(key: str, default: str, read: Callable[[str], float]) -> float:
        text = values.pop(key, default)
        try:
            return read(text)
        except ValueError:
            raise UsageError(f"{key} is {text!r} in {url!r}; give a number") from None
        except UsageError as error:
            raise UsageError(f"{key} in {url!r}: {error}") from None

    seed = int(take("seed", "1", int))
    interval = values.pop("interval", "")
    operator = SimulatedOperator(
        seed=seed,
        level=take("level", "150", float),
        interval=_positive(interval) if interval else None,
        fates=_fates(values.pop("fates", "good")),
    )
    speed = take("speed", "max", lambda t: math.inf if t == "max" else _positive(t))
    bench = PlatesBench(
        operator=operator,
        seed=seed,
        washers=int(take("washers", "0", int)),
        thermometer=bool(take("thermometer", "0", int)),
    )
    if urlsplit(url).path == "mass":
        bench = _mass_bench(bench, take)
    source = None
    if urlsplit(url).path in _MACHINES:
        source = _machine(urlsplit(url).path, seed, take, values.pop("signal", ""))
    top_rate = values.pop("top_rate", "")
    module = values.pop("module", DEFAULT_MODULE)
    path = urlsplit(url).path
    modules = int(take("modules", _INPUTS if path in _MACHINES else "1", int))
    module_list(module, modules)
    setup = ChassisSetup(
        bench=source or (None if path == "sine" else bench),
        speed=speed,
        module=module,
        modules=modules,
        name=values.pop("name", "cDAQSim1"),
        host=values.pop("host", LOOPBACK),
        top_rate=_positive(top_rate) if top_rate else None,
        analogue_trigger=bool(take("trigger", "1", int)),
        faults=parse_faults(values.pop("faults", "")),
        port=int(take("port", "0", int)),
    )
    if values:
        raise UsageError(
            f"unknown key {next(iter(values))!r} in {url!r}; known: {_KEYS}"
        )
    return setup


def _machine(
    path: str,
    seed: int,
    take: Callable[[str, str, Callable[[str], float]], float],
    signal: str,
) -> RunningMachine:
    if path == "spindle":
        if signal:
            raise UsageError("signal is for sim:shaker; a spindle has rpm")
        return RunningMachine(seed=seed, rpm=take("rpm", "3000", _positive))
    if signal not in {"", *_SIGNALS}:
        raise UsageError(f"signal {signal!r} must be one of {', '.join(_SIGNALS)}")
    return RunningMachine(seed=seed, shaker=signal or _SIGNALS[0])


def _mass_bench(
    bench: PlatesBench, take: Callable[[str, str, Callable[[str], float]], float]
) -> PlatesBench:
    hammer, response = take("hammer", "1", _positive), take("response", "1", _positive)
    first, *others = bench.sensors
    return replace(
        bench,
        design=CalibrationMass(mass=take("mass", "4.5", float)),
        sensors=(
            replace(first, sensitivity=hammer * first.sensitivity),
            *(replace(s, sensitivity=response * s.sensitivity) for s in others),
        ),
    )


def _fates(text: str) -> tuple[Fate, ...]:
    fates: list[Fate] = []
    for word in text.split(","):
        name, _, count = word.strip().partition("*")
        try:
            fates += [Fate(name)] * int(count or 1)
        except ValueError:
            known = ", ".join(fate.value for fate in Fate)
            raise UsageError(
                f"fate {word!r} must be one of {known}, as in good*3,double"
            ) from None
    return tuple(fates)


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not value > 0:
        raise UsageError(f"{text!r} must be a number above zero")
    return value
