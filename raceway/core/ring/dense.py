"""Linear algebra and copies inside compiled loops: no allocation, no LAPACK call.

Where an array is assigned to a slice of another, numba compiles the words of its error message, too: seconds.
"""

from numba import boolean, int64, void

from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR


@jit(boolean(MATRIX, VECTOR))
def solve(matrix, rhs):
    """Solve in place by Gaussian elimination with partial pivoting; ``rhs`` becomes the solution.

    Returns False when a pivot vanishes or is not a number; both arrays are then undefined.
    """
    n = rhs.size
    for column in range(n):
        pivot, largest = column, abs(matrix[column, column])
        for row in range(column + 1, n):
            if abs(matrix[row, column]) > largest:
                pivot, largest = row, abs(matrix[row, column])
        if not largest > 0.0:
            return False
        if pivot != column:
            for k in range(column, n):
                matrix[column, k], matrix[pivot, k] = matrix[pivot, k], matrix[column, k]
            rhs[column], rhs[pivot] = rhs[pivot], rhs[column]
        inverse = 1.0 / matrix[column, column]
        for row in range(column + 1, n):
            factor = matrix[row, column] * inverse
            if factor != 0.0:
                for k in range(column + 1, n):
                    matrix[row, k] -= factor * matrix[column, k]
                rhs[row] -= factor * rhs[column]
    for row in range(n - 1, -1, -1):
        total = rhs[row]
        for k in range(row + 1, n):
            total -= matrix[row, k] * rhs[k]
        rhs[row] = total / matrix[row, row]
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
    """target[:, :] = source."""
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
