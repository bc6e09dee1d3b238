"""Elastic bodies in contact, solved exactly: all that is linear once, Newton's method in the contacts alone."""

import gc
from collections.abc import Callable

import attrs
import numpy as np
from numba import int64, void

from raceway.core.fem.elastic.assembly import Assembly
from raceway.core.fem.elastic.contact import NodalContact
from raceway.core.fem.elastic.interface import Interface, Motions, OnProgress, interface_of, touchable
from raceway.core.fem.elastic.newton import searched
from raceway.core.fem.elastic.unknowns import Near, of_nodes
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX
from raceway.errors import ConvergenceError


class _Beyond(Exception):
    """A contact presses on nodes (k,) that its bodies were not reduced to."""

    def __init__(self, nodes: np.ndarray) -> None:
        super().__init__()
        self.nodes = nodes


class _Pressing:
    """Contacts during one step.

    contact : NodalContact;  face : Interface
    u, v : (3 nodes,) displacements and velocities at which the last contact forces were evaluated; v None at rest
    rate : by which velocities change with displacements [1/s];  dt : step [s]
    """

    def __init__(
        self, contact: NodalContact, face: Interface, u: np.ndarray, v: np.ndarray | None, rate: float, dt: float
    ) -> None:
        self._contact, self._face, self._u, self._v, self._rate, self._dt = contact, face, u, v, rate, dt
        self._of: Near | None = None
        self._near_v: np.ndarray | None = None

    def forces(self) -> np.ndarray:
        """(n, 3) internal forces of the contacts on the contacts' nodes, as last evaluated."""
        self._follow()
        return self._on_nodes(-(self._near.move.T @ self._contact.force.reshape(-1)))

    def forces_at(self, displacement: np.ndarray) -> np.ndarray:
        """The same at motions (n, 3) on top of u."""
        self._follow()
        rate = None if self._near_v is None else self._with(self._near_v, self._rate * displacement)
        return self._on_nodes(self._contact.evaluate_near(self._dt, self._with(self._near_u, displacement), rate))

    def locate(self, displacement: np.ndarray) -> bool:
        """Look up where the points lie on the second surfaces at motions (n, 3); whether anything changed."""
        self._follow()
        where = self._near.move @ self._with(self._near_u, displacement)
        return self._contact.update(self._contact.place + where.reshape(-1, 3))

    def _follow(self) -> None:
        """The entries that the points hang on, which are others when these were looked up."""
        near = self._near = self._contact.near
        if near is self._of:
            return
        self._of = near
        rows = self._face.place[near.entries // 3]
        self._inside = np.flatnonzero(rows >= 0)
        self._outside = np.flatnonzero(rows < 0)
        self._at = 3 * rows[self._inside] + near.entries[self._inside] % 3
        self._near_u = self._u[near.entries]
        self._near_v = None if self._v is None else self._v[near.entries]

    def _with(self, values: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        out = values.copy()
        out[self._inside] += displacement.ravel()[self._at]
        return out

    def _on_nodes(self, forces: np.ndarray) -> np.ndarray:
        beyond = self._outside[forces[self._outside] != 0.0]
        if beyond.size:
            raise _Beyond(np.unique(self._near.entries[beyond] // 3))
        out = np.zeros(3 * len(self._face.numbers))
        out[self._at] = forces[self._inside]
        return out.reshape(-1, 3)


@jit(void(int64[:, ::1], MATRIX, CUBE, MATRIX))
def _add_points(places, weights, blocks, matrix):  # type: ignore[no-untyped-def]
    """Add B^T D B of points to a matrix (3 k, 3 k).

    places : (n, 8) nodes in the matrix;  weights : (n, 8) by which a point moves with them;  blocks : (n, 3, 3) D
    """
    for i in range(places.shape[0]):
        for a in range(8):
            for b in range(8):
                w = weights[i, a] * weights[i, b]
                if w != 0.0:
                    row, column = 3 * places[i, a], 3 * places[i, b]
                    for c in range(3):
                        for d in range(3):
                            matrix[row + c, column + d] += w * blocks[i, c, d]


@attrs.frozen(eq=False)
class BallTangent:
    """Tangent of the contacts of one ball with both rings."""

    #: ball, rings : (a,), (b,) numbers of the nodes that points in contact lie on
    ball: np.ndarray
    rings: np.ndarray
    matrix: np.ndarray  # (3 (a + b), 3 (a + b)) of both, those of the ball first [N/m]

    @classmethod
    def of(cls, nodes: np.ndarray, weights: np.ndarray, blocks: np.ndarray) -> "BallTangent":
        """From points: ``nodes`` (n, 8), four of the ball, then four of a ring, ``weights`` (n, 8), ``blocks`` (n, 3, 3)."""
        ball, rings = np.unique(nodes[:, :4]), np.unique(nodes[:, 4:])
        places = [np.searchsorted(ball, nodes[:, :4]), len(ball) + np.searchsorted(rings, nodes[:, 4:])]
        matrix = np.zeros((3 * (len(ball) + len(rings)),) * 2)
        _add_points(np.concatenate(places, axis=1), np.ascontiguousarray(weights), np.ascontiguousarray(blocks), matrix)
        return cls(ball, rings, matrix)


#: Unknowns up to which one factorisation costs less than iterations.
_FACTORED = 900
#: Vectors that GMRES keeps.
_VECTORS = 120
#: Relative error of solutions unless asked for less.
TIGHT = 1e-12


class LinearisedContacts:
    """x = driver - flexibility (T x) + carried q, with the tangents T of the contacts.

    face : Interface
    tangents : of each ball;  frame : (m, m) matrix of the frame;  unknown : (m,) bool, motions that are not held

    The balls are eliminated one by one; what is left are the rings' nodes in contact and the frame. Small systems are
    factored. Large ones are solved by GMRES, preconditioned with what each ball's contacts are without the other balls':
    what couples them, the rings' stiffness from ball to ball and the frame, is smooth and has few modes.
    """

    def __init__(self, face: Interface, tangents: dict[int, BallTangent], frame: np.ndarray, unknown: np.ndarray) -> None:
        self._face, self._tangents, self._frame, self._unknown = face, tangents, frame, unknown
        ring_places = [tangent.rings for tangent in tangents.values()]
        nodes = np.unique(np.concatenate(ring_places)) if ring_places else np.zeros(0, dtype=np.int64)
        self._rings = face.of_rings(nodes)
        self._nodes, self._carried = self._rings.nodes, self._rings.carried
        self._size = 3 * len(self._nodes)
        self._balls = {k: _Ball(face, k, tangent) for k, tangent in tangents.items()}
        self._places = {k: of_nodes(np.searchsorted(self._nodes, tangent.rings)) for k, tangent in tangents.items()}
        overlap = sum(map(len, ring_places)) > len(nodes)
        self._inverse = self._direct_inverse() if overlap or self._size <= _FACTORED else self._iterative_inverse()

    def forces(self, driver: Motions, tolerance: float = TIGHT) -> tuple[Motions, np.ndarray]:
        """T x, of which ``frame`` is what it is on the frame, and motions (m,) of the frame.

        driver : ``nodes`` and ``balls`` are motions, ``frame`` is a force (m,) on the frame
        """
        face = self._face
        remaining, answers = np.zeros(self._size), {}
        for k, tangent in self._tangents.items():
            answers[k] = self._balls[k].alone(driver.nodes[tangent.ball], driver.balls[k])
            remaining[self._places[k]] += self._balls[k].across @ answers[k][: 3 * len(tangent.ball)]
        right = driver.nodes[self._nodes].ravel() - self._rings.times(remaining)
        on_frame = np.where(self._unknown, driver.frame - self._carried.T @ remaining, 0.0)
        solution = self._inverse(np.concatenate([right, on_frame]), tolerance)
        force, balls = np.zeros_like(driver.nodes), np.zeros_like(driver.balls)
        for k, tangent in self._tangents.items():
            at_rings = solution[self._places[k]]
            at_ball = answers[k] - self._balls[k].follows @ at_rings
            cut = 3 * len(tangent.ball)
            contact_force = tangent.matrix @ np.concatenate([at_ball[:cut], at_rings])
            force[tangent.ball] += contact_force[:cut].reshape(-1, 3)
            force[tangent.rings] += contact_force[cut:].reshape(-1, 3)
            balls[k] = face.springs(k, len(tangent.ball) > 0) * at_ball[cut:]
        return Motions(force, balls, face.on_frame(force)), np.where(self._unknown, solution[self._size :], 0.0)

    def _direct_inverse(self) -> Callable[[np.ndarray, float], np.ndarray]:
        from scipy.linalg import lu_factor, lu_solve

        size, m = self._size, len(self._frame)
        matrix = np.zeros((size + m, size + m), order="F")
        matrix[np.arange(size), np.arange(size)] = 1.0
        for k, places in self._places.items():
            stiffness = self._balls[k].stiffness
            matrix[:size, places] += self._rings.under(places, stiffness)
            matrix[size:, places] += self._carried[places].T @ stiffness
        matrix[:size, size:], matrix[size:, size:] = -self._carried, self._frame
        fixed_dofs = size + np.flatnonzero(~self._unknown)
        matrix[fixed_dofs] = 0.0
        matrix[fixed_dofs, fixed_dofs] = 1.0
        factors = lu_factor(matrix, overwrite_a=True, check_finite=False)
        return lambda right, tolerance: np.asarray(lu_solve(factors, right, check_finite=False))

    def _iterative_inverse(self) -> Callable[[np.ndarray, float], np.ndarray]:
        from scipy.linalg import lu_factor, lu_solve
        from scipy.sparse.linalg import LinearOperator, gmres

        size, m, ride, frame_stiffness, unknown = (self._size, len(self._frame), self._carried, self._frame, self._unknown)
        # What is kept below knows the arrays and not this object, which would know it: all iterations' would stay in memory.
        rings, balls, at = self._rings, self._balls, self._places
        factors = {}
        for k, places in at.items():
            blocks = rings.among(places, balls[k].stiffness)
            blocks[np.arange(len(blocks)), np.arange(len(blocks))] += 1.0
            factors[k] = lu_factor(blocks, overwrite_a=True, check_finite=False)

        def contact_forces(w: np.ndarray) -> np.ndarray:
            out = np.zeros_like(w)
            for k, places in at.items():
                out[places] = balls[k].stiffness @ w[places]
            return out

        def apart(right: np.ndarray) -> np.ndarray:
            out = right.copy()
            for k, places in at.items():
                out[places] = lu_solve(factors[k], right[places], check_finite=False)
            return out

        along = apart(ride)
        small = np.where(unknown[:, None], frame_stiffness + ride.T @ contact_forces(along), np.eye(m))

        def preconditioner(right: np.ndarray) -> np.ndarray:
            w = apart(right[:size])
            on_frame = right[size:] - np.where(unknown, ride.T @ contact_forces(w), 0.0)
            frame = np.linalg.solve(small, on_frame)
            return np.concatenate([w + along @ frame, frame])

        def image(w: np.ndarray) -> np.ndarray:
            w = w.ravel()
            force, frame = contact_forces(w[:size]), w[size:]
            on_frame = np.where(unknown, ride.T @ force + frame_stiffness @ frame, frame)
            out = w[:size] + rings.times(force) - ride @ frame
            return preconditioner(np.concatenate([out, on_frame]))

        operator = LinearOperator((size + m, size + m), matvec=image, dtype=float)

        def inverse(right: np.ndarray, tolerance: float) -> np.ndarray:
            solution, fault = gmres(operator, preconditioner(right), rtol=tolerance, restart=_VECTORS, maxiter=3)
            if fault or not np.isfinite(solution).all():
                raise ConvergenceError("the contacts' linear equations have no solution: a part is unconstrained")
            return np.asarray(solution)

        return inverse


class _Ball:
    """A ball between the rings, x_b = b - X x_r of its nodes and mean motions: X ``follows``, b ``alone``.

    stiffness : of the rings' nodes through the ball;  across : force on them of the ball's nodes
    """

    def __init__(self, face: Interface, ball: int, tangent: BallTangent) -> None:
        from scipy.linalg import lu_factor, lu_solve
        from scipy.sparse import csr_array

        cut = 3 * len(tangent.ball)
        flexibility = face.of_ball(ball, tangent.ball)
        sparse = csr_array(tangent.matrix[:cut])  # a point couples eight nodes
        contact = (
            sparse.T @ flexibility[:cut]
        ).T  # flexibility, which is symmetric, times stiffness, which is not with friction
        system = np.empty_like(flexibility, order="F")
        system[:, :cut] = contact[:, :cut]
        system[:, cut:] = flexibility[:, cut:] * face.springs(ball, cut > 0)
        system[np.arange(len(system)), np.arange(len(system))] += 1.0
        self._factors = lu_factor(system, overwrite_a=True, check_finite=False)
        self.across = csr_array(tangent.matrix[cut:, :cut])
        self.follows = lu_solve(self._factors, np.asfortranarray(contact[:, cut:]), overwrite_b=True, check_finite=False)
        self.stiffness = tangent.matrix[cut:, cut:] - self.across @ self.follows[:cut]

    def alone(self, nodes: np.ndarray, motions: np.ndarray) -> np.ndarray:
        from scipy.linalg import lu_solve

        return np.asarray(lu_solve(self._factors, np.concatenate([nodes.ravel(), motions]), check_finite=False))


#: Iterations of a step of all bodies in the contacts.
NEWTON_LIMIT = 40
#: Unbalanced forces of the contacts over what balances at which Newton's method ends: solutions have six digits before refinement.
TOLERANCE = 1e-10
#: The same over the forces by which an increment changes them: bodies' single precision leaves as much.
_INCREMENT = 1e-6
#: Relative error of a step of Newton's method: its own is no smaller.
_ENOUGH = 1e-6
#: Rounding of a gap over the largest coordinate of a place.
ROUNDING = 8.0 * float(np.finfo(float).eps)
#: Relative change of tangents up to which Newton's method goes on with those before: so much of its error is left by an iteration.
_CLOSE = 1e-3
#: What an iteration leaves of the residual from which tangents are made anew.
SLOW = 0.1


class CondensedSolver:
    """Steps of c_k K + c_c C + c_m M with contacts, every node of every body an unknown.

    assembly : Assembly of inner ring, outer ring and balls;  contact : NodalContact

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
        self.last: tuple[Interface, tuple[np.ndarray, ...], LinearisedContacts] | None = None

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
        system = step._linear_system(close=0.0)
        columns = [system.forces(attrs.evolve(step.alone, frame=force))[1] for force in np.eye(m)]
        return np.stack(columns, axis=1)

    def increment(
        self, c_k: float, c_c: float, c_m: float, right: np.ndarray, u: np.ndarray, v: np.ndarray | None, dt: float
    ) -> np.ndarray:
        """(size,) increment by which forces change by ``right``: those of the contacts themselves, not their tangents.

        u, v : (3 nodes,) displacements and velocities at which the last contact forces were evaluated
        dt : with this step [s]; 0 at rest, where places on the second surfaces are looked up meanwhile
        """
        while True:
            try:
                return _Step(self, c_k, c_c, c_m, right).nonlinear(u, v, dt)
            except _Beyond as beyond:
                nodes = beyond.nodes  # (k,) to which a contact has come: the bodies are reduced to these, too
            if self._wanted[nodes].all():
                first = self.assembly.bodies[int(np.searchsorted(self.assembly.starts, nodes[0], side="right")) - 1]
                seat = "its seat reaches into the groove. Mesh it with free nodes there"
                raise ConvergenceError(f"{first.name}: a contact presses on nodes that are held: {seat}")
            self._wanted[nodes] = True
            self._wanted |= touchable(self.contact, self.assembly.nodes)
            self._interface = self.last = None


def _alike(arrays: tuple[np.ndarray, ...], present: tuple[np.ndarray, ...], close: float) -> bool:
    """Whether arrays are equal to a part of their largest entry."""
    return all(
        a.shape == b.shape
        and float(np.abs(np.subtract(a, b, dtype=float)).max(initial=0.0)) <= close * float(np.abs(a).max(initial=0.0))
        for a, b in zip(arrays, present, strict=True)
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
        additions = sum(ring.added for ring in face.rings if ring.added.size)
        self.frame = a.frame_stiffness + self.rate * a.frame_damping + c_m / c_k * a.frame_mass + additions
        nodes, balls = np.empty((len(face.numbers), 3)), np.zeros((face.ball_count, face.extra))
        on_frame, self.carried = right[:m] / c_k, []
        if quiet:  # no forces on the bodies
            self.alone = Motions(np.zeros_like(nodes), balls, on_frame)
            return
        for ring in face.rings:
            displacement, force, interior = ring.forward(self.force)
            nodes[face.place[ring.nodes]] = displacement.reshape(-1, 3)
            on_frame[: len(force)] += force
            self.carried.append(interior)
        for group, members in face.groups:
            displacement, interior = group.forward(self.force)
            nodes[face.place[group.loose.nodes]] = displacement[:, : group.size].reshape(len(members), -1, 3)
            balls[members] = displacement[:, group.size :]
            self.carried.append(interior)
        self.alone = Motions(nodes, balls, on_frame)
        solver.solves += 1

    def linear(self) -> np.ndarray:
        force, frame = self._linear_system(close=0.0).forces(self.alone)
        return self._whole(self._displacement(force, frame), force)

    def nonlinear(self, u: np.ndarray, v: np.ndarray | None, dt: float) -> np.ndarray:
        """Newton's method with a line search; every state balances all forces but those of the contacts."""
        pressing = _Pressing(self.contact, self.face, u, v, self.rate, dt)
        start = pressing.forces()

        def imbalance(state: Motions, force: Motions) -> np.ndarray:
            return force.nodes - (pressing.forces_at(state.nodes) - start)

        force, frame = self._linear_system().forces(self.alone)
        state = self._displacement(force, frame)
        residual = imbalance(state, force)
        # Gaps are differences of places: their last digit is a force, too.
        rounding = ROUNDING * np.abs(self.contact.place).max() * np.abs(self.contact.stiffness).max(initial=0.0)
        enough = max(_INCREMENT * np.abs(force.nodes).max(), rounding)
        before, close = np.inf, _CLOSE
        for _ in range(NEWTON_LIMIT):
            if dt == 0.0 and pressing.locate(state.nodes):
                residual = imbalance(state, force)
            size = np.abs(start + force.nodes).max()
            if np.abs(residual).max() <= max(TOLERANCE * size, enough, 1e-300):
                return self._whole(state, force)
            if not np.isfinite(residual).all():
                raise ConvergenceError("forces are not finite.")
            self.solver.iterations += 1
            if np.abs(residual).max() > SLOW * before:  # what hardly anything holds feels small errors of tangents
                close = 0.0
            before = np.abs(residual).max()
            back = self.face.moved(Motions(residual, np.zeros_like(force.balls), np.zeros_like(frame)), np.zeros_like(frame))
            driver = Motions(back.nodes, back.balls, self.face.on_frame(residual))
            pressed_on, frame_change = self._linear_system(close).forces(driver, _ENOUGH)
            change = Motions(pressed_on.nodes - residual, pressed_on.balls, frame_change)
            way = self.face.moved(Motions(-change.nodes, -change.balls, frame_change), frame_change)
            state, force, residual = self._along(state, way, force, change, imbalance, residual)
        why = f"Newton's residual in the contacts stands at {np.abs(residual).max() / size:.1e} of the largest force after {NEWTON_LIMIT} iterations."
        raise ConvergenceError(why)

    @staticmethod
    def _along(
        state: Motions,
        way: Motions,
        force: Motions,
        change: Motions,
        imbalance: Callable[[Motions, Motions], np.ndarray],
        residual: np.ndarray,
    ) -> tuple[Motions, Motions, np.ndarray]:
        """Motions and forces along a step, and what of the forces is unbalanced there."""

        def at(part: float) -> tuple[tuple[Motions, Motions, np.ndarray], float, bool]:
            trial, trial_force = state.plus(part, way), force.plus(part, change)
            remaining = imbalance(trial, trial_force)
            return (trial, trial_force, remaining), float((way.nodes * remaining).sum()), False

        return searched(float((way.nodes * residual).sum()), at)

    def _linear_system(self, close: float = _CLOSE) -> LinearisedContacts:
        """With the tangents of the last contact forces; the one before where the same points touch and these are as ``close``."""
        contact, face, solver = self.contact, self.face, self.solver
        blocks = contact.stiffness + self.rate * contact.rate_stiffness
        touching = np.flatnonzero(blocks.any(axis=(1, 2)))
        nodes, weights, blocks = face.place[contact.nodes[touching]], contact.weights[touching], blocks[touching]
        made_of = nodes, weights, blocks, self.frame, self.unknown
        if contact.friction is not None:
            close = 0.0  # a point that begins to slide changes little of its tangent and all of its force
        if solver.last is not None and solver.last[0] is face and _alike(solver.last[1], made_of, close):
            return solver.last[2]
        solver.last = None  # one at a time: they are large
        ball = contact.pair[touching] % face.ball_count
        tangents = {}
        for k in range(face.ball_count):
            of_ball = ball == k
            tangents[k] = BallTangent.of(nodes[of_ball], weights[of_ball], blocks[of_ball])
        system = LinearisedContacts(face, tangents, self.frame, self.unknown)
        solver.last = face, tuple(array.copy() for array in made_of), system
        return system

    def _displacement(self, force: Motions, frame: np.ndarray) -> Motions:
        back = self.face.moved(Motions(-force.nodes, -force.balls, frame), frame)
        return Motions(self.alone.nodes + back.nodes, self.alone.balls + back.balls, frame)

    def _whole(self, state: Motions, force: Motions) -> np.ndarray:
        """(size,) all unknowns."""
        a, face = self.a, self.face
        out = np.zeros(3 * a.nodes)
        for ring, interior in zip(face.rings, self.carried, strict=False):
            frame = state.frame[: ring.carried.shape[1]]
            ring.backward(interior, state.nodes[face.place[ring.nodes]].ravel(), frame, out)
        for (group, members), interior in zip(face.groups, self.carried[len(face.rings) :], strict=True):
            displacement = state.nodes[face.place[group.loose.nodes]].reshape(len(members), -1)
            group.backward(interior, displacement, force.balls[members], out)
        return np.concatenate([state.frame, out[a.free]])
