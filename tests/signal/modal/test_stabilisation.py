# SPDX-License-Identifier: MIT
"""Tracks of poles over orders."""

import numpy as np
import pytest

from jointbench.signal.modal.lscf import OrderPoles
from jointbench.signal.modal.stabilisation import (
    StabilityLimits,
    candidates,
    mac,
    stabilise,
)


def pole(frequency: float, damping: float) -> complex:
    """Return the pole of a mode [rad/s]."""
    omega = 2.0 * np.pi * frequency
    return complex(omega * (-damping + 1j * np.sqrt(1.0 - damping**2)))


def table_of(
    rows: list[list[complex]], shapes: list[list[list[float]]] | None = None
) -> list[OrderPoles]:
    """Return one `OrderPoles` a row, orders 2, 3, ..."""
    return [
        OrderPoles(
            order + 2,
            np.array(row, complex),
            np.array(shapes[order], complex)
            if shapes
            else np.ones((len(row), 1), complex),
        )
        for order, row in enumerate(rows)
    ]


def test_a_pole_that_comes_back_is_stable_from_its_second_order_on() -> None:
    """Three orders with the same pole: unstable, stable, stable."""
    table = stabilise(table_of([[pole(100.0, 0.01)]] * 3))
    assert table.stable.tolist() == [False, True, True]
    assert np.all(table.track == table.track[0])


def test_frequency_and_damping_are_judged_apart() -> None:
    """Frequency moves by 0.1 %, damping by 50 %: limits 0.2 % and 15 %."""
    table = stabilise(table_of([[pole(100.0, 0.010)], [pole(100.1, 0.015)]]))
    assert table.stable_frequency.tolist() == [False, True]
    assert table.stable_damping.tolist() == [False, False]


def test_a_changed_shape_makes_a_pole_unstable() -> None:
    """Same frequency and damping, shapes at right angles."""
    rows = [[pole(100.0, 0.01)], [pole(100.0, 0.01)]]
    table = stabilise(table_of(rows, [[[1.0, 0.0]], [[0.0, 1.0]]]))
    assert table.stable_frequency.tolist() == [False, True]
    assert table.stable_shape.tolist() == [False, False]


def test_a_close_pair_stays_two_tracks() -> None:
    """455 and 458.5 Hz, both in every order, wandering by 0.1 Hz."""
    rng = np.random.default_rng(0)
    rows = [
        [pole(455.0 + d[0], 0.007), pole(458.5 + d[1], 0.011)]
        for d in 0.1 * rng.normal(size=(20, 2))
    ]
    found = candidates(stabilise(table_of(rows)))
    frequency = [abs(c.pole) / (2.0 * np.pi) for c in found]
    assert frequency == pytest.approx([455.0, 458.5], abs=0.1)


def test_a_track_survives_orders_without_its_pole() -> None:
    """Missing twice in the middle, it is still one candidate."""
    here, gone = [pole(100.0, 0.01)], list[complex]()
    table = stabilise(table_of([here, here, here, gone, gone, here, here, here]))
    assert len(candidates(table)) == 1
    assert np.unique(table.track).size == 1


def test_wandering_poles_are_no_candidates() -> None:
    """Fresh random poles at each of 40 orders."""
    rng = np.random.default_rng(1)
    rows = [[pole(rng.uniform(100, 5000), 0.01)] for _ in range(40)]
    assert candidates(stabilise(table_of(rows))) == ()


def test_heavily_damped_poles_are_left_out_of_the_table() -> None:
    """25 % with a limit of 20 %."""
    table = stabilise(table_of([[pole(100.0, 0.01), pole(500.0, 0.25)]] * 3))
    assert table.frequency == pytest.approx([100.0] * 3)


def test_a_short_track_is_no_candidate() -> None:
    """Stable at 3 of 50 orders where 10 % are asked for."""
    rows = [[pole(100.0, 0.01)]] * 50
    for row in (5, 6, 7, 8):
        rows[row] = [pole(100.0, 0.01), pole(300.0, 0.01)]
    found = candidates(stabilise(table_of(rows)), StabilityLimits(persistence=0.1))
    assert [round(abs(c.pole) / (2 * np.pi)) for c in found] == [100]


def test_a_narrow_late_pole_inside_a_broad_steady_one_is_a_splinter() -> None:
    """2 % over 50 orders with 0.5 % on its flank over the last 10."""
    broad, narrow = pole(1000.0, 0.02), pole(1010.0, 0.005)
    rows = [[broad]] * 40 + [[broad, narrow]] * 10
    (found,) = candidates(stabilise(table_of(rows)))
    assert found.pole == pytest.approx(broad)


def test_no_poles_at_all_make_an_empty_table() -> None:
    """Noise may leave nothing inside the circle."""
    table = stabilise(table_of([[], [], []]))
    assert table.order.size == 0
    assert candidates(table) == ()


def test_mac_is_blind_to_scale_and_phase_and_zero_at_right_angles() -> None:
    """By definition."""
    shape = np.array([1.0, 2.0, -1.0], complex)
    assert mac(shape, 3j * shape) == pytest.approx(1.0)
    assert mac(shape, np.array([1.0, 0.0, 1.0], complex)) == pytest.approx(0.0)


def test_a_pole_between_two_tracks_goes_to_the_one_that_wanders() -> None:
    """0.09 Hz off a track that stands still, 0.19 off one that moves by 0.15 Hz."""
    rows = [
        [pole(100.0, 0.01), pole(100.2 + 0.075 * (-1.0) ** k, 0.01)] for k in range(21)
    ]
    table = stabilise(table_of([*rows, [pole(100.09, 0.01)]]))
    still, wandering = table.track[:2]
    assert table.frequency[1] > table.frequency[0]
    assert still != wandering
    assert table.track[-1] == wandering
