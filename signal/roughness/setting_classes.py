# SPDX-License-Identifier: MIT
"""Default settings of profiles, and the nesting indices of maps."""

from dataclasses import dataclass

from jointbench.acquisition.basics.errors import UsageError

SECTIONS = 5
"""Sections of the default evaluation length [-]."""
PIXELS_OF_S_FILTER = 5
"""Least samples in the nesting index of the S-filter of a map [-] (ISO 25178-3:2012,
table 3: the sampling distance of a stylus is at most a fifth of it)."""


@dataclass(frozen=True, slots=True)
class SettingClass:
    """One column of the default settings of profiles.

    Attributes:
        name: ``"Sc3"``.
        roughness_up_to: largest Rz of a profile that is measured with it [m].
        short: nesting index of the S-filter (lambda_s) [m].
        long: nesting index of the L-filter (lambda_c), and section length [m].
        pitch: largest distance of neighbours [m].
        tip: largest radius of the stylus [m].
    """

    name: str
    roughness_up_to: float
    short: float
    long: float
    pitch: float
    tip: float

    @property
    def evaluation_length(self) -> float:
        """Length of all sections [m]."""
        return SECTIONS * self.long


SETTING_CLASSES = (
    SettingClass("Sc1", 0.16e-6, 2.5e-6, 0.08e-3, 0.5e-6, 2e-6),
    SettingClass("Sc2", 0.8e-6, 2.5e-6, 0.25e-3, 0.5e-6, 2e-6),
    SettingClass("Sc3", 16e-6, 2.5e-6, 0.8e-3, 0.5e-6, 2e-6),
    SettingClass("Sc4", 80e-6, 8e-6, 2.5e-3, 1.5e-6, 5e-6),
    SettingClass("Sc5", float("inf"), 25e-6, 8e-3, 5e-6, 10e-6),
)
"""ISO 21920-3:2021, tables 2 and 3."""

_SERIES = (0.1, 0.2, 0.25, 0.5, 0.8, 1.0, 2.0, 2.5, 5.0, 8.0, 10.0)
MAP_INDICES = tuple(
    round(one * 10.0**power, 12)
    for power in range(-7, -2)
    for one in _SERIES
    if one < 1 or power == -3
)
"""Nesting indices of maps [m] (ISO 25178-3:2012, table 1)."""


def setting_class(name: str) -> SettingClass:
    """Return the settings of one class.

    Raises:
        UsageError: no such class.
    """
    for one in SETTING_CLASSES:
        if one.name.lower() == name.lower():
            return one
    names = ", ".join(one.name for one in SETTING_CLASSES)
    raise UsageError(f"setting class {name!r} is not one of {names} (ISO 21920-3)")


def class_of_roughness(roughness: float) -> SettingClass:
    """Return the class of an Rz [m]."""
    return next(one for one in SETTING_CLASSES if roughness <= one.roughness_up_to)


def map_s_index(pitch: float) -> float:
    """Return the shortest nesting index of the series that a pitch resolves [m]."""
    least = PIXELS_OF_S_FILTER * pitch * (1 - 1e-9)
    return next((one for one in sorted(set(MAP_INDICES)) if one >= least), least)
