# SPDX-License-Identifier: MIT
"""What NI-DAQmx says on an error by its number."""

from jointbench.simulators.chassis.protocol import DAQmxErrors, bad_value
from jointbench.simulators.chassis.tasks.acquisition import not_yet


def error_words(code: int) -> str:
    """Return the text of an error; of most, the name that NI's package gives it."""
    if code == DAQmxErrors.SAMPLES_NOT_YET_AVAILABLE:
        return str(not_yet())
    if code == DAQmxErrors.INVALID_ATTRIBUTE_VALUE:
        return str(bad_value("", "")).partition("\n")[0]
    known: dict[int, str] = {int(each): each.name for each in DAQmxErrors}
    if code not in known:
        return "Error code could not be found. Reinstalling the driver might help."
    return f"{known[code].replace('_', ' ').capitalize()}."
