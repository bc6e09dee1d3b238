"""What damped contacts add to the stiffness against small harmonic motions, the balls condensed out at their frequency.

In a motion with exp(g t) contact k answers with k + g c.  Condensing the balls of ring coordinates q and places p gives the matrix
S(g) = H_qq - H_qp H_pp^-1 H_pq with H(g) = K + g C, and j w S is wanted at.  For real g > 0 compiled kernels give S exactly (a time
step needs it).  S is a rational function whose poles are the balls' rates of decay, in the left half plane: the barycentric rational
function through values on the positive axis continues it to the imaginary one, to rounding.  With K and C condensed each, j w C is
right for w -> 0 only.

Nakatsukasa, Sete, Trefethen, The AAA algorithm for rational approximation, SIAM J. Sci. Comput. 40 (2018), eq. 2.4 and section 3
(weights from the null space of the Loewner matrix).
"""

from collections.abc import Callable

import numpy as np

#: Rates that S is evaluated at, over the frequency; every other one is a support point, a degree up to 12 (balls loaded alike
#: need 1 or 2).  Off complex arithmetic by 3e-12 of S at w c / k = 0.3, balls all loaded differently; by 1e-9 above 1.
_RATES = np.geomspace(0.0625, 16.0, 25)
#: Rounding of S over S, below which the degree of the rational function is not resolved further, and nothing beside K + g C is.
_ROUNDING, _LINEAR = 1e-13, 1e-12


def viscous_stiffness(
    stiffness: Callable[[float], np.ndarray], damping: np.ndarray, frequency: float, cage: float = 0.0
) -> np.ndarray:
    """S(j w) - S(0) (5, 5) from ``stiffness``, S at real rates [1/s].

    damping : (5, 5) of slow motions, dS/dg at 0 [N s/m, ...]
    frequency : w [rad/s];  cage : speed of orbiting balls [rad/s]

    Orbiting balls see a forward motion (z = -j y) at w less the cage speed, and a backward one at w plus it; axial motions at w.
    That is exact where balls are loaded alike; where they are not, parts that couple these motions are left out.
    """
    static, fastest = stiffness(0.0), abs(frequency) + abs(cage)
    size = np.sqrt(np.abs(np.diag(static)))
    linear = (np.abs(stiffness(fastest) - static - fastest * damping) <= _LINEAR * np.outer(size, size)).all()

    def change(w: float) -> np.ndarray:
        return 1j * w * damping if linear else _continuation(stiffness, w) - static

    if cage == 0.0:
        return change(frequency)
    forward = np.zeros((5, 5), dtype=complex)
    forward[1:3, 1:3] = forward[3:, 3:] = [[0.5, 0.5j], [-0.5j, 0.5]]
    axial = np.diag([1.0, 0.0, 0.0, 0.0, 0.0])
    parts = ((axial, frequency), (forward, frequency - cage), (forward.conj(), frequency + cage))
    return np.asarray(sum(part @ change(w) @ part for part, w in parts))


def _continuation(stiffness: Callable[[float], np.ndarray], frequency: float) -> np.ndarray:
    """S(j w) from S on the positive axis."""
    values = np.array([stiffness(abs(frequency) * rate) for rate in _RATES])
    size = np.sqrt(np.abs(np.diagonal(values, axis1=1, axis2=2)).max(axis=0))
    size[size == 0.0] = 1.0
    unit_values = values / np.outer(size, size)
    support, targets = _RATES[::2], _RATES[1::2]
    loewner = (unit_values[1::2, None] - unit_values[::2]) / np.subtract.outer(targets, support)[:, :, None, None]
    _, singular, rows = np.linalg.svd(np.moveaxis(loewner, 1, -1).reshape(-1, len(support)), full_matrices=False)
    # Of all weights that interpolate to rounding those whose denominator is largest.
    null = rows[min(int((singular > _ROUNDING * max(singular[0], 1.0)).sum()), len(rows) - 1) :]
    distance = 1.0 / (1j - support)
    terms = (null.T @ (null @ distance.conj())) * distance
    value = np.tensordot(terms, values[::2], 1) / terms.sum()
    return np.asarray(value if frequency > 0.0 else value.conj())
