"""Conjugate gradients for the linearised system, with multigrid that knows the contacts and the rigid frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.contact.hertz import ball_compliance
from raceway.core.fem.elastic.assembly import Assembly, Cage
from raceway.core.fem.elastic.bearing_data import BearingData
from raceway.core.fem.elastic.contact import Contact, NodalContact, Pair, PlaceLaw, groove, penalty_stiffness
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.core.fem.elastic.linear_statics import BlockMatrix, Preconditioner
from raceway.core.fem.elastic.resultant import LoadedBody, ResultantContact, Touch, footprint
from raceway.core.fem.elastic.surface import Facets, SurfacePoints, surface_points
from raceway.core.fem.elastic.unknowns import of_nodes
from raceway.core.fem.mesh.hex_mesh import HexMesh
from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Unknowns up to which factors are made.  Rings and balls couple at their contacts only, so that factors stay small: at
#: 97 000 unknowns of a coarse bearing 4.4 CPU-s and 0.75 GB, at 15 000 0.7 CPU-s.  One compact body fills up: two of 16 000
#: unknowns each cost more than multigrid with all its iterations.
_MOST_UNKNOWNS, _MOST_OF_A_BODY = 60_000, 15_000


class _Factorised:
    """LU of a symmetric matrix on the rows that are not held.

    matrix : (n, n) CSR;  held : (n,) bool
    ConvergenceError: a singular matrix: a motion that nothing holds.
    """

    def __init__(self, matrix: csr_matrix, fixed_dofs: np.ndarray) -> None:
        from scipy.sparse.linalg import splu

        rows = np.flatnonzero(~fixed_dofs)
        inner = matrix[rows][:, rows].tocsc()
        try:
            self._factors = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError as why:  # "Factor is exactly singular"
            raise ConvergenceError(f"the stiffness of the bodies is singular: a part is unconstrained ({why})") from why

    def __call__(self, residual: np.ndarray) -> np.ndarray:
        """Solution for a residual (m,), or columns of them, on the m rows."""
        return np.asarray(self._factors.solve(residual))


class LowRankContacts:
    """Low-rank change of an inverse by a few contact resultants and a cage.

    contact : Contact;  cage : Cage | None
    inverse : of the bodies without either, on columns (m, k) of the free nodes;  free : (m,) their rows of all nodes

    With the contacts' motions and the cage's as rows of B and their stiffness D, (A + B^T D B)^-1 = A^-1 - Y (I + D G)^-1 D B A^-1,
    where Y = A^-1 B^T and G = B Y (Woodbury).  Each of them acts on dozens of nodes or on all of a ball: in the matrix itself
    it would couple all of these, and no factor or multigrid stays sparse.  Y does not depend on D, which changes from
    iteration to iteration.
    """

    def __init__(
        self, contact: Contact, cage: Cage | None, inverse: Callable[[np.ndarray], np.ndarray], free: np.ndarray
    ) -> None:
        from scipy.sparse import vstack

        self._contact, self._held = contact, np.zeros(0) if cage is None else cage.stiffness
        rows = contact.move if cage is None else vstack([contact.move, cage.rows], format="csr")
        self._rows = rows[:, free]
        self._answers = np.asarray(inverse(np.ascontiguousarray(self._rows.toarray().T)))
        self._flexibility = self._rows @ self._answers

    def inverse(self, bodies: Callable[[np.ndarray], np.ndarray], rates: float) -> Callable[[np.ndarray], np.ndarray]:
        """With the contacts' present tangents: ``bodies`` is the inverse without them, ``rates`` the weight of the dampers'."""
        from scipy.linalg import block_diag

        # Curvature takes a little of the stiffness across, in iterations far off a lot: conjugate gradients need the positive part.
        values, vectors = np.linalg.eigh(self._contact.stiffness + rates * self._contact.rate_stiffness)
        blocks = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1)
        stiffness = block_diag(*blocks, np.diag(self._held))
        middle = np.linalg.solve(np.eye(len(stiffness)) + stiffness @ self._flexibility, stiffness)

        def apply(residual: np.ndarray) -> np.ndarray:
            alone = bodies(residual)
            return np.asarray(alone - self._answers @ (middle @ (self._rows @ alone)))

        return apply


#: Points of a ball count as contact points where the undeformed gap is below this many Hertz approaches at four times the
#: reference load: the ellipse may then move along the groove by twice its own length.
REACH = 5.0
#: Or at this peak pressure [Pa], where that is more: half the load that ISO 76 (4200 MPa) calls a ball bearing's static limit.
#: So bodies are reduced to the same nodes for all loads that bearings run at.
_STATIC = 4.2e9 * 0.5 ** (1.0 / 3.0)
#: Largest reach of a ring over the ball's diameter; semi-axes of the ellipse that a whole contact presses on, along the groove and
#: across it, over the reach of a ring and over the radius of a ball.
_REACH, _ON_RING, _ON_BALL = 0.34, (0.3, 0.6), (0.5, 0.5)
#: Largest overlap of undeformed bodies over the ball's diameter: tens of times what a contact bears.
_OVERLAP = 0.01
#: Distance of nodes over the ball's diameter at which two balls are the same mesh.
_SAME = 1e-9


def nodal_contact(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> NodalContact:
    """Pressures at points; ``meshes``: inner ring, outer ring, balls."""
    s, g, pairs = setup, setup.geometry, []
    for race, word in enumerate(("inner", "outer")):
        surface = _groove_nodes(s, race)
        facets = Facets(meshes[race].points, meshes[race].facet_nodes("raceway"))
        ellipse = g.ellipses(s.modulus)[race]
        often = (_STATIC / float(ellipse.peak_pressure(1.0))) ** 3  # the pressure grows with the load's cube root
        reach = REACH * float(ellipse.approach(max(4.0 * s.reference_load, often)))
        for k, ball in enumerate(meshes[2:]):
            middle = 0.5 * g.pitch_diameter * s.radial(k)
            points = surface_points(ball.points, ball.facet_nodes("surface"), middle)
            side = (points.place - middle) @ s.line(k, g.contact_angle)
            # Whole facets, four points each, on the race's side of the ball, whose gap in the groove is small.
            x, radius = points.place[:, 0] - surface[1], np.hypot(points.place[:, 1], points.place[:, 2])
            small = surface[5] - np.hypot(x, radius - surface[4]) < reach
            near = (((side < 0.0) == (race == 0)) & small).reshape(-1, 4).any(axis=1)
            points = points[np.repeat(near, 4)]
            points = SurfacePoints(points.place, points.area, points.nodes + assembly.starts[k + 2], points.weights)
            pairs.append(Pair(f"ball {k}, {word} race", points, surface, facets, int(assembly.starts[race])))
    pair = np.repeat(np.arange(len(pairs)), [len(p.points.area) for p in pairs])
    area = np.concatenate([p.points.area for p in pairs])
    damping = 0.0
    if s.contact_damping > 0.0:
        a, b = g.ellipses(s.modulus)[0].semi_axes(s.reference_load)
        damping = s.contact_damping / (np.pi * float(a) * float(b))
    friction = CoulombFriction(s.friction, sticking_stiffness(s, area)) if s.friction > 0.0 else None
    return NodalContact(pairs, assembly.nodes, PlaceLaw(s.law, s.params(pair, area), s.state_size, damping), friction)


def resultant_contact(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> ResultantContact:
    """A force for each ball and race, at the contact angles of ``setup``; ``meshes``: inner ring, outer ring, balls."""
    s, g = setup, setup.geometry
    assert s.angles is not None
    balls = [Facets(ball.points, ball.facet_nodes("surface")) for ball in meshes[2:]]
    answers = _loaded_balls(s, meshes, assembly)
    beyond = np.zeros(2 * s.ball_count) if s.beyond is None else s.beyond
    touches = []
    for race, word in enumerate(("inner", "outer")):
        conformity = g.conformity_inner if race == 0 else g.conformity_outer
        surface = _groove_nodes(s, race)
        surface[5] -= 0.5 * g.ball_diameter
        facets = Facets(meshes[race].points, meshes[race].facet_nodes("raceway"))
        seat = float(np.hypot(*meshes[race].points[meshes[race].nodes("seat"), 1:].T).mean())
        ring = _load_answers(assembly, race, s.rings)
        semi_axes = (float(x) for x in g.ellipses(s.modulus)[race].semi_axes(s.reference_load))
        sphere = ball_compliance(0.5 * g.ball_diameter, *s.balls[:2], *semi_axes)[0]
        for k in range(s.ball_count):
            angle = float(s.angles[race * s.ball_count + k])
            # From the ball into the ring, and along the groove.
            normal, along = s.line(k, angle) * (1.0 if race else -1.0), s.line(k, angle + 0.5 * np.pi)
            centre = s.offsets[race][0] * np.array([1.0, 0.0, 0.0]) + s.offsets[race][1] * s.radial(k)
            pole = centre + conformity * g.ball_diameter * normal
            reach = min(abs(float(np.hypot(*pole[1:])) - seat), _REACH * g.ball_diameter)
            wide = _ON_RING[0] * reach, _ON_RING[1] * reach
            on_ring = footprint(facets, pole, normal, along, centre, wide)
            below = ring.separated(on_ring, pole, normal, wide, reach)
            radius, middle = 0.5 * g.ball_diameter, 0.5 * g.pitch_diameter * s.radial(k)
            wide = _ON_BALL[0] * radius, _ON_BALL[1] * radius
            on_ball = footprint(balls[k], middle + radius * normal, -normal, along, middle, wide)
            # Balls that are the same mesh know each other's answers.
            rotation = s.turn(k) @ s.turn(answers[k][0]).T
            above = answers[k][1].replaced(on_ball, rotation.T @ -normal, sphere)
            name, first = f"ball {k}, {word} race", int(assembly.starts[k + 2])
            on_ball = attrs.evolve(on_ball, nodes=on_ball.nodes + first)
            on_ring = attrs.evolve(on_ring, nodes=on_ring.nodes + int(assembly.starts[race]))
            local = below.local + above - beyond[race * s.ball_count + k]
            overlap = min(float(facets.short.mean()), _OVERLAP * g.ball_diameter)
            touches.append(Touch(name, on_ball, on_ring, middle, surface, local, below.spread, overlap))
    params = s.params(np.arange(len(touches)), np.ones(len(touches)))
    return ResultantContact(touches, assembly.nodes, PlaceLaw(s.law, params, s.state_size, s.contact_damping))


def _loaded_balls(setup: BearingData, meshes: list[HexMesh], assembly: Assembly) -> list[tuple[int, LoadedBody]]:
    """For each ball the first one with the same mesh, turned about the bearing's axis, and that one's answers."""
    out: list[tuple[int, LoadedBody]] = []
    for k, ball in enumerate(meshes[2:]):
        for first, answers in out:
            earlier = meshes[first + 2]
            reference = earlier.points @ setup.turn(first)
            same = earlier.points.shape == ball.points.shape and np.array_equal(earlier.cells, ball.cells)
            if same and np.abs(ball.points @ setup.turn(k) - reference).max() < _SAME * setup.geometry.ball_diameter:
                out.append((first, answers))
                break
        else:
            out.append((k, _load_answers(assembly, k + 2, setup.balls, floating=True)))
    return out


def _load_answers(
    assembly: Assembly, index: int, material: tuple[float, float, float], floating: bool = False
) -> LoadedBody:
    rows, body = assembly.part(index), assembly.bodies[index]
    clamp = np.ones(3 * assembly.nodes, dtype=bool)
    clamp[assembly.free] = False
    stiffness = assembly.stiffness()[rows][:, rows]
    mass = assembly.own_mass[rows.start // 3 : rows.stop // 3] if floating else None
    return LoadedBody(body.points, body.operator.cells, stiffness, clamp[rows].reshape(-1, 3), mass, material)


def _groove_nodes(setup: BearingData, race: int) -> np.ndarray:
    g, centre = setup.geometry, setup.offsets[race]
    radius = (g.conformity_outer if race else g.conformity_inner) * g.ball_diameter
    return groove(np.array([centre[0], 0.0, 0.0]), centre[1] + (0.0 if race else setup.growth), radius)


def sticking_stiffness(setup: BearingData, area: np.ndarray) -> np.ndarray:
    """(n,) stiffness of sticking points [N/m3]; by default 2 (1 - nu) / (2 - nu) of a penalty's (Mindlin 1949)."""
    if setup.stick is not None:
        return np.full(len(area), setup.stick)
    nu = 0.5 * (setup.rings[1] + setup.balls[1])
    return 2.0 * (1.0 - nu) / (2.0 - nu) * penalty_stiffness(setup.modulus, 2.0 * np.sqrt(area))


#: Iterations after which a solve gives up, and after which the multigrid is made anew for the next one.
MOST_ITERATIONS, _MANY_ITERATIONS = 600, 300
#: Iterations of a solve with factors that still fit, and how many more all solves together may take before new factors pay.
_FEW_ITERATIONS, _WORTH_FACTORS = 3, 30
#: Nodes of an aggregate.  Flat cells of contacts are put together in pairs or triples, whose six unknowns would make the next
#: level dearer than the finest one: at 9600 cells 1.3 times the iterations, each at a quarter of the cost.
_FEWEST_NODES = 6
#: Share of the springs in the cage's place that is left where the cage itself is added, so that loose balls have an inverse.
_HARDLY = 1e-3
#: Ratio of the mass' share of the matrix at which the multigrid is made anew.
_OTHER_MASS = 4.0
#: Relative residual to which the free nodes' following of a frame is solved.
_FOLLOW_TOLERANCE = 1e-2


class LinearSolver:
    """(c_k K + c_c C + c_m M)^-1 with the tangents of the last contact forces.

    A frame that moves drags the system along: with Phi = the free nodes' displacement under a unit motion of each
    frame, solved for whenever the multigrid is made, y = (q, Phi q + w) splits the matrix into two blocks that hardly know of
    each other: Phi^T A Phi, a few numbers, and multigrid for w (bodies, contacts, masses).
    """

    def __init__(self, assembly: Assembly, contact: Contact | None, modulus: float) -> None:
        self.assembly, self.contact, self.modulus = assembly, contact, modulus
        self._multigrid: Preconditioner | _Factorised | None = None
        self._whole: LowRankContacts | None = None
        self._built = 0.0
        self._fresh = False
        self._extra = 0
        #: Iterations of the last solve, of all solves, number of solves and of multigrid set-ups.
        self.last_iterations, self.iterations, self.solves, self.setups = 0, 0, 0, 0
        a = assembly
        self._ride = a.carried[a.free]
        self._follow = self._ride
        self._matrix: BlockMatrix | None = None

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float) -> np.ndarray:
        """(size,) solution to a relative residual; zero for frames' coordinates that are held."""
        a = self.assembly
        ratio = c_m / c_k
        stale = self._multigrid is None or self.last_iterations > _MANY_ITERATIONS and not self._fresh
        # Factors hold the contacts' stiffness of when they were made, unless whole contacts are added to them.
        aged = isinstance(self._multigrid, _Factorised) and self._whole is None
        stale = stale or aged and self._extra > _WORTH_FACTORS
        length = float(np.cbrt(a.free_mass.max() / a.bodies[0].operator.density))
        other = abs(np.log((ratio + 1e-300) / (self._built + 1e-300))) > np.log(_OTHER_MASS)
        matters = max(ratio, self._built) * a.free_mass.max() > 1e-3 * self.modulus * length
        if stale or (other and matters):
            self._make(c_k, c_m)
        free_right = np.where(a.unknown, right, 0.0)
        apply = self.image(c_k, c_c, c_m)
        precondition = self._preconditioner(c_k, c_c, apply)
        solution, self.last_iterations = _conjugate_gradients(apply, free_right, precondition, tolerance)
        self._fresh = False
        self._extra += max(self.last_iterations - _FEW_ITERATIONS, 0)
        self.iterations += self.last_iterations
        self.solves += 1
        return solution

    def forget(self) -> None:
        """The next solve makes its multigrid anew."""
        self._multigrid = None

    def _make(self, c_k: float, c_m: float) -> None:
        a, contact = self.assembly, self.contact
        matrix, resultants = a.stiffness(), contact is not None and contact.resultants_only
        if contact is not None and not resultants:
            matrix = matrix + contact.tangent(contact.stiffness)
        extra = c_m / c_k * np.repeat(a.node_mass, 3)
        largest = 3 * int(np.diff(a.starts).max())
        small = len(a.free) <= _MOST_UNKNOWNS and largest <= _MOST_OF_A_BODY
        # Multigrid does not know the answers of bodies that are hardly held well enough to correct them.
        cage = a.cage if resultants and small else None
        if a.cage is not None:
            extra += (1.0 if cage is None else _HARDLY) * a.cage.nodal
        from scipy.sparse import diags_array

        fixed_dofs = np.ones(3 * a.nodes, dtype=bool)
        fixed_dofs[a.free] = False
        sprung = (matrix + diags_array(extra)).tocsr()
        self._multigrid = (
            _Factorised(sprung, fixed_dofs) if small else Preconditioner(sprung, a.points, fixed_dofs, _FEWEST_NODES)
        )
        self._whole = LowRankContacts(contact, cage, self._multigrid, a.free) if contact is not None and resultants else None
        self._built, self._fresh, self._extra = c_m / c_k, True, 0
        self.setups += 1
        # Displacement of the free nodes with each frame
        a, m = self.assembly, self.assembly.frame_size
        self._follow = self._ride.copy()
        apply, multigrid = self.image(c_k, 0.0, c_m), self._inverse(c_k, 0.0)
        for k in np.flatnonzero(a.frame_free):
            start = np.concatenate([np.eye(m)[k], self._ride[:, k]])
            more, count = _conjugate_gradients(
                lambda w: apply(np.concatenate([np.zeros(m), w]))[m:], -apply(start)[m:], multigrid, _FOLLOW_TOLERANCE
            )
            self._follow[:, k] += more
            self.iterations += count

    def image(self, c_k: float, c_c: float, c_m: float) -> Callable[[np.ndarray], np.ndarray]:
        """The matrix' product with unknowns (size,), with the tangents of the last contact forces."""
        a, contact = self.assembly, self.contact
        m = a.frame_size
        if self._matrix is None:
            self._matrix = BlockMatrix(a.stiffness())
        matrix = self._matrix
        blocks = None
        if contact is not None:
            blocks = c_k * contact.stiffness + c_c * contact.rate_stiffness
            touching = np.flatnonzero(blocks.any(axis=(1, 2)))
            move = contact.move[of_nodes(touching)]
            back, blocks = move.T.tocsr(), blocks[touching]
        frame = c_k * a.frame_stiffness + c_c * 0.5 * (a.frame_damping + a.frame_damping.T) + c_m * a.frame_mass

        def apply(y: np.ndarray) -> np.ndarray:
            q, u = y[:m], a.nodal(y)
            force = matrix.times(u)
            if a.cage is not None:
                force += a.cage.internal(u)
            frame_force = np.zeros(m)
            for foundation, ride in a.foundations:
                pull = foundation @ (ride @ q)
                force -= pull
                frame_force += ride.T @ (pull - foundation @ u)
            force *= c_k
            if blocks is not None and len(blocks):
                force += back @ np.einsum("iab,ib->ia", blocks, (move @ u).reshape(-1, 3)).ravel()
            out = a.reduced(force)
            out[:m] += c_k * frame_force + frame @ q
            out[m:] += c_m * a.free_mass * y[m:]
            out[~a.unknown] = 0.0
            return out

        return apply

    def _inverse(self, c_k: float, c_c: float) -> Callable[[np.ndarray], np.ndarray]:
        """Approximate inverse for the free nodes (m,), frames held."""
        multigrid, scale = self._multigrid, 1.0 / c_k
        assert multigrid is not None
        inner = multigrid if self._whole is None else self._whole.inverse(multigrid, c_c / c_k)
        return lambda r: scale * inner(r)

    def _preconditioner(
        self, c_k: float, c_c: float, operator: Callable[[np.ndarray], np.ndarray]
    ) -> Callable[[np.ndarray], np.ndarray]:
        a, m, multigrid = self.assembly, self.assembly.frame_size, self._inverse(c_k, c_c)
        follow = self._follow
        inverse = np.zeros((m, m))
        if a.frame_free.any():
            free = np.flatnonzero(a.frame_free)
            images = np.stack([operator(np.concatenate([np.eye(m)[k], follow[:, k]])) for k in free], axis=1)
            block = images[free] + follow[:, free].T @ images[m:]
            inverse[np.ix_(free, free)] = np.linalg.pinv(0.5 * (block + block.T), hermitian=True)

        def apply(r: np.ndarray) -> np.ndarray:
            out = np.empty_like(r)
            out[m:] = multigrid(r[m:])
            if m:
                out[:m] = inverse @ (r[:m] + follow.T @ r[m:])
                out[m:] += follow @ out[:m]
            return out

        return apply


def _conjugate_gradients(
    apply: Callable[[np.ndarray], np.ndarray],
    right: np.ndarray,
    precondition: Callable[[np.ndarray], np.ndarray],
    tolerance: float,
) -> tuple[np.ndarray, int]:
    """Solution and iterations; the residual is measured in the preconditioner's norm, in which N and N m may be added."""
    solution, residual = np.zeros_like(right), right.copy()
    direction, before, goal = np.zeros_like(right), 1.0, 0.0
    for iteration in range(MOST_ITERATIONS):
        correction = precondition(residual)
        now = float(residual @ correction)
        if iteration == 0:
            goal = tolerance**2 * now
        if now < 0.0:  # a preconditioner that is indefinite here: along the residual, or with what was found so far
            if iteration:
                return solution, iteration
            correction, now, goal = residual.copy(), float(residual @ residual), 0.0
        elif now <= goal:
            return solution, iteration
        direction = correction + (now / before if iteration else 0.0) * direction
        image = apply(direction)
        curvature = float(direction @ image)
        if curvature <= 0.0:  # a free motion or a buckled state: what was found so far still descends
            return (solution if iteration else correction), iteration
        step = now / curvature
        solution += step * direction
        residual -= step * image
        before = now
    return solution, MOST_ITERATIONS
