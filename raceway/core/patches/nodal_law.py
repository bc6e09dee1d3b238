"""Pressures by a contact law at every point: f = A p(w), w = g + C f, by Newton with the law's own derivative.

Notes
-----
With D = -A dp/dw the loads change by t with (1/D + C) t = w - g - C f over the points with D > 0: symmetric and positive
definite for every law that grows with the approach.  All gaps then become w = g + C (f + t).  The step is halved where the
residual grew.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import attrs
import numpy as np
from scipy.linalg import cho_factor, cho_solve

from raceway.core.patches.factor import Factor
from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from raceway.core.jit import Kernel

_LIMIT = 60
#: Residual of the gaps that counts as none, of the deepest overlap.
_TOLERANCE = 1e-11


@attrs.frozen(eq=False)
class PointLaw:
    """A law without memory at the points of one contact.

    Attributes
    ----------
    kernel : compiled ``LAW``;  params : (k,) of this contact;  area : of a point [m2]
    """

    kernel: Kernel
    params: np.ndarray
    area: float

    def __call__(self, gap: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces of points (n,) [N] and their derivatives by gap and by gap rate."""
        n = len(gap)
        none = np.zeros((n, 0))
        pressure, by_gap, by_rate = np.empty(n), np.empty(n), np.empty(n)
        params = np.tile(self.params, (n, 1))  # a broadcast of a single row would be read-only, which no kernel takes
        self.kernel(np.ascontiguousarray(gap), rate, params, none, none.copy(), 0.0, pressure, by_gap, by_rate)
        return self.area * pressure, self.area * by_gap, self.area * by_rate


@attrs.frozen(eq=False)
class LawState:
    """Points that carry something.

    Attributes
    ----------
    nodes, load : (n,) [N];  gap : (n,) left open by the law: its penetration [m]
    lower : factor of C + 1/D;  viscous : (n,) the law's rate derivative over D [s]
    """

    nodes: np.ndarray
    load: np.ndarray
    gap: np.ndarray
    lower: Any
    viscous: np.ndarray
    iterations: int

    def solve(self, right: np.ndarray) -> np.ndarray:
        """(C + 1/D)^-1 right."""
        return cho_solve(self.lower, right, check_finite=False) if len(self.nodes) else np.zeros_like(right)


def by_law(gap: np.ndarray, rate: np.ndarray, law: PointLaw, start: np.ndarray, factor: Factor) -> LawState:
    """Pressures at gaps (rows * columns,) that change at rates of the same shape.

    Parameters
    ----------
    start : (rows * columns,) penetrations w of a similar state, zeros when there is none; overwritten by those found

    Raises
    ------
    ConvergenceError
        Newton stalls.
    """
    near = np.flatnonzero(gap < 0.0)
    if not len(near):
        return LawState(near, np.zeros(0), np.zeros(0), None, np.zeros(0), 0)
    compliance = factor.block(near, near)
    g, v = gap[near], np.ascontiguousarray(rate[near])
    depth = abs(g.min())
    w = np.minimum(start[near], 0.0)
    if not (w < 0.0).any():
        w = np.where(g < -0.5 * depth, 0.02 * g, 0.0)
    before, count = np.inf, 0
    while count < _LIMIT:
        count += 1
        load, by_gap, by_rate = law(w, v)
        rest = g + compliance @ load - w
        now = float(np.abs(rest).max())
        if now <= _TOLERANCE * depth:
            break
        active = np.flatnonzero(by_gap < 0.0)
        more = np.zeros(len(near))
        if len(active):
            lower = _factor(compliance, active, -by_gap[active])
            more[active] = -cho_solve(lower, rest[active], check_finite=False)
        step = rest + compliance @ more
        part = 1.0 if now < before else 0.5
        w = w + part * step
        before = now
    else:
        raise ConvergenceError(f"the contact law's pressures were not found after {_LIMIT} iterations")
    start[:] = 0.0
    start[near] = np.minimum(w, 0.0)
    active = np.flatnonzero((load > 0.0) & (by_gap < 0.0))
    stiff = -by_gap[active]
    lower = _factor(compliance, active, stiff) if len(active) else None
    return LawState(near[active], load[active], w[active], lower, by_rate[active] / stiff, count)


def _factor(compliance: np.ndarray, active: np.ndarray, stiff: np.ndarray) -> Any:
    matrix = compliance[np.ix_(active, active)]
    matrix[np.diag_indices(len(active))] += 1.0 / stiff
    return cho_factor(matrix, lower=True, check_finite=False)
