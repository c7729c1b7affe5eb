# SPDX-License-Identifier: MIT
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.torque_to_preload import preload_from_torque


def test_preload_is_torque_over_nut_factor_and_diameter():
    """One M10 bolt, 40 N m, K 0.18."""
    found = preload_from_torque(40.0, diameter=0.01, nut_factor=0.18)
    assert_allclose((found.value, found.sd), (40 / 0.0018, 0.0))


def test_common_errors_do_not_average_out_over_the_bolts_and_scatter_does():
    """Wrench 3 %, nut factor 10 %, scatter 8 % over four bolts: 4 %."""
    found = preload_from_torque(
        40.0,
        diameter=0.01,
        bolts=4,
        torque_sd=1.2,
        nut_factor_sd=0.02,
        bolt_scatter=0.08,
    )
    relative = (0.03**2 + 0.1**2 + 0.04**2) ** 0.5
    assert_allclose(found.sd / found.value, relative)


@pytest.mark.parametrize(
    "bad", [{"diameter": 0.0}, {"bolts": 0}, {"nut_factor": -0.2}, {"torque_sd": -1.0}]
)
def test_impossible_bolts_are_refused(bad):
    """The message names the number."""
    with pytest.raises(BadData, match=next(iter(bad))):
        preload_from_torque(40.0, **{"diameter": 0.01, **bad})
