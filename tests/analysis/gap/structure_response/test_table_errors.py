# SPDX-License-Identifier: MIT
"""Errors of a modal table in closed modes, against tables drawn with such errors."""

from dataclasses import replace

import numpy as np
from bolted_bodies import NOMINAL, random_bodies, smooth_hits

from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    base_layout,
)
from jointbench.analysis.gap.structure_response.closed_modes import real_modes
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.hit_frames import hit_frame
from jointbench.analysis.gap.structure_response.joint_state import (
    JointState,
    state_of,
)
from jointbench.analysis.gap.structure_response.residue_errors import residue_errors
from jointbench.analysis.gap.structure_response.table_errors import (
    tuned_again,
    tuned_modes,
)

MADE = HitCampaign("made", random_bodies(), NOMINAL, smooth_hits())


def test_the_sd_of_closed_frequencies_is_that_of_drawn_tables() -> None:
    """Frequencies of the free modes drawn with their sd scatter the closed ones."""
    made = replace(MADE, nominal=replace(NOMINAL, table_sd=(0.005, 0.0)))
    layout = base_layout(made.bodies, made.nominal)
    state = state_of(made.bodies, made.nominal, layout, np.zeros(layout.sd.size))
    tuned = tuned_modes(made, state)
    assert tuned is not None
    whole = real_modes(made.bodies, state).omega
    at = [int(np.argmin(np.abs(whole - w))) for w in tuned.omega]
    rng = np.random.default_rng(498)
    drawn = []
    for _ in range(400):
        factor = np.exp(0.005 * rng.standard_normal(made.bodies.omega.size))
        bodies = replace(made.bodies, omega=made.bodies.omega * factor)
        drawn.append(np.log(real_modes(bodies, state).omega[at] / tuned.omega))
    sd = tuned.sd[: tuned.omega.size]
    np.testing.assert_allclose(np.std(drawn, axis=0), sd, rtol=0.15)


def uncertain() -> tuple[HitCampaign, BaseLayout, JointState]:
    """Return a campaign with an uncertain table, its layout and its nominal state."""
    made = replace(MADE, nominal=replace(NOMINAL, table_sd=(0.005, 0.02)))
    bare = base_layout(made.bodies, made.nominal)
    state = state_of(made.bodies, made.nominal, bare, np.zeros(bare.sd.size))
    layout = base_layout(made.bodies, made.nominal, tuned_modes(made, state))
    return made, layout, state


def test_a_coupling_turns_two_modes_as_stiffness_between_them_does() -> None:
    """Closed frequencies are those of the two by two problem; others stay."""
    made, layout, state = uncertain()
    tuned = layout.tuned
    assert tuned is not None and len(tuned.pairs) == 2
    base = np.zeros(layout.sd.size)
    base[layout.couplings.start] = 0.03
    turned = state_of(made.bodies, made.nominal, layout, base)
    i, j = tuned.pairs[0]
    own, between = tuned.omega[[i, j]] ** 2, 2.0 * np.prod(tuned.omega[[i, j]])
    square = np.linalg.eigvalsh([[own[0], 0.03 * between], [0.03 * between, own[1]]])
    found, before = (real_modes(made.bodies, s).omega for s in (turned, state))
    others = np.setdiff1d(before, tuned.omega[[i, j]])
    expected = np.sort(np.concatenate([others, np.sqrt(square)]))
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_a_softer_joint_keeps_what_tunes_the_frequencies() -> None:
    """Modes of a joint a third as stiff are tuned as those of the nominal one were."""
    made, layout, _ = uncertain()
    assert layout.tuned is not None
    rng = np.random.default_rng(502)
    own = [layout.at(name) for name in layout.tuned.names]
    base = np.zeros(layout.sd.size)
    base[own] = layout.tuned.sd * rng.standard_normal(len(own))
    tuned = state_of(made.bodies, made.nominal, layout, base)
    same = tuned_again(made, tuned, layout.tuned)
    assert same is not None
    np.testing.assert_allclose(same[1], base[own], atol=1e-12)
    soft = replace(tuned, compliance=3.0 * tuned.compliance)
    again = tuned_again(made, soft, layout.tuned)
    assert again is not None
    after = real_modes(
        made.bodies, replace(soft, tuned=again[0].stiffness_at(again[1]))
    ).omega
    wanted = real_modes(made.bodies, soft).omega
    bare = real_modes(made.bodies, replace(soft, tuned=None)).omega
    lowest = np.isin(bare, again[0].omega)
    shift = np.abs(np.log(wanted / bare))[lowest]
    left = np.abs(np.log(after / wanted))[lowest]
    assert shift.max() > 2e-3
    assert left.max() < 0.1 * shift.max()


def test_an_exact_table_leaves_no_frequency_open() -> None:
    """Its modes are those of the bodies."""
    layout = base_layout(MADE.bodies, NOMINAL)
    state = state_of(MADE.bodies, NOMINAL, layout, np.zeros(layout.sd.size))
    assert tuned_modes(MADE, state) is None


def test_errors_of_stiffness_leave_residues_almost_real() -> None:
    """Modes apart from each other have a tenth of the error in quadrature, or less."""
    made, _, state = uncertain()
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    sd = residue_errors(made, state, frame).sd
    modes = (sd.shape[-1] - 1) // 3
    in_phase, across = sd[..., :modes], sd[..., modes : 2 * modes]
    assert np.all(across <= in_phase)
    assert 0.0 < np.median(across / in_phase) < 0.1


def test_errors_of_some_records_are_their_own_among_those_of_all() -> None:
    """Responses to errors follow the forces of the records that are chosen."""
    made, _, state = uncertain()
    frame = hit_frame(made.hits, made.hits.force.shape[1])
    errors = residue_errors(made, state, frame)
    whole = errors.rows(np.arange(len(frame.force)))
    some = np.array([1, 0])
    np.testing.assert_array_equal(errors.rows(some), whole[some])
    second = errors.chosen(some).rows(np.array([1]))
    np.testing.assert_array_equal(second, whole[:1])
    assert not np.array_equal(whole[0], whole[1])
