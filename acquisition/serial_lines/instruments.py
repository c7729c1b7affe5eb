# SPDX-License-Identifier: MIT
"""The serial instruments by name, and a reading from each with its package named."""

from dataclasses import replace

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.basics.registry import (
    Entry,
    Registry,
    UnknownEntry,
    unknown_words,
)
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile
from jointbench.acquisition.serial_lines import diavite, mark10, mitutoyo
from jointbench.acquisition.serial_lines.line import Line
from jointbench.acquisition.serial_lines.serial_instrument import (
    ProfileOptions,
    Reading,
    SerialInstrument,
)


def _built_in() -> tuple[SerialInstrument, ...]:
    return (diavite.INSTRUMENT, mitutoyo.INSTRUMENT, mark10.INSTRUMENT)


SERIAL_INSTRUMENTS = Registry(
    "jointbench.serial_instruments", "serial instrument", SerialInstrument, _built_in
)


def torque_tester(name: str) -> Entry[SerialInstrument]:
    """Return the torque tester of a name.

    Raises:
        UsageError: there is none, or its package cannot be used.
    """
    known = [
        entry
        for entry in SERIAL_INSTRUMENTS.entries()
        if entry.value.read_torque is not None
    ]
    return _named(name, "torque tester", known)


def roughness_tester(name: str) -> Entry[SerialInstrument]:
    """Return the roughness tester of a name.

    Raises:
        UsageError: there is none, or its package cannot be used.
    """
    known = [
        entry
        for entry in SERIAL_INSTRUMENTS.entries()
        if entry.value.read_profile is not None
    ]
    return _named(name, "roughness tester", known)


def _named(
    name: str, what: str, known: list[Entry[SerialInstrument]]
) -> Entry[SerialInstrument]:
    by_name = {entry.value.name: entry for entry in known}
    if name not in by_name:
        if name in SERIAL_INSTRUMENTS.names():
            SERIAL_INSTRUMENTS.entry(name)  # reports the fault of its package
        raise UnknownEntry(unknown_words(name, what, by_name))
    return by_name[name]


def read_torque(tester: Entry[SerialInstrument], line: Line) -> Reading:
    """Return what a torque tester shows.

    Raises:
        InstrumentError: it answers with an error, or code of its package fails.
        FormatError: no answer can be read.
    """
    assert tester.value.read_torque is not None, "torque_tester returned it"
    with tester.running(InstrumentError):
        reading = tester.value.read_torque(line)
        if not isinstance(reading, Reading):
            raise TypeError("read_torque must return a Reading")
    return reading


def read_profile(
    tester: Entry[SerialInstrument], line: Line, options: ProfileOptions
) -> Profile:
    """Return the last profile of a roughness tester.

    Raises:
        InstrumentError: the line breaks, or code of its package fails.
        FormatError: the answer is not what the instrument's notes say.
    """
    assert tester.value.read_profile is not None, "roughness_tester returned it"
    with tester.running(InstrumentError):
        profile = tester.value.read_profile(line, options)
        if not isinstance(profile, Profile):
            raise TypeError("read_profile must return a Profile")
    if tester.built_in:
        return profile
    origin = step("package", instrument=tester.value.name, package=tester.package)
    return replace(profile, provenance=(origin, *profile.provenance))
