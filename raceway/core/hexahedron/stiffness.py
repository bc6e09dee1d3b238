"""Element stiffness matrices, and their sum straight into a compressed sparse matrix."""

import numpy as np
from numba import float64, int32, int64, uint32, void

from raceway.core.hexahedron.shape import HOURGLASS
from raceway.core.hexahedron.strain import COLUMNS, strain_matrices
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR

_CELLS = uint32[:, ::1]


@jit(void(VECTOR, CUBE, int64, float64, MATRIX))
def stress_rows(moduli, B, point, weight, out):
    """weight times stress for every column of strains: out (6, 33) [N m, over the unit of a column]."""
    lame, shear = moduli[0] * weight, moduli[1] * weight
    for j in range(COLUMNS):
        bulk = lame * (B[point, 0, j] + B[point, 1, j] + B[point, 2, j])
        for k in range(3):
            out[k, j] = bulk + 2.0 * shear * B[point, k, j]
            out[3 + k, j] = shear * B[point, 3 + k, j]


@jit(void(VECTOR, MATRIX, MATRIX, float64, MATRIX))
def add_hourglass(moduli, x, mean, volume, K):
    """Add the hourglass stiffness of the one-point element; see ``raceway.core.hexahedron.one_point``."""
    squares = 0.0
    for n in range(8):
        for k in range(3):
            squares += mean[n, k] * mean[n, k]
    factor = moduli[2] * squares * volume / 8.0
    for a in range(4):
        slope_x, slope_y, slope_z = 0.0, 0.0, 0.0
        for n in range(8):
            slope_x += HOURGLASS[n, a] * x[n, 0]
            slope_y += HOURGLASS[n, a] * x[n, 1]
            slope_z += HOURGLASS[n, a] * x[n, 2]
        for i in range(8):
            left = HOURGLASS[i, a] - slope_x * mean[i, 0] - slope_y * mean[i, 1] - slope_z * mean[i, 2]
            for j in range(8):
                right = HOURGLASS[j, a] - slope_x * mean[j, 0] - slope_y * mean[j, 1] - slope_z * mean[j, 2]
                for k in range(3):
                    K[3 * i + k, 3 * j + k] += factor * left * right


@jit(void(int64, VECTOR, MATRIX, MATRIX, MATRIX, CUBE, VECTOR, MATRIX, MATRIX))
def element_stiffness(kind, moduli, x, inverse, mean, B, weight, rows, K):
    """Stiffness of one element: the first 24 rows and columns of K (33, 33) [N/m]; the other arrays are work space."""
    points = strain_matrices(kind, x, inverse, mean, B, weight)
    columns = COLUMNS if kind == 2 else 24
    K[:, :] = 0.0
    for g in range(points):
        stress_rows(moduli, B, g, weight[g], rows)
        for i in range(columns):
            for s in range(6):
                factor = B[g, s, i]
                if factor != 0.0:
                    for j in range(columns):
                        K[i, j] += factor * rows[s, j]
    if kind == 0:
        add_hourglass(moduli, x, mean, weight[0], K)
    for pivot in range(columns - 1, 23, -1):  # the incompatible modes carry no load: they are eliminated
        for i in range(pivot):
            factor = K[i, pivot] / K[pivot, pivot]
            for j in range(pivot):
                K[i, j] -= factor * K[pivot, j]


@jit(void(int64, int64, int64, VECTOR, _CELLS, MATRIX, CUBE), allocates=True, releases=True)
def stiffnesses(kind, first, last, moduli, cells, points, out):
    """Stiffness matrices of the elements ``first`` to ``last - 1``: out (last - first, 24, 24) [N/m]."""
    x, inverse, mean, weight = np.empty((8, 3)), np.empty((3, 3)), np.empty((8, 3)), np.empty(8)
    B, rows, K = np.zeros((8, 6, COLUMNS)), np.zeros((6, COLUMNS)), np.empty((COLUMNS, COLUMNS))
    for e in range(first, last):
        for n in range(8):
            for k in range(3):
                x[n, k] = points[cells[e, n], k]
        element_stiffness(kind, moduli, x, inverse, mean, B, weight, rows, K)
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
