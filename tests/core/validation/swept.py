"""A profile swept into a full mesh of a body, assembled and solved in three dimensions: what its harmonics must equal."""

from typing import Any

import numpy as np

from raceway.core.fem.elastic.linear_statics import rigid_motions
from raceway.core.fem.revolution.sections import Profile
from raceway.extend import HexOperator


class Swept:
    """The body's own mesh, stiffness and masses; nodes meridian after meridian."""

    def __init__(
        self, profile: Profile, divisions: int, formulation: str = "incompatible", hourglass: float = 0.005
    ) -> None:
        count = len(profile.points)
        psi = 2.0 * np.pi * np.arange(divisions) / divisions
        self.cosine, self.sine = np.cos(psi)[:, None], np.sin(psi)[:, None]
        r, x = profile.points.T
        points = np.stack([np.broadcast_to(x, (divisions, count)), r * self.cosine, r * self.sine], axis=-1)
        k = np.arange(divisions)[:, None, None] * count
        cells = np.concatenate([profile.quads + k, profile.quads + (k + count) % (count * divisions)], axis=2)
        self.profile, self.divisions, self.count = profile, divisions, count
        self.points = points.reshape(-1, 3)
        self.operator = HexOperator(self.points, cells.reshape(-1, 8), 212e9, 0.29, 7810.0, formulation, hourglass)
        self.stiffness: Any = self.operator.stiffness().tocsc()

    def seat_nodes(self) -> np.ndarray:
        return (self.profile.seat + self.count * np.arange(self.divisions)[:, None]).ravel()

    def force(self, node: int, component: int) -> np.ndarray:
        """(3 n,) unit force at azimuth 0, where r is y and theta is z."""
        out = np.zeros((len(self.points), 3))
        out[node, (1, 2, 0)[component]] = 1.0
        return out.reshape(-1)

    def clamped(self, force: np.ndarray) -> np.ndarray:
        """Displacements with the seat held."""
        from scipy.sparse.linalg import spsolve

        held = np.zeros((len(self.points), 3), dtype=bool)
        held[self.seat_nodes()] = True
        free = np.flatnonzero(~held.reshape(-1))
        out = np.zeros(len(force))
        out[free] = spsolve(self.stiffness[free][:, free], force[free])
        return out

    def bedded(self, force: np.ndarray, areas: np.ndarray, bed: float) -> np.ndarray:
        """Displacements with springs under the seat: areas (k,) of the seat nodes of one meridian [m2], bed [N/m3]."""
        from scipy.sparse import diags_array
        from scipy.sparse.linalg import spsolve

        springs = np.zeros((len(self.points), 3))
        springs[self.seat_nodes()] = (bed * np.tile(areas, self.divisions))[:, None]
        return np.asarray(spsolve((self.stiffness + diags_array(springs.reshape(-1))).tocsc(), force))

    def floating(self, force: np.ndarray) -> np.ndarray:
        """Displacements of the free body: the load balanced by inertia, three nodes held so that nothing strains, and the
        rigid motion of the masses taken off."""
        from scipy.sparse.linalg import splu

        mass = np.repeat(self.operator.lumped_mass(), 3)[:, None]
        rigid = rigid_motions(self.points, np.zeros(3))
        square = rigid.T @ (mass * rigid)
        balanced = force - (mass * rigid) @ np.linalg.solve(square, rigid.T @ force)
        held = self._three_nodes()
        free = np.setdiff1d(np.arange(len(force)), held)
        factor = splu(self.stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0)
        out = np.zeros(len(force))
        out[free] = factor.solve(balanced[free])
        return np.asarray(out - rigid @ np.linalg.solve(square, (mass * rigid).T @ out))

    def _three_nodes(self) -> np.ndarray:
        """(6,) Degrees of freedom that take away the rigid motions and no more."""
        far = np.argmax(self.points, axis=0)
        # x, y, z of one node, y and z of one far along x, z of one far along y.
        a, b, c = int(np.argmin(self.points[:, 2])), int(far[0]), int(far[1])
        return np.array([3 * a, 3 * a + 1, 3 * a + 2, 3 * b + 1, 3 * b + 2, 3 * c + 2])

    def seen(self, u: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """(divisions, 3 k) r, then theta, then x of nodes (k,) of every meridian."""
        x, y, z = np.moveaxis(u.reshape(self.divisions, self.count, 3)[:, nodes], 2, 0)
        return np.concatenate([y * self.cosine + z * self.sine, z * self.cosine - y * self.sine, x], axis=1)
