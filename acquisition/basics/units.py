# SPDX-License-Identifier: MIT
"""Units as text, converted to SI once, at import.

Inside, everything is SI and plain floats; a unit is never guessed.
"""

import math
import re
import unicodedata
from types import MappingProxyType

from jointbench.acquisition.basics.errors import UnitError

STANDARD_GRAVITY = 9.80665  # [m/s^2], exact by definition (CGPM 1901)
_POUND = 0.45359237  # [kg], exact
_POUND_FORCE = _POUND * STANDARD_GRAVITY  # [N], exact
_INCH = 0.0254  # [m], exact
_FOOT = 12 * _INCH
_PSI = _POUND_FORCE / _INCH**2

_LENGTH = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "pm": 1e-12,
    "in": _INCH,
    "ft": _FOOT,
    "mil": 1e-3 * _INCH,
    "micron": 1e-6,
    "microns": 1e-6,
}
# Keys are normalised: micro is "u", powers are plain digits, products have no sign.
_UNITS = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
        | {"sec": 1.0, "second": 1.0, "seconds": 1.0},
        "length": _LENGTH,
        "displacement": _LENGTH,
        "force": {"N": 1.0, "mN": 1e-3, "uN": 1e-6, "kN": 1e3, "MN": 1e6}
        | {"lbf": _POUND_FORCE, "kgf": STANDARD_GRAVITY, "kp": STANDARD_GRAVITY},
        "acceleration": {"m/s2": 1.0, "cm/s2": 1e-2, "mm/s2": 1e-3, "um/s2": 1e-6}
        | {"g": STANDARD_GRAVITY, "gn": STANDARD_GRAVITY, "mg": 1e-3 * STANDARD_GRAVITY}
        | {"ft/s2": _FOOT, "in/s2": _INCH},
        "velocity": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3, "um/s": 1e-6}
        | {"km/h": 1 / 3.6, "in/s": _INCH, "ft/s": _FOOT},
        "frequency": {"Hz": 1.0, "mHz": 1e-3, "kHz": 1e3, "MHz": 1e6, "1/s": 1.0}
        | {"rpm": 1 / 60},
        "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5}
        | {"N/m2": 1.0, "N/mm2": 1e6, "kN/mm2": 1e9, "psi": _PSI, "ksi": 1e3 * _PSI},
        "torque": {"Nm": 1.0, "mNm": 1e-3, "kNm": 1e3, "Ncm": 1e-2, "Nmm": 1e-3}
        | dict.fromkeys(("lbfft", "ftlbf", "lbft", "ftlb"), _POUND_FORCE * _FOOT)
        | dict.fromkeys(("lbfin", "inlbf", "lbin", "inlb"), _POUND_FORCE * _INCH)
        | {"kgfm": STANDARD_GRAVITY},
        "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": _POUND},
        "area": {"m2": 1.0, "cm2": 1e-4, "mm2": 1e-6, "um2": 1e-12},
        "density": {"kg/m3": 1.0, "g/cm3": 1e3, "kg/dm3": 1e3},
        "stiffness": {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "GN/m": 1e9, "N/mm": 1e3}
        | {"kN/mm": 1e6, "N/um": 1e6, "kN/um": 1e9, "N/nm": 1e9}
        | {"lbf/in": _POUND_FORCE / _INCH},
        "damping": {"Ns/m": 1.0, "kNs/m": 1e3, "Ns/mm": 1e3, "kg/s": 1.0},
        "rotational_stiffness": {"Nm/rad": 1.0, "kNm/rad": 1e3, "MNm/rad": 1e6}
        | {"Nm/mrad": 1e3, "Nm/urad": 1e6},
        "coupling_stiffness": {"N/rad": 1.0, "kN/rad": 1e3, "MN/rad": 1e6},
        "coupling_damping": {"Ns/rad": 1.0, "kNs/rad": 1e3},
        "curvature": {"1/m": 1.0, "1/mm": 1e3, "1/um": 1e6},
        "rotational_damping": {"Nms/rad": 1.0, "kNms/rad": 1e3},
        "inertia": {"kgm2": 1.0, "gm2": 1e-3, "kgcm2": 1e-4, "kgmm2": 1e-6},
        "angular_rate": {"rad/s": 1.0, "Hz": 2 * math.pi, "rpm": 2 * math.pi / 60},
        "angle": {"rad": 1.0, "deg": math.pi / 180},
        "voltage": {"V": 1.0, "mV": 1e-3, "uV": 1e-6, "kV": 1e3},
        "tacho": {"V": 1.0, "mV": 1e-3},
        "temperature": {"degC": 1.0, "K": 1.0},
        "strain": {"m/m": 1.0, "mm/m": 1e-3, "um/m": 1e-6},
        "ratio": {"": 1.0, "1": 1.0, "%": 1e-2, "ppm": 1e-6},
    }
)
_VALUE = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)", re.DOTALL)


def to_si(unit: str, kind: str) -> float:
    """Return the factor from `unit` to SI.

    Args:
        unit: in any usual spelling: ``"um"``, ``"µm"``, ``"m/s^2"``, ``"m/s²"``, ``"N
            m"``, ``"N·m"``; case matters (``mN`` is not ``MN``).
        kind: the physical quantity, for example ``"length"`` or ``"force"``.

    Returns:
        The factor [SI unit of `kind` per `unit`].

    Raises:
        UnitError: `unit` is not a unit of `kind`.
    """
    table = _UNITS.get(str(kind))
    if table is None:
        raise UnitError(
            f"{kind!r} is no kind of quantity known here; known are {', '.join(_UNITS)}"
        )
    factor = table.get(_normalised(unit))
    if factor is None:
        raise UnitError(_complaint(unit, str(kind)))
    return factor


def parse_value(text: str, kind: str) -> float:
    """Read a number with its unit, for example ``"2.5 um"`` as a length.

    Args:
        text: the number, then the unit; a space between them is optional.
        kind: the physical quantity the unit must belong to.

    Returns:
        The value in SI.

    Raises:
        UnitError: there is no number, no unit, or a unit of something else.
    """
    number, unit = _split(text, example=f"2.5 {example_unit(kind)}")
    if not unit and kind != "ratio":
        raise UnitError(
            f"{text.strip()!r} has no unit; write it as a {kind}, for example "
            f"'{number:g} {example_unit(kind)}'"
        )
    return number * to_si(unit, kind)


def parse_sensitivity(text: str, kind: str) -> float:
    """Read the sensitivity of a sensor, for example ``"10 mV/g"`` of an accelerometer.

    Args:
        text: a number, a voltage, a slash and the unit of the measured quantity.
        kind: the measured quantity, for example ``"acceleration"``.

    Returns:
        The sensitivity [V per SI unit of `kind`].

    Raises:
        UnitError: it has another form, or is not above zero.
    """
    example = f"100mV/{example_unit(kind)}"
    number, unit = _split(text, example=example)
    volts, slash, measured = unit.partition("/")
    if not slash:
        raise UnitError(
            f"sensitivity {text.strip()!r} must be volts per unit of {kind}, "
            f"for example {example}"
        )
    if number <= 0:
        raise UnitError(f"sensitivity {text.strip()!r} must be above zero: {example}")
    measured = measured.strip().removeprefix("(").removesuffix(")")
    return number * to_si(volts, "voltage") / to_si(measured, kind)


def example_unit(kind: str) -> str:
    """Return a unit of `kind`, for examples in messages."""
    special = {"acceleration": "m/s^2", "torque": "N m", "damping": "N s/m"}
    return special.get(str(kind)) or next(iter(_UNITS.get(str(kind), {"": 1.0})))


def is_unit(unit: str, kind: str) -> bool:
    """Return whether `unit` is a unit of `kind`."""
    return _normalised(unit) in _UNITS.get(str(kind), {})


def _normalised(unit: str) -> str:
    """Return a unit in the spelling of the tables."""
    # NFKC turns the micro sign into the Greek letter and a raised 2 into a plain one.
    text = unicodedata.normalize("NFKC", unit).replace("\u03bc", "u")
    return re.sub(r"[\s^*\u00b7\u22c5\u2022]", "", text)


def _split(text: str, *, example: str) -> tuple[float, str]:
    match = _VALUE.fullmatch(text)
    if match is None:
        raise UnitError(
            f"{text.strip()!r} does not begin with a number; write for example "
            f"'{example}'"
        )
    return float(match[1]), match[2].strip()


def _complaint(unit: str, kind: str) -> str:
    others = [other for other in _UNITS if other != kind and is_unit(unit, other)]
    if not unit.strip():
        return f"no unit is given; write a {kind} in one of {', '.join(_UNITS[kind])}"
    of = f"a unit of {' or '.join(others)}, not" if others else "not a unit"
    return f"{unit!r} is {of} of {kind}; write one of {', '.join(_UNITS[kind])}"
