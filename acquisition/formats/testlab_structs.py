# SPDX-License-Identifier: MIT
"""Structs of MAT files as Simcenter Testlab exports them.

A struct of Testlab has ``x_values`` (start, increment, number, label of the unit),
``y_values`` (values, quantity with the label of its unit) and ``function_record``
(names of the channels).
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import named

_DEEPEST = 4
Struct = Mapping[str, Any]


def testlab_structs(
    content: Struct, prefix: str = "", depth: int = 0
) -> Iterator[tuple[str, Struct]]:
    """Yield the structs with x_values and y_values, and their names."""
    for name, value in content.items():
        for number, one in enumerate(value if isinstance(value, list) else [value], 1):
            if not isinstance(one, Mapping):
                continue
            own = f"{prefix}{name}" + (f"({number})" if isinstance(value, list) else "")
            if isinstance(one.get("x_values"), Mapping) and isinstance(
                one.get("y_values"), Mapping
            ):
                yield own, one
            elif depth < _DEEPEST:
                yield from testlab_structs(one, f"{own}.", depth + 1)


def struct_values(struct: Struct) -> NDArray[Any]:
    """Return the values of a struct, shape (n_values, n_functions)."""
    values = np.asarray(struct["y_values"].get("values", np.zeros(0)))
    if values.dtype.kind not in "fiuc":
        return np.zeros((0, 1))
    if values.ndim < 2 or 1 in values.shape:
        values = values.reshape(-1, 1)
    lines = struct_number(struct["x_values"], "number_of_values")
    return values.T if values.shape[0] != lines == values.shape[1] else values


def struct_axis(path: Path, where: str, struct: Struct) -> tuple[float, float, str]:
    """Return start and increment of the axis of a struct, and the label of its unit.

    Raises:
        FormatError: it claims another number of values than there are.
    """
    along = struct["x_values"]
    label = ""
    if isinstance(along.get("quantity"), Mapping):
        label = str(along["quantity"].get("label", "")).strip()
    start, increment = (struct_number(along, n) for n in ("start_value", "increment"))
    count = struct_values(struct).shape[0]
    claimed = struct_number(along, "number_of_values")
    if claimed != count or not (np.isfinite(start) and 0.0 < increment < np.inf):
        raise FormatError(
            f"{named(path)}: {where} claims {claimed:g} values from {start:g} in "
            f"steps of {increment:g} and holds {count}; use another copy"
        )
    return start, increment, label


def struct_unit(struct: Struct) -> tuple[str, float]:
    """Return the label of the unit of the values, and the factor stated beside it."""
    quantity = struct["y_values"].get("quantity")
    if not isinstance(quantity, Mapping):
        return "", 1.0
    label = str(quantity.get("label", "")).strip()
    change = quantity.get("unit_transformation")
    factor = struct_number(change, "factor") if isinstance(change, Mapping) else 1.0
    return label, factor if np.isfinite(factor) else 1.0


def struct_labels(struct: Struct, column: int) -> tuple[str, str]:
    """Return the labels of output and input, as far as the struct states them."""
    record = struct.get("function_record")
    if not isinstance(record, Mapping):
        return "", ""
    found = [
        _channel(record.get(f"{side}_channel"), column)
        for side in ("primary", "reference")
    ]
    return found[0], found[1]


def struct_number(parts: Any, name: str) -> float:
    """Return a number of a struct, NaN where it has none."""
    value = np.asarray(parts.get(name, np.nan))
    if value.size != 1 or value.dtype.kind not in "fiu":
        return float("nan")
    return float(value.ravel()[0])


def _channel(channel: Any, column: int) -> str:
    if isinstance(channel, list):
        channel = channel[column] if column < len(channel) else {}
    if not isinstance(channel, Mapping):
        return ""
    place = channel.get("point_info")
    parts = channel if not isinstance(place, Mapping) else {**channel, **place}
    for name in ("label", "name", "node_id", "id_string"):
        text = parts.get(name)
        if isinstance(text, str) and text.strip():
            return text.strip()
    return ""
