"""Elastic bodies in contact as one system: settled, or stepped in time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.contacts.contact import Contact
from raceway.core.elastic.solver import LinearSolver
from raceway.core.elastic.statics import TOLERANCE, Settled, settle
from raceway.core.elastic.superelements.solver import CondensedSolver
from raceway.errors import ConvergenceError, MeshError

#: Relative residual of the linear solves of a time step: Newton's next iteration takes the rest.
LINEAR_TOLERANCE = 1e-4
#: Nodal forces of bodies over those of contacts, one where they balance, below which nothing has deformed yet.
_PRESSED_BACK = 0.5


class ElasticSystem:
    """M a + C v + f(y) = load + scale * excitation(t) for the unknowns of an assembly.

    Parameters
    ----------
    assembly : Assembly;  contact : Contact | None
    modulus : E* of the contacts [Pa]
    load : (size,) constant forces [N, N m]
    excitation : function of t -> (frame unknowns,) forces on the first frame's motions, or None
    condensed : solver by superelements, of a bearing in nodal contact; None: conjugate gradients
    """

    conservative = True

    def __init__(
        self,
        assembly: Assembly,
        contact: Contact | None,
        modulus: float,
        load: np.ndarray,
        excitation: Callable[[float], np.ndarray] | None = None,
        condensed: CondensedSolver | None = None,
    ) -> None:
        self.assembly, self.contact, self.load = assembly, contact, np.array(load, dtype=float)
        self.excitation = excitation
        #: Called with the relative residual of every iteration of ``settle``.
        self.on_residual: Callable[[float], None] | None = None
        self.condensed = condensed
        self.solver: LinearSolver | CondensedSolver = condensed or LinearSolver(assembly, contact, modulus)
        self.size = assembly.size
        m = assembly.frame_size
        # Moments count as the force at the arm of the rotations: columns of rotations hold lengths, of translations ones.
        reach = np.abs(assembly.carried).max(axis=0) if m else np.zeros(0)
        self._weight = np.concatenate([np.where(reach > 0.0, 1.0 / np.maximum(reach, 1e-30), 0.0), np.ones(self.size - m)])
        self._u = np.zeros(3 * assembly.nodes)
        self._y = np.zeros(self.size)
        #: Velocities (size,) and step with which contact forces were evaluated last.
        self._at: tuple[np.ndarray | None, float] = (None, 0.0)
        self._element_step: float | None = None
        self._refuse_overlap()

    # Forces

    def outer_force(self, t: float) -> np.ndarray:
        """The excitation on the first frame's motions."""
        return np.zeros(self.assembly.frame_size) if self.excitation is None else np.asarray(self.excitation(t))

    def external(self, t: float, scale: float) -> np.ndarray:
        out = self.load.copy()
        force = self.outer_force(t)
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
        self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float = LINEAR_TOLERANCE
    ) -> np.ndarray:
        return self.solver.solve(c_k, c_c, c_m, right, tolerance)

    def increment(self, c_k: float, c_c: float, c_m: float, right: np.ndarray) -> np.ndarray:
        """(size,) increment by which the forces of the last ``internal`` change by ``right``; without superelements by their tangents."""
        if self.condensed is None:
            return self.solve(c_k, c_c, c_m, right)
        v, dt = self._at
        rate = None if v is None else self.assembly.nodal(np.ascontiguousarray(v))
        return self.condensed.increment(c_k, c_c, c_m, right, self._u, rate, dt, locates=dt == 0.0)

    def mass_times(self, a: np.ndarray) -> np.ndarray:
        m = self.assembly.frame_size
        return np.concatenate([self.assembly.frame_mass @ a[:m], self.assembly.free_mass * a[m:]])

    def divide_mass(self, r: np.ndarray, c: float = 0.0) -> np.ndarray:
        a = self.assembly
        m = a.frame_size
        out = np.concatenate([np.zeros(m), r[m:] / a.free_mass])
        if m:
            free = a.frame_free
            matrix = (a.frame_mass + c * a.frame_damping)[np.ix_(free, free)]
            out[:m][free] = np.linalg.solve(matrix, r[:m][free])
        return out

    def measure(self, r: np.ndarray) -> float:
        """Euclidean norm of nodal forces and of the frames' forces; moments over their arm [N]."""
        return float(np.linalg.norm(r * self._weight * self.assembly.unknown))

    def undeformed(self, y: np.ndarray) -> bool:
        """Whether contacts at surface points press on bodies that do not press back yet: they overlap as rigid ones do."""
        a, contact = self.assembly, self.contact
        if contact is None or contact.whole:
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
        if self._element_step is None:
            self._element_step = min(body.operator.stable_step() for body in self.assembly.unequal())
        mine = np.inf if self.contact is None else self.contact.stable_step(self.assembly.node_mass)
        return float(1.0 / np.sqrt(1.0 / self._element_step**2 + 1.0 / mine**2))

    def stiffened(self) -> bool:
        """Whether a contact is stiffer than at any ``stable_step`` before: elements stay as they are."""
        return self.contact is not None and self.contact.stiffened()

    def commit(self) -> None:
        if self.contact is not None:
            self.contact.commit()
            # Between steps only: within one, places that jump would keep Newton from converging.
            self.contact.update(self.contact.where, in_motion=True)

    def rollback(self) -> None:
        if self.contact is not None:
            self.contact.rollback()

    # Statics

    def settle(self, guess: np.ndarray, tolerance: float = TOLERANCE) -> Settled:
        """Equilibrium under ``load``; places on the second surfaces are looked up anew until they stay.

        Raises
        ------
        ConvergenceError
            A rigid motion that nothing holds, by name, or no equilibrium: with the last good state and the residuals.
        """
        touching = []
        if self.contact is not None:
            touching = [self._bodies_of(index) for index in range(len(self.contact.counts))]
        loose = self.assembly.loose_motions(touching)
        if loose:
            raise ConvergenceError("nothing holds " + "; ".join(loose))
        return settle(self, np.array(guess, dtype=float), tolerance)

    @contextmanager
    def without_friction(self) -> Iterator[None]:
        """Contacts carry no friction inside; its history is kept."""
        contact = self.contact
        if contact is None:
            yield
            return
        kept, contact.friction = contact.friction, None
        try:
            yield
        finally:
            contact.friction = kept

    def locate(self, y: np.ndarray) -> bool:
        """Look up where the points lie on the second surfaces at a state; whether that changed anything."""
        if self.contact is None:
            return False
        moved = self.contact.move @ self.assembly.nodal(y)
        return self.contact.update(self.contact.place + moved.reshape(-1, 3))

    def energies(self, y: np.ndarray, v: np.ndarray) -> dict[str, float]:
        """Energies [J] at the last ``internal``."""
        a = self.assembly
        u = a.nodal(y)
        elastic = a.elastic_energy(y, u)
        return {
            "elastic": elastic,
            "kinetic": float(0.5 * v @ self.mass_times(v)),
            "contact": 0.0 if self.contact is None else self.contact.energy(),
            "friction": 0.0 if self.contact is None else self.contact.friction_energy(),
            "hourglass": a.hourglass_energy(u),
        }

    def _bodies_of(self, pair: int) -> tuple[int, int]:
        assert self.contact is not None
        first, second = np.searchsorted(self.assembly.starts, self.contact.nodes_of(pair), side="right") - 1
        return int(first), int(second)

    def _refuse_overlap(self) -> None:
        """Surfaces that overlap by more than an element before anything has moved were put in the wrong place."""
        if self.contact is None:
            return
        self.contact.evaluate(0.0, self._u)
        for index in range(len(self.contact.counts)):
            name, depth, size = self.contact.overlap(index)
            if depth > size:
                raise MeshError(
                    f"{name}: the surfaces overlap by {1e6 * depth:.3g} um before anything is loaded, more than an "
                    f"element there or a hundredth of a ball ({1e6 * size:.3g} um): check the places of the bodies, radial_clearance, preload and radial_expansion"
                )
