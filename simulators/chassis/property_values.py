# SPDX-License-Identifier: MIT
"""Values of NI's properties: a table of defaults, and what a client has set."""

from collections.abc import Mapping

from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal

Value = bool | int | float | str | tuple[float, ...] | tuple[int, ...]


class PropertyValues:
    """Properties of one object: those of its table, at their defaults until set."""

    def __init__(self, defaults: Mapping[str, Value]) -> None:
        self._defaults = defaults
        self._set: dict[str, Value] = {}

    def get(self, name: str) -> Value:
        """Return a value.

        Raises:
            Refusal: the hardware has no such property.
        """
        if name not in self._defaults:
            raise not_supported(name)
        return self._set.get(name, self._defaults[name])

    def set(self, name: str, value: Value) -> None:
        """Set a value.

        Raises:
            Refusal: the hardware has no such property.
        """
        if name not in self._defaults:
            raise not_supported(name)
        self._set[name] = value

    def reset(self, name: str) -> None:
        """Return to the default."""
        self.get(name)
        self._set.pop(name, None)

    def changed(self, name: str) -> bool:
        """Return whether a value was set."""
        return name in self._set

    def number(self, name: str) -> float:
        """Return a real value."""
        value = self.get(name)
        assert isinstance(value, int | float), name
        return float(value)

    def whole(self, name: str) -> int:
        """Return an integer or enumerated value."""
        return int(self.number(name))

    def text(self, name: str) -> str:
        """Return a text."""
        return str(self.get(name))


def not_supported(name: str) -> Refusal:
    """Return the refusal of a property that the hardware of a task does not have."""
    return Refusal(
        DAQmxErrors.ATTRIBUTE_NOT_SUPPORTED_IN_TASK_CONTEXT,
        "Specified property is not supported by the device or is not applicable to "
        f"the task.\n\nProperty: DAQmx_{name}",
    )
