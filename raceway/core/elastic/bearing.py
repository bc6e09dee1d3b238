"""The bodies of a ball bearing, made into an elastic system: supports, contacts, cage, and what a record looks at."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.body import Body, Frame
from raceway.core.elastic.cage import Cage, cage_rows
from raceway.core.elastic.contact import NodalContact, Pair
from raceway.core.elastic.facets import Facets
from raceway.core.elastic.friction import CoulombFriction
from raceway.core.elastic.gap import groove
from raceway.core.elastic.penalty import penalty_stiffness
from raceway.core.elastic.setup import Setup
from raceway.core.elastic.surface import SurfacePoints, surface_points
from raceway.core.elastic.system import ElasticSystem
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.mesh import HexMesh
from raceway.core.stepping.elastic import Seen
from raceway.errors import MeshError

#: Points of a ball count as contact points where the undeformed gap is below this many Hertz approaches at four times the
#: reference load: the ellipse may then move along the groove by twice its own length.
REACH = 5.0
#: Stiffness of the cage's springs over that of a Hertz contact: it only has to be there.
CAGE_SHARE = 0.1


class ElasticBearing:
    """One row of balls between two rings.

    Parameters
    ----------
    meshes : body -> mesh: inner_ring, outer_ring with the sets "raceway" and "seat", balls in the order of their azimuths
    setup : Setup

    Attributes
    ----------
    system : ElasticSystem
    """

    def __init__(self, meshes: Mapping[str, HexMesh], setup: Setup) -> None:
        self.setup = setup
        names = [name for name in meshes if name not in ("inner_ring", "outer_ring")]
        if len(names) != len(setup.azimuth) or len(names) + 2 != len(meshes):
            raise MeshError(f"{len(setup.azimuth)} balls and two rings are needed, the mesh has {', '.join(meshes)}")
        self._meshes = [meshes["inner_ring"], meshes["outer_ring"], *(meshes[name] for name in names)]
        bodies = [self._ring(meshes["inner_ring"], True), self._ring(meshes["outer_ring"], False)]
        for name in names:
            mesh = meshes[name]
            held = np.zeros((len(mesh.points), 3), dtype=bool)
            bodies.append(Body(name, HexOperator(mesh.points, mesh.cells, *setup.balls, *self._formulation), held))
        bare = Assembly(bodies)
        assembly = Assembly(bodies, self._cage(bare)) if setup.caged else bare
        self._mass = [assembly.node_mass[assembly.starts[k + 2] : assembly.starts[k + 3]] for k in range(self.ball_count)]
        contact = self._contact(assembly)
        load = np.zeros(3 * assembly.nodes)
        for k in range(self.ball_count):
            share = self._mass[k] / self._mass[k].sum()
            load[assembly.part(k + 2)] = (setup.ball_force * share[:, None] * self._radial(k)).ravel()
        load = assembly.reduced(load)
        load[:5] += setup.load
        self.system = ElasticSystem(assembly, contact, setup.modulus, load)

    @property
    def ball_count(self) -> int:
        return len(self.setup.azimuth)

    @property
    def cells(self) -> int:
        return sum(len(mesh.cells) for mesh in self._meshes)

    @property
    def _formulation(self) -> tuple[str, float]:
        return self.setup.formulation, self.setup.hourglass

    def guess(self, q: np.ndarray, ball: np.ndarray) -> np.ndarray:
        """(size,) undeformed bodies where a rigid bearing has them: ring q (5,), balls (Z, 2) from the outer groove centre."""
        a, centre = self.system.assembly, self.setup.offsets[1]
        u = a.carried @ q
        for k in range(self.ball_count):
            moved = ball[k, :2] + centre - [0.0, 0.5 * self.setup.geometry.pitch_diameter]
            u[a.part(k + 2)] = np.tile(moved[0] * np.array([1.0, 0.0, 0.0]) + moved[1] * self._radial(k), len(self._mass[k]))
        return np.concatenate([q, u[a.free]])

    def look(self, system: ElasticSystem, y: np.ndarray, v: np.ndarray) -> Seen:
        """Ring displacement and velocity (5,), smallest gaps and normal forces (2 Z,), ball places (Z, 2)."""
        contact = system.contact
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
            out[k] = mean[0] - centre[0], mean @ self._radial(k) + 0.5 * self.setup.geometry.pitch_diameter - centre[1]
        return out

    def cage_forces(self, y: np.ndarray) -> np.ndarray:
        """(Z, 4) what the ideal cage carries: force along the orbit [N], moments about x, y, z [N m]."""
        a = self.system.assembly
        if a.cage is None:
            return np.zeros((self.ball_count, 4))
        return a.cage.force(a.nodal(y)).reshape(-1, 4)

    def _radial(self, k: int) -> np.ndarray:
        psi = self.setup.azimuth[k]
        return np.array([0.0, np.cos(psi), np.sin(psi)])

    def _ring(self, mesh: HexMesh, inner: bool) -> Body:
        s = self.setup
        operator = HexOperator(mesh.points, mesh.cells, *s.rings, *self._formulation)
        held = np.zeros((len(mesh.points), 3), dtype=bool)
        seat = s.seat_inner if inner else s.seat_outer
        bed = None if isinstance(seat, str) else (mesh.facet_nodes("seat"), float(seat))
        if not inner:
            if bed is None:
                held[mesh.nodes("seat")] = True
            return Body("outer_ring", operator, held, None, bed)
        reference = np.array([s.offsets[0][0], 0.0, 0.0])
        free = np.asarray(s.free, dtype=float) > 0.0
        frame = Frame(mesh.nodes("seat"), reference, (0, 1, 2, 4, 5), s.mass, s.damping, s.stiffness, free)
        return Body("inner_ring", operator, held, frame, bed)

    def _cage(self, assembly: Assembly) -> Cage:
        from scipy.sparse import coo_array

        s, data, rows, columns = self.setup, [], [], []
        g = s.geometry
        inner = g.ellipses(s.modulus)[0]
        normal = 1.5 * s.reference_load / float(inner.approach(s.reference_load))
        names, nodal = [], np.zeros(3 * assembly.nodes)
        for k in range(len(s.azimuth)):
            body = assembly.bodies[k + 2]
            mass = assembly.node_mass[assembly.starts[k + 2] : assembly.starts[k + 3]]
            along = np.array([0.0, -np.sin(s.azimuth[k]), np.cos(s.azimuth[k])])
            found = cage_rows(body.points, mass, along)
            data.append(found.ravel())
            rows.append(np.repeat(4 * k + np.arange(4), found.shape[1]))
            columns.append(np.tile(3 * assembly.starts[k + 2] + np.arange(found.shape[1]), 4))
            nodal[assembly.part(k + 2)] = CAGE_SHARE * normal * np.repeat(mass / mass.sum(), 3)
            names += [f"{body.name}: along its orbit", *(f"{body.name}: turning about {axis}" for axis in "xyz")]
        shape = (4 * len(s.azimuth), 3 * assembly.nodes)
        matrix = coo_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape).tocsr()
        turning = 0.1 * g.ball_diameter**2  # of a sphere: what a spring on every node by its mass holds against turning
        one = CAGE_SHARE * normal * np.array([1.0, turning, turning, turning])
        return Cage(matrix, np.tile(one, len(s.azimuth)), tuple(names), nodal)

    def _contact(self, assembly: Assembly) -> NodalContact:
        s, g = self.setup, self.setup.geometry
        pairs = []
        for inner in (True, False):
            index = 0 if inner else 1
            centre = s.offsets[index]
            radius = (g.conformity_inner if inner else g.conformity_outer) * g.ball_diameter
            circle = centre[1] + (s.growth if inner else 0.0)
            surface = groove(np.array([centre[0], 0.0, 0.0]), circle, radius)
            mesh = self._meshes[index]
            facets = Facets(mesh.points, mesh.facet_nodes("raceway"))
            ellipse = g.ellipses(s.modulus)[index]
            reach = REACH * float(ellipse.approach(4.0 * s.reference_load))
            for k in range(self.ball_count):
                ball = self._meshes[k + 2]
                middle = 0.5 * g.pitch_diameter * self._radial(k)
                found = surface_points(ball.points, ball.facet_nodes("surface"), middle)
                side = (found.place - middle) @ np.array(
                    [np.sin(g.contact_angle), *np.cos(g.contact_angle) * self._radial(k)[1:]]
                )
                found = _near(found, (side < 0.0) == inner, surface, reach)
                found = SurfacePoints(found.place, found.area, found.nodes + assembly.starts[k + 2], found.weights)
                word = "inner" if inner else "outer"
                pairs.append(Pair(f"ball {k}, {word} race", found, surface, facets, int(assembly.starts[index])))
        which = np.repeat(np.arange(len(pairs)), [len(p.points.area) for p in pairs])
        area = np.concatenate([p.points.area for p in pairs])
        damping = 0.0
        if s.contact_damping > 0.0:
            a, b = g.ellipses(s.modulus)[0].semi_axes(s.reference_load)
            damping = s.contact_damping / (np.pi * float(a) * float(b))
        friction = CoulombFriction(s.friction, self._sticking(area)) if s.friction > 0.0 else None
        return NodalContact(pairs, assembly.nodes, s.law, s.params(which, area), s.state_size, damping, friction)

    def _sticking(self, area: np.ndarray) -> np.ndarray:
        """(n,) stiffness of sticking points [N/m3]; by default 2 (1 - nu) / (2 - nu) of a penalty's (Mindlin 1949)."""
        if self.setup.stick is not None:
            return np.full(len(area), self.setup.stick)
        nu = 0.5 * (self.setup.rings[1] + self.setup.balls[1])
        return 2.0 * (1.0 - nu) / (2.0 - nu) * penalty_stiffness(self.setup.modulus, 2.0 * np.sqrt(area))


def _near(points: SurfacePoints, side: np.ndarray, surface: np.ndarray, reach: float) -> SurfacePoints:
    """Points on one side of the ball whose gap in the groove is below ``reach`` [m]; whole facets, four points each."""
    x, radius = points.place[:, 0] - surface[1], np.hypot(points.place[:, 1], points.place[:, 2])
    gap = surface[5] - np.hypot(x, radius - surface[4])
    chosen = (side & (gap < reach)).reshape(-1, 4).any(axis=1)
    return points[np.repeat(chosen, 4)]
