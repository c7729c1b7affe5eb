# SPDX-License-Identifier: MIT
"""Settings of a Surfcom trace: the TX3 file that the instrument writes beside it.

One key and value per line, in the language of the instrument, with a tab between them.
"""

from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.formats.heights.stated_lengths import (
    StatedLength,
    stated_length,
)

_MOST_BYTES = 2**16
_CUTOFF_WORDS = ("onda de corte", "cutoff", "cut-off", "cut off", "grenzwellen")
# Spanish is known from real files; the others are the terms of ISO 4287 and of the
# makers' manuals.
_EVALUATED = (
    "longitud evaluación",
    "longitud de evaluación",
    "evaluation length",
    "bewertungslänge",
    "auswertelänge",
    "gesamtmessstrecke",
    "longueur d'évaluation",
    "longueur évaluation",
    "lunghezza di valutazione",
    "lunghezza valutazione",
)
_MEASURED = (
    "longitud medición",
    "longitud de medición",
    "measurement length",
    "measuring length",
    "messlänge",
    "messstrecke",
    "longueur de mesure",
    "lunghezza di misura",
    "lunghezza misura",
)
_RANGE = (
    "rango de medida",
    "rango medida",
    "measurement range",
    "measuring range",
    "messbereich",
    "plage de mesure",
    "campo di misura",
)


@dataclass(frozen=True, slots=True)
class SurfcomSettings:
    """What a TX3 file says; None where it does not.

    Attributes:
        source: name of the file, or that there is none.
        cutoff_short: [m].
        cutoff_long: [m].
        evaluated: length that was evaluated.
        measured: length that was to be measured.
        reach: largest height to both sides of 0 [m].
    """

    source: str = "no TX3 beside it"
    cutoff_short: float | None = None
    cutoff_long: float | None = None
    evaluated: StatedLength | None = None
    measured: StatedLength | None = None
    reach: float | None = None


def read_settings(path: Path) -> SurfcomSettings | None:
    """Read the TX3 file beside a profile, if there is one."""
    beside = [path.with_suffix(ending) for ending in (".tx3", ".TX3")]
    found = next((file for file in beside if file.is_file() and file != path), None)
    if found is None:
        return None
    with found.open("rb") as file:
        lines = file.read(_MOST_BYTES).decode("latin-1").splitlines()
    rows = [line.partition("\t")[::2] for line in lines]
    pairs = [(" ".join(key.casefold().split()), cell.strip()) for key, cell in rows]
    cutoffs = _cutoffs(pairs)
    reach = _first(pairs, _RANGE)
    return SurfcomSettings(
        source=found.name,
        cutoff_short=cutoffs.get("short"),
        cutoff_long=cutoffs.get("long"),
        evaluated=_first(pairs, _EVALUATED),
        measured=_first(pairs, _MEASURED),
        reach=None if reach is None else reach.value,
    )


def _cutoffs(pairs: list[tuple[str, str]]) -> dict[str, float]:
    """Return the filter cut-offs [m]; the key of lambda_s holds "Ls"."""
    found: dict[str, float] = {}
    for key, cell in pairs:
        short = " ls" in key
        if not short and not any(word in key for word in _CUTOFF_WORDS):
            continue
        try:
            value = parse_value(cell, "length")
        except UnitError:
            continue
        if 0 < value < 1:
            found.setdefault("short" if short else "long", value)
    return found


def _first(pairs: list[tuple[str, str]], words: tuple[str, ...]) -> StatedLength | None:
    """Return the first length above zero after one of the keys."""
    for key, cell in pairs:
        if not key.startswith(words):
            continue
        found = stated_length(cell.removeprefix("+/-").removeprefix("±"))
        if found is not None:
            return found
    return None
