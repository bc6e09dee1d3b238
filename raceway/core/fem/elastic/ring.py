"""A bearing of elastic bodies seen from its inner ring: the interface of ``raceway.core.ring.ring.Ring``."""

from collections.abc import Iterator
from contextlib import contextmanager

import attrs
import numpy as np

from raceway.core.contact.geometry import Growth
from raceway.core.fem.elastic.bearing import ElasticBearing, ElasticSystem
from raceway.core.fem.elastic.superelement_solver import CondensedSolver
from raceway.core.record import Motion
from raceway.core.ring.orbit import Orbit, at_time
from raceway.core.ring.ring import AT_ONCE, Evaluation, Increment
from raceway.core.ring.system import SteppedRing, System
from raceway.errors import ConvergenceError

#: Relative residual of equilibria, and of the linear solves for the ring's stiffness, whose error is its square.
_TOLERANCE, _LINEAR = 1e-7, 1e-4


@attrs.define(eq=False, kw_only=True)
class ElasticRing(SteppedRing):
    """All nodes of rings and balls; the ring's reference point is what the rest of the program sees."""

    bodies: ElasticBearing
    #: axial load [N] whose displacement, where it acts alone on the mounted bearing, is held; None: the axial motion is free
    held_by: float | None = None
    _y: np.ndarray | None = attrs.field(init=False, default=None)
    _stiffness: np.ndarray | None = attrs.field(init=False, default=None)

    @property
    def conservative(self) -> bool:
        return self.bodies.system.conservative

    @property
    def ball_columns(self) -> int:
        return 2

    def stepped(self) -> ElasticSystem:
        """The system that the loops in Python step."""
        self.bodies.system.excitation = self.outer_force
        return self.bodies.system

    def solve_equilibrium(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = _TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under ``load``; the first guess is the equilibrium of rigid bodies, or the one found before.

        Friction is left out: the balls have rolled into place.

        ConvergenceError: With the last good state ``y`` and the residuals.
        """
        if self._y is None and self.held_by is not None:
            guess = self._alone(q, self.held_by)
        elif self._y is None:
            guess = self._undeformed(self.surrogate, q)
        else:
            guess = self._y
        self._y, count = self.equilibrium_under(guess, self.load, max(tolerance, _TOLERANCE))
        self._stiffness = None
        return self._y[:5].copy(), self.bodies.ball_places(self._y), count

    @property
    def equilibrium(self) -> np.ndarray:
        """(size,) unknowns at the last equilibrium under ``load``; ConvergenceError where none was looked for."""
        if self._y is None:
            raise ConvergenceError("elastic bodies have forces at their equilibria only: solve for them first")
        return self._y

    def in_place(self, y: np.ndarray) -> np.ndarray:
        """(size,) internal forces of a state at rest without friction; the bodies keep its contacts."""
        system = self.bodies.system
        with system.without_friction():
            system.locate(y)
            return np.asarray(system.static_internal(y))

    def evaluate(
        self, q: np.ndarray, v: np.ndarray | None = None, ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None, t: float = 0.0, step: Increment = AT_ONCE,
    ) -> Evaluation:  # fmt: skip
        """The last equilibrium; its tangent is that of the ring with all nodes in balance.

        ConvergenceError: A place of the ring that is no equilibrium that was found.
        """
        y = self.equilibrium
        if np.abs(y[:5] - q).max() > 0.0:
            raise ConvergenceError("elastic bodies have forces at their equilibria only", {"q": np.asarray(q)})
        force_on_frame = self.in_place(y)[:5]
        _, _, gap, force, places = self.bodies.look(y, np.zeros_like(y))
        if self._stiffness is None:
            self._stiffness = self._tangent()
        on_ring, tangent = force_on_frame - self.stiffness @ y[:5], self._stiffness.copy()
        return Evaluation(on_ring, tangent, np.zeros((5, 5)), gap, force, places, self.law_state.copy())

    def without(self, *entries: int) -> "ElasticRing":
        """Itself: balls of elastic bodies do not orbit, and equilibria know no friction."""
        return self

    def stopped(self, t: float) -> "ElasticRing":
        return self

    def critical_time_step(self, tangent: np.ndarray) -> float:
        """Of elements and contacts at the last state that was computed [s]; the ring's own tangent does not limit it."""
        return float(self.bodies.system.stable_step())

    def equilibrium_under(
        self, guess: np.ndarray, load: np.ndarray, tolerance: float = _TOLERANCE
    ) -> tuple[np.ndarray, int]:
        """Unknowns (size,) at the equilibrium under a load (5,) of the ring, without friction, and Newton's iterations."""
        system = self.bodies.system
        before = system.load.copy()
        system.load[:5] = load
        try:
            with system.without_friction():
                equilibrium = system.solve_equilibrium(guess, tolerance)
        finally:
            system.load = before
        return equilibrium.y, equilibrium.iterations

    def _undeformed(self, rigid: System, q: np.ndarray) -> np.ndarray:
        """(size,) undeformed bodies at the equilibrium of rigid ones near q (5,)."""
        displacement, balls, _ = rigid.solve_equilibrium(q)
        if not balls[:, 1].any():
            # Weightless balls lie between the groove centres: their first column is the distance.
            centre, _ = self.centre_vectors(displacement)
            balls = np.asarray(centre / np.linalg.norm(centre, axis=1, keepdims=True) * balls[:, :1])
        return self.bodies.guess(displacement, balls)

    def _alone(self, q: np.ndarray, axial: float) -> np.ndarray:
        """(size,) equilibrium as mounted under an axial load [N] alone, the ring's other motions held."""
        only, load = np.arange(5) == 0, np.array([axial, 0.0, 0.0, 0.0, 0.0])
        inner_raceways = Growth(np.array([0.0, self.bodies.setup.growth, 0.0, 0.0, 0.0]), np.zeros((self.ball_count, 5)))
        rigid = self.surrogate.standing(inner_raceways)
        rigid = attrs.evolve(rigid, free=only.astype(float), load=load)
        with self.bodies.mounted(), self._letting_free(only):
            y, _ = self.equilibrium_under(self._undeformed(rigid, q * only), load)
        self.bodies.system.solver.forget()  # it knows how the bodies follow the axial motion
        return y

    @contextmanager
    def _letting_free(self, motions: np.ndarray) -> Iterator[None]:
        """Inside, these motions (5,) of the ring are the unknowns, and no others."""
        assembly = self.bodies.system.assembly
        frame_free, unknown = assembly.frame_free.copy(), assembly.unknown.copy()
        assembly.frame_free[:], assembly.unknown[:5] = motions, motions
        try:
            yield
        finally:
            assembly.frame_free[:], assembly.unknown[:] = frame_free, unknown

    def _tangent(self) -> np.ndarray:
        """(5, 5) stiffness of the ring's motions, the shaft's left out: inverse of its compliance, all motions let free.

        Of solutions u_k with errors e_k under forces f_k: f_i u_k + f_k u_i - u_i A u_k = f_i A^-1 f_k - e_i A e_k.
        """
        system = self.bodies.system
        with self._letting_free(np.ones(5, dtype=bool)):
            if isinstance(system.solver, CondensedSolver):
                compliance = system.solver.frame_compliance()
            else:
                forces = np.eye(5, system.size)
                motions = np.stack([system.solve(1.0, 0.0, 0.0, force, tolerance=_LINEAR) for force in forces])
                image = system.solver.image(1.0, 0.0, 0.0)
                compliance = motions[:, :5] + motions[:, :5].T - motions @ np.stack([image(u) for u in motions], axis=1)
        stiffness = np.linalg.inv(0.5 * (compliance + compliance.T)) - self.stiffness
        return np.asarray(0.5 * (stiffness + stiffness.T))


#: Angle of the excitation between the equilibria that tell velocity and acceleration [rad].
_ANGLE = 0.25


def from_orbit(ring: ElasticRing, orbit: Orbit) -> Motion:
    """Near the steady orbit of the same ring with rigid bodies, at the first of its times.

    The contacts carry the excitation less the inertia of ring and rotor.  Equilibria under these forces a little before and
    after give velocity and acceleration: of a displacement at the excitation's frequency exactly.  Elastic bodies move
    further than rigid ones; the inertia is scaled by how much further, found by a first equilibrium.
    """
    speed = 2.0 * np.pi / orbit.period
    still = ring.equilibrium
    step = _ANGLE / speed

    def load(t: float, scale: float) -> np.ndarray:
        return np.asarray(ring.load + ring.outer_force(t) - scale * ring.mass @ at_time(orbit.acceleration, orbit.period, t))

    now, _ = ring.equilibrium_under(still, load(0.0, 1.0))
    rigid = ring.surrogate.solve_equilibrium(still[:5])[0]
    shift, rigidly = now[1:3] - still[1:3], orbit.displacement[0, 1:3] - rigid[1:3]
    scale = float(np.linalg.norm(shift) / max(float(np.linalg.norm(rigidly)), 1e-300)) if rigidly.any() else 1.0
    now, _ = ring.equilibrium_under(now, load(0.0, scale))
    before, _ = ring.equilibrium_under(now, load(-step, scale))
    after, _ = ring.equilibrium_under(now, load(step, scale))
    v = (after - before) * speed / (2.0 * np.sin(_ANGLE))
    a = (after - 2.0 * now + before) * speed**2 / (2.0 * (1.0 - np.cos(_ANGLE)))
    return _ring_motion(ring, now, v, a)


def standstill(ring: ElasticRing, ramped: bool) -> Motion:
    """At rest in the static equilibrium; without a ramp the excitation acts at once."""
    y = ring.equilibrium
    outer, still = np.zeros_like(y), np.zeros_like(y)
    if not ramped:
        outer[:5] = ring.outer_force(0.0)
    return _ring_motion(ring, y, still, ring.stepped().accelerations(outer, np.zeros_like(y), still, 0.0))


def static_orbit(ring: ElasticRing, ramped: bool) -> Motion:
    """The equilibrium under the constant load and the excitation's force at time zero: for series of equilibria."""
    y = ring.equilibrium
    if not ramped:
        y, _ = ring.equilibrium_under(y, ring.load + ring.outer_force(0.0))
    return _ring_motion(ring, y, np.zeros_like(y), np.zeros_like(y))


def _ring_motion(ring: ElasticRing, y: np.ndarray, v: np.ndarray, a: np.ndarray) -> Motion:
    """A motion whose contacts carry no friction yet: the balls have rolled into place."""
    ring.in_place(y)
    time_system, contact = ring.stepped(), ring.bodies.system.contact
    if contact is not None and contact.friction is not None:
        contact.friction.begin((contact.move @ ring.bodies.system.assembly.nodal(y)).reshape(-1, 3))
    return time_system.motion_of(y, v, a)
