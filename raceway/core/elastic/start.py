"""Initial states of elastic bodies in time, as ``raceway.core.ring.start`` gives them for five coordinates."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.ring import ElasticRing
from raceway.core.ring.orbit import Orbit, at_time
from raceway.core.stepping.record import Motion

#: Angle of the excitation between the equilibria that tell velocity and acceleration [rad].
_ANGLE = 0.25


def from_orbit(ring: ElasticRing, orbit: Orbit, dt: float) -> Motion:
    """Near the steady orbit of the same ring with rigid bodies, at the first of its times.

    Notes
    -----
    The contacts carry the excitation less the inertia of ring and rotor.  Equilibria under these forces a little before and
    after tell velocity and acceleration: of a displacement at the excitation's frequency exactly.  Elastic bodies move
    further than rigid ones; the inertia is scaled by how much further, found by a first equilibrium.  No step dt back is
    needed: balls have velocities of their own.
    """
    speed = 2.0 * np.pi / orbit.period
    still = ring.equilibrium
    step = _ANGLE / speed

    def load(t: float, scale: float) -> np.ndarray:
        return np.asarray(ring.load + ring.outer_force(t) - scale * ring.mass @ at_time(orbit.acceleration, orbit.period, t))

    now, _ = ring.settled(still, load(0.0, 1.0))
    rigid = ring.surrogate.settle(still[:5])[0]
    moved, wanted = now[1:3] - still[1:3], orbit.displacement[0, 1:3] - rigid[1:3]
    scale = float(np.linalg.norm(moved) / max(float(np.linalg.norm(wanted)), 1e-300)) if wanted.any() else 1.0
    now, _ = ring.settled(now, load(0.0, scale))
    before, _ = ring.settled(now, load(-step, scale))
    after, _ = ring.settled(now, load(step, scale))
    v = (after - before) * speed / (2.0 * np.sin(_ANGLE))
    a = (after - 2.0 * now + before) * speed**2 / (2.0 * (1.0 - np.cos(_ANGLE)))
    return _motion(ring, now, v, a)


def at_rest(ring: ElasticRing, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """At rest in the static equilibrium; without a ramp the excitation acts at once."""
    y = ring.equilibrium
    outer = np.zeros(ring.bodies.system.size)
    if not ramped:
        outer[:5] = ring.outer_force(0.0)
    a = ring.bodies.system.divide_mass(outer)
    return _motion(ring, y, np.zeros_like(y), a)


def static_orbit(ring: ElasticRing, q: np.ndarray, ball: np.ndarray, ramped: bool) -> Motion:
    """The equilibrium under the constant load and the excitation's force at time zero: for series of equilibria."""
    y = ring.equilibrium
    if not ramped:
        y, _ = ring.settled(y, ring.load + ring.outer_force(0.0))
    return _motion(ring, y, np.zeros_like(y), np.zeros_like(y))


def _motion(ring: ElasticRing, y: np.ndarray, v: np.ndarray, a: np.ndarray) -> Motion:
    """A motion whose contacts carry no friction yet: the balls have rolled into place."""
    ring.in_place(y)
    stepped, contact = ring.stepped(), ring.bodies.system.contact
    if contact is not None and contact.friction is not None:
        contact.friction.begin((contact.move @ ring.bodies.system.assembly.nodal(y)).reshape(-1, 3))
    return stepped.motion_of(y, v, a)
