# SPDX-License-Identifier: MIT
"""Units of FRFs as programs write them: a motion over a force, in any order of signs.

``m/s^2/N``, ``(m/s^2)/lbf``, ``g/N``, ``(1/N)*(m/s^2)``, ``m/(N s^2)``, ``1/kg``: each
names receptance, mobility or accelerance, and a factor that leads to SI.
"""

import re
import unicodedata
from collections.abc import Iterator

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import is_unit, to_si
from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.records.recordings import Quantity

EXAMPLES = "m/N, m/s/N, m/s^2/N, g/N, (m/s^2)/lbf"
"""Units for messages."""
MOTIONS = (Quantity.ACCELERATION, Quantity.VELOCITY, Quantity.DISPLACEMENT)
_SI = {
    "1/kg": Quantity.ACCELERATION,
    "kg-1": Quantity.ACCELERATION,
    "s/kg": Quantity.VELOCITY,
    "s2/kg": Quantity.DISPLACEMENT,
    "m*s-2*N-1": Quantity.ACCELERATION,
    "m*s-1*N-1": Quantity.VELOCITY,
    "m*N-1": Quantity.DISPLACEMENT,
}
_INVERSE_FIRST = re.compile(r"\(?1/\(?(?P<force>\w+)\)?\)?\*?\(?(?P<motion>[^()]+)\)?")
_INVERSE_LAST = re.compile(r"\(?(?P<motion>[^()]+?)\)?\*?\(1/\(?(?P<force>\w+)\)?\)")
_JOINED = re.compile(r"(?P<length>\w+)/\(?(?P<force>[A-Za-z]+?)\*?(?P<time>s2?)\)?")
_SECONDS = {"s": "/s", "s2": "/s2"}


def parse_frf_unit(text: str) -> tuple[Quantity, float]:
    """Read the unit of an FRF.

    Args:
        text: a motion over a force, see the top of this module.

    Returns:
        What the response measures, and the factor to its SI unit per newton.

    Raises:
        UnitError: it is none; the message has examples.

    >>> parse_frf_unit("mm/s^2/N")
    (<Quantity.ACCELERATION: 'acceleration'>, 0.001)
    """
    plain = _plain(text)
    if plain in _SI:
        return _SI[plain], 1.0
    for motion, force in _pairs(plain):
        for quantity in MOTIONS:
            if is_unit(motion, quantity.value) and is_unit(force, "force"):
                return quantity, to_si(motion, quantity.value) / to_si(force, "force")
    unit = f"unit {shown(text.strip())}" if text.strip() else "an empty unit"
    raise UnitError(
        f"{unit} is no unit of an FRF; an FRF is a motion over a force: {EXAMPLES}"
    )


def is_frf_unit(text: str) -> bool:
    """Return whether a text is the unit of an FRF."""
    try:
        parse_frf_unit(text)
    except UnitError:
        return False
    return True


def _plain(text: str) -> str:
    """Spell powers and products the one way that the patterns know."""
    text = unicodedata.normalize("NFKC", text).replace("\u03bc", "u")
    text = re.sub(r"[\u00b7\u22c5\u2022]", "*", text.replace("**", "").replace("^", ""))
    text = re.sub(r"\[(.*)\]", r"\1", text.strip())
    return re.sub(r"\s+", "", re.sub(r"(?<=\w)\s+(?=\w)", "*", text))


def _pairs(text: str) -> Iterator[tuple[str, str]]:
    """Yield every way to part a text into motion and force."""
    for place in (i for i, sign in enumerate(text) if sign == "/"):
        yield _bare(text[:place]), _bare(text[place + 1 :])
    for pattern in (_INVERSE_FIRST, _INVERSE_LAST):
        match = pattern.fullmatch(text)
        if match:
            yield match["motion"], match["force"]
    match = _JOINED.fullmatch(text)
    if match:
        yield match["length"] + _SECONDS[match["time"]], match["force"]
    parts = text.split("/")
    if len(parts) in (3, 4) and set(parts[2:]) <= {"s", "s2"}:  # m/N/s, m/N/s/s
        yield f"{parts[0]}/s{'2' * (parts[2:] in (['s2'], ['s', 's']))}", parts[1]


def _bare(text: str) -> str:
    return text[1:-1] if text.startswith("(") and text.endswith(")") else text
