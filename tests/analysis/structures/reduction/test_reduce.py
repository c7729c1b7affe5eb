"""The reduced model: its frequencies, its bound, its cache."""

from pathlib import Path

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    GROUND,
    Joint,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    frequency_bound,
    solve_reduced,
)
from jointbench.analysis.structures.reduction.reduction_cache import cached, content_key

ROUNDING = 1e-8
# Glue is 3e5 times stiffer than the bodies: so many digits are lost in a full solve.
GLUE_ROUNDING = 1e-6


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
    poor = reduced.restricted(np.eye(reduced.size, 40))
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


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1)])
def test_glued_bodies_are_reduced_as_one(
    marble: Material, order: tuple[int, ...]
) -> None:
    """Within the bound of the whole mesh, neighbours in the list or not."""
    size, cells = (0.3, 0.2, 0.05), (2, 2, 1)
    stack = [
        solid_body(name, box_mesh(size, cells, origin=(0, 0, height)), marble)
        for name, height in (("low", 0.0), ("mid", 0.05), ("top", 0.1))
    ]
    joints = [Joint("glue", ("low", "mid"), glued=True), Joint("j", ("mid", "top"))]
    structure = build_structure([stack[at] for at in order], joints)
    model = reduce_structure(structure, modes=10, box=(1e7, 1e9))
    stiffness = np.array([3e8, 5e7, 8e7])
    full = solve_full(structure, stiffness, 10).natural_frequency
    found, bound = frequency_bound(model, stiffness)
    assert np.all(np.abs(found - full) <= bound + GLUE_ROUNDING * full)
    assert np.count_nonzero(full == 0) == 6


def test_an_empty_box_is_refused(plates: Structure) -> None:
    """Low must lie below high."""
    with pytest.raises(UsageError, match="low below high"):
        reduce_structure(plates, modes=8, box=(1e9, 1e9))


def test_a_support_that_holds_too_little_is_reduced_with_its_mechanisms(
    marble: Material,
) -> None:
    """Springs along the normal alone: three motions cost nothing in both models."""
    body = solid_body("plate", box_mesh((0.5, 0.3, 0.05), (3, 2, 1)), marble)
    top = solid_body(
        "top", box_mesh((0.5, 0.3, 0.05), (3, 2, 1), origin=(0, 0, 0.05)), marble
    )
    springs = Support("plate", "z-", SupportKind.SPRINGS, (1e8, 0.0, 0.0))
    structure = build_structure(
        [body, top], [Joint("joint", ("plate", "top"))], supports=[springs]
    )
    model = reduce_structure(structure, modes=10, box=(1e7, 1e9))
    stiffness = np.array([3e8, 5e7, 8e7])
    full = solve_full(structure, stiffness, 10).natural_frequency
    found, bound = frequency_bound(model, stiffness)
    assert np.count_nonzero(full == 0) == np.count_nonzero(found == 0) == 3
    assert np.all(np.abs(found - full) <= bound + 1e-7 * full)


@pytest.mark.parametrize(
    ("size", "box"), [((1.0, 0.8, 0.0375), (1e5, 1e9)), ((0.5, 0.4, 0.15), (1e3, 1e9))]
)
def test_close_and_slow_modes_are_iterated_until_their_bound_is_met(
    size: tuple[float, float, float], box: tuple[float, float]
) -> None:
    """A table on the ground, from 0.5 Hz on: right wherever it is tried."""
    steel = Material(youngs_modulus=200e9, poisson_ratio=0.3, density=7850.0)
    body = solid_body("table", box_mesh(size, (4, 4, 1)), steel)
    structure = build_structure([body], [Joint("bed", ("table", GROUND), face="z-")])
    model = reduce_structure(structure, modes=8, box=box)
    random = np.random.default_rng(1)
    for _ in range(6):
        stiffness = np.exp(random.uniform(*np.log(box), 3))
        found, bound = frequency_bound(model, stiffness)
        full = solve_full(structure, stiffness, 8).natural_frequency
        assert np.all(found - full <= bound + 1e-7 * full)
        assert np.all(np.abs(found / full - 1) < 1e-4)


def test_a_bound_that_rounding_keeps_up_says_so(plates: Structure) -> None:
    """No tolerance is met below rounding: the message does not name the box first."""
    with pytest.raises(BadData, match=r"do not lower it.*larger tolerance"):
        reduce_structure(plates, modes=8, box=(1e6, 1e8), tolerance=1e-18)
