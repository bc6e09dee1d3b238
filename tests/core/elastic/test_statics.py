"""Newton's method for elastic bodies in contact: starts from equilibria, and line searches past points that close."""

from types import SimpleNamespace

import numpy as np
import pytest

from raceway.core.fem.elastic.newton import solve_equilibrium
from raceway.testing import settled
from tests.core.test_elastic_scene import TINY

COARSE = {key: TINY[key] for key in ("bearing", "bodies", "mesh")} | {
    "contact": {"kind": "hertz", "discretisation": "nodal"}
}


@pytest.mark.parametrize("axial", [2300.0, 2950.0])
def test_an_equilibrium_leads_to_its_neighbour_in_a_few_iterations(axial: float):
    """A fifth of the load more, across it: no point opens or closes, and Newton's method converges quadratically."""
    ring = settled(COARSE | {"load": {"axial": axial}})[0].system
    start = ring.equilibrium
    more = np.array([0.0, 500.0, 0.0, 0.0, 0.0])
    there, iterations = ring.equilibrium_under(start, ring.load + more)
    assert iterations <= 4
    # Forth and back: residuals of 1e-7 of the load are 1e-6 of the change, here a hundred times that.
    back, _ = ring.equilibrium_under(there, ring.load)
    assert np.abs(back[:5] - start[:5]).max() < 1e-4 * np.abs(there[:5] - start[:5]).max()
    # A start from an equilibrium is told from undeformed bodies.
    system = ring.bodies.system
    assert not system.undeformed(ring.equilibrium)
    assert system.undeformed(ring._undeformed(ring.surrogate, ring.equilibrium[:5]))


class Stop:
    """A spring that softens, and meets a stiff stop after a way: one unknown, as a contact point that closes.  f(y) = y -
    SOFTER y^2 + k max(y - w, 0)"""

    contact, on_residual = SimpleNamespace(resultants_only=True, refuse=lambda: None), None
    SOFTER = 0.05

    smooth, linear_iterations = False, 0

    def __init__(self, stiff: float, way: float):
        self.load, self.stiff, self.way = np.ones(1), stiff, way
        self.tangent, self.evaluations = 1.0, 0

    def static_internal(self, y: np.ndarray, share: float = 0.0) -> np.ndarray:
        self.evaluations += 1
        self.tangent = 1.0 - 2.0 * self.SOFTER * y[0] + (self.stiff if y[0] > self.way else 0.0)
        return y - self.SOFTER * y**2 + self.stiff * np.maximum(y - self.way, 0.0)

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float) -> np.ndarray:
        return right / self.tangent

    def undeformed(self, y: np.ndarray) -> bool:
        return False

    def locate(self, y: np.ndarray) -> bool:
        return False

    def measure(self, r: np.ndarray) -> float:
        return float(np.abs(r[0]))

    def force_scale(self) -> float:
        return 1.0


@pytest.mark.parametrize("stiff", [1e2, 1e4, 1e6])
@pytest.mark.parametrize("way", [0.03, 0.3])
def test_a_step_past_a_stiff_stop_ends_near_the_minimum_along_it(stiff: float, way: float):
    """Under the load 1.  A tenth of the step leaves more than 0.9 of the slope: it has to be lengthened, not cut further."""
    system = Stop(stiff, way)
    found = solve_equilibrium(system, np.zeros(1))
    wanted = np.roots([-system.SOFTER, 1.0 + stiff, -1.0 - stiff * way]).min()
    assert found.y[0] == pytest.approx(wanted, rel=1e-6)
    # Of all load steps, those that failed too.
    assert len(found.residuals) <= 9
    assert system.evaluations <= 60
