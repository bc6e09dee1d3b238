"""A tangential load on a Hertz contact, below the limit of sliding: an annulus slips.

For like half-spaces pressed together by Q and pulled along x by T < mu Q, Cattaneo's and Mindlin's tractions are those of full
sliding less the same, scaled by c = (1 - T / (mu Q))^(1/3), over a similar ellipse that sticks.  The displacement is then

    delta = 3/2 S mu Q (1 - (1 - T / (mu Q))^(2/3)),

S the compliance at T = 0 (traction that grows like (1 - x2/a2 - y2/b2)^(-1/2), displacement at the centre by Cerruti's
solution).  A load that swings between -T and T follows Masing's rule.
Mindlin, J. Appl. Mech. 16 (1949) 259; Mindlin, Deresiewicz, J. Appl. Mech. 20 (1953) 327; Johnson, Contact Mechanics (1985),
sections 3.6, 7.2 and 7.4.
"""

import attrs
import numpy as np


@attrs.frozen
class Mindlin:
    """Two like bodies; a [m] the semi-axis along the pull, b [m] the other, E [Pa], nu, limit mu Q [N]."""

    a: float
    b: float
    young: float
    poisson: float
    limit: float

    @property
    def compliance(self) -> float:
        """S [m/N]."""
        angle = (np.arange(4000) + 0.5) * (2.0 * np.pi / 4000)
        shape = np.sqrt(np.cos(angle) ** 2 / self.a**2 + np.sin(angle) ** 2 / self.b**2)
        cerruti = (1.0 - self.poisson) + self.poisson * np.cos(angle) ** 2
        integral = float(np.mean(cerruti * np.pi / (2.0 * shape)) * 2.0 * np.pi)
        modulus = 0.5 * self.young / (1.0 + self.poisson)
        return 2.0 * integral / (2.0 * np.pi * modulus * 2.0 * np.pi * self.a * self.b)

    def displacement(self, pull: np.ndarray | float) -> np.ndarray:
        """[m]"""
        return np.asarray(1.5 * self.compliance * self.limit * (1.0 - (1.0 - np.asarray(pull) / self.limit) ** (2.0 / 3.0)))

    def stick_share(self, pull: float) -> float:
        """Area that sticks, of the ellipse's."""
        return float((1.0 - pull / self.limit) ** (2.0 / 3.0))

    def loop(self, pull: float) -> float:
        """Energy that a full swing between -pull and pull takes [J]: the area between Masing's branches."""
        load = np.linspace(-pull, pull, 20001)
        end = self.displacement(pull)
        width = (end - 2.0 * self.displacement(0.5 * (pull - load))) - (-end + 2.0 * self.displacement(0.5 * (load + pull)))
        return float(np.trapezoid(width, load))
