"""Small dense systems in kernels: elimination with pivots, Cholesky's factors, copies."""

from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.lanes import WIDTH, live_of, put, take
from raceway.core.signatures import CUBE, MATRIX, VECTOR


@jit(void(MATRIX, int64, int64, float64, int64))
def _subtract(matrix, row, other, factor, first):
    """matrix[row, first:] -= factor * matrix[other, first:]."""
    width, every = matrix.shape[1], live_of(0, WIDTH)
    whole = width - (width - first) % WIDTH
    for k in range(first, whole, WIDTH):
        put(matrix, row, k, every, take(matrix, row, k, every) - factor * take(matrix, other, k, every))
    for k in range(whole, width):
        matrix[row, k] -= factor * matrix[other, k]


@jit(boolean(MATRIX))
def _triangulate(matrix):
    """Gaussian elimination with partial pivoting of (n, n + k), a system and its k right sides; False where a pivot vanishes or is no number."""
    n, width = matrix.shape
    for column in range(n):
        pivot, largest = column, abs(matrix[column, column])
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > largest:
                pivot, largest = row, abs(matrix[row, column])
        if not largest > 0.0:
            return False
        if pivot != column:
            for k in range(column, width):
                matrix[column, k], matrix[pivot, k] = matrix[pivot, k], matrix[column, k]
        inverse = 1.0 / matrix[column, column]
        for row in range(column + 1, n):
            factor = matrix[row, column] * inverse
            if factor != 0.0:
                # What a block changes to the left of the diagonal is not read again.
                _subtract(matrix, row, column, factor, (column + 1) // WIDTH * WIDTH)
    return True


@jit(boolean(MATRIX))
def eliminate(matrix):
    """Solve in place: (n, n + k), a system and its k right sides, which become solutions, all of them at once.

    Returns False when a pivot vanishes or is not a number; the matrix is then undefined.
    """
    if not _triangulate(matrix):
        return False
    n, width = matrix.shape
    for row in range(n - 1, -1, -1):
        inverse = 1.0 / matrix[row, row]
        for k in range(n, width):
            matrix[row, k] *= inverse
        for above in range(row):
            factor = matrix[above, row]
            if factor != 0.0:
                _subtract(matrix, above, row, factor, n)
    return True


@jit(boolean(MATRIX))
def solve(matrix):
    """The same one right side after the other, which rounds otherwise: chaotic motions differ."""
    if not _triangulate(matrix):
        return False
    n, width = matrix.shape
    for k in range(n, width):
        for row in range(n - 1, -1, -1):
            total = matrix[row, k]
            for column in range(row + 1, n):
                total -= matrix[row, column] * matrix[column, k]
            matrix[row, k] = total / matrix[row, row]
    return True


@jit(boolean(MATRIX, VECTOR, int64))
def cholesky_solve(matrix, rhs, n):
    """Solve a symmetric positive definite system in place; False (undefined arrays) when it is not one."""
    for j in range(n):
        total = matrix[j, j]
        for k in range(j):
            total -= matrix[j, k] * matrix[j, k]
        if not total > 0.0:
            return False
        root = total**0.5
        matrix[j, j] = root
        for i in range(j + 1, n):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = total / root
    for i in range(n):
        total = rhs[i]
        for k in range(i):
            total -= matrix[i, k] * rhs[k]
        rhs[i] = total / matrix[i, i]
    for i in range(n - 1, -1, -1):
        total = rhs[i]
        for k in range(i + 1, n):
            total -= matrix[k, i] * rhs[k]
        rhs[i] = total / matrix[i, i]
    return True


@jit(void(MATRIX, MATRIX))
def copy_matrix(source, target):
    """target[:, :] = source.

    Where an array is assigned to a slice of another, numba compiles the words of its error message, too: seconds.
    """
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@jit(void(CUBE, CUBE))
def copy_cube(source, target):
    """target[:, :, :] = source."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            for k in range(source.shape[2]):
                target[i, j, k] = source[i, j, k]
