"""The reduced model: its frequencies, its bound, its cache."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.errors import BadData, UsageError
from jointbench.analysis.structures.assembly import Material
from jointbench.analysis.structures.cache import cached, content_key
from jointbench.analysis.structures.full_modes import solve_full
from jointbench.analysis.structures.mesh import box_mesh
from jointbench.analysis.structures.parts import (
    Joint,
    solid_body,
)
from jointbench.analysis.structures.reduced import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)
from jointbench.analysis.structures.reduction import reduce_structure
from jointbench.analysis.structures.structure import (
    Structure,
    build_structure,
)

ROUNDING = 1e-8


def test_the_bound_holds_and_the_error_is_small_at_random_joints(
    plates: Structure, reduced: ReducedModel
) -> None:
    """Points that the reduction has never seen, over four decades."""
    random = np.random.default_rng(3)
    for _ in range(8):
        stiffness = 10.0 ** random.uniform(6, 10, 3)
        found, bound = frequency_bound(reduced, stiffness)
        full = solve_full(plates, stiffness, 14).natural_frequency
        error = found - full
        assert np.all(found[:6] == 0.0)
        assert np.all(error >= -ROUNDING * full)
        assert np.all(error <= bound + ROUNDING * full)
        assert np.all(error[6:] < 1e-4 * full[6:])


def test_the_bound_of_a_poor_basis_is_as_large_as_its_error(
    plates: Structure, reduced: ReducedModel
) -> None:
    """Basis vectors taken away: the error grows, and the bound stays above it."""
    kept = np.arange(reduced.size) < 40
    columns = np.tile(kept, 2 + len(reduced.names))
    poor = ReducedModel(
        stiffness=reduced.stiffness[np.ix_(kept, kept)],
        spread=reduced.spread[:, kept][:, :, kept],
        loss=reduced.loss[np.ix_(kept, kept)],
        basis=reduced.basis[:, kept],
        riesz=reduced.riesz[:, columns],
        scale=reduced.scale,
        shift=reduced.shift,
        box=reduced.box,
        modes=reduced.modes,
        names=reduced.names,
    )
    stiffness = np.array([3e9, 2e9, 1e9])
    found, bound = frequency_bound(poor, stiffness)
    full = solve_full(plates, stiffness, 14).natural_frequency
    error = found - full
    assert error.max() > 1.0
    assert np.all(error <= bound + ROUNDING * full)


def test_a_cached_model_is_read_back_and_a_torn_file_made_again(
    plates: Structure, reduced: ReducedModel, tmp_path: Path
) -> None:
    """By content: the same matrices have the same key, a new option another one."""
    key = content_key(plates, 14)
    assert key == content_key(plates, 14) != content_key(plates, 15)
    made = []

    def make() -> ReducedModel:
        made.append(1)
        return reduced

    cached(tmp_path, key, make)
    again = cached(tmp_path, key, make)
    stiffness = np.full(3, 1e8)
    np.testing.assert_array_equal(
        solve_reduced(again, stiffness).eigenvalue,
        solve_reduced(reduced, stiffness).eigenvalue,
    )
    (tmp_path / f"{key}.npz").write_bytes(b"PK torn")
    cached(tmp_path, key, make)
    assert len(made) == 2


def test_a_glued_joint_is_not_reduced_body_by_body(marble: Material) -> None:
    """The message says what to do instead."""
    lower = solid_body("lower", box_mesh((0.1, 0.1, 0.1), (1, 1, 1)), marble)
    top = box_mesh((0.1, 0.1, 0.1), (1, 1, 1), origin=(0.0, 0.0, 0.1))
    free = box_mesh((0.1, 0.1, 0.1), (1, 1, 1), origin=(0.0, 0.0, 0.2))
    bodies = [lower, solid_body("mid", top, marble), solid_body("top", free, marble)]
    joints = [Joint("glue", ("lower", "mid"), glued=True), Joint("j", ("mid", "top"))]
    with pytest.raises(BadData, match="glued joint ties bodies together"):
        reduce_structure(build_structure(bodies, joints), modes=8)


def test_an_empty_box_is_refused(plates: Structure) -> None:
    """Low must lie below high."""
    with pytest.raises(UsageError, match="low below high"):
        reduce_structure(plates, modes=8, box=(1e9, 1e9))
