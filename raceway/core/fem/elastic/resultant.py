"""Contact resultants on a mesh: one force each, by a law whose compliance replaces that of the mesh below it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.contact.hertz import normal_displacement
from raceway.core.fem.elastic.contact import Contact, PlaceLaw
from raceway.core.fem.elastic.linear_statics import StaticSolver
from raceway.core.fem.elastic.surface import Facets
from raceway.core.fem.mesh.hex_mesh import shape_slopes, shape_values
from raceway.errors import ConvergenceError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

#: Rings of the ellipse, points on each, and points on the circle that gives the motion of the surroundings.
_RINGS, _ANGLES, _AROUND = 6, 12, 8


@attrs.frozen(eq=False)
class Footprint:
    """A contact on one body."""

    nodes: np.ndarray  # (k,) int of the body
    weights: np.ndarray  # (k,) float, of the ellipse: a unit force, and the mean displacement under it
    share: np.ndarray  # (3, k, 3) float: displacement of the surface against which the other body moves


def hertz_weights(semi_axes: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) [m] of an ellipse and weights (n,) of a unit force, its pressure falling as 1 - (x / a)^2 - (y / b)^2."""
    x, w = np.polynomial.legendre.leggauss(_RINGS)
    r = 0.5 * (x + 1.0)
    angle = 2.0 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
    points = np.stack([np.outer(r, np.cos(angle)).ravel(), np.outer(r, np.sin(angle)).ravel()], axis=1)
    weights = np.repeat(w * r * (1.0 - r * r), _ANGLES)
    return points * semi_axes, weights / weights.sum()


def footprint(
    facets: Facets,
    pole: np.ndarray,
    normal: np.ndarray,
    along: np.ndarray,
    centre: np.ndarray,
    semi_axes: tuple[float, float],
) -> Footprint:
    """A contact at a pole of a body.

    pole : (3,) [m];  normal : (3,) into the body;  along : (3,) of the first semi-axis, both of length 1
    centre : (3,) of the surface's curvature [m];  semi_axes : of the ellipse, along the groove and across [m]

    The normal force is spread over an ellipse far wider than Hertz's, so that the local compliance of the mesh is smaller
    than the contact's and can be subtracted from it. The tangential displacement of the surface is that of its surroundings,
    moved as a rigid body to the centre of curvature: a ball that turns, and a groove that tilts about the centre of its own
    arc, leave the line between the two centres where it is.
    """
    axes = np.stack([along, np.cross(normal, along)])
    places, force = hertz_weights(semi_axes)
    facet, weights, _ = facets.locate(pole + places @ axes)
    angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
    circle = max(semi_axes) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    facet_around, weights_around, _ = facets.locate(pole + circle @ axes)
    nodes = np.unique(np.concatenate([facets.quads[facet].ravel(), facets.quads[facet_around].ravel()]))
    pressure_share = np.zeros(len(nodes))
    np.add.at(pressure_share, np.searchsorted(nodes, facets.quads[facet]).ravel(), (force[:, None] * weights).ravel())
    moved = np.zeros((_AROUND, len(nodes)))
    rows = np.repeat(np.arange(_AROUND), 4)
    np.add.at(moved, (rows, np.searchsorted(nodes, facets.quads[facet_around]).ravel()), weights_around.ravel())
    # What displacements of the nodes say of that of the centre, as one rigid body
    places = moved @ facets.points[nodes]
    arm = places - centre
    size = np.linalg.norm(arm, axis=1).max()
    columns = np.zeros((len(places), 3, 6))
    columns[:, :, :3] = np.eye(3)
    for a in range(3):
        columns[:, :, 3 + a] = np.cross(np.eye(3)[a], arm / size)
    fit = np.linalg.pinv(columns.reshape(-1, 6))[:3].reshape(3, len(places), 3)
    inward = np.outer(normal, normal)
    across = np.einsum("ab,bjc,jk->akc", np.eye(3) - inward, fit, moved)
    return Footprint(nodes, pressure_share, across + inward[:, None, :] * pressure_share[None, :, None])


#: Newton's iterations of the law with the mesh's compliance, and their tolerance over the deepest gap.
_ITERATIONS, _TOLERANCE = 60, 1e-12
#: Share of the law's own compliance that has to be left, and halvings of the search for the gap where no more is.
_LEFT, _HALVINGS = 0.2, 60
#: Deepest gap that is looked at [m]: no contact is pressed by a millimetre.
_DEEPEST = 1e-3


@attrs.frozen(eq=False)
class Touch:
    """One ball on one race."""

    name: str
    #: ball, race : Footprint; node numbers are the assembly's
    ball: Footprint
    race: Footprint
    centre: np.ndarray  # (3,) of the ball [m]
    #: (8,) on which that centre lies at a gap of zero (``raceway.core.fem.elastic.contact``): the groove, its tube smaller
    #: by the ball
    surface: np.ndarray
    local: float  # compliance of both meshes that the law's replaces, less what calibrates it [m/N]
    spread: float  # how well they know it [m/N]
    size: float  # largest overlap of undeformed bodies [m]


class ResultantContact(Contact):
    """All balls on all races of an assembly.

    touches : list of Touch;  nodes : int, of the assembly;  law : see ``Contact``

    The centres of ball and groove approach by -g, the law's own approach by -h: h = g - m Q(h) with the compliance m of the
    meshes below the contact, which Q compresses already.  From dQ = (dg - m dQ) dQ/dh follows dQ/dg = Q' / (1 + m Q'),
    stiffer than the law's Q' = dQ/dh < 0.  A law that depends on the rate of the gap gets that of g.

    Where a law has less compliance than that, the force goes on along its tangent: iterations may pass there, but what ends
    there is refused by ``refuse``.
    """

    resultants_only = True

    def __init__(self, touches: list[Touch], nodes: int, law: PlaceLaw) -> None:
        self.touches = touches
        centres, surfaces = np.array([t.centre for t in touches]), np.array([t.surface for t in touches])
        ones = np.ones(len(touches))
        super().__init__(centres, ones, ones.astype(int), surfaces, law)
        self.local = np.array([t.local for t in touches])
        self._carried, self._approach = np.zeros(len(touches)), np.zeros(len(touches))
        # (3 n, 3 nodes) sparse displacement of balls against races.
        from scipy.sparse import coo_array

        rows, columns, values = [], [], []
        for k, touch in enumerate(touches):
            for sign, side in ((1.0, touch.ball), (-1.0, touch.race)):
                rows.append(np.broadcast_to(3 * k + np.arange(3)[:, None, None], side.share.shape).ravel())
                columns.append(np.broadcast_to((3 * side.nodes)[:, None] + np.arange(3), side.share.shape).ravel())
                values.append(sign * side.share.ravel())
        join = np.concatenate
        move = coo_array((join(values), (join(rows), join(columns))), shape=(3 * len(touches), 3 * nodes)).tocsr()
        move.eliminate_zeros()
        self.move = move
        self._mobility: np.ndarray | None = None
        # The deepest gap of the law [m] that leaves it some compliance, at rest and without history
        deep, shallow = np.full(len(self.local), -_DEEPEST), np.zeros(len(self.local))
        for _ in range(_HALVINGS):
            middle = 0.5 * (deep + shallow)
            super().press(middle, np.zeros_like(middle), 0.0)
            stays = 1.0 + self.local * self.d_gap >= _LEFT
            deep, shallow = np.where(stays, deep, middle), np.where(stays, middle, shallow)
        self._last = shallow

    def nodes_of(self, pair: int) -> tuple[int, int]:
        touch = self.touches[pair]
        return int(touch.ball.nodes[0]), int(touch.race.nodes[0])

    def overlap(self, pair: int) -> tuple[str, float, float]:
        touch = self.touches[pair]
        return touch.name, float(self._approach[pair]), touch.size

    def stable_step(self, mass: np.ndarray) -> float:
        """See ``Contact``: eigenvalues of M^-1 B^T D B but 0 are those of D B M^-1 B^T, of three rows a contact."""
        np.maximum(self.stiffest, self._sizes(), out=self.stiffest)
        if self._mobility is None:
            from scipy.sparse import diags_array

            self._mobility = (self.move @ diags_array(np.repeat(1.0 / mass, 3)) @ self.move.T).toarray()
        values, vectors = np.linalg.eigh(self.stiffness)
        n = len(values)
        root = np.zeros((n, 3, n, 3))
        root[np.arange(n), :, np.arange(n)] = (vectors * np.sqrt(np.abs(values))[:, None, :]).transpose(0, 2, 1)
        square = root.reshape(3 * n, 3 * n)
        largest = float(np.linalg.eigvalsh(square @ self._mobility @ square.T).max())
        return 2.0 / np.sqrt(largest) if largest > 0.0 else np.inf

    def press(self, gap: np.ndarray, rate: np.ndarray, dt: float) -> np.ndarray:
        law_gap, self._approach = np.maximum(gap, self._last), -gap
        smallest = _TOLERANCE * max(-float(gap.min()), 1e-300)
        for _ in range(_ITERATIONS):
            super().press(law_gap, rate, dt)
            slope = np.maximum(1.0 + self.local * self.d_gap, _LEFT)
            misfit = law_gap + self.local * self.pressure - gap
            beyond = (law_gap <= self._last) & (misfit > 0.0)
            if np.abs(np.where(beyond, 0.0, misfit)).max() <= smallest:
                self.d_gap /= slope
                self.d_rate /= slope
                self.pressure -= np.where(beyond, misfit * self.d_gap, 0.0)
                self.gap, self._carried = law_gap, self.pressure.copy()
                return law_gap
            law_gap = np.maximum(law_gap - misfit / slope, self._last)
        raise ConvergenceError(f"the law of resultants gives no force at gaps down to {1e6 * gap.min():.3g} µm.")

    def refuse(self) -> None:
        worst = int(np.argmin(self.gap - self._last))
        if self.gap[worst] <= self._last[worst]:
            touch = self.touches[worst]
            raise ConvergenceError(
                f"{touch.name}: under {self.pressure[worst]:.3g} N the contact is stiffer than the mesh below it, which gives "
                f"{1e9 * touch.local:.3g} nm/N that the law replaces. Use a smaller load, a softer law, or contact.discretisation = 'nodal'; check clearance and radial_expansion."
            )

    def energy(self) -> float:
        """Energy stored by the law at the last gaps, less the local energy of the meshes [J]."""
        return super().energy() - 0.5 * float(self.local @ self._carried**2)


#: Depths between which the fields are compared, over the body's reach, and how many.
DEPTHS, COUNT = (0.5, 0.9), 7
#: Frequency of the springs that hold a floating body, over the speed of sound by its size: far below its own.
_SLOW = 0.05


@attrs.frozen(eq=False)
class _Separation:
    """Compliances of a mesh under one contact."""

    local: float  # s - c [m/N]
    structural: float  # c, of a body held as it is [m/N]
    spread: float  # largest less smallest difference of the fields over the depths [m/N]: what the mesh leaves open


#: Cells near a point that are tried, and Newton's steps in each of them.
_TRIED, _INTERIOR_STEPS = 12, 15
#: Places in a cell's own coordinates that Newton's method may reach.
_FAR = 5.0


def interpolation_at(points: np.ndarray, cells: np.ndarray, where: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 8) and weights (n, 8) that interpolate at ``where`` (n, 3) [m].

    points : (m, 3) nodes [m];  cells : (k, 8) trilinear hexahedra

    A point outside of the mesh is extrapolated from the cell that it is nearest to, in that cell's coordinates.
    """
    from scipy.spatial import KDTree

    near = KDTree(points[cells].mean(axis=1)).query(where, k=min(_TRIED, len(cells)))[1].reshape(len(where), -1)
    local = np.zeros((*near.shape, 3))
    corners = points[cells[near]]
    for _ in range(_INTERIOR_STEPS):
        flat = local.reshape(-1, 3)
        missing = where[:, None] - np.einsum("nkc,nkca->nka", shape_values(flat).reshape(*near.shape, 8), corners)
        slopes = np.einsum("nkcb,nkca->nkab", shape_slopes(flat).reshape(*near.shape, 8, 3), corners)
        local = np.clip(local + np.linalg.solve(slopes, missing[..., None])[..., 0], -_FAR, _FAR)
    best = np.abs(local).max(axis=2).argmin(axis=1)
    rows = np.arange(len(where))
    return cells[near[rows, best]], shape_values(local[rows, best])


class LoadedBody:
    """One body, to be pressed in many places.

    points, cells : of its mesh;  stiffness : (3 n, 3 n) CSR, with beds [N/m];  held : (n, 3) bool
    mass : (n,) of its nodes [kg], where nothing holds it: a force accelerates it, and displacements are those from the mean of
        its masses; None: ``held`` holds it
    material : young [Pa], poisson, density [kg/m3]
    """

    def __init__(
        self, points: np.ndarray, cells: np.ndarray, stiffness: csr_matrix, fixed_dofs: np.ndarray,
        mass: np.ndarray | None, material: tuple[float, float, float],
    ) -> None:  # fmt: skip
        self._points, self._cells, self._material = points, cells, material
        self._share = None if mass is None else mass / mass.sum()
        if mass is not None:
            from scipy.sparse import diags_array

            size = np.ptp(points, axis=0).max()
            slow = (_SLOW / size) ** 2 * material[0] / material[2]
            stiffness = stiffness + diags_array(slow * np.repeat(mass, 3))
        self._solver = StaticSolver(stiffness.tocsr(), points, fixed_dofs)

    def along(self, contact: Footprint, normal: np.ndarray) -> np.ndarray:
        """(n,) displacements of the nodes along a unit force on a footprint, into the body along ``normal`` (3,) [m/N]."""
        load = np.zeros_like(self._points)
        load[contact.nodes] = contact.weights[:, None] * normal
        if self._share is not None:
            load -= self._share[:, None] * normal
        return np.asarray(self._solver.solve(load).displacement @ normal)

    def replaced(self, contact: Footprint, normal: np.ndarray, structural: float) -> float:
        """Local compliance of a body whose structural compliance [m/N] is known."""
        return float(contact.weights @ self.along(contact, normal)[contact.nodes]) - structural

    def separated(
        self, contact: Footprint, pole: np.ndarray, normal: np.ndarray, semi_axes: tuple[float, float], reach: float
    ) -> _Separation:
        """Compliances under a contact of ``footprint`` with the same pole, normal and semi-axes.

        reach : thickness below the contact [m], as ``raceway.core.fem.structural.reach``

        Under the force of a footprint the surface of the mesh deflects by s, which depends on the cells there. Below it, the
        mesh's displacement u(z) and that of a half-space h(z) differ by a nearly constant amount, the structural compliance
        c of the body (``raceway.core.fem.structural``). Of s, the part s - c is local: to be replaced by Hertz's.

        The depths lie further down than those of condensed bodies: there the field of the coarsest useful mesh, two cells
        through a ring's wall, is right. A ball needs no depths: its c is that of the exact sphere
        (``raceway.core.contact.hertz.ball_compliance``).
        """
        along = self.along(contact, normal)
        depth = reach * np.linspace(*DEPTHS, COUNT)
        nodes, weights = interpolation_at(self._points, self._cells, pole + depth[:, None] * normal)
        places, force = hertz_weights(semi_axes)
        half = normal_displacement(depth, np.linalg.norm(places, axis=1), *self._material[:2]) @ force
        difference = np.einsum("nk,nk->n", weights, along[nodes]) - half
        structural = float(difference.mean())
        return _Separation(float(contact.weights @ along[contact.nodes]) - structural, structural, float(np.ptp(difference)))
