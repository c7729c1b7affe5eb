# SPDX-License-Identifier: MIT
"""Names, units and meanings of the parameters, in the order of tables."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ParameterName:
    """One parameter of a standard.

    Attributes:
        name: ``"Ra"``.
        unit: SI unit: ``"m"``, ``"1"``, ``"rad"``.
        meaning: as the standard calls it.
    """

    name: str
    unit: str
    meaning: str


def _names(*rows: tuple[str, str, str]) -> tuple[ParameterName, ...]:
    return tuple(ParameterName(*row) for row in rows)


PROFILE_PARAMETERS = _names(
    ("Ra", "m", "arithmetic mean height"),
    ("Rq", "m", "root mean square height"),
    ("Rz", "m", "maximum height per section, mean of the sections"),
    ("Rt", "m", "total height"),
    ("Rp", "m", "mean peak height"),
    ("Rv", "m", "mean pit depth"),
    ("Rsk", "1", "skewness"),
    ("Rku", "1", "kurtosis"),
    ("Rsm", "m", "mean profile element spacing"),
    ("Rc", "m", "mean profile element height"),
    ("Rdq", "1", "root mean square gradient"),
    ("Rk", "m", "core height"),
    ("Rpk", "m", "reduced peak height"),
    ("Rvk", "m", "reduced pit depth"),
    ("Rmrk1", "1", "material ratio of the hills"),
    ("Rmrk2", "1", "material ratio of the core and hills"),
)
"""ISO 21920-2:2021."""

MAP_PARAMETERS = _names(
    ("Sa", "m", "arithmetic mean height"),
    ("Sq", "m", "root mean square height"),
    ("Sz", "m", "maximum height"),
    ("Sp", "m", "maximum peak height"),
    ("Sv", "m", "maximum pit depth"),
    ("Ssk", "1", "skewness"),
    ("Sku", "1", "kurtosis"),
    ("Sal", "m", "autocorrelation length"),
    ("Str", "1", "texture aspect ratio"),
    ("Std", "rad", "texture direction, of the lay"),
    ("Sdq", "1", "root mean square gradient"),
    ("Sdr", "1", "developed interfacial area ratio"),
    ("Sk", "m", "core height"),
    ("Spk", "m", "reduced peak height"),
    ("Svk", "m", "reduced pit depth"),
    ("Smrk1", "1", "material ratio of the hills"),
    ("Smrk2", "1", "material ratio of the core and hills"),
    ("Sxp", "m", "peak extreme height"),
    ("Vmp", "m", "peak material volume over the area"),
    ("Vmc", "m", "core material volume over the area"),
    ("Vvc", "m", "core void volume over the area"),
    ("Vvv", "m", "pit void volume over the area"),
)
"""ISO 25178-2:2021."""
