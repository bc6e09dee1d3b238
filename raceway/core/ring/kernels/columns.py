"""What the columns of ``ball`` mean and how many rows ``work`` has, told by the system's constants.

Notes
-----
Columns 0 and 1 of a ball are positions; columns 2 and 3 are slips where there is friction; then come, of condensed bodies,
two structural approaches and, where balls act on each other through the rings, two displacements of groove centres.  All
but slips have rates, slips are only committed.
"""

from numba import boolean, float64, int64, void

from raceway.core.jit import jit
from raceway.core.ring.kernels import WORK_ROWS
from raceway.core.ring.kernels.layout import SCALARS
from raceway.core.ring.kernels.structural_rows import ELASTIC_ROWS
from raceway.core.signatures import MATRIX, VECTOR

#: Entries of ``scalars`` beyond the rigid ones: compliance of a ball by the load on its other race [m/N]; 1 where balls act
#: on each other through the rings; balls of a row; first angle [rad] and distance of the table's angles, their number n;
#: then the table: inner compliance (n,), its slopes by angle over that distance (n,), and both again for the outer race.
#: Where balls act on each other, ``BLOCK`` numbers follow for each distance of two balls, 0 to Z - 1, see ``between``.
BALL_CROSS, COUPLED, ROW, FIRST, DISTANCE, KNOTS, VALUES = range(SCALARS, SCALARS + 7)
BLOCK = 5
#: Column of ``ball`` that the slips of friction begin at, inner and outer contact [m].
SLIPS = 2


@jit(boolean(VECTOR))
def are_condensed(scalars):
    """Whether these constants belong to condensed bodies."""
    return scalars.size > SCALARS


@jit(int64(VECTOR))
def elastic_columns(scalars):
    """Columns of ``ball`` for the elasticity of the bodies, the last ones."""
    if not are_condensed(scalars):
        return 0
    return 4 if scalars[COUPLED] != 0.0 else 2


@jit(int64(VECTOR, MATRIX))
def work_rows(scalars, table):
    """Rows of ``work`` that a system needs."""
    if not are_condensed(scalars):
        return WORK_ROWS
    return WORK_ROWS + ELASTIC_ROWS + 2 * table.shape[0]


@jit(int64(VECTOR, MATRIX))
def slips_end(scalars, ball):
    """The column after the slips, which begin at ``SLIPS``."""
    return ball.shape[1] - elastic_columns(scalars)


@jit(void(VECTOR, MATRIX, MATRIX))
def keep_slips(scalars, ball, known):
    """known, like ball: zeros, and the committed slips: what is known of the rates of balls at rest."""
    end = slips_end(scalars, ball)
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            known[k, c] = ball[k, c] if 2 <= c < end else 0.0


@jit(void(VECTOR, float64, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def next_balls(scalars, dt, ball, before, known, trial):
    """First guess of the balls after a step, and the part of their rates that is known by then.

    Notes
    -----
    Rates follow the second-order backward difference (1.5 new - 2 now + 0.5 before) / dt.
    """
    end, inverse = slips_end(scalars, ball), 1.0 / dt
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            now, last = ball[k, c], before[k, c]
            committed = SLIPS <= c < end
            known[k, c] = now if committed else (0.5 * last - 2.0 * now) * inverse
            trial[k, c] = now if committed else 2.0 * now - last


@jit(void(VECTOR, float64, MATRIX, MATRIX, MATRIX, MATRIX), inline=True)
def accept_balls(scalars, dt, ball, before, known, trial):
    """Commit ``trial``, then what ``next_balls`` gives for the step after it: in one pass."""
    end, inverse = slips_end(scalars, ball), 1.0 / dt
    for k in range(ball.shape[0]):
        for c in range(ball.shape[1]):
            now, last = trial[k, c], ball[k, c]
            committed = SLIPS <= c < end
            before[k, c], ball[k, c] = last, now
            known[k, c] = now if committed else (0.5 * last - 2.0 * now) * inverse
            trial[k, c] = now if committed else 2.0 * now - last
