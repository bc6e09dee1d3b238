"""The bodies of a ball bearing, made into an elastic system: supports, contacts, cage, and what a record looks at."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from raceway.core.fem.elastic import device
from raceway.core.fem.elastic.assembly import Assembly, Body, Cage, Frame
from raceway.core.fem.elastic.bearing_data import BearingData
from raceway.core.fem.elastic.contact import CIRCLE, Contact, NodalContact
from raceway.core.fem.elastic.copies import Copies, Group, same_bodies, sectors
from raceway.core.fem.elastic.explicit import ExplicitSteps, served
from raceway.core.fem.elastic.interface import free_nodes, touchable
from raceway.core.fem.elastic.iterative_solver import LinearSolver, nodal_contact, resultant_contact
from raceway.core.fem.elastic.newton import TOLERANCE, StaticSolution, solve_equilibrium
from raceway.core.fem.elastic.superelement_solver import CondensedSolver
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.fem.mesh.hex_mesh import HexMesh
from raceway.core.record import Motion, Observation, State, divide
from raceway.core.threads import ThreadPool
from raceway.errors import ConvergenceError, MeshError, SceneError

#: Relative residual of the linear solves of a time step: Newton's next iteration takes the rest.
_LINEAR_TOLERANCE = 1e-4
#: Nodal forces of bodies over those of contacts, one where they balance, below which nothing has deformed yet.
_PRESSED_BACK = 0.5

#: Names of the unknowns in ``Motion.full_state``.
_UNKNOWNS = ("u", "v", "a", "rest")
#: Ring displacement, velocity (5,), gaps, contact forces (2 Z,), ball places (Z, 2).
Seen = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class ElasticSystem:
    """M a + C v + f(y) = load + scale * excitation(t) for the unknowns of an assembly: a ``SteppedSystem``.

    assembly : Assembly;  contact : Contact | None;  modulus : E* of the contacts [Pa]
    load : (size,) constant forces [N, N m]
    condensed : solver by superelements, of a bearing in nodal contact; None: conjugate gradients
    look : what a record keeps, function of (y, v); None: smallest gap and normal force of every pair, no ring

    excitation : function of t -> (frame unknowns,) forces on the first frame's motions, or None
    """

    def __init__(
        self, assembly: Assembly, contact: Contact | None, modulus: float, load: np.ndarray,
        condensed_solver: CondensedSolver | None = None, look: Callable[[np.ndarray, np.ndarray], Seen] | None = None,
    ) -> None:  # fmt: skip
        self.assembly, self.contact, self.load = assembly, contact, np.array(load, dtype=float)
        self.excitation: Callable[[float], np.ndarray] | None = None
        #: Called with the relative residual of every iteration of ``solve_equilibrium``.
        self.on_residual: Callable[[float], None] | None = None
        self.condensed, self._look = condensed_solver, look
        self.solver: LinearSolver | CondensedSolver = condensed_solver or LinearSolver(assembly, contact, modulus)
        self.size: int = assembly.size
        self.ball_count = 0 if contact is None else (len(contact.counts) + 1) // 2
        m = assembly.frame_size
        # Moments count as the force at the arm of the rotations: columns of rotations hold lengths, of translations ones.
        reach = np.abs(assembly.carried).max(axis=0) if m else np.zeros(0)
        self._weight = np.concatenate([np.where(reach > 0.0, 1.0 / np.maximum(reach, 1e-30), 0.0), np.ones(self.size - m)])
        self._u = np.zeros(3 * assembly.nodes)
        self._y = np.zeros(self.size)
        #: Velocities (size,) and step with which contact forces were evaluated last.
        self._at: tuple[np.ndarray | None, float] = (None, 0.0)
        self._element_step: float | None = None
        # Surfaces that overlap by more than an element before loading are in the wrong place
        if self.contact is not None:
            self.contact.evaluate(0.0, self._u)
            for index in range(len(self.contact.counts)):
                name, depth, size = self.contact.overlap(index)
                if depth > size:
                    raise MeshError(
                        f"{name}: the surfaces overlap by {1e6 * depth:.3g} µm before loading, more than an "
                        f"element there or a hundredth of a ball ({1e6 * size:.3g} µm): check the places of the bodies, radial_clearance, preload and radial_expansion"
                    )

    # Forces

    @property
    def conservative(self) -> bool:
        return self.contact is None or self.contact.friction is None

    @property
    def smooth(self) -> bool:
        return self.condensed is not None

    @property
    def linear_iterations(self) -> int:
        """Of all linear solves so far."""
        return self.solver.iterations

    @property
    def threads(self) -> ThreadPool:
        return self.assembly.threads

    def outer_force(self, t: float) -> np.ndarray:
        out, force = np.zeros(5), self.on_frame(t)[:5]
        out[: len(force)] = force
        return out

    def on_frame(self, t: float) -> np.ndarray:
        return np.zeros(self.assembly.frame_size) if self.excitation is None else np.asarray(self.excitation(t))

    def external(self, t: float, scale: float) -> np.ndarray:
        load, force = self.load, self.on_frame(t)
        out = np.empty(self.size)
        self.threads.do_shares(self.size, lambda first, last: np.copyto(out[first:last], load[first:last]))
        out[: len(force)] += scale * force
        return out

    def internal(self, t: float, dt: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        a = self.assembly
        out, self._u = a.forces(dt, np.ascontiguousarray(u), v, self.contact)
        self._at = v if dt > 0.0 else None, dt
        m = a.frame_size
        out[:m] += a.frame_damping @ v[:m]
        return out

    def static_internal(self, y: np.ndarray, share: float = 0.0) -> np.ndarray:
        """(size,) internal forces at rest; ``share``: see ``Contact.evaluate``."""
        a = self.assembly
        self._y, self._u = y.copy(), a.nodal(y)
        out = a.internal(y, self._u)
        if self.contact is not None:
            self._at = None, 0.0
            out += a.reduced(self.contact.evaluate(0.0, self._u, None, share))
        return out

    def solve(
        self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float = _LINEAR_TOLERANCE
    ) -> np.ndarray:
        """(size,) increment by which the forces of the last ``internal`` change by ``right``.

        tolerance : of conjugate gradients, by which without superelements the tangents of these forces are solved
        """
        if self.condensed is None:
            return self.solver.solve(c_k, c_c, c_m, right, tolerance)
        v, dt = self._at
        rate = None if v is None else self.assembly.nodal(np.ascontiguousarray(v))
        return self.condensed.increment(c_k, c_c, c_m, right, self._u, rate, dt)

    def mass_times(self, a: np.ndarray) -> np.ndarray:
        m = self.assembly.frame_size
        return np.concatenate([self.assembly.frame_mass @ a[:m], self.assembly.free_mass * a[m:]])

    def accelerations(self, outer: np.ndarray, inner: np.ndarray, a: np.ndarray, c: float) -> np.ndarray:
        """In place of ``inner``: masses of nodes are lumped, those of the frames a small matrix."""
        assembly = self.assembly
        m, free = assembly.frame_size, assembly.frame_free
        frame = np.zeros(m)
        if free.any():
            remaining = outer[:m] - inner[:m] + c * (assembly.frame_damping @ a[:m])
            matrix = assembly.frame_mass + c * assembly.frame_damping
            frame[free] = np.linalg.solve(matrix[np.ix_(free, free)], remaining[free])
        masses, outside, inside = assembly.free_mass, outer[m:], inner[m:]
        self.threads.do_shares(len(masses), lambda first, last: divide(first, last, outside, inside, masses))
        inner[:m] = frame
        return inner

    def measure(self, r: np.ndarray) -> float:
        """Euclidean norm of nodal forces and of the frames' forces; moments over their arm [N]."""
        return float(np.linalg.norm(r * self._weight * self.assembly.unknown))

    def undeformed(self, y: np.ndarray) -> bool:
        """Whether contacts at surface points press on bodies that do not press back yet: they overlap as rigid ones do."""
        a, contact = self.assembly, self.contact
        if contact is None or contact.resultants_only:
            return False
        u = a.nodal(y)
        pressing, back = a.reduced(contact.evaluate(0.0, u)), a.internal(y, u)
        m = a.frame_size
        return bool(np.linalg.norm(back[m:]) < _PRESSED_BACK * np.linalg.norm(pressing[m:]))

    def force_scale(self) -> float:
        """Norm of the forces that have to balance at the last ``internal`` [N]."""
        nodal = 0.0
        if self.contact is not None:
            nodal = self.measure(self.assembly.reduced(self.contact.move.T @ self.contact.force.reshape(-1)))
        return max(nodal, self.measure(self.load))

    def contacts(self) -> tuple[float, float, float]:
        if self.contact is None:
            return 0.0, 0.0, 0.0
        force = np.linalg.norm(self.contact.resultants(), axis=1)
        return max(-float(self.contact.gap.min()), 0.0), float(force.max()), float(force.sum())

    def stable_step(self) -> float:
        """Of elements and contacts together: 1/dt^2 adds up, as the largest eigenvalues at most do [s]."""
        mine = np.inf if self.contact is None else self.contact.stable_step(self.assembly.node_mass)
        return float(1.0 / np.sqrt(1.0 / self.element_step() ** 2 + 1.0 / mine**2))

    def element_step(self) -> float:
        """Stable step of the elements alone [s]."""
        if self._element_step is None:
            self._element_step = min(body.operator.stable_step() for body in self.assembly.unequal())
        return self._element_step

    def stiffened(self) -> bool:
        """Whether a contact is stiffer than at any ``stable_step`` before: elements stay as they are."""
        return self.contact is not None and self.contact.stiffened()

    def explicit(self, dt: float, where: str) -> ExplicitSteps | None:
        a, able = self.assembly, served(self)
        if where != "cpu":
            reason = "steps only hexahedra of the formulation 'one_point' on rigid seats in contact at surface points"
            if able and self.contact is not None:
                reason = device.refusal(sum(len(body.operator.cells) for body in a.bodies), a.nodes, self.contact.law)
            if not reason:
                from raceway.core.fem.elastic.device_steps import DeviceSteps

                return DeviceSteps(self, dt)
            if where == "gpu":
                raise SceneError.at("integrator.device", "gpu", f"{reason}, or use 'cpu' or 'auto'")
        return ExplicitSteps(self, dt) if able else None

    def commit(self) -> None:
        if self.contact is not None:
            self.contact.commit()
            # Between steps only: within one, places that jump would keep Newton from converging.
            self.contact.update(self.contact.where, in_motion=True)

    def rollback(self) -> None:
        """Nothing: trials of contacts leave no trace."""

    # Motions

    def begin(self, motion: Motion) -> State:
        full_state = dict(motion.full_state or {})
        contact = self.contact
        if contact is not None and "projected" in full_state:
            contact.restore(full_state["projected"], full_state["memory"])
            if contact.friction is not None:
                contact.friction.restore(full_state)
        return State(*(np.array(full_state[name]) for name in _UNKNOWNS))

    def motion(self, state: State) -> Motion:
        s, contact = state.copy(), self.contact
        net_force = -self.mass_times(s.a) if s.net_force is None else s.net_force
        full_state = dict(zip(_UNKNOWNS, (s.u, s.v, s.a, net_force), strict=True))
        if contact is not None:
            full_state |= {"projected": contact.projected.copy(), "memory": contact.memory.copy()}
            if contact.friction is not None:
                full_state |= contact.friction.state()
        q, v, _, _, ball = self._seen(s.u, s.v)
        return Motion(q, v, self._seen(s.u, s.a)[1], ball, ball.copy(), full_state=full_state)

    def motion_of(self, y: np.ndarray, v: np.ndarray, a: np.ndarray) -> Motion:
        """A motion with unknowns, velocities and accelerations (size,) whose forces balance."""
        return self.motion(State(y, v, a, -self.mass_times(a)))

    def observe(self, u: np.ndarray, v: np.ndarray) -> Observation:
        q, speed, gap, force, ball = self._seen(u, v)
        return Observation(q, speed, gap, force, ball, self.energies(u, v))

    def _seen(self, u: np.ndarray, v: np.ndarray) -> Seen:
        if self._look is not None:
            return self._look(u, v)
        contact, z = self.contact, self.ball_count
        gap, force = np.zeros(2 * z), np.zeros(2 * z)
        if contact is not None:
            n = len(contact.counts)
            gap[:n] = contact.deepest()
            force[:n] = np.linalg.norm(contact.resultants(), axis=1)
        return np.zeros(5), np.zeros(5), gap, force, np.zeros((z, 2))

    # Statics

    def solve_equilibrium(self, guess: np.ndarray, tolerance: float = TOLERANCE) -> StaticSolution:
        """Equilibrium under ``load``; places on the second surfaces are looked up anew until they stay.

        ConvergenceError: A rigid motion that nothing holds, by name, or no equilibrium: with the last good state and the residuals.
        """
        touching = []
        if self.contact is not None:
            for nodes in map(self.contact.nodes_of, range(len(self.contact.counts))):
                first, second = np.searchsorted(self.assembly.starts, nodes, side="right") - 1
                touching.append((int(first), int(second)))
        loose = self.assembly.loose_motions(touching)
        if loose:
            raise ConvergenceError("nothing holds " + "; ".join(loose))
        return solve_equilibrium(self, np.array(guess, dtype=float), tolerance)

    @contextmanager
    def without_friction(self) -> Iterator[None]:
        """Contacts carry no friction inside; its history is unchanged."""
        contact = self.contact
        if contact is None:
            yield
            return
        friction, contact.friction = contact.friction, None
        try:
            yield
        finally:
            contact.friction = friction

    def locate(self, y: np.ndarray) -> bool:
        """Look up where the points lie on the second surfaces at a state; whether that changed anything."""
        if self.contact is None:
            return False
        surface = self.contact.move @ self.assembly.nodal(y)
        return self.contact.update(self.contact.place + surface.reshape(-1, 3))

    def energies(self, y: np.ndarray, v: np.ndarray) -> dict[str, float]:
        """Energies [J] at the last ``internal``."""
        a = self.assembly
        u = a.nodal(y)
        added = {"added mass": float(0.5 * np.repeat(a.added_mass, 3) @ a.nodal(v) ** 2)} if a.added_mass.any() else {}
        return added | {
            "elastic": float(0.5 * y @ a.internal(y, u)),  # of bodies, beds, the frames' springs and the cage
            "kinetic": float(0.5 * v @ self.mass_times(v)),
            "contact": 0.0 if self.contact is None else self.contact.energy(),
            "friction": 0.0 if self.contact is None else self.contact.friction_energy(),
            "hourglass": a.body_forces.hourglass_energy(u, a.threads),
        }


#: Stiffness of the cage's springs over that of a Hertz contact: it only has to be there.
SHARE = 0.1
#: With friction: of a motion in which a ball rolls, and of turning in the meridian plane, where it does not.
_ROLLS, _HELD = 1e-3, 100.0


def cage_stiffness(normal: float, diameter: float, friction: bool) -> np.ndarray:
    """(4,) springs [N/m, N m/rad] of a ball's cage, for the rows of ``cage_rows``.

    normal : stiffness of a Hertz contact [N/m];  diameter : of the ball [m]

    With friction a cage's stiffness is felt: what pushes a ball that cannot turn slides or sticks.  Balls roll along their orbits,
    hence freely about axes in the meridian plane; about the orbit they do not, as for rigid and condensed bodies.
    """
    turning = 0.1 * diameter**2  # of a sphere: what a spring on every node by its mass holds against turning
    share = np.array([_ROLLS, _HELD, _ROLLS, _ROLLS] if friction else [SHARE] * 4)
    return np.asarray(share * normal * np.array([1.0, turning, turning, turning]))


def cage_fields(points: np.ndarray, mass: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centre of mass (3,) of a ball, and the rows of its cage, with ``along`` a unit vector of its orbit, as fields t + w x r about that (4, 6)."""
    total, axis, fields = mass.sum(), np.array([1.0, 0.0, 0.0]), np.zeros((4, 6))
    centre = (mass[:, None] * points).sum(axis=0) / total
    arm = points - centre
    inertia = ((arm**2).sum(axis=1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]) * mass[:, None, None]
    about = np.stack([along, np.cross(along, axis), axis])
    fields[0, :3], fields[1:, 3:] = along / total, np.linalg.solve(inertia.sum(axis=0), about.T).T
    return centre, fields


def cage_rows(points: np.ndarray, mass: np.ndarray, centre: np.ndarray, fields: np.ndarray) -> np.ndarray:
    """(4, 3 n) of one ball's ``cage_fields``: mass means of the displacement along its orbit, of turns about orbit, radius and axis.

    A rigid motion u = c + w x r about the centre of mass gives c . along and the parts of w; elastic motions that are orthogonal to
    the rigid ones give nothing.
    """
    each = fields[:, None, :3] + np.cross(fields[:, None, 3:], points - centre)
    return np.asarray((each * mass[:, None]).reshape(4, -1))


def _ring_parts(assembly: Assembly, index: int, azimuth: np.ndarray) -> Copies:
    body, first = assembly.bodies[index], int(assembly.starts[index])
    seat = np.zeros(len(body.points), dtype=bool)
    if body.foundation is not None:
        seat[body.foundation[0].ravel()] = True
    cells = np.asarray(body.operator.cells, dtype=np.int64)
    marks = np.column_stack([free_nodes(assembly, index), seat])
    ring_sectors = sectors(body.points, cells, azimuth, marks, first)
    return Copies.single(body.points, cells, first) if ring_sectors is None else ring_sectors


class ElasticBearing:
    """One row of balls between two rings.

    meshes : body -> mesh: inner_ring, outer_ring with the sets "raceway" and "seat", balls in the order of their azimuths
    setup : Setup

    system : ElasticSystem
    """

    def __init__(self, meshes: Mapping[str, HexMesh], setup: BearingData) -> None:
        self.setup = setup
        names = [name for name in meshes if name not in ("inner_ring", "outer_ring")]
        if len(names) != len(setup.azimuth) or len(names) + 2 != len(meshes):
            raise MeshError(f"{len(setup.azimuth)} balls and two rings are needed, the mesh has {', '.join(meshes)}")
        self._meshes = [meshes["inner_ring"], meshes["outer_ring"], *(meshes[name] for name in names)]
        bodies = [self._ring(meshes["inner_ring"], True), self._ring(meshes["outer_ring"], False)]
        for name in names:
            mesh = meshes[name]
            fixed_dofs = np.zeros((len(mesh.points), 3), dtype=bool)
            bodies.append(Body(name, HexOperator(mesh.points, mesh.cells, *setup.balls, *self._formulation), fixed_dofs))
        assembly = Assembly(bodies)
        rings = [Group(_ring_parts(assembly, index, setup.azimuth), [index]) for index in (0, 1)]
        parts = [(body.points, np.asarray(body.operator.cells)) for body in assembly.bodies[2:]]
        balls = same_bodies(parts, setup.azimuth, assembly.starts[2:-1])  # supports are equal, too
        assembly.groups = rings + [Group(copies, [ball + 2 for ball in members]) for copies, members in balls]
        if setup.caged:
            assembly.hold(self._cage(assembly))
        self._mass = [assembly.own_mass[assembly.starts[k + 2] : assembly.starts[k + 3]] for k in range(self.ball_count)]
        contact = (nodal_contact if setup.angles is None else resultant_contact)(setup, self._meshes, assembly)
        outward = np.zeros(3 * assembly.nodes)
        for k in range(self.ball_count):
            share = self._mass[k] / self._mass[k].sum()
            outward[assembly.part(k + 2)] = (setup.ball_force * share[:, None] * setup.radial(k)).ravel()
        self._centrifugal = assembly.reduced(outward)
        load = self._centrifugal.copy()
        load[:5] += setup.load
        condensed_solver = None
        if isinstance(contact, NodalContact):
            # Each ring needs a free node among those that contacts may touch
            under = touchable(contact, assembly.nodes)
            seats = (setup.seat_inner, setup.seat_outer)
            for index, (name, seat) in enumerate(zip(("inner", "outer"), seats, strict=True)):
                groove = under[assembly.starts[index] : assembly.starts[index + 1]]
                if groove.any() and not (groove & free_nodes(assembly, index)).any():
                    held = f"the set 'seat' of the {name} ring, and that has every node of the groove below the contacts"
                    remedy = f"Take the groove out of the set in mesh.{name}_ring, or name the right one"
                    why = f'it holds {held}: none is free. {remedy}: [mesh.sets.{name}_ring] seat = "..."'
                    raise MeshError.at(f"supports.{name}_seat", seat, why)
            condensed_solver = CondensedSolver(assembly, contact)
        self.system = ElasticSystem(assembly, contact, setup.modulus, load, condensed_solver, self.look)

    @property
    def ball_count(self) -> int:
        return self.setup.ball_count

    @property
    def cells(self) -> int:
        return sum(len(mesh.cells) for mesh in self._meshes)

    @property
    def _formulation(self) -> tuple[str, float, float]:
        return self.setup.formulation, self.setup.hourglass, self.setup.least_step

    def guess(self, q: np.ndarray, ball: np.ndarray) -> np.ndarray:
        """(size,) undeformed bodies where a rigid bearing has them: ring q (5,), balls (Z, 2) from the outer groove centre."""
        a, centre = self.system.assembly, self.setup.offsets[1]
        u = a.carried @ q
        for k in range(self.ball_count):
            shift = ball[k, :2] + centre - [0.0, 0.5 * self.setup.geometry.pitch_diameter]
            moved = shift[0] * np.array([1.0, 0.0, 0.0]) + shift[1] * self.setup.radial(k)
            u[a.part(k + 2)] = np.tile(moved, len(self._mass[k]))
        return np.concatenate([q, u[a.free]])

    @contextmanager
    def mounted(self) -> Iterator[None]:
        """Inside, the bearing stands still and has not grown: no centrifugal forces, the inner groove as it is meshed."""
        system, inner = self.system, slice(0, self.ball_count)
        assert system.contact is not None
        surfaces = system.contact.surfaces
        system.load -= self._centrifugal
        surfaces[inner, CIRCLE] -= self.setup.growth
        try:
            yield
        finally:
            surfaces[inner, CIRCLE] += self.setup.growth
            system.load += self._centrifugal

    def look(self, y: np.ndarray, v: np.ndarray) -> Seen:
        """Ring displacement and velocity (5,), smallest gaps and normal forces (2 Z,), ball places (Z, 2)."""
        contact = self.system.contact
        assert contact is not None
        force = np.linalg.norm(contact.resultants(), axis=1)
        return y[:5].copy(), v[:5].copy(), contact.deepest(), force, self.ball_places(y)

    def ball_places(self, y: np.ndarray) -> np.ndarray:
        """(Z, 2) mass means of the balls in their meridian planes, from the outer groove centre: axial, radial [m]."""
        a, centre = self.system.assembly, self.setup.offsets[1]
        u = a.nodal(y)
        out = np.empty((self.ball_count, 2))
        for k, mass in enumerate(self._mass):
            mean = mass @ u[a.part(k + 2)].reshape(-1, 3) / mass.sum()
            out[k] = mean[0] - centre[0], mean @ self.setup.radial(k) + 0.5 * self.setup.geometry.pitch_diameter - centre[1]
        return out

    def _ring(self, mesh: HexMesh, inner: bool) -> Body:
        s = self.setup
        operator = HexOperator(mesh.points, mesh.cells, *s.rings, *self._formulation)
        fixed_dofs = np.zeros((len(mesh.points), 3), dtype=bool)
        seat = s.seat_inner if inner else s.seat_outer
        foundation = None if isinstance(seat, str) else (mesh.facet_nodes("seat"), float(seat))
        if not inner:
            if foundation is None:
                fixed_dofs[mesh.nodes("seat")] = True
            return Body("outer_ring", operator, fixed_dofs, None, foundation)
        reference = np.array([s.offsets[0][0], 0.0, 0.0])
        free = np.asarray(s.free, dtype=float) > 0.0
        frame = Frame(mesh.nodes("seat"), reference, (0, 1, 2, 4, 5), s.mass, s.damping, s.stiffness, free)
        return Body("inner_ring", operator, fixed_dofs, frame, foundation)

    def _cage(self, assembly: Assembly) -> Cage:
        from scipy.sparse import coo_array

        s, data, rows, columns, balls = self.setup, [], [], [], []
        g = s.geometry
        inner = g.ellipses(s.modulus)[0]
        normal = 1.5 * s.reference_load / float(inner.approach(s.reference_load))
        springs = cage_stiffness(normal, g.ball_diameter, s.friction > 0.0)
        nodal = np.zeros(3 * assembly.nodes)
        for k in range(len(s.azimuth)):
            body = assembly.bodies[k + 2]
            mass = assembly.own_mass[assembly.starts[k + 2] : assembly.starts[k + 3]]
            along = np.array([0.0, -np.sin(s.azimuth[k]), np.cos(s.azimuth[k])])
            balls.append(cage_fields(body.points, mass, along))
            means = cage_rows(body.points, mass, *balls[-1])
            data.append(means.ravel())
            rows.append(np.repeat(4 * k + np.arange(4), means.shape[1]))
            columns.append(np.tile(3 * assembly.starts[k + 2] + np.arange(means.shape[1]), 4))
            nodal[assembly.part(k + 2)] = SHARE * normal * np.repeat(mass / mass.sum(), 3)
        shape = (4 * len(s.azimuth), 3 * assembly.nodes)
        matrix = coo_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape).tocsr()
        centres, fields = (np.array(each) for each in zip(*balls, strict=True))
        return Cage(matrix, np.tile(springs, len(s.azimuth)), nodal, fields, centres)
