"""Peak pressure and semi-axes of whole contacts: Hertz's, or what follows from the force of a law that is a foundation."""

from __future__ import annotations

import numpy as np

from raceway.bodies.basis import Basis
from raceway.core.contact.hertz import Ellipse
from raceway.core.ring.ring import Ring
from raceway.core.ring.system import surrogate
from raceway.framework.duties import traits_of
from raceway.scene.scene import Scene

#: Halvings of an interval of approaches: to the last bit.
_HALVINGS = 80


def law_of_pair(ring: Ring, race: int, approach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (n,) [N] and stiffness (n,) [N/m] of the law at rest, for contacts of one race (0 inner, 1 outer).

    Parameters
    ----------
    approach : (n,) [m]
    """
    system, n = surrogate(ring), len(approach)
    row, z = race * system.ball_count, system.ball_count
    # A number of contacts that is that of the balls is theirs: rows may differ.
    chosen = np.arange(row, row + z) if n == z else np.full(n, row)
    params, state = (np.ascontiguousarray(each[chosen]) for each in (system.law_params, system.law_state))
    force, d_gap, d_rate = np.empty(n), np.empty(n), np.empty(n)
    system.law(-np.ascontiguousarray(approach), np.zeros(n), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return force, -d_gap


def approach_at(ring: Ring, diameter: float, race: int, load: np.ndarray) -> np.ndarray:
    """(n,) approach [m] at which the law gives a load (n,) [N], by bisection; 0 where there is none."""
    load = np.asarray(load, dtype=float)
    low, high = np.zeros_like(load), np.full_like(load, 1e-3 * diameter)
    while (short := law_of_pair(ring, race, high)[0] < load).any():
        high = np.where(short, 2.0 * high, high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = law_of_pair(ring, race, middle)[0] < load
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.where(load > 0.0, high, 0.0)


def contact_ellipse(
    scene: Scene, basis: Basis, ring: Ring, race: int, load: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Peak pressure (n,) [Pa] and semi-axes a, b (n,) [m] of the contacts of a race at loads (n,) [N].

    Notes
    -----
    Of a foundation, whose pressure p(g) follows from the overlap g at each place, the force on the overlap ellipse
    A x^2 + B y^2 <= delta is F = pi / sqrt(A B) int_0^delta p dg.  So the peak pressure is p(delta) = sqrt(A B) / pi dF/ddelta,
    and the semi-axes are sqrt(delta / A), sqrt(delta / B).
    """
    ellipse: Ellipse = (basis.inner, basis.outer)[race]
    contact = scene.contact
    if not scene.bearing.equal_rows and len(load) != len(basis.azimuth):
        # Loads of no particular balls: of the row in which they press hardest.
        each = [one.ellipses(basis.modulus)[race] for one in basis.geometries]
        ellipse = max(each, key=lambda one: float(one.peak_pressure(1.0)))
    if not traits_of(scene).resultants or not getattr(contact.law, "foundation", False):
        return ellipse.peak_pressure(load), *ellipse.semi_axes(load)
    a, b = ellipse.curvatures
    approach = approach_at(ring, basis.geometry.ball_diameter, race, load)
    slope = law_of_pair(ring, race, approach)[1]
    return np.sqrt(a * b) / np.pi * slope, np.sqrt(approach / a), np.sqrt(approach / b)
