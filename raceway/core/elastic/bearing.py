"""The bodies of a ball bearing, made into an elastic system: supports, contacts, cage, and what a record looks at."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.bearing_data import BearingData
from raceway.core.elastic.body import Body, Frame
from raceway.core.elastic.cage import NAMES, SHARE, Cage, cage_rows, cage_stiffness
from raceway.core.elastic.contacts.gap import CIRCLE
from raceway.core.elastic.contacts.nodal import NodalContact
from raceway.core.elastic.equal_parts import equal_parts, free_nodes
from raceway.core.elastic.stepped import Seen
from raceway.core.elastic.superelements.bearing import touchable
from raceway.core.elastic.superelements.solver import CondensedSolver
from raceway.core.elastic.system import ElasticSystem
from raceway.core.elastic.touching import nodal_contact, resultant_contact
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.mesh.hex_mesh import HexMesh
from raceway.errors import MeshError


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

    def __init__(self, meshes: Mapping[str, HexMesh], setup: BearingData) -> None:
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
        assembly = Assembly(bodies)
        assembly.share(equal_parts(assembly, setup.azimuth))
        if setup.caged:
            assembly.hold(self._cage(assembly))
        self._mass = [assembly.node_mass[assembly.starts[k + 2] : assembly.starts[k + 3]] for k in range(self.ball_count)]
        contact = (nodal_contact if setup.angles is None else resultant_contact)(setup, self._meshes, assembly)
        outward = np.zeros(3 * assembly.nodes)
        for k in range(self.ball_count):
            share = self._mass[k] / self._mass[k].sum()
            outward[assembly.part(k + 2)] = (setup.ball_force * share[:, None] * setup.radial(k)).ravel()
        self._centrifugal = assembly.reduced(outward)
        load = self._centrifugal.copy()
        load[:5] += setup.load
        condensed = None
        if isinstance(contact, NodalContact):
            _refuse_held_grooves(assembly, touchable(contact, assembly.nodes), (setup.seat_inner, setup.seat_outer))
            condensed = CondensedSolver(assembly, contact)
        self.system = ElasticSystem(assembly, contact, setup.modulus, load, condensed=condensed)

    @property
    def ball_count(self) -> int:
        return self.setup.ball_count

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
            u[a.part(k + 2)] = np.tile(
                moved[0] * np.array([1.0, 0.0, 0.0]) + moved[1] * self.setup.radial(k), len(self._mass[k])
            )
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
            out[k] = mean[0] - centre[0], mean @ self.setup.radial(k) + 0.5 * self.setup.geometry.pitch_diameter - centre[1]
        return out

    def cage_forces(self, y: np.ndarray) -> np.ndarray:
        """(Z, 4) what the ideal cage carries: force along the orbit [N], moments about orbit, radius and axis [N m]."""
        a = self.system.assembly
        if a.cage is None:
            return np.zeros((self.ball_count, 4))
        return a.cage.force(a.nodal(y)).reshape(-1, 4)

    def _ring(self, mesh: HexMesh, inner: bool) -> Body:
        s = self.setup
        operator = HexOperator(mesh.points, mesh.cells, *s.rings, *self._formulation)
        held = np.zeros((len(mesh.points), 3), dtype=bool)
        seat = s.seat_inner if inner else s.seat_outer
        foundation = None if isinstance(seat, str) else (mesh.facet_nodes("seat"), float(seat))
        if not inner:
            if foundation is None:
                held[mesh.nodes("seat")] = True
            return Body("outer_ring", operator, held, None, foundation)
        reference = np.array([s.offsets[0][0], 0.0, 0.0])
        free = np.asarray(s.free, dtype=float) > 0.0
        frame = Frame(mesh.nodes("seat"), reference, (0, 1, 2, 4, 5), s.mass, s.damping, s.stiffness, free)
        return Body("inner_ring", operator, held, frame, foundation)

    def _cage(self, assembly: Assembly) -> Cage:
        from scipy.sparse import coo_array

        s, data, rows, columns = self.setup, [], [], []
        g = s.geometry
        inner = g.ellipses(s.modulus)[0]
        normal = 1.5 * s.reference_load / float(inner.approach(s.reference_load))
        springs = cage_stiffness(normal, g.ball_diameter, s.friction > 0.0)
        names, nodal = [], np.zeros(3 * assembly.nodes)
        for k in range(len(s.azimuth)):
            body = assembly.bodies[k + 2]
            mass = assembly.node_mass[assembly.starts[k + 2] : assembly.starts[k + 3]]
            along = np.array([0.0, -np.sin(s.azimuth[k]), np.cos(s.azimuth[k])])
            found = cage_rows(body.points, mass, along)
            data.append(found.ravel())
            rows.append(np.repeat(4 * k + np.arange(4), found.shape[1]))
            columns.append(np.tile(3 * assembly.starts[k + 2] + np.arange(found.shape[1]), 4))
            nodal[assembly.part(k + 2)] = SHARE * normal * np.repeat(mass / mass.sum(), 3)
            names += [f"{body.name}: {motion}" for motion in NAMES]
        shape = (4 * len(s.azimuth), 3 * assembly.nodes)
        matrix = coo_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape).tocsr()
        return Cage(matrix, np.tile(springs, len(s.azimuth)), tuple(names), nodal)


def _refuse_held_grooves(assembly: Assembly, under: np.ndarray, seats: tuple[float | str, float | str]) -> None:
    """Rings without any free node among those that contacts may touch, ``under`` (nodes,) bool, before anything is factored."""
    for index, (name, seat) in enumerate(zip(("inner", "outer"), seats, strict=True)):
        groove = under[assembly.starts[index] : assembly.starts[index + 1]]
        if groove.any() and not (groove & free_nodes(assembly, index)).any():
            raise MeshError.at(
                f"supports.{name}_seat",
                seat,
                f"it holds the set 'seat' of the {name} ring, and that has every node of the groove below the contacts: none is free. "
                f'Take the groove out of the set in mesh.{name}_ring, or name the right one: [mesh.sets.{name}_ring] seat = "..."',
            )
