"""The filter of a campaign, record by record and side by side."""

import numpy as np
import pytest
from scipy.signal import firwin

from jointbench.analysis.gap.structure_response.common_filter import CommonFilter


@pytest.mark.parametrize("step", [1, 2, 3])
@pytest.mark.parametrize("length", [5, 128, 129, 500])
def test_records_side_by_side_are_filtered_as_each_of_them(
    step: int, length: int
) -> None:
    """Beyond both ends of a record there is nothing."""
    filtering = CommonFilter(firwin(31, 0.8 / step), step)
    values = np.random.default_rng(520).standard_normal((4, length))
    found = filtering.in_time(np.ascontiguousarray(values.T))
    assert found.shape == (-(-length // step), 4)
    np.testing.assert_allclose(found.T, filtering(values), atol=1e-12)
