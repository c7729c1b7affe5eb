# SPDX-License-Identifier: MIT
"""Roots of matrix polynomials of rising order, each order started from the last.

The poles of one order are nearly those of the order before. Ehrlich-Aberth iteration
uses that: all roots are refined at once, each repelled by the others so that no two
converge to one root, at a cost of n^2 per sweep where a companion matrix takes n^3.
What does not converge, or does not add up to the trace, is solved by LAPACK instead.

Source:
    Aberth, Math. Comp. 27 (1973) 339; Bini and Noferini, Linear Algebra Appl. 439
    (2013) 1130 (matrix polynomials).
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.basics.compiled import compiled

# Convergence is cubic: the next step is below rounding.
_SMALL_STEP = 1e-9
_SWEEPS = 30
# Roots of a monic polynomial add up to minus its next coefficient, within this.
_TRACE_ERROR = 1e-9
# Below this many roots a companion matrix is as fast.
_FEW = 8
# Inputs for which the determinant is written out.
_PAIR = 2


def inverse_roots(
    denominator: ComplexArray, start: ComplexArray | None = None
) -> ComplexArray:
    """Return 1/z for all roots z of det(I + A_1 z + ... + A_n z^n) = 0.

    Args:
        denominator: I, A_1, ..., A_n, shape (n + 1, m, m).
        start: the same of a lower order, shape (fewer than n m,), or None.

    Returns:
        Shape (n m,); unsorted. Inverse roots stay finite where A_n vanishes.
    """
    size = (denominator.shape[0] - 1) * denominator.shape[1]
    if start is None or size < _FEW:
        return companion_roots(denominator)
    guess = _grown(start, size)
    done = _polish(np.ascontiguousarray(denominator), guess, _SMALL_STEP, _SWEEPS)
    total = complex(np.trace(denominator[1]))
    error = abs(complex(guess.sum()) + total)
    if not done or not error <= _TRACE_ERROR * float(np.abs(guess).sum()):
        return companion_roots(denominator)
    return guess


def companion_roots(denominator: ComplexArray) -> ComplexArray:
    """Return the inverse roots by LAPACK, from the block companion matrix."""
    order, width = denominator.shape[0] - 1, denominator.shape[1]
    companion = np.eye(order * width, k=width, dtype=complex)
    last = -denominator[:0:-1].transpose(1, 0, 2).reshape(width, -1)
    companion[-width:] = last
    return np.asarray(np.linalg.eigvals(companion), np.complex128)


def _grown(start: ComplexArray, size: int) -> ComplexArray:
    """Add the extra roots of a higher order in the widest gaps of angle.

    An offset from the ring keeps them distinct.
    """
    roots = start
    radius = float(np.sort(np.abs(start))[start.size // 2])
    while roots.size < size:
        angle = np.sort(np.angle(roots))
        gap = np.empty(angle.size)
        gap[:-1] = angle[1:] - angle[:-1]
        gap[-1] = angle[0] + 2.0 * np.pi - angle[-1]
        few = min(size - roots.size, max(1, gap.size // 2))
        widest = np.argsort(gap)[::-1][:few]
        added = radius * np.exp(1j * (angle[widest] + 0.5 * gap[widest]))
        roots = np.concatenate((roots, added))
    return np.array(roots, np.complex128)


@compiled(error_model="numpy")
def _polish(
    denominator: ComplexArray, roots: ComplexArray, small: float, sweeps: int
) -> bool:
    """Refine all roots in place; return whether all converged."""
    moving = np.ones(roots.size, np.bool_)
    for _ in range(sweeps):
        left = 0
        for i in range(roots.size):
            if not moving[i]:
                continue
            root = roots[i]
            slope = _slope(denominator, root) - _push(roots, i)
            square = slope.real * slope.real + slope.imag * slope.imag
            # An infinite slope is at a root; a NaN has failed.
            change = slope.conjugate() / square if square < np.inf else 0.0j
            if not abs(change) < np.inf:
                return False
            roots[i] = root - change
            if abs(change) <= small * abs(root):
                moving[i] = False
            else:
                left += 1
        if left == 0:
            return True
    return False


@compiled(error_model="numpy")
def _push(roots: ComplexArray, i: int) -> complex:
    """Return the sum of 1 / (root i - root j) over all others, in real numbers."""
    root, along, across = roots[i], 0.0, 0.0
    for j in range(roots.size):
        if j != i:
            away = root - roots[j]
            inverse = 1.0 / (away.real * away.real + away.imag * away.imag)
            along += away.real * inverse
            across -= away.imag * inverse
    return complex(along, across)


@compiled(error_model="numpy")
def _slope(denominator: ComplexArray, root: complex) -> complex:
    """Return d/du log det B(u), B(u) = u^n I + A_1 u^(n - 1) + ... + A_n.

    Within the unit circle by Horner's rule on B; outside on A at z = 1 / u, where no
    power can overflow.
    """
    order, width = denominator.shape[0] - 1, denominator.shape[1]
    inside = abs(root) <= 1.0
    point = root if inside else 1.0 / root
    if width == _PAIR:
        trace = _pair_slope(denominator, point, inside)
        return trace if inside else complex(point * (order * width - point * trace))
    value = np.zeros((width, width), np.complex128)
    slope = np.zeros((width, width), np.complex128)
    for k in range(order + 1):
        row = k if inside else order - k
        for i in range(width):
            for j in range(width):
                slope[i, j] = slope[i, j] * point + value[i, j]
                value[i, j] = value[i, j] * point + denominator[row, i, j]
    trace = _log_slope(value, slope)
    return trace if inside else complex(point * (order * width - point * trace))


@compiled(error_model="numpy")
def _pair_slope(denominator: ComplexArray, point: complex, inside: bool) -> complex:
    """Return trace(value^-1 slope) for two inputs, all numbers in registers."""
    order = denominator.shape[0] - 1
    a = b = c = d = 0.0j
    da = db = dc = dd = 0.0j
    for k in range(order + 1):
        row = k if inside else order - k
        da, db = da * point + a, db * point + b
        dc, dd = dc * point + c, dd * point + d
        a = a * point + denominator[row, 0, 0]
        b = b * point + denominator[row, 0, 1]
        c = c * point + denominator[row, 1, 0]
        d = d * point + denominator[row, 1, 1]
    determinant = a * d - b * c
    if determinant == 0.0:
        return complex(np.inf, 0.0)
    return complex((d * da - c * db - b * dc + a * dd) / determinant)


@compiled(error_model="numpy")
def _log_slope(value: ComplexArray, slope: ComplexArray) -> complex:
    """Return trace(value^-1 slope) by elimination; both are overwritten."""
    width = value.shape[0]
    for k in range(width):
        best = k
        for i in range(k + 1, width):
            if abs(value[i, k]) > abs(value[best, k]):
                best = i
        for j in range(width):
            value[k, j], value[best, j] = value[best, j], value[k, j]
            slope[k, j], slope[best, j] = slope[best, j], slope[k, j]
        if value[k, k] == 0.0:
            return complex(np.inf, 0.0)
        for i in range(k + 1, width):
            share = value[i, k] / value[k, k]
            for j in range(k, width):
                value[i, j] -= share * value[k, j]
            for j in range(width):
                slope[i, j] -= share * slope[k, j]
    trace = 0.0j
    for k in range(width - 1, -1, -1):
        for j in range(width):
            total = slope[k, j]
            for i in range(k + 1, width):
                total -= value[k, i] * slope[i, j]
            slope[k, j] = total / value[k, k]
        trace += slope[k, k]
    return trace
