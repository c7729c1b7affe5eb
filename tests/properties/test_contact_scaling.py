# SPDX-License-Identifier: MIT
"""Contact physics does not depend on the units it is written in."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.model_catalogue import CONTACT_MODELS, contact_model


@settings(max_examples=60, deadline=None)
@given(
    model=st.sampled_from(sorted(CONTACT_MODELS)),
    offset=st.floats(0.15, 0.9),
    decade=st.floats(-11, -7),
    load=st.floats(1.0, 1e4),
    length=st.floats(1e-2, 1e2),
    pressure=st.floats(1e-2, 1e2),
)
def test_stiffness_scales_as_pressure_times_length(
    model, offset, decade, load, length, pressure
):
    """All lengths times l and all pressures times p: force p l^2, stiffness p l."""
    dimension = contact_model(model).topography.lowest_dimension + offset
    plain, scaled = (
        contact_curve(
            model,
            dimension=dimension,
            roughness=size * 10**decade,
            material=ContactMaterial(
                69.3e9 * stress, 2.265e9 * stress, 0.25, yield_strength=8e8 * stress
            ),
            preload=load * stress * size**2,
        )
        for size, stress in ((1.0, 1.0), (length, pressure))
    )
    assert_allclose(scaled.largest_area, plain.largest_area * length**2, rtol=1e-9)
    assert_allclose(
        scaled.stiffness,
        plain.stiffness * pressure * length,
        rtol=1e-8,
        atol=1e-9 * np.abs(plain.stiffness).max() * pressure * length,
    )
