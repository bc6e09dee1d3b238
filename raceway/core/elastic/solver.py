"""Conjugate gradients for the linearised system, with multigrid that knows the contacts and the rigid frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from raceway.core.blocks import BlockMatrix
from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.contact import NodalContact
from raceway.core.linear_statics import Preconditioner

#: Iterations after which a solve gives up, and after which the multigrid is made anew for the next one.
MOST_ITERATIONS, MANY_ITERATIONS = 600, 60
SOFT=1.0
#: Ratio of the mass' share of the matrix at which the multigrid is made anew.
_OTHER_MASS = 4.0


class LinearSolver:
    """(c_k K + c_c C + c_m M)^-1 with the tangents of the last contact forces.

    Notes
    -----
    Let w be the displacements against the frames, y = (q, R q + w).  The bodies' stiffness does not see q then, and the
    preconditioner is block diagonal: multigrid on w (bodies, contacts, masses, at the state at which it was made) and a
    small dense block for q, in which each contact counts with the stiffness 2 E* sqrt(area / pi) of a flat punch: what
    resists a frame is the contacts' Hertzian softness, not their penalty.
    """

    def __init__(self, assembly: Assembly, contact: NodalContact | None, modulus: float) -> None:
        self.assembly, self.contact, self.modulus = assembly, contact, modulus
        self._multigrid: Preconditioner | None = None
        self._built = (1.0, 0.0)
        self._fresh = False
        #: Iterations of the last solve, of all solves, number of solves and of multigrid set-ups.
        self.last_iterations, self.iterations, self.solves, self.setups = 0, 0, 0, 0
        a = assembly
        self._ride = a.carried[a.free]
        self._matrix: BlockMatrix | None = None

    def solve(self, c_k: float, c_c: float, c_m: float, right: np.ndarray, tolerance: float) -> np.ndarray:
        """(size,) solution to a relative residual; zero for frames' coordinates that are held."""
        a = self.assembly
        ratio = c_m / c_k
        stale = self._multigrid is None or self.last_iterations > MANY_ITERATIONS and not self._fresh
        other = (
            abs(np.log((ratio + 1e-300) / (self._built[1] + 1e-300))) > np.log(_OTHER_MASS)
            and max(ratio, self._built[1]) * a.free_mass.max() > 1e-3 * self.modulus * self._length()
        )
        if stale or other:
            self._make(c_k, c_m)
        wanted = np.where(a.unknown, right, 0.0)
        apply, precondition = self._operator(c_k, c_c, c_m), self._preconditioner(c_k, c_c, c_m)
        found, self.last_iterations = _conjugate_gradients(apply, wanted, precondition, tolerance)
        self._fresh = False
        self.iterations += self.last_iterations
        self.solves += 1
        return found

    def forget(self) -> None:
        """The next solve makes its multigrid anew."""
        self._multigrid = None

    def _length(self) -> float:
        a = self.assembly
        return float(np.cbrt(a.free_mass.max() / a.bodies[0].operator.density))

    def _make(self, c_k: float, c_m: float) -> None:
        a = self.assembly
        matrix = a.stiffness()
        if self.contact is not None:
            matrix = matrix + self.contact.tangent(SOFT * self.contact.stiffness)
        extra = c_m / c_k * np.repeat(a.node_mass, 3)
        if a.cage is not None:
            # The mean of a ball's motion is dense; a spring on every node in proportion to its mass holds it as well.
            for rows, k in zip(a.cage.rows.tolil().rows, a.cage.stiffness, strict=True):
                body = int(np.searchsorted(3 * a.starts, rows[0], side="right") - 1)
                mass = a.node_mass[a.starts[body] : a.starts[body + 1]]
                if len(rows) and k > 0.0:
                    extra[a.part(body)] += np.repeat(k * mass / mass.sum(), 3) / 4.0
        from scipy.sparse import diags_array

        held = np.ones(3 * a.nodes, dtype=bool)
        held[a.free] = False
        self._multigrid = Preconditioner((matrix + diags_array(extra)).tocsr(), a.points, held)
        self._built, self._fresh = (c_k, c_m / c_k), True
        self.setups += 1

    def _operator(self, c_k: float, c_c: float, c_m: float) -> Callable[[np.ndarray], np.ndarray]:
        a, contact = self.assembly, self.contact
        m = a.frame_size
        if self._matrix is None:
            self._matrix = BlockMatrix(a.stiffness())
        matrix = self._matrix
        blocks = None if contact is None else c_k * contact.stiffness + c_c * contact.rate_stiffness
        if blocks is not None:
            chosen = np.flatnonzero(blocks.any(axis=(1, 2)))
            move = contact.move[(3 * chosen[:, None] + np.arange(3)).ravel()]
            transposed, blocks = move.T.tocsr(), blocks[chosen]
        frame = c_k * a.frame_stiffness + c_c * 0.5 * (a.frame_damping + a.frame_damping.T) + c_m * a.frame_mass

        def apply(y: np.ndarray) -> np.ndarray:
            q, u = y[:m], a.nodal(y)
            force = matrix.times(u)
            if a.cage is not None:
                force += a.cage.internal(u)
            pulled = np.zeros(m)
            for bed, ride in a.beds:
                pull = bed @ (ride @ q)
                force -= pull
                pulled += ride.T @ (pull - bed @ u)
            force *= c_k
            if blocks is not None and len(blocks):
                force += transposed @ np.einsum("iab,ib->ia", blocks, (move @ u).reshape(-1, 3)).ravel()
            out = a.reduced(force)
            out[:m] += c_k * pulled + frame @ q
            out[m:] += c_m * a.free_mass * y[m:]
            out[~a.unknown] = 0.0
            return out

        return apply

    def _preconditioner(self, c_k: float, c_c: float, c_m: float) -> Callable[[np.ndarray], np.ndarray]:
        a, m, multigrid = self.assembly, self.assembly.frame_size, self._multigrid
        assert multigrid is not None
        inverse = np.linalg.pinv(self._frame_block(c_k, c_c, c_m)) if m else np.zeros((0, 0))
        scale = 1.0 / c_k

        def apply(r: np.ndarray) -> np.ndarray:
            out = np.empty_like(r)
            out[m:] = scale * multigrid(r[m:])
            if m:
                out[:m] = inverse @ (r[:m] + self._ride.T @ r[m:])
                out[m:] += self._ride @ out[:m]
            return out

        return apply

    def _frame_block(self, c_k: float, c_c: float, c_m: float) -> np.ndarray:
        """(m, m) what resists the frames, about."""
        a = self.assembly
        block = c_k * a.frame_stiffness + c_c * 0.5 * (a.frame_damping + a.frame_damping.T) + c_m * a.frame_mass
        mass = np.repeat(a.node_mass, 3)[a.free]
        block = block + c_m * (self._ride.T @ (mass[:, None] * self._ride))
        contact = self.contact
        if contact is not None:
            active = contact.stiffness.any(axis=(1, 2))
            for index in range(len(contact.pairs)):
                mine = np.flatnonzero(active & (contact.pair == index))
                if not len(mine):
                    continue
                area = contact.area[mine].sum()
                rows = (3 * mine[:, None] + np.arange(3)).ravel()
                slip = (contact.move[rows] @ a.carried).reshape(len(mine), 3, -1)
                towards = np.einsum("iak,ia->ik", slip, contact.normal[mine])
                mean = contact.area[mine] @ towards / area
                block = block + c_k * self.modulus * np.sqrt(area / np.pi) * np.outer(mean, mean)
        keep = a.frame_free
        block = np.where(keep[:, None] & keep[None, :], block, 0.0)
        return np.asarray(block + np.diag(np.where(keep, 1e-9 * max(np.trace(block), 1e-300), 0.0)))


def _conjugate_gradients(
    apply: Callable[[np.ndarray], np.ndarray],
    right: np.ndarray,
    precondition: Callable[[np.ndarray], np.ndarray],
    tolerance: float,
) -> tuple[np.ndarray, int]:
    """Solution and iterations; the residual is measured in the preconditioner's norm, in which N and N m may be added."""
    found, residual = np.zeros_like(right), right.copy()
    direction, before, goal = np.zeros_like(right), 1.0, 0.0
    for done in range(MOST_ITERATIONS):
        corrected = precondition(residual)
        now = float(residual @ corrected)
        if done == 0:
            goal = tolerance**2 * now
        if now <= goal:
            return found, done
        direction = corrected + (now / before if done else 0.0) * direction
        image = apply(direction)
        curvature = float(direction @ image)
        if curvature <= 0.0:  # a free motion or a buckled state: what was found so far still descends
            return (found if done else corrected), done
        step = now / curvature
        found += step * direction
        residual -= step * image
        before = now
    return found, MOST_ITERATIONS
