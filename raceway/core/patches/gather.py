"""Compliance of ball and race together between chosen points."""

from numba import void

from raceway.core.jit import jit
from raceway.core.patches.gap import INDEX
from raceway.core.signatures import CUBE, MATRIX, VECTOR


@jit(void(CUBE, CUBE, INDEX, INDEX, MATRIX))
def between(ball, race, to, of, out):
    """out (len(to), len(of)) [m/N]: displacement of points ``to`` by forces on points ``of``.

    Parameters
    ----------
    ball : (rows, n, n) by distance in rows;  race : (n, m, m) by distance in columns
    to, of : numbers k * n + i
    """
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            out[a, b] = ball[abs(k - q), i, j] + race[abs(i - j), k, q]


@jit(void(CUBE, CUBE, INDEX, INDEX, VECTOR, VECTOR))
def displaced(ball, race, to, of, load, out):
    """out (len(to),) [m]: displacement of points ``to`` by loads [N] on points ``of``."""
    n = ball.shape[1]
    for a in range(to.size):
        k, i = to[a] // n, to[a] % n
        total = 0.0
        for b in range(of.size):
            q, j = of[b] // n, of[b] % n
            total += (ball[abs(k - q), i, j] + race[abs(i - j), k, q]) * load[b]
        out[a] = total
