"""Internal force of the hexahedra with eight points: full, incompatible modes, mean dilatation.

These are the elements for accuracy on coarse meshes; the loops are plain, one element after the other.
"""

import numpy as np
from numba import float64, int64, uint32, void

from raceway.core.hexahedron.stiffness import stress_rows
from raceway.core.hexahedron.strain import COLUMNS, strain_matrices
from raceway.core.jit import jit
from raceway.core.ring.dense import solve
from raceway.core.signatures import CUBE, MATRIX, VECTOR


@jit(void(VECTOR, CUBE, int64, float64, int64, int64, VECTOR, VECTOR))
def point_stress(moduli, B, point, weight, first, last, values, stress):
    """weight times the stress (6,) of the columns ``first`` to ``last - 1`` with these values."""
    xx, yy, zz, xy, yz, zx = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(first, last):
        value = values[j]
        xx += B[point, 0, j] * value
        yy += B[point, 1, j] * value
        zz += B[point, 2, j] * value
        xy += B[point, 3, j] * value
        yz += B[point, 4, j] * value
        zx += B[point, 5, j] * value
    bulk, twice = moduli[0] * (xx + yy + zz), 2.0 * moduli[1]
    stress[0], stress[1], stress[2] = (
        weight * (bulk + twice * xx),
        weight * (bulk + twice * yy),
        weight * (bulk + twice * zz),
    )
    stress[3], stress[4], stress[5] = weight * moduli[1] * xy, weight * moduli[1] * yz, weight * moduli[1] * zx


@jit(void(int64, VECTOR, CUBE, VECTOR, MATRIX, MATRIX, VECTOR, VECTOR))
def _relax_modes(points, moduli, B, weight, rows, square, stress, values):
    """The amplitudes of the nine incompatible modes, ``values[24:]``, at which they carry no load."""
    square[:, :] = 0.0
    for i in range(9):
        values[24 + i] = 0.0
    load = values[24:]
    for g in range(points):
        stress_rows(moduli, B, g, weight[g], rows)
        point_stress(moduli, B, g, weight[g], 0, 24, values, stress)
        for i in range(9):
            for s in range(6):
                load[i] -= B[g, s, 24 + i] * stress[s]
                for j in range(9):
                    square[i, j] += B[g, s, 24 + i] * rows[s, 24 + j]
    solve(square, load)


@jit(void(int64, int64, int64[:, ::1], uint32[:, ::1], MATRIX, VECTOR, VECTOR, VECTOR), allocates=True, releases=True)
def range_point_force(kind, r, ranges, cells, points, u, moduli, f):
    """Forces of one range of elements; see ``raceway.core.hexahedron.one_point.range_force``."""
    first, last, node, end, place = ranges[r, 0], ranges[r, 1], ranges[r, 2], ranges[r, 3], ranges[r, 4]
    x, inverse, mean, weight = np.empty((8, 3)), np.empty((3, 3)), np.empty((8, 3)), np.empty(8)
    B, rows, square = np.zeros((8, 6, COLUMNS)), np.zeros((6, COLUMNS)), np.empty((9, 9))
    values, stress = np.zeros(COLUMNS), np.empty(6)
    columns = COLUMNS if kind == 2 else 24
    f[3 * place : 3 * (place + end - node)] = 0.0
    for e in range(first, last):
        for n in range(8):
            for k in range(3):
                x[n, k] = points[cells[e, n], k]
                values[3 * n + k] = u[3 * int64(cells[e, n]) + k]
        count = strain_matrices(kind, x, inverse, mean, B, weight)
        if kind == 2:
            _relax_modes(count, moduli, B, weight, rows, square, stress, values)
        for g in range(count):
            point_stress(moduli, B, g, weight[g], 0, columns, values, stress)
            for n in range(8):
                at = 3 * (int64(cells[e, n]) - node + place)
                for k in range(3):
                    for s in range(6):
                        f[at + k] += B[g, s, 3 * n + k] * stress[s]
