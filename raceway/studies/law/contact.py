"""A contact of a scene in its equilibrium, alone: force, stiffness and damping at any approach and rate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.bodies.model import build_model
from raceway.core.ring.increment import Increment
from raceway.core.ring.kernels.impact import single_contact
from raceway.core.ring.surrogate import compiled
from raceway.errors import RacewayError, SceneError
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.scene.scene import Scene

RACES = ("inner", "outer")


@attrs.frozen(eq=False)
class Contact:
    """One ball-race contact.

    Attributes
    ----------
    race : "inner" or "outer";  ball : its number, from 1
    load : normal force in the equilibrium [N]
    approach : there [m]: minus the gap between the undeformed surfaces
    reach : gap at which the contact begins to carry [m]: 0, or what a film puts between the surfaces
    hertz_factor : K of Hertz' force K delta^1.5 [N/m^1.5]
    system : a mass against the contact alone, whose x is approach + reach
    """

    race: str
    ball: int
    load: float
    approach: float
    reach: float
    hertz_factor: float
    system: System

    def at(
        self, approach: float, rate: float = 0.0, step: Increment | None = None
    ) -> tuple[float, float, float, np.ndarray]:
        """Force [N], its derivatives by approach [N/m] and by the approach's rate [N s/m], and the law's memory (2, m).

        Parameters
        ----------
        approach, rate : [m, m/s]
        step : since the memory was committed; None: at rest, without a history
        """
        q, v = np.zeros(5), np.zeros(5)
        q[0], v[0] = approach + self.reach, rate
        now = self.system.evaluate(q, v, ball=np.zeros((1, 2)), step=step or Increment())
        return float(now.force[0]), float(now.stiffness[0, 0]), float(now.damping[0, 0]) + 0.0, now.memory  # no -0

    def curves(self, approach: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """(3, m, n) force, stiffness and damping over rates (m,) [m/s] and approaches (n,) [m], each without a history."""
        found = [[self.at(float(one), float(rate))[:3] for one in approach] for rate in rates]
        return np.moveaxis(np.array(found), -1, 0)

    def hertz(self, approach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and stiffness (n,) by Hertz' law over approaches (n,) [m]."""
        deep = np.maximum(approach, 0.0)
        return self.hertz_factor * deep**1.5, 1.5 * self.hertz_factor * np.sqrt(deep)


def contact_of(scene: Scene, race: str = "inner", ball: int | None = None) -> Contact:
    """A contact of a scene with rigid bodies, in its equilibrium.

    Parameters
    ----------
    race : "inner" or "outer"
    ball : its number, from 1 over all rows; None: the most loaded one

    Raises
    ------
    SceneError
        Another race, a ball that is not there, bodies that are not rigid.
    RacewayError
        A contact that carries nothing.
    ConvergenceError
        No equilibrium.
    """
    if race not in RACES:
        raise SceneError.at("race", race, f"must be one of {', '.join(RACES)}")
    if scene.bodies.name != "rigid":
        rule = "has contacts whose approach is shared with the bodies' compliance: take bodies.kind = 'rigid' to see a law alone"
        raise SceneError.at("bodies.kind", scene.bodies.name, rule)
    model = build_model(scene, make_plan(scene))
    still = settle(model)
    ring = compiled(model.system)
    assert ring is not None, "rings of rigid bodies are compiled"
    count = ring.ball_count
    loads = still.contact_force.reshape(2, count)[RACES.index(race)]
    number = int(np.argmax(loads)) + 1 if ball is None else ball
    if not 1 <= number <= count:
        raise SceneError.at("ball", ball, f"must be from 1 to {count}")
    index = RACES.index(race) * count + number - 1
    load = float(still.contact_force[index])
    if load <= 0.0:
        rule = f"carries nothing at the {race} race: the most loaded is {int(np.argmax(loads)) + 1}"
        raise RacewayError(f"ball {number} {rule}" if loads.any() else f"no ball carries anything at the {race} race")
    ellipse = model.inner if race == "inner" else model.outer
    factors = np.broadcast_to(np.asarray(ellipse.factor, dtype=float), count)
    reach = 0.0 if ring.reach is None else float(ring.reach[index])
    approach = -float(still.gap[index]) - reach
    return Contact(race, number, load, approach, reach, float(factors[number - 1]), single_contact(ring, index))
