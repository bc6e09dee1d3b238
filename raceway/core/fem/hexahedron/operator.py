"""One mesh of hexahedra with its material: forces, matrices, stresses, energies, steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from raceway.core.fem.hexahedron.rows import (
    add_parts,
    assemble,
    centre_stress,
    divide,
    mass_factors,
    nodal_volumes,
    stable_step,
)
from raceway.core.fem.hexahedron.stiffness import (
    WORK,
    Mesh,
    range_force,
    range_hourglass_energy,
    range_point_force,
    stiffnesses,
)
from raceway.core.fem.hexahedron.strain import KINDS
from raceway.core.fem.mesh.hex_mesh import Floats
from raceway.core.threads import Job, ThreadPool
from raceway.errors import MeshError

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class HexOperator:
    """Small-strain linear elasticity on eight-node hexahedra.

    Parameters
    ----------
    points : (n, 3) nodes [m];  cells : (m, 8) elements, in the order of VTK's hexahedron
    young, poisson, density : of all elements [Pa, -, kg/m3]
    formulation : "one_point" (exact mean gradient, hourglass control), "full" (2 x 2 x 2), "incompatible" or "mean_dilatation"
    hourglass : stiffness of the hourglass modes of "one_point", as a share of lambda + 2 mu; 0 leaves them free
    least_step : explicit step [s] that every element allows by added mass; 0 adds none

    Raises
    ------
    MeshError
        Cells that name no node or are inverted.
    ValueError
        A material or formulation that does not exist.

    Notes
    -----
    Forces are the same to the last bit for any number of threads (``raceway.core.fem.hexahedron.rows``).  Their speed rests
    on neighbours having near numbers: renumber a mesh first.
    """

    def __init__(
        self, points: ArrayLike, cells: ArrayLike, young: float, poisson: float, density: float,
        formulation: str = "one_point", hourglass: float = 0.05, least_step: float = 0.0,
    ) -> None:  # fmt: skip
        if formulation not in KINDS:
            raise ValueError(f"formulation {formulation!r} is none of {', '.join(KINDS)}")
        if not (young > 0.0 and density > 0.0 and -1.0 < poisson < 0.5 and hourglass >= 0.0):
            raise ValueError(
                f"young {young:g}, poisson {poisson:g}, density {density:g}, hourglass {hourglass:g}: young and density must "
                "be positive, poisson between -1 and 0.5, hourglass not negative"
            )
        self.points: Floats = np.ascontiguousarray(points, dtype=np.float64)
        numbers = np.asarray(cells)
        if self.points.shape[1:] != (3,) or numbers.shape[1:] != (8,) or not len(numbers):
            why = f"points of shape {self.points.shape} and cells of shape {numbers.shape}: a mesh of hexahedra has points (n, 3) and at least one cell, cells (m, 8)"
            raise MeshError(why)
        if numbers.min() < 0 or numbers.max() >= len(self.points):
            why = f"cells name nodes {numbers.min()} to {numbers.max()}, but there are nodes 0 to {len(self.points) - 1}"
            raise MeshError(why)
        self.cells: NDArray[np.uint32] = np.ascontiguousarray(numbers, dtype=np.uint32)
        self.formulation, self.hourglass, self.density = formulation, float(hourglass), float(density)
        self._least_step = least_step
        self._material = young, poisson, density
        lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        shear = young / (2.0 * (1.0 + poisson))
        #: (3,) lambda, mu, and hourglass (lambda + 2 mu) [Pa].
        self.moduli: Floats = np.array([lame, shear, hourglass * (lame + 2.0 * shear)])
        #: (m, 8) Shares of the nodes' lumped masses [kg].
        self.element_masses: Floats = density * nodal_volumes(self.points, self.cells)
        self._kind = KINDS[formulation]
        #: (m,) Mass of the elements over that of their material.
        self.mass_factors: Floats = np.ones(len(self.cells))
        if least_step > 0.0:
            self.mass_factors = mass_factors(self.element_stiffness, self.element_masses, least_step)
            self.element_masses *= self.mass_factors[:, None]
        self.ranges = divide(self.cells)
        self._mesh = Mesh(self.ranges, self.cells, self.points.reshape(-1), self.moduli)
        last = self.ranges[-1]
        self._parts = np.zeros(3 * int(last[4] + last[3] - last[2]))
        self._work = np.zeros(WORK * len(self.ranges))

    def of_mesh(self, points: ArrayLike, cells: ArrayLike) -> HexOperator:
        """The same material and formulation on another mesh."""
        return HexOperator(points, cells, *self._material, self.formulation, self.hourglass, self._least_step)

    @property
    def bytes(self) -> int:
        """Memory of the arrays that the force needs, nodal vectors of the caller aside."""
        return sum(a.nbytes for a in (self.points, self.cells, self.element_masses, self._parts, self._work))

    @property
    def range_sizes(self) -> NDArray[np.int64]:
        """Elements of each range: what one thread computes at a time."""
        return np.asarray(self.ranges[:, 1] - self.ranges[:, 0])

    def internal_force(self, u: ArrayLike, out: Floats | None = None, threads: int = 1) -> Floats:
        """(n, 3) Internal forces K u [N] of displacements u (n, 3) [m]; ``out`` is overwritten and returned if given."""
        flat = self._flat(u)
        f = np.empty_like(self.points) if out is None else out
        with ThreadPool(threads) as pool:
            pool.do(len(self.ranges), self.force_job(flat))
            pool.do_shares(len(self.points), lambda a, b: self.add_parts(a, b, f.reshape(-1)))
        return f

    def stiffness(self) -> csr_matrix:
        """(3 n, 3 n) Assembled stiffness [N/m], scipy.sparse.csr_array."""
        return assemble(self.cells, len(self.points), 3, self.element_stiffness)

    def element_stiffness(self, part: slice) -> Floats:
        """(k, 24, 24) Stiffness matrices of a slice of elements [N/m]."""
        out = np.empty((part.stop - part.start, 24, 24))
        stiffnesses(self._kind, part.start, part.stop, self.moduli, self.cells, self.points, out)
        return out

    def lumped_mass(self) -> Floats:
        """(n,) Masses of the nodes [kg]: row sums of the consistent mass."""
        masses = np.bincount(self.cells.ravel(), weights=self.element_masses.ravel(), minlength=len(self.points))
        return masses.astype(np.float64, copy=False)

    def added_mass(self) -> Floats:
        """(n,) What of the nodes' masses is added for a larger step [kg]."""
        added = self.element_masses * (1.0 - 1.0 / self.mass_factors)[:, None]
        return np.asarray(np.bincount(self.cells.ravel(), weights=added.ravel(), minlength=len(self.points)), dtype=float)

    def stress(self, u: ArrayLike) -> Floats:
        """(m, 6) Stresses at the elements' centres [Pa], xx yy zz xy yz zx; "one_point" has but these."""
        return centre_stress(self.points, self.cells, self._flat(u).reshape(-1, 3), self.moduli, self.formulation)

    def energy(self, u: ArrayLike) -> float:
        """Strain energy u . K u / 2 [J], that of the hourglass modes included."""
        return float(0.5 * np.vdot(self._flat(u), self.internal_force(u)))

    def hourglass_energy(self, u: ArrayLike) -> float:
        """The part of ``energy`` [J] that the hourglass control holds; 0 for the other formulations."""
        flat = self._flat(u)
        return float(sum(self.range_hourglass_energy(r, flat) for r in range(len(self.ranges))))

    def range_hourglass_energy(self, r: int, u: Floats) -> float:
        """``hourglass_energy`` [J] of one range of elements at u (3 n,) [m]."""
        return float(range_hourglass_energy(r, self._mesh, u)) if self.formulation == "one_point" else 0.0

    def stable_step(self) -> float:
        """Stable step of central differences with the lumped mass [s], from the elements' eigenvalues."""
        return stable_step(self.element_stiffness, self.element_masses)

    def force_job(self, u: Floats) -> Job:
        """The forces of one range of elements, by its number, at u (3 n,) [m]; ``add_parts`` sums them when all are there."""
        if self.formulation == "one_point":
            return lambda r: range_force(r, self._mesh, u, self._work, self._parts)
        return lambda r: range_point_force(self._kind, r, self._mesh, u, self._parts)

    def add_parts(self, first: int, last: int, f: Floats) -> None:
        """Forces of the nodes ``first`` to ``last - 1`` into f (3 n,) [N], from those of the ranges."""
        add_parts(first, last, self.ranges, self._parts, f)

    def _flat(self, values: ArrayLike) -> Floats:
        flat = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        if flat.size != self.points.size:
            raise ValueError(f"{flat.size} numbers for {len(self.points)} nodes with three components")
        return flat
