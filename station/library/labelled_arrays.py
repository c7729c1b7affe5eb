# SPDX-License-Identifier: MIT
"""Results as xarray datasets: labelled coordinates, a unit on every variable."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.errors import UsageError

if TYPE_CHECKING:
    from xarray import Dataset

Variable = tuple[Sequence[str], ArrayLike, str, str]
"""Names of the dimensions, values, unit, and what it is in words."""


def dataset(
    variables: Mapping[str, Variable],
    coordinates: Mapping[str, Variable],
    facts: Mapping[str, object],
) -> "Dataset":
    """Return a dataset with ``units`` and ``long_name`` on everything.

    Args:
        variables: by name.
        coordinates: by name.
        facts: attributes of the whole; None and empty ones are left out.

    Raises:
        UsageError: xarray is not installed.
    """
    try:
        from xarray import Dataset
    except ImportError as error:
        raise UsageError(
            "to_xarray needs xarray: pip install 'jointbench[xarray]'"
        ) from error
    return Dataset(
        {name: _labelled(one) for name, one in variables.items()},
        {name: _labelled(one) for name, one in coordinates.items()},
        {key: value for key, value in facts.items() if value not in (None, "", ())},
    )


def _labelled(one: Variable) -> tuple[tuple[str, ...], object, dict[str, str]]:
    dimensions, values, unit, words = one
    # "1" is the unit of a ratio in the CF conventions; names have no unit.
    units = {"units": unit or "1"} if np.asarray(values).dtype.kind in "fciu" else {}
    return tuple(dimensions), np.asarray(values), {**units, "long_name": words}
