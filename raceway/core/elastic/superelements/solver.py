"""Elastic bodies in contact, solved exactly: all that is linear once, Newton's method in the contacts alone."""

from __future__ import annotations

import gc
from collections.abc import Callable

import attrs
import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.contacts.nodal import NodalContact
from raceway.core.elastic.line_search import searched
from raceway.core.elastic.superelements.bearing import interface_of, touchable
from raceway.core.elastic.superelements.interface import Interface, Motions
from raceway.core.elastic.superelements.kept import OnProgress
from raceway.core.elastic.superelements.linearised import Linearised
from raceway.core.elastic.superelements.pressing import Beyond, Pressing
from raceway.core.elastic.superelements.tangent import BallTangent
from raceway.errors import ConvergenceError

#: Iterations of a step of all bodies in the contacts.
NEWTON_LIMIT = 40
#: Unbalanced forces of the contacts over what balances at which Newton's method ends: solutions have six digits before refinement.
TOLERANCE = 1e-10
#: The same over the forces by which an increment changes them: bodies' single precision leaves as much.
INCREMENT = 1e-6
#: Relative error of a step of Newton's method: its own is no smaller.
ENOUGH = 1e-6
#: Rounding of a gap over the largest coordinate of a place.
ROUNDING = 8.0 * float(np.finfo(float).eps)
#: Relative change of tangents up to which Newton's method goes on with those before: so much of its error is left by an iteration.
CLOSE = 1e-3
#: What an iteration leaves of the residual from which tangents are made anew.
SLOW = 0.1


class CondensedSolver:
    """Steps of c_k K + c_c C + c_m M with contacts, every node of every body an unknown.

    Parameters
    ----------
    assembly : Assembly of inner ring, outer ring and balls;  contact : NodalContact

    Attributes
    ----------
    iterations, solves, setups : of Newton's method in the contacts, of all bodies, and factorisations
    """

    def __init__(self, assembly: Assembly, contact: NodalContact) -> None:
        self.assembly, self.contact = assembly, contact
        self.iterations, self.solves, self.setups = 0, 0, 0
        #: Told of bodies while they are factored.
        self.on_progress: OnProgress | None = None
        #: (nodes,) which nodes bodies are reduced to: as they are meshed, so that they do not depend on loads.
        self._wanted = touchable(contact, assembly.nodes)
        self._interface: tuple[float, Interface] | None = None
        #: The last linearised bearing: of which superelements, tangents and frame.
        self.last: tuple[Interface, tuple[np.ndarray, ...], Linearised] | None = None

    def interface(self, mass: float) -> Interface:
        """Superelements of K + mass * M, made at the first call; those of another mass go: they are as large as the rest of a run."""
        if self._interface is None or self._interface[0] != mass:
            self._interface = self.last = None
            gc.collect()  # they know each other: without this they stay until Python looks
            self._interface = mass, interface_of(self.assembly, self._wanted, mass, self.on_progress)
            self.setups += 1
        return self._interface[1]

    def forget(self) -> None:
        """Nothing: superelements do not know the contacts."""

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float = 0.0) -> np.ndarray:
        """(size,) solution with the tangents of the last contact forces, to six digits."""
        return _Step(self, c_k, c_c, c_m, right).linear()

    def frame_compliance(self) -> np.ndarray:
        """(m, m) motions of the frame under unit forces on it, all bodies in balance, with the tangents of the last contact forces."""
        m = self.assembly.frame_size
        step = _Step(self, 1.0, 0.0, 0.0, np.zeros(self.assembly.size), quiet=True)
        linearised = step._linearised(close=0.0)
        columns = [linearised.forces(attrs.evolve(step.alone, frame=force))[1] for force in np.eye(m)]
        return np.stack(columns, axis=1)

    def increment(
        self,
        c_k: float,
        c_c: float,
        c_m: float,
        right: np.ndarray,
        u: np.ndarray,
        v: np.ndarray | None,
        dt: float,
        locates: bool = False,
    ) -> np.ndarray:
        """(size,) increment by which forces change by ``right``: those of the contacts themselves, not their tangents.

        Parameters
        ----------
        u, v : (3 nodes,) displacements and velocities at which the last contact forces were evaluated;  dt : with this step [s]
        locates : whether places on the second surfaces are looked up meanwhile
        """
        while True:
            try:
                return _Step(self, c_k, c_c, c_m, right).nonlinear(u, v, dt, locates)
            except Beyond as beyond:
                self._widen(beyond.nodes)

    def _widen(self, nodes: np.ndarray) -> None:
        """Reduce the bodies to more nodes: a contact has come to some (k,) beyond them."""
        if self._wanted[nodes].all():
            first = self.assembly.bodies[int(np.searchsorted(self.assembly.starts, nodes[0], side="right")) - 1]
            raise ConvergenceError(
                f"{first.name}: a contact presses on nodes that are held: its seat reaches into the groove. Mesh it with free nodes there"
            )
        self._wanted[nodes] = True
        self._wanted |= touchable(self.contact, self.assembly.nodes)
        self._interface = self.last = None


def _alike(one: tuple[np.ndarray, ...], other: tuple[np.ndarray, ...], close: float) -> bool:
    """Whether arrays are equal to a part of their largest entry."""
    return all(
        a.shape == b.shape
        and float(np.abs(np.subtract(a, b, dtype=float)).max(initial=0.0)) <= close * float(np.abs(a).max(initial=0.0))
        for a, b in zip(one, other, strict=True)
    )


class _Step:
    """One right side, eliminated down to the contacts."""

    def __init__(
        self, solver: CondensedSolver, c_k: float, c_c: float, c_m: float, right: np.ndarray, quiet: bool = False
    ) -> None:
        a = self.a = solver.assembly
        self.solver, self.contact = solver, solver.contact
        self.face, self.rate = solver.interface(c_m / c_k), c_c / c_k
        m = a.frame_size
        self.force = np.zeros(3 * a.nodes)
        self.force[a.free] = right[m:] / c_k
        self.unknown = a.frame_free
        face = self.face
        added = sum(ring.added for ring in face.rings if ring.added.size)
        self.frame = a.frame_stiffness + self.rate * a.frame_damping + c_m / c_k * a.frame_mass + added
        nodes, balls = np.empty((len(face.numbers), 3)), np.zeros((face.ball_count, face.extra))
        on_frame, self.carried = right[:m] / c_k, []
        if quiet:  # no forces on the bodies
            self.alone = Motions(np.zeros_like(nodes), balls, on_frame)
            return
        for ring in face.rings:
            moved, force, carried = ring.forward(self.force)
            nodes[face.place[ring.nodes]] = moved.reshape(-1, 3)
            on_frame[: len(force)] += force
            self.carried.append(carried)
        for group, members in face.groups:
            moved, carried = group.forward(self.force)
            nodes[face.place[group.loose.nodes]] = moved[:, : group.size].reshape(len(members), -1, 3)
            balls[members] = moved[:, group.size :]
            self.carried.append(carried)
        self.alone = Motions(nodes, balls, on_frame)
        solver.solves += 1

    def linear(self) -> np.ndarray:
        force, frame = self._linearised(close=0.0).forces(self.alone)
        return self._whole(self._moved(force, frame), force)

    def nonlinear(self, u: np.ndarray, v: np.ndarray | None, dt: float, locates: bool) -> np.ndarray:
        """Newton's method with a line search; every state balances all forces but those of the contacts."""
        pressed = Pressing(self.contact, self.face, u, v, self.rate, dt)
        start = pressed.forces()

        def unbalanced(state: Motions, force: Motions) -> np.ndarray:
            return force.nodes - (pressed.forces_at(state.nodes) - start)

        force, frame = self._linearised().forces(self.alone)
        state = self._moved(force, frame)
        rest = unbalanced(state, force)
        # Gaps are differences of places: their last digit is a force, too.
        rounding = ROUNDING * np.abs(self.contact.place).max() * np.abs(self.contact.stiffness).max(initial=0.0)
        asked = max(INCREMENT * np.abs(force.nodes).max(), rounding)
        before, close = np.inf, CLOSE
        for _ in range(NEWTON_LIMIT):
            if locates and pressed.locate(state.nodes):
                rest = unbalanced(state, force)
            size = np.abs(start + force.nodes).max()
            if np.abs(rest).max() <= max(TOLERANCE * size, asked, 1e-300):
                return self._whole(state, force)
            if not np.isfinite(rest).all():
                raise ConvergenceError("forces are not finite.")
            self.solver.iterations += 1
            if np.abs(rest).max() > SLOW * before:  # what hardly anything holds feels small errors of tangents
                close = 0.0
            before = np.abs(rest).max()
            back = self.face.moved(Motions(rest, np.zeros_like(force.balls), np.zeros_like(frame)), np.zeros_like(frame))
            driver = Motions(back.nodes, back.balls, self.face.on_frame(rest))
            pressed_on, turned = self._linearised(close).forces(driver, ENOUGH)
            change = Motions(pressed_on.nodes - rest, pressed_on.balls, turned)
            way = self.face.moved(Motions(-change.nodes, -change.balls, turned), turned)
            state, force, rest = self._along(state, way, force, change, unbalanced, rest)
        raise ConvergenceError(
            f"Newton's residual in the contacts stands at {np.abs(rest).max() / size:.1e} of the largest force after {NEWTON_LIMIT} iterations."
        )

    @staticmethod
    def _along(
        state: Motions,
        way: Motions,
        force: Motions,
        change: Motions,
        unbalanced: Callable[[Motions, Motions], np.ndarray],
        rest: np.ndarray,
    ) -> tuple[Motions, Motions, np.ndarray]:
        """Motions and forces along a step, and what of the forces is unbalanced there."""

        def at(part: float) -> tuple[tuple[Motions, Motions, np.ndarray], float, bool]:
            trial, tried = state.plus(part, way), force.plus(part, change)
            left = unbalanced(trial, tried)
            return (trial, tried, left), float((way.nodes * left).sum()), False

        return searched(float((way.nodes * rest).sum()), at)

    def _linearised(self, close: float = CLOSE) -> Linearised:
        """With the tangents of the last contact forces; the one before where the same points touch and these are as ``close``."""
        contact, face, solver = self.contact, self.face, self.solver
        blocks = contact.stiffness + self.rate * contact.rate_stiffness
        chosen = np.flatnonzero(blocks.any(axis=(1, 2)))
        nodes, weights, blocks = face.place[contact.nodes[chosen]], contact.weights[chosen], blocks[chosen]
        made_of = nodes, weights, blocks, self.frame, self.unknown
        if contact.friction is not None:
            close = 0.0  # a point that begins to slide changes little of its tangent and all of its force
        if solver.last is not None and solver.last[0] is face and _alike(solver.last[1], made_of, close):
            return solver.last[2]
        solver.last = None  # one at a time: they are large
        ball = contact.pair[chosen] % face.ball_count
        tangents = {}
        for k in range(face.ball_count):
            own = ball == k
            tangents[k] = BallTangent.of(nodes[own], weights[own], blocks[own])
        found = Linearised(face, tangents, self.frame, self.unknown)
        solver.last = face, tuple(one.copy() for one in made_of), found
        return found

    def _moved(self, force: Motions, frame: np.ndarray) -> Motions:
        back = self.face.moved(Motions(-force.nodes, -force.balls, frame), frame)
        return Motions(self.alone.nodes + back.nodes, self.alone.balls + back.balls, frame)

    def _whole(self, state: Motions, force: Motions) -> np.ndarray:
        """(size,) all unknowns."""
        a, face = self.a, self.face
        out = np.zeros(3 * a.nodes)
        for ring, carried in zip(face.rings, self.carried, strict=False):
            frame = state.frame[: ring.carried.shape[1]]
            ring.backward(carried, state.nodes[face.place[ring.nodes]].ravel(), frame, out)
        for (group, members), carried in zip(face.groups, self.carried[len(face.rings) :], strict=True):
            moved = state.nodes[face.place[group.loose.nodes]].reshape(len(members), -1)
            group.backward(carried, moved, force.balls[members], out)
        return np.concatenate([state.frame, out[a.free]])
