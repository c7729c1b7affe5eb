# SPDX-License-Identifier: MIT
"""The compiled closing of joints, and of what is added to bodies, line by line.

Complex values are held as real and imaginary parts, and of each line all force columns
are moved by the same instructions. Arrays of one line stay in the cache, where products
of arrays of all lines are bound by memory.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.residuals.slopes import SlopeArray

Planes = tuple[FloatArray, FloatArray]
"""Real and imaginary parts."""
Interfaces = tuple[ComplexArray, FloatArray, ComplexArray, ComplexArray, FloatArray]
"""Compliance of each joint, shape (n_lines, n_joints); what couples the normal ones, of
all bolts or none, shape (n, n), and its factor, shape (n_lines,); stiffness of each
attached thing, shape (n_lines, n_attached), and between tuned modes, (n, n)."""
_Work = tuple[Planes, Planes, tuple[FloatArray, FloatArray, FloatArray, FloatArray]]
_EACH, _NORMAL = 3, 2  # freedoms of a bolt, and the one along it
_FMA = {"contract"}  # NaN stays NaN, which other options of fastmath do not promise


@compiled(fastmath=_FMA, error_model="numpy")
def _take(
    factor: tuple[float, float],
    source: Planes,
    target: Planes,
) -> None:
    """Take a complex multiple of a row from another row, both of shape (n,)."""
    re, im = factor
    a, b = source
    c, d = target
    for k in range(a.size):
        c[k] -= re * a[k] - im * b[k]
        d[k] -= re * b[k] + im * a[k]


@compiled(fastmath=_FMA, error_model="numpy")
def _solve(re: FloatArray, im: FloatArray) -> None:
    """Solve a system in place by Gauss and Jordan, with row pivoting.

    Args:
        re: real part of the matrix with its right-hand sides, shape (n, n + n_right);
            these become the solutions.
        im: imaginary part.
    """
    n, width = re.shape
    for k in range(n):
        best, largest = k, abs(re[k, k]) + abs(im[k, k])
        for i in range(k + 1, n):
            size = abs(re[i, k]) + abs(im[i, k])
            if size > largest:
                best, largest = i, size
        if best != k:
            for j in range(k, width):
                re[k, j], re[best, j] = re[best, j], re[k, j]
                im[k, j], im[best, j] = im[best, j], im[k, j]
        square = re[k, k] ** 2 + im[k, k] ** 2
        a, b = re[k, k] / square, -im[k, k] / square
        for j in range(k + 1, width):
            x, y = re[k, j], im[k, j]
            re[k, j] = a * x - b * y
            im[k, j] = a * y + b * x
        source = re[k, k + 1 :], im[k, k + 1 :]
        for i in range(n):
            if i != k:
                target = re[i, k + 1 :], im[i, k + 1 :]
                _take((re[i, k], im[i, k]), source, target)


@compiled(fastmath=_FMA, error_model="numpy")
def _spread(
    row: FloatArray, count: int, between: FloatArray, across: FloatArray
) -> None:
    """Write the sums of one line into matrices.

    Args:
        row: sums between interfaces, upper triangle by rows, then of each interface
            with each column.
        count: interfaces.
        between: shape (count, count), written.
        across: shape (count, n_columns), written.
    """
    at = 0
    for i in range(count):
        for j in range(i, count):
            between[i, j] = between[j, i] = row[at]
            at += 1
    for i in range(count):
        for j in range(across.shape[1]):
            across[i, j] = row[at]
            at += 1


@compiled(fastmath=_FMA, error_model="numpy")
def _closed(
    line: int,
    interfaces: Interfaces,
    between: Planes,
    across: Planes,
    work: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Write the forces at the interfaces per unit of each column.

    Args:
        line: index of the line.
        interfaces: what holds them.
        between: displacement of interfaces per force across them, nothing closed,
            shape (n_interfaces, n_interfaces).
        across: the same per unit of each column, shape (n_interfaces, n_columns); the
            forces take its place.
        work: systems of the joints, shape (n_joints, n_joints + n_added + n_columns),
            and of what is added, shape (n_added, n_added + n_columns).
    """
    compliance, coupled, loss, attached, tuned = interfaces
    joint_re, joint_im = work[:2]
    joints, added, columns = len(joint_re), len(work[2]), across[0].shape[1]
    for part, whole, system in (
        (between[0], across[0], joint_re),
        (between[1], across[1], joint_im),
    ):
        for i in range(joints):
            for j in range(joints + added):
                system[i, j] = part[i, j]
            for j in range(columns):
                system[i, joints + added + j] = whole[i, j]
    for i in range(joints):
        joint_re[i, i] += compliance[line, i].real
        joint_im[i, i] += compliance[line, i].imag
    for i in range(len(coupled)):
        for j in range(len(coupled)):
            one = coupled[i, j] / loss[line]
            row, column = _EACH * i + _NORMAL, _EACH * j + _NORMAL
            joint_re[row, column] += one.real
            joint_im[row, column] += one.imag
    _solve(joint_re, joint_im)
    if added:
        _close_added(line, (attached, tuned), between, across, work)
    for i in range(joints):
        for j in range(columns):
            across[0][i, j] = joint_re[i, joints + added + j]
            across[1][i, j] = joint_im[i, joints + added + j]


@compiled(fastmath=_FMA, error_model="numpy")
def _close_added(
    line: int,
    stiffness: tuple[ComplexArray, FloatArray],
    between: Planes,
    across: Planes,
    work: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Write the forces of what is added, and correct those of the joints for them.

    Args:
        line: index of the line.
        stiffness: of each attached thing on all lines, and between tuned modes.
        between: as in `_closed`.
        across: as in `_closed`, its rows of what is added written.
        work: as in `_closed`, the system of the joints solved.
    """
    attached, tuned = stiffness
    joint_re, joint_im, added_re, added_im = work
    joints, added, columns = len(joint_re), len(added_re), across[0].shape[1]
    things = attached.shape[1]
    # Displacement of what is added, joints closed, by itself and by each column.
    for i in range(added):
        for j in range(added):
            added_re[i, j] = between[0][joints + i, joints + j]
            added_im[i, j] = between[1][joints + i, joints + j]
        for j in range(columns):
            added_re[i, added + j] = across[0][joints + i, j]
            added_im[i, added + j] = across[1][joints + i, j]
        for k in range(joints):
            source = joint_re[k, joints:], joint_im[k, joints:]
            own = between[0][k, joints + i], between[1][k, joints + i]
            _take(own, source, (added_re[i], added_im[i]))
    for i in range(things):
        z = attached[line, i]
        for j in range(added + columns):
            x = z * complex(added_re[i, j], added_im[i, j])
            added_re[i, j], added_im[i, j] = x.real, x.imag
    for part in (added_re, added_im):
        moved = part[things:].copy()
        part[things:] = 0.0
        for i in range(len(tuned)):
            for k in range(len(tuned)):
                if tuned[i, k] != 0.0:
                    for j in range(added + columns):
                        part[things + i, j] += tuned[i, k] * moved[k, j]
    for i in range(added):
        added_re[i, i] += 1.0
    _solve(added_re, added_im)
    for i in range(added):
        force = added_re[i, added:], added_im[i, added:]
        for j in range(columns):
            across[0][joints + i, j], across[1][joints + i, j] = (
                force[0][j],
                force[1][j],
            )
        for k in range(joints):
            right = joint_re[k, joints + added :], joint_im[k, joints + added :]
            _take((joint_re[k, joints + i], joint_im[k, joints + i]), force, right)


@compiled(fastmath=_FMA, error_model="numpy")
def _work_of(interfaces: Interfaces, columns: int) -> _Work:
    """Return what one line takes, unset: `between`, `across` and `work` of `_closed`.

    Args:
        interfaces: what holds them.
        columns: force columns.
    """
    compliance, _, _, attached, tuned = interfaces
    joints, added = compliance.shape[1], attached.shape[1] + len(tuned)
    count = joints + added
    between = np.empty((count, count)), np.empty((count, count))
    across = np.empty((count, columns)), np.empty((count, columns))
    whole, inner = (joints, count + columns), (added, added + columns)
    work = np.empty(whole), np.empty(whole), np.empty(inner), np.empty(inner)
    return between, across, work


@compiled(fastmath=_FMA, error_model="numpy")
def forces_on_lines(
    sums: Planes, interfaces: Interfaces, first: int, found: Planes
) -> None:
    """Write the forces at the interfaces per unit of each column, on some lines.

    Args:
        sums: over modes, of each line: as in `_spread`, shape (n_lines, n).
        interfaces: joints, then what is added, on the same lines.
        first: index of the first of these lines among all.
        found: forces on all lines, shape (n_interfaces, n_columns, n_all_lines).
    """
    count, columns, _ = found[0].shape
    between, across, work = _work_of(interfaces, columns)
    for line in range(len(interfaces[0])):
        _spread(sums[0][line], count, between[0], across[0])
        _spread(sums[1][line], count, between[1], across[1])
        _closed(line, interfaces, between, across, work)
        for i in range(count):
            for j in range(columns):
                found[0][i, j, first + line] = across[0][i, j]
                found[1][i, j, first + line] = across[1][i, j]


@compiled(fastmath=_FMA, error_model="numpy")
def responses_on_lines(
    sums: Planes, interfaces: Interfaces, shape: tuple[int, int], found: ComplexArray
) -> None:
    """Write the response of rows to columns, everything closed, on some lines.

    Responses are reciprocal, so the fewer ones of rows and columns are closed.

    Args:
        sums: over modes, of each line: as in `_spread`, with the fewer ones as columns,
            then of each interface with each of the others, then of each of the fewer
            ones with each of the others, shape (n_lines, n).
        interfaces: joints, then what is added, on the same lines.
        shape: how many the fewer ones are, and the others.
        found: displacement per force, shape (n_lines, n_fewer, n_others), written.
    """
    fewer, others = shape
    between, across, work = _work_of(interfaces, fewer)
    count = len(between[0])
    own = np.empty(others), np.empty(others)
    for line in range(len(interfaces[0])):
        re, im = sums[0][line], sums[1][line]
        _spread(re, count, between[0], across[0])
        _spread(im, count, between[1], across[1])
        _closed(line, interfaces, between, across, work)
        ends = count * (count + 1) // 2 + count * fewer
        direct = ends + count * others
        for i in range(fewer):
            at = direct + i * others
            own[0][:] = re[at : at + others]
            own[1][:] = im[at : at + others]
            for k in range(count):
                some = slice(ends + k * others, ends + (k + 1) * others)
                factor = across[0][k, i], across[1][k, i]
                _take(factor, (re[some], im[some]), own)
            for j in range(others):
                found[line, i, j] = complex(own[0][j], own[1][j])


@compiled(fastmath=_FMA, error_model="numpy")
def summed_products(
    left: Planes,
    right: Planes,
    chosen: IntArray,
    records: tuple[IntArray, IntArray, ComplexArray],
    found: ComplexArray,
) -> None:
    """Write the sums of products of rows and columns of records, on all lines.

    Args:
        left: of each row, shape (n, n_rows, n_lines).
        right: of each distinct column, shape (n_all, n_columns, n_lines); those of
            no record are passed over.
        chosen: which of all belong to the n, shape (n,).
        records: some of all, shape (n_records,), the column of each, likewise, and its
            factor on each line, shape (n_records, n_lines).
        found: of all records, shape (n_all_records, n_rows, n_lines or more), written.
    """
    own, column_of, force = records
    count, rows, lines = left[0].shape
    re, im = np.empty(lines), np.empty(lines)
    for column in range(right[0].shape[1]):
        if not np.any(column_of == column):
            continue
        for r in range(rows):
            re[:] = 0.0
            im[:] = 0.0
            for q in range(count):
                a, b = left[0][q, r], left[1][q, r]
                c, d = right[0][chosen[q], column], right[1][chosen[q], column]
                for k in range(lines):
                    re[k] += a[k] * c[k] - b[k] * d[k]
                    im[k] += a[k] * d[k] + b[k] * c[k]
            for record in range(len(own)):
                if column_of[record] == column:
                    target, factor = found[own[record], r], force[record]
                    for k in range(lines):
                        target[k] = complex(re[k], im[k]) * factor[k]


@compiled(fastmath=_FMA, error_model="numpy")
def multiplied(planes: Planes, factor: ComplexArray) -> Planes:
    """Return planes times a factor that is the same for all columns.

    Args:
        planes: shape (n, n_columns, n_lines).
        factor: shape (n, n_lines).
    """
    a, b = planes
    re, im = np.empty(a.shape), np.empty(a.shape)
    for m in range(a.shape[0]):
        own = factor[m]
        for j in range(a.shape[1]):
            for k in range(a.shape[2]):
                x, y, z = a[m, j, k], b[m, j, k], own[k]
                re[m, j, k] = x * z.real - y * z.imag
                im[m, j, k] = x * z.imag + y * z.real
    return re, im


@compiled(fastmath=_FMA, error_model="numpy")
def write_over(
    values: FloatArray, growth: FloatArray, sigma: FloatArray, found: SlopeArray
) -> None:
    """Write records over their sd, what damps the line removed.

    Args:
        values: on the damped line, shape (n_records, n_channels, n or more).
        growth: factor that removes the damping, shape (n,) or more.
        sigma: of each record and channel, shape (n_records, n_channels).
        found: shape (n_records, n_channels, n), written.
    """
    records, channels, count = found.shape
    for r in range(records):
        for c in range(channels):
            share = 1.0 / sigma[r, c]
            source, target = values[r, c], found[r, c]
            for k in range(count):
                target[k] = source[k] * (growth[k] * share)
