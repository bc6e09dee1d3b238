"""Forces and tangents of a contact from gaps, memory and friction, with bounds of steps: common to all kinds of contacts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import attrs
import numpy as np
from numba import boolean, int64, void

from raceway.core.contact.damping import add_damping, stored_energy
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.core.fem.elastic.surface import Facets, SurfacePoints
from raceway.core.fem.elastic.unknowns import Near, of_nodes
from raceway.core.jit import Kernel, jit
from raceway.core.signatures import CUBE, MATRIX, VECTOR

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


#: Of a groove: the radius of its centre circle [m].
CIRCLE = 4


def groove(centre: np.ndarray, circle: float, radius: float) -> np.ndarray:
    """(8,) the inside of a torus about an axis along x: middle [m], radius of its centre circle and of its tube [m]."""
    return np.array([1.0, *centre, circle, radius, 0.0, 0.0])


@jit(void(MATRIX, int64[::1], MATRIX, VECTOR, MATRIX, CUBE), releases=True)
def surface_gaps(where, pair, surfaces, gap, normal, bend):  # type: ignore[no-untyped-def]
    """Signed distance from a surface, its gradient and its second derivative.

    where : (n, 3) float [m];  pair : (n,) int, row of ``surfaces`` (m, 8)
    gap : (n,) out [m], negative inside the body;  normal : (n, 3) out, away from the body
    bend : (n, 3, 3) out: second derivative of the gap [1/m]

    A groove: with the radius r about the axis and m the unit vector from the centre circle (x0, R) to the point, at the
    distance d, gap = tube - d, normal = -m, and the second derivative is minus that of d: 1/d across m in the meridian
    plane, (m . e_r)/r around the axis.
    """
    for i in range(where.shape[0]):
        p = pair[i]
        if surfaces[p, 0] == 0.0:
            gap[i] = 0.0
            for a in range(3):
                gap[i] += (where[i, a] - surfaces[p, 1 + a]) * surfaces[p, 4 + a]
                normal[i, a] = surfaces[p, 4 + a]
                for b in range(3):
                    bend[i, a, b] = 0.0
            continue
        x, y, z = where[i, 0] - surfaces[p, 1], where[i, 1] - surfaces[p, 2], where[i, 2] - surfaces[p, 3]
        r = np.sqrt(y * y + z * z)
        c, s = y / r, z / r
        away = r - surfaces[p, 4]
        d = np.sqrt(x * x + away * away)
        mx, mr = x / d, away / d
        gap[i] = surfaces[p, 5] - d
        m = (mx, mr * c, mr * s)
        along = (-mr, mx * c, mx * s)
        around = (0.0, -s, c)
        for a in range(3):
            normal[i, a] = -m[a]
            for b in range(3):
                bend[i, a, b] = -(along[a] * along[b] / d + mr / r * around[a] * around[b])


@jit(void(VECTOR, VECTOR, VECTOR, VECTOR, MATRIX, CUBE, MATRIX, CUBE, CUBE), releases=True)
def forces_and_tangents(area, pressure, d_gap, d_rate, normal, bend, force, stiffness, damping):  # type: ignore[no-untyped-def]
    """Forces (n, 3) [N] on the points and minus their derivatives by place and velocity (n, 3, 3) [N/m, N s/m].

    F = A p n, so -dF/dy = -A (dp/dg n n^T + p d2g/dy2): symmetric.
    """
    for i in range(area.size):
        w = area[i]
        for a in range(3):
            force[i, a] = w * pressure[i] * normal[i, a]
            for b in range(3):
                nn = normal[i, a] * normal[i, b]
                stiffness[i, a, b] = -w * (d_gap[i] * nn + pressure[i] * bend[i, a, b])
                damping[i, a, b] = -w * d_rate[i] * nn


@jit(void(CUBE, VECTOR), releases=True)
def row_sums(stiffness, out):  # type: ignore[no-untyped-def]
    """Largest row sum (n,) of the sizes of matrices (n, 3, 3)."""
    for i in range(stiffness.shape[0]):
        out[i] = 0.0
        for a in range(3):
            total = abs(stiffness[i, a, 0]) + abs(stiffness[i, a, 1]) + abs(stiffness[i, a, 2])
            if not total <= out[i]:  # what is no number is kept
                out[i] = total


@jit(boolean(MATRIX, MATRIX, VECTOR), releases=True)
def has_moved(where, before, far):  # type: ignore[no-untyped-def]
    """Whether a point (n, 3) has moved along an axis by more than ``far`` (n,)."""
    for i in range(where.shape[0]):
        for a in range(3):
            if abs(where[i, a] - before[i, a]) > far[i]:
                return True
    return False


#: Stiffness of the penalty over E* / h.  The layer under one row of elements of size h yields about h p / E*: ten times
#: stiffer, the penalty adds a tenth of what the mesh errs by; stiffer still, pressures ring from point to point.
RATIO = 10.0


def penalty_stiffness(modulus: float, size: np.ndarray | float) -> np.ndarray:
    """RATIO E* / h with E* [Pa] and the size h [m] of the facets across the contact."""
    return np.asarray(RATIO * modulus / np.asarray(size))


#: Growth of a point's stiffness that asks for the stable step anew: half of it is what a step may be too long by.
STIFFER = 1.02


@attrs.frozen(eq=False)
class PlaceLaw:
    """Normal force of the places of a contact."""

    #: kernel, params, state_size : of signature ``LAW``, (n, k) its parameters, columns of its memory
    kernel: Kernel
    params: np.ndarray
    state_size: int = 0
    damping: float = 0.0  # normal damping, pressure per gap rate [N s/m3]; of resultants [N s/m]


class Contact(ABC):
    """Places at which forces act between two bodies: points of a surface, or contact resultants.

    place : (n, 3) undisplaced [m];  area : (n,) what pressures are multiplied with [m2], 1 for resultants
    counts : (pairs,) places of each pair of surfaces;  surfaces : (pairs, 8), see ``raceway.core.fem.elastic.contact``
    law : PlaceLaw;  friction : CoulombFriction | None

    move : (3 n, 3 nodes) sparse B: displacement of the places against the second bodies

    With y = X + B u, gap = g(y) of the exact surface and its normal n = grad g, the force on a place of the first body is
    A p n: forces on the nodes are f = -B^T F and the tangent is B^T D B with 3 x 3 blocks D.  No momentum is lost.
    """

    #: Whether each place is a contact resultant: few of them, and each on many nodes.
    resultants_only = False

    def __init__(
        self, place: np.ndarray, area: np.ndarray, counts: np.ndarray, surfaces: np.ndarray, law: PlaceLaw,
        friction: CoulombFriction | None = None,
    ) -> None:  # fmt: skip
        self.place, self.area, self.counts, self.law = place, area, counts, law.kernel
        self.params = np.ascontiguousarray(law.params, dtype=float)
        self.damping, self.friction = float(law.damping), friction
        self.pair, self.starts = np.repeat(np.arange(len(counts)), counts), np.r_[0, np.cumsum(counts)[:-1]]
        self.surfaces = np.ascontiguousarray(surfaces)
        n = len(area)
        self.memory = np.zeros((n, law.state_size))
        self._trial = self.memory.copy()
        self.gap, self.pressure, self.d_gap, self.d_rate = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
        self.normal, self.bend = np.zeros((n, 3)), np.zeros((n, 3, 3))
        self.force, self.stiffness, self.rate_stiffness = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3, 3))
        self.stiffest = np.zeros(n)
        self.move: csr_matrix = None
        #: (n, 3) where the places were at the last forces [m].
        self.where = place
        self._near: tuple[csr_matrix, Near] | None = None

    # What kinds of contacts differ in

    @property
    def projected(self) -> np.ndarray:
        """(n, 3) where the places lay when B was last made [m]."""
        return self.place

    def restore(self, where: np.ndarray, memory: np.ndarray) -> None:
        """B and the law's memory as another contact had them."""
        self.memory[:] = memory

    def update(self, where: np.ndarray, in_motion: bool = False) -> bool:
        """Make B anew for places at ``where`` (n, 3) [m] that are too far from ``projected``; whether anything changed."""
        return False

    @abstractmethod
    def nodes_of(self, pair: int) -> tuple[int, int]:
        """A node of the first and one of the second body of a pair."""

    @abstractmethod
    def overlap(self, pair: int) -> tuple[str, float, float]:
        """Name of a pair, how deep it overlaps at the last gaps [m], and how deep undeformed bodies may [m]."""

    @abstractmethod
    def stable_step(self, mass: np.ndarray) -> float:
        """Bound of the explicit step by the contacts alone [s]; ``mass`` (nodes,) of the nodes [kg]."""

    @abstractmethod
    def refuse(self) -> None:
        """Raise ``ConvergenceError`` where the last forces are none that the law may end with."""

    def press(self, gap: np.ndarray, rate: np.ndarray, dt: float) -> np.ndarray:
        """Sets ``pressure``, ``d_gap`` and ``d_rate`` at gaps (n,) and their rates; what is left of the gaps for the law (n,)."""
        self.law(gap, rate, self.params, self.memory, self._trial, dt, self.pressure, self.d_gap, self.d_rate)
        return gap

    def evaluate(self, dt: float, u: np.ndarray, v: np.ndarray | None = None, share: float = 0.0) -> np.ndarray:
        """(3 nodes,) internal forces of the contacts [N] at displacements u (3 nodes,) [m] and velocities v.

        share : places less deep than this share of their pair's deepest one count as open
            Of an overlap that nothing has deformed yet, half the depth bounds the contact area.
        """
        rate = None if v is None else self.move @ v
        self.respond(dt, self.move @ u, rate, share)
        return np.asarray(-(self.move.T @ self.force.reshape(-1)))

    @property
    def near(self) -> Near:
        """The displacements that the places depend on; another object when B was made anew."""
        if self._near is None or self._near[0] is not self.move:
            self._near = self.move, Near.of(self.move)
        return self._near[1]

    def evaluate_near(self, dt: float, u: np.ndarray, v: np.ndarray | None) -> np.ndarray:
        """(k,) forces as ``evaluate`` gives them, at the entries of ``near`` alone, of displacements and velocities (k,) there."""
        move = self.near.move
        self.respond(dt, move @ u, None if v is None else move @ v, 0.0)
        return np.asarray(-(move.T @ self.force.reshape(-1)))

    def respond(self, dt: float, u: np.ndarray, v: np.ndarray | None, share: float) -> None:
        """Forces and tangents of the places, from their displacements and velocities (3 n,) against the second bodies."""
        displacement = u.reshape(-1, 3)
        where = self.where = self.place + displacement
        surface_gaps(where, self.pair, self.surfaces, self.gap, self.normal, self.bend)
        gap = self.gap
        if share > 0.0:
            deepest = np.minimum.reduceat(gap, self.starts)
            gap = np.where(gap > share * np.minimum(deepest, 0.0)[self.pair], np.maximum(gap, 0.0), gap)
        rate = np.zeros(len(gap))
        if v is not None and dt > 0.0:
            rate = np.einsum("ia,ia->i", v.reshape(-1, 3), self.normal)
        gap = self.press(gap, rate, dt)
        if dt > 0.0:
            add_damping(self.damping, gap, rate, self.pressure, self.d_gap, self.d_rate)
        forces_and_tangents(
            self.area, self.pressure, self.d_gap, self.d_rate, self.normal, self.bend,
            self.force, self.stiffness, self.rate_stiffness,
        )  # fmt: skip
        if share > 0.0:
            # Pressures of such an overlap are many times too large, and so would be their geometric stiffness: leave it out.
            across = self.normal[:, :, None] * self.normal[:, None, :]
            self.stiffness = -(self.area * self.d_gap)[:, None, None] * across
        if self.friction is not None:
            traction, tangent = self.friction.evaluate(displacement, self.normal, self.pressure, self.d_gap)
            self.force += self.area[:, None] * traction
            self.stiffness += self.area[:, None, None] * tangent

    def tangent(self, blocks: np.ndarray) -> csr_matrix:
        """(3 nodes, 3 nodes) sparse B^T D B, of the points whose block is not zero."""
        from scipy.sparse import bsr_array

        touching = np.flatnonzero(blocks.any(axis=(1, 2)))
        move, size = self.move[of_nodes(touching)], len(touching)
        diagonal = (np.ascontiguousarray(blocks[touching]), np.arange(size), np.arange(size + 1))
        middle = bsr_array(diagonal, shape=(3 * size, 3 * size))
        return (move.T @ (middle @ move)).tocsr()

    def resultants(self) -> np.ndarray:
        """(pairs, 3) forces on the first bodies [N]."""
        return np.stack([np.bincount(self.pair, self.force[:, a], len(self.counts)) for a in range(3)], axis=1)

    def deepest(self) -> np.ndarray:
        """(pairs,) smallest gap [m]."""
        return np.minimum.reduceat(self.gap, self.starts)

    def energy(self) -> float:
        """Energy stored by the law and by sticking points at the last gaps [J]; meant for laws without memory."""
        n = len(self.gap)
        out = np.empty(n)
        stored_energy(self.law, self.params, self.memory, self._trial.copy(), self.gap, np.zeros((6, n)), out)
        friction_energy = 0.0 if self.friction is None else float(self.area @ self.friction.stored())
        return float(self.area @ out) + friction_energy

    def friction_energy(self) -> float:
        """Work of friction up to the last commit [J]."""
        return 0.0 if self.friction is None else float(self.area @ self.friction.dissipated)

    def stiffened(self) -> bool:
        """Whether a point has closed or become stiffer than at any ``stable_step`` before."""
        return bool((self._sizes() > STIFFER * self.stiffest).any())

    def _sizes(self) -> np.ndarray:
        """(n,) largest row sum of each point's stiffness [N/m]."""
        out = np.empty(len(self.area))
        row_sums(self.stiffness, out)
        return out

    def commit(self) -> None:
        self.refuse()
        self.memory, self._trial = self._trial, self.memory
        if self.friction is not None:
            self.friction.commit()


#: Half widths of a facet by which a point may have moved along a surface before its place there is looked up anew: at rest, and in
#: motion, where every new place takes or gives a little energy, while a vibration moves points by less.
_AT_REST, IN_MOTION = 0.02, 0.5


@attrs.frozen(eq=False)
class Pair:
    """Two surfaces that may touch."""

    name: str
    points: SurfacePoints  # of the first surface; node numbers are the assembly's
    surface: np.ndarray  # (8,) the second one, exact (``raceway.core.fem.elastic.contact``)
    facets: Facets  # of the second surface
    first_node: int  # what to add to its node numbers for those of the assembly


class NodalContact(Contact):
    """Points of all pairs of an assembly.

    pairs : list of Pair;  nodes : int, of the assembly;  law, friction : see ``Contact``

    A point moves by y = X + u_1(X) - u_2(projection of y); the force on it goes to the nodes of its facet, and the opposite
    to those of the second one's, with the interpolation's weights.
    """

    def __init__(self, pairs: list[Pair], nodes: int, law: PlaceLaw, friction: CoulombFriction | None = None) -> None:
        self.pairs, self._nodes = pairs, nodes
        counts = np.array([len(pair.points.area) for pair in pairs])
        places = np.concatenate([pair.points.place for pair in pairs])
        area = np.concatenate([pair.points.area for pair in pairs])
        surfaces = np.array([pair.surface for pair in pairs])
        super().__init__(places, area, counts, surfaces, law, friction)
        self.outside = np.zeros(len(area))
        self._projected = np.full((len(area), 3), np.inf)
        #: (n, 8) nodes of the assembly that a point's motion is interpolated from, and their weights.
        self.nodes, self.weights = np.zeros((len(area), 8), dtype=np.int64), np.zeros((len(area), 8))
        #: (n,) half widths of the facets that points were projected on [m].
        self.facet = np.zeros(len(area))
        self._weights: csr_matrix = None
        self.update(self.place)

    @property
    def projected(self) -> np.ndarray:
        return self._projected

    def restore(self, where: np.ndarray, memory: np.ndarray) -> None:
        self._projected[:] = np.inf
        self.update(where)
        super().restore(where, memory)

    def nodes_of(self, pair: int) -> tuple[int, int]:
        contact = self.pairs[pair]
        return int(contact.points.nodes[0, 0]), contact.first_node

    def overlap(self, pair: int) -> tuple[str, float, float]:
        gap, contact = self.gap[self.pair == pair], self.pairs[pair]
        # A facet has four points.
        return contact.name, -float(gap.min()), float(np.sqrt(4.0 * contact.points.area[gap.argmin()]))

    def refuse(self) -> None:
        """Points find a pressure at any gap."""

    def update(self, where: np.ndarray, in_motion: bool = False) -> bool:
        """Look up where the points lie on the second surface; whether anything changed."""
        where = np.ascontiguousarray(where, dtype=float)
        if not has_moved(where, self._projected, (IN_MOTION if in_motion else _AT_REST) * self.facet):
            return False
        from scipy.sparse import csr_array, kron

        n = len(self.area)
        columns, weights = self.nodes, self.weights
        begin = 0
        for pair, count in zip(self.pairs, self.counts, strict=True):
            part = slice(begin, begin + count)
            begin += count
            facet, values, self.outside[part] = pair.facets.locate(where[part])
            self.facet[part] = pair.facets.short[facet]
            columns[part, :4], weights[part, :4] = pair.points.nodes, pair.points.weights
            columns[part, 4:], weights[part, 4:] = pair.facets.quads[facet] + pair.first_node, -values
        self._projected = where.copy()
        rows = np.arange(0, 8 * n + 1, 8)
        matrix = csr_array((weights.ravel().copy(), columns.ravel().copy(), rows), shape=(n, self._nodes))
        self._weights, self.move = abs(matrix), kron(matrix, np.eye(3), format="csr")
        return True

    def stable_step(self, mass: np.ndarray) -> float:
        """See ``Contact``; by Gershgorin's theorem on M^-1 B^T D B, 2 / sqrt(largest row sum)."""
        size = self._sizes()
        np.maximum(self.stiffest, size, out=self.stiffest)
        touching = np.flatnonzero(size)
        if not len(touching):
            return np.inf
        weights = self._weights[touching]
        rows = weights.T @ (size[touching] * np.asarray(weights.sum(axis=1)).ravel())
        return float(2.0 / np.sqrt((rows / mass).max()))
