"""Element stiffness matrices, and their sum straight into a compressed sparse matrix."""

from typing import NamedTuple

import numpy as np
from numba import float64, int32, int64, types, uint32, uint64, void

from raceway.core.fem.hexahedron.strain import (
    COLUMNS,
    ELEMENT,
    gradient_modes,
    mean_gradient,
    modes,
    new_element,
    nodal,
    square,
    strain_matrices,
)
from raceway.core.fem.mesh.hex_mesh import HOURGLASS
from raceway.core.jit import jit
from raceway.core.ring.elimination import eliminate
from raceway.core.signatures import CUBE, MATRIX, VECTOR, record


@jit(void(VECTOR, CUBE, int64, float64, MATRIX))
def _stress_rows(moduli, B, point, weight, out):
    """weight times stress for every column of strains: out (6, 33) [N m, over the unit of a column]."""
    lame, shear = moduli[0] * weight, moduli[1] * weight
    for j in range(COLUMNS):
        bulk = lame * (B[point, 0, j] + B[point, 1, j] + B[point, 2, j])
        for k in range(3):
            out[k, j] = bulk + 2.0 * shear * B[point, k, j]
            out[3 + k, j] = shear * B[point, 3 + k, j]


@jit(void(int64, VECTOR, ELEMENT, MATRIX))
def _element_stiffness(kind, moduli, element, K):
    """Stiffness of one element from its corners: the first 24 rows and columns of K (33, 33) [N/m]."""
    points = strain_matrices(kind, element)
    x, mean, B, weight, _, rows = element
    columns = COLUMNS if kind == 2 else 24
    K[:, :] = 0.0
    for g in range(points):
        _stress_rows(moduli, B, g, weight[g], rows)
        for i in range(columns):
            for s in range(6):
                factor = B[g, s, i]
                if factor != 0.0:
                    for j in range(columns):
                        K[i, j] += factor * rows[s, j]
    if kind == 0:
        # The hourglass stiffness of the one-point element
        squares = 0.0
        for n in range(8):
            for k in range(3):
                squares += mean[n, k] * mean[n, k]
        hourglass = moduli[2] * squares * weight[0] / 8.0
        for a in range(4):
            slope_x, slope_y, slope_z = 0.0, 0.0, 0.0
            for n in range(8):
                slope_x += HOURGLASS[n, a] * x[n, 0]
                slope_y += HOURGLASS[n, a] * x[n, 1]
                slope_z += HOURGLASS[n, a] * x[n, 2]
            for i in range(8):
                gamma_i = HOURGLASS[i, a] - slope_x * mean[i, 0] - slope_y * mean[i, 1] - slope_z * mean[i, 2]
                for j in range(8):
                    gamma_j = HOURGLASS[j, a] - slope_x * mean[j, 0] - slope_y * mean[j, 1] - slope_z * mean[j, 2]
                    for k in range(3):
                        K[3 * i + k, 3 * j + k] += hourglass * gamma_i * gamma_j
    for pivot in range(columns - 1, 23, -1):  # the incompatible modes carry no load: they are eliminated
        for i in range(pivot):
            factor = K[i, pivot] / K[pivot, pivot]
            for j in range(pivot):
                K[i, j] -= factor * K[pivot, j]


class Mesh(NamedTuple):
    """Ranges (r, 5) of ``divide``, cells (m, 8), coordinates x (3 n,) node by node [m], moduli (3,) lambda, mu and
    hourglass (lambda + 2 mu) [Pa].
    """

    ranges: np.ndarray
    cells: np.ndarray
    x: np.ndarray
    moduli: np.ndarray


_CELLS = uint32[:, ::1]
_MESH = record(Mesh, int64[:, ::1], _CELLS, VECTOR, VECTOR)


@jit(void(int64, int64, int64, VECTOR, _CELLS, MATRIX, CUBE), allocates=True, releases=True)
def stiffnesses(kind, first, last, moduli, cells, points, out):
    """Stiffness matrices of the elements ``first`` to ``last - 1``: out (last - first, 24, 24) [N/m]."""
    element, K = new_element(), np.empty((COLUMNS, COLUMNS))
    for e in range(first, last):
        for n in range(8):
            for k in range(3):
                element.x[n, k] = points[cells[e, n], k]
        _element_stiffness(kind, moduli, element, K)
        for i in range(24):
            for j in range(24):
                out[e - first, i, j] = K[i, j]


@jit(void(int64, int64, CUBE, _CELLS, int64[::1], int32[::1], VECTOR))
def add_to_sparse(first, components, matrices, cells, starts, neighbours, data):
    """Add element matrices (k, 8 c, 8 c), c = ``components``, of the elements from ``first`` on.

    Node i's neighbours stand sorted in ``neighbours[starts[i] : starts[i + 1]]``; its c rows of ``data`` follow each other.
    """
    for e in range(matrices.shape[0]):
        for i in range(8):
            row = int64(cells[first + e, i])
            begin, count = starts[row], starts[row + 1] - starts[row]
            for j in range(8):
                column = int64(cells[first + e, j])
                low, high = begin, begin + count - 1
                while low < high:
                    middle = (low + high) // 2
                    if neighbours[middle] < column:
                        low = middle + 1
                    else:
                        high = middle
                for a in range(components):
                    at = components * (components * begin + a * count + low - begin)
                    for b in range(components):
                        data[at + b] += matrices[e, components * i + a, components * j + b]


#: Elements of a block.
WIDTH = 16
#: Numbers of a block: three coordinates and three displacements of eight nodes.
WORK = 48 * WIDTH

_W = float64[::1]

_THREE, _FOUR, _SIX, _SEVEN = (types.UniTuple(float64, count) for count in (3, 4, 6, 7))
_THREE_SEVEN = types.UniTuple(_SEVEN, 3)


@jit(_SEVEN(_W, uint64), inline=True)
def _load(w, at):
    """Modes of the eight nodal values that lie a block's width apart."""
    return modes((
        w[at], w[at + uint64(16)], w[at + uint64(32)], w[at + uint64(48)],
        w[at + uint64(64)], w[at + uint64(80)], w[at + uint64(96)], w[at + uint64(112)],
    ))  # fmt: skip


@jit(void(_W, uint64, _SEVEN), inline=True)
def _store(w, at, m):
    """The eight nodal values of seven modes, a block's width apart."""
    f0, f1, f2, f3, f4, f5, f6, f7 = nodal(m)
    w[at], w[at + uint64(16)], w[at + uint64(32)], w[at + uint64(48)] = f0, f1, f2, f3
    w[at + uint64(64)], w[at + uint64(80)], w[at + uint64(96)], w[at + uint64(112)] = f4, f5, f6, f7


@jit(_THREE(float64, types.UniTuple(_SIX, 3), _SEVEN), inline=True)
def _gradient(r, b, u):
    """Mean gradient of a field by its modes; r = 1 / (64 V)."""
    return r * mean_gradient(b[0], u), r * mean_gradient(b[1], u), r * mean_gradient(b[2], u)


@jit(_FOUR(float64, _THREE, _SEVEN, types.UniTuple(_SEVEN, 3)), inline=True)
def _hourglass(k, g, u, x):
    """Forces k gamma_a . u in the four hourglass modes: what the linear field of gradient g leaves of u."""
    return (
        k * (u[3] - g[0] * x[0][3] - g[1] * x[1][3] - g[2] * x[2][3]),
        k * (u[4] - g[0] * x[0][4] - g[1] * x[1][4] - g[2] * x[2][4]),
        k * (u[5] - g[0] * x[0][5] - g[1] * x[1][5] - g[2] * x[2][5]),
        k * (u[6] - g[0] * x[0][6] - g[1] * x[1][6] - g[2] * x[2][6]),
    )


@jit(float64(float64, _FOUR, _SEVEN), inline=True)
def _orthogonal(r, q, x):
    """What the hourglass forces q take off the stress along a coordinate, so that linear fields feel none of them."""
    return r * (q[0] * x[3] + q[1] * x[4] + q[2] * x[5] + q[3] * x[6])


@jit(_SEVEN(_THREE, types.UniTuple(_SIX, 3), _FOUR), inline=True)
def _force(s, b, q):
    """Modes of the nodal forces along one direction, of its stresses s and its hourglass forces q."""
    f, g, h = s
    x, y, z = b
    return (
        f * x[0] + g * y[0] + h * z[0], f * x[1] + g * y[1] + h * z[1], f * x[2] + g * y[2] + h * z[2],
        f * x[3] + g * y[3] + h * z[3] + q[0], f * x[4] + g * y[4] + h * z[4] + q[1],
        f * x[5] + g * y[5] + h * z[5] + q[2], q[3],
    )  # fmt: skip


@jit(_THREE_SEVEN(_THREE_SEVEN, _THREE_SEVEN, float64, float64, float64), inline=True)
def element_force(x, u, lame, shear, hourglass):
    """Modes of the nodal forces of one element along x, y and z, of those of its coordinates x [m] and displacements u [m].

    lame, shear, hourglass : lambda, mu and hourglass (lambda + 2 mu), each over 64 [Pa]
    """
    b = gradient_modes(x[1], x[2]), gradient_modes(x[2], x[0]), gradient_modes(x[0], x[1])
    r = 1.0 / mean_gradient(b[0], x[0])  # 1 / (64 V)
    k = hourglass * r * (square(b[0]) + square(b[1]) + square(b[2]))  # kappa / 8, as B:B = squares / 512
    gu, gv, gz = _gradient(r, b, u[0]), _gradient(r, b, u[1]), _gradient(r, b, u[2])
    bulk, twice = lame * (gu[0] + gv[1] + gz[2]), 2.0 * shear
    sxy, syz, szx = shear * (gu[1] + gv[0]), shear * (gv[2] + gz[1]), shear * (gu[2] + gz[0])
    q = _hourglass(k, gu, u[0], x)
    s = bulk + twice * gu[0] - _orthogonal(r, q, x[0]), sxy - _orthogonal(r, q, x[1]), szx - _orthogonal(r, q, x[2])
    along_x = _force(s, b, q)
    q = _hourglass(k, gv, u[1], x)
    s = sxy - _orthogonal(r, q, x[0]), bulk + twice * gv[1] - _orthogonal(r, q, x[1]), syz - _orthogonal(r, q, x[2])
    along_y = _force(s, b, q)
    q = _hourglass(k, gz, u[2], x)
    s = szx - _orthogonal(r, q, x[0]), syz - _orthogonal(r, q, x[1]), bulk + twice * gz[2] - _orthogonal(r, q, x[2])
    return along_x, along_y, _force(s, b, q)


@jit(void(_W, uint64, float64, float64, float64), inline=True)
def _block(w, base, lame, shear, hourglass):
    """Replace the displacements of 16 elements by their nodal forces.

    w : coordinate c of node I of element l at ``base + (8 c + I) WIDTH + l`` [m]; the displacements follow likewise [m]
    """
    for i in range(WIDTH):
        at = base + uint64(i)  # unsigned: numba then checks for no index from the end
        x = _load(w, at), _load(w, at + uint64(128)), _load(w, at + uint64(256))
        u = _load(w, at + uint64(384)), _load(w, at + uint64(512)), _load(w, at + uint64(640))
        f = element_force(x, u, lame, shear, hourglass)
        _store(w, at + uint64(384), f[0])
        _store(w, at + uint64(512), f[1])
        _store(w, at + uint64(640), f[2])


@jit(void(int64, _MESH, _W, _W, _W), releases=True)
def range_force(r, mesh, u, work, f):
    """Forces of one range of elements, into that range's part of ``f``.

    r : number of the range;  u : (3 n,) displacements, node by node [m]
    work : (ranges WORK,) scratch;  f : (3 places,) the part of this range is overwritten by its forces [N]

    With B_jI the integral of dN_I/dx_j over the element, V its volume and G = u B^T / V the mean displacement gradient,

        f_iI = sum_j sigma_ij(G) B_jI + kappa / 8 sum_a (gamma_a . u_i) gamma_aI,
        gamma_a = h_a - sum_j (h_a . x_j) B_j / V,   a = 4 ... 7,
        kappa = hourglass (lambda + 2 mu) B:B / V.

    gamma is orthogonal to every linear field, so the patch test holds and only the twelve hourglass modes feel kappa.
    Everything is done in modes (``raceway.core.fem.hexahedron.strain.modes``): nodes are met by additions only.

    Elements go through in blocks of 16, transposed into a structure of arrays, because LLVM then vectorises the loop over
    the block.  Blocks of 8 it unrolls instead, at three times the time.

    Flanagan, Belytschko, A uniform strain hexahedron and quadrilateral with orthogonal hourglass control, Int. J. Numer.
    Meth. Engng 17 (1981) 679-706.
    """
    ranges, cells, x, moduli = mesh
    first, last, node, end, offset = ranges[r, 0], ranges[r, 1], ranges[r, 2], ranges[r, 3], ranges[r, 4]
    for i in range(3 * offset, 3 * (offset + end - node)):
        f[i] = 0.0
    base = uint64(WORK * r)
    for begin in range(first, last, WIDTH):
        for i in range(WIDTH):
            e = uint64(min(begin + i, last - 1))  # the last block is filled up with its last element
            for j in range(8):
                to = base + uint64(WIDTH * j + i)
                n = uint64(3) * uint64(cells[e, uint64(j)])
                work[to], work[to + uint64(384)] = x[n], u[n]
                work[to + uint64(128)], work[to + uint64(512)] = x[n + uint64(1)], u[n + uint64(1)]
                work[to + uint64(256)], work[to + uint64(640)] = x[n + uint64(2)], u[n + uint64(2)]
        _block(work, base, moduli[0] / 64.0, moduli[1] / 64.0, moduli[2] / 64.0)
        for i in range(min(WIDTH, last - begin)):
            e = uint64(begin + i)
            for j in range(8):
                at = base + uint64(WIDTH * j + i + 384)
                n = uint64(3) * uint64(cells[e, uint64(j)] - node + offset)
                f[n] += work[at]
                f[n + uint64(1)] += work[at + uint64(128)]
                f[n + uint64(2)] += work[at + uint64(256)]


@jit(_SEVEN(uint32[:, ::1], int64, uint64, _W), inline=True)
def _component(cells, e, k, a):
    """Modes of component k of the nodal values of an element."""
    e, three = uint64(e), uint64(3)
    return modes((
        a[three * cells[e, 0] + k], a[three * cells[e, 1] + k], a[three * cells[e, 2] + k], a[three * cells[e, 3] + k],
        a[three * cells[e, 4] + k], a[three * cells[e, 5] + k], a[three * cells[e, 6] + k], a[three * cells[e, 7] + k],
    ))  # fmt: skip


@jit(_THREE_SEVEN(uint32[:, ::1], int64, _W), inline=True)
def corner_modes(cells, e, a):
    """Modes of the three components of the nodal values of an element."""
    return _component(cells, e, uint64(0), a), _component(cells, e, uint64(1), a), _component(cells, e, uint64(2), a)


@jit(float64(int64, _MESH, _W), releases=True)
def range_hourglass_energy(r, mesh, u):
    """Energy [J] that the hourglass control of one range of elements holds; arguments as of ``range_force``.

    kappa / 16 sum_ai (gamma_a . u_i)^2 an element: half of what its forces do on u.
    """
    ranges, cells, x, moduli = mesh
    total = 0.0
    for e in range(ranges[r, 0], ranges[r, 1]):
        at, moved = corner_modes(cells, e, x), corner_modes(cells, e, u)
        b = gradient_modes(at[1], at[2]), gradient_modes(at[2], at[0]), gradient_modes(at[0], at[1])
        over = 1.0 / mean_gradient(b[0], at[0])
        squares = 0.0
        for k in range(3):
            q = _hourglass(1.0, _gradient(over, b, moved[k]), moved[k], at)
            squares += q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
        total += 0.5 * (moduli[2] / 64.0) * over * (square(b[0]) + square(b[1]) + square(b[2])) * squares
    return total


@jit(void(VECTOR, CUBE, int64, float64, int64, VECTOR, VECTOR))
def _point_stress(moduli, B, point, weight, columns, values, stress):
    """weight times the stress (6,) of the first columns with these values."""
    xx, yy, zz, xy, yz, zx = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(columns):
        value = values[j]
        xx += B[point, 0, j] * value
        yy += B[point, 1, j] * value
        zz += B[point, 2, j] * value
        xy += B[point, 3, j] * value
        yz += B[point, 4, j] * value
        zx += B[point, 5, j] * value
    bulk, twice = moduli[0] * (xx + yy + zz), 2.0 * moduli[1]
    stress[0], stress[1] = weight * (bulk + twice * xx), weight * (bulk + twice * yy)
    stress[2] = weight * (bulk + twice * zz)
    stress[3], stress[4], stress[5] = weight * moduli[1] * xy, weight * moduli[1] * yz, weight * moduli[1] * zx


@jit(void(int64, VECTOR, ELEMENT, MATRIX, VECTOR, VECTOR))
def _relax_modes(points, moduli, element, square, stress, values):
    """The amplitudes of the nine incompatible modes, ``values[24:]``, at which they carry no load; square (9, 10) is scratch."""
    B, weight, rows = element.B, element.weight, element.rows
    square[:, :] = 0.0
    for g in range(points):
        _stress_rows(moduli, B, g, weight[g], rows)
        _point_stress(moduli, B, g, weight[g], 24, values, stress)
        for i in range(9):
            for s in range(6):
                square[i, 9] -= B[g, s, 24 + i] * stress[s]
                for j in range(9):
                    square[i, j] += B[g, s, 24 + i] * rows[s, 24 + j]
    eliminate(square)
    for i in range(9):
        values[24 + i] = square[i, 9]


@jit(void(int64, int64, _MESH, VECTOR, VECTOR), allocates=True, releases=True)
def range_point_force(kind, r, mesh, u, f):
    """Forces of one range of elements; see ``raceway.core.fem.hexahedron.stiffness.range_force``.

    These are the elements for accuracy on coarse meshes; the loops are plain, one element after the other.
    """
    ranges, cells, x, moduli = mesh
    first, last, node, end, offset = ranges[r, 0], ranges[r, 1], ranges[r, 2], ranges[r, 3], ranges[r, 4]
    element, square = new_element(), np.empty((9, 10))
    values, stress = np.zeros(COLUMNS), np.empty(6)
    columns = COLUMNS if kind == 2 else 24
    f[3 * offset : 3 * (offset + end - node)] = 0.0
    for e in range(first, last):
        for n in range(8):
            for k in range(3):
                at = 3 * int64(cells[e, n]) + k
                element.x[n, k], values[3 * n + k] = x[at], u[at]
        count = strain_matrices(kind, element)
        if kind == 2:
            _relax_modes(count, moduli, element, square, stress, values)
        for g in range(count):
            _point_stress(moduli, element.B, g, element.weight[g], columns, values, stress)
            for n in range(8):
                at = 3 * (int64(cells[e, n]) - node + offset)
                for k in range(3):
                    for s in range(6):
                        f[at + k] += element.B[g, s, 3 * n + k] * stress[s]
