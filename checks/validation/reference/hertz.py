"""Exact elliptic Hertz contact by quadrature: the integrals are done numerically, the ellipse found by brentq."""

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq


def integrals(ratio: float) -> tuple[float, float]:
    """Complete elliptic integrals (first, second kind) of an ellipse with b/a = ratio, by quadrature."""
    m = 1.0 - ratio**2
    first = quad(lambda t: 1.0 / np.sqrt(1.0 - m * np.sin(t) ** 2), 0.0, np.pi / 2, epsabs=0, epsrel=1e-11)[0]
    second = quad(lambda t: np.sqrt(1.0 - m * np.sin(t) ** 2), 0.0, np.pi / 2, epsabs=0, epsrel=1e-11)[0]
    return first, second


def contact(curvature_a: float, curvature_b: float, modulus: float, load: float) -> dict[str, float]:
    """Semi-axes a, b [m], approach [m] and peak pressure p0 [Pa] for a gap A x^2 + B y^2 (A <= B) under a load [N].

    With e^2 = 1 - (b/a)^2 and p0 = 3 Q / (2 pi a b), integrating the half-space's displacement over the ellipse gives
    A = p0 b (K - E) / (E* e^2 a^2), B = p0 b (a^2/b^2 E - K) / (E* e^2 a^2), approach = p0 b K / E*.
    Johnson, Contact Mechanics (1985), equations 3.65 to 3.69 and 4.26 (E* as there).
    """

    def mismatch(ratio: float) -> float:
        first, second = integrals(ratio)
        return (second / ratio**2 - first) / (first - second) - curvature_b / curvature_a

    ratio = 1.0 if curvature_b / curvature_a < 1.0 + 1e-9 else brentq(mismatch, 1e-4, 1.0 - 1e-9, xtol=1e-16, rtol=1e-14)
    first, second = integrals(ratio)
    # A + B = p0 b (E/ratio^2 - E) / (E* e^2 a^2) = p0 b E / (E* b^2), with p0 = 3 Q ratio / (2 pi b^2).
    b = (1.5 * load * ratio * second / (np.pi * modulus * (curvature_a + curvature_b))) ** (1.0 / 3.0)
    a = b / ratio
    p0 = 1.5 * load / (np.pi * a * b)
    return {"a": a, "b": b, "approach": p0 * b * first / modulus, "p0": p0}


def factor(curvature_a: float, curvature_b: float, modulus: float) -> float:
    """K [N/m^1.5] of Q = K delta^1.5."""
    return 1.0 / contact(curvature_a, curvature_b, modulus, 1.0)["approach"] ** 1.5
