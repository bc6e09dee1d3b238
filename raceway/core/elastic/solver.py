"""Conjugate gradients for the linearised system, with multigrid that knows the contacts and the rigid frames."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.assembly import Assembly
from raceway.core.elastic.contacts.contact import Contact
from raceway.core.elastic.factorised import MOST_OF_A_BODY, MOST_UNKNOWNS, Factorised
from raceway.core.elastic.low_rank import LowRankContacts
from raceway.core.linear.blocks import BlockMatrix
from raceway.core.linear.statics import Preconditioner

#: Iterations after which a solve gives up, and after which the multigrid is made anew for the next one.
MOST_ITERATIONS, MANY_ITERATIONS = 600, 300
#: Iterations of a solve with factors that still fit, and how many more all solves together may take before new factors pay.
FEW_ITERATIONS, WORTH_FACTORS = 3, 30
#: Nodes of an aggregate.  Flat cells of contacts are put together in pairs or triples, whose six unknowns would make the next
#: level dearer than the finest one: at 9600 cells 1.3 times the iterations, each at a quarter of the cost.
FEWEST_NODES = 6
#: Share of the springs in the cage's place that is left where the cage itself is added, so that loose balls have an inverse.
_HARDLY = 1e-3
#: Ratio of the mass' share of the matrix at which the multigrid is made anew.
_OTHER_MASS = 4.0
#: Relative residual to which the free nodes' following of a frame is solved.
_FOLLOW_TOLERANCE = 1e-2


class LinearSolver:
    """(c_k K + c_c C + c_m M)^-1 with the tangents of the last contact forces.

    Notes
    -----
    A frame that moves drags the whole system along: with Phi = the free nodes' displacement under a unit motion of each
    frame, solved for whenever the multigrid is made, y = (q, Phi q + w) splits the matrix into two blocks that hardly know of
    each other: Phi^T A Phi, a few numbers, and multigrid for w (bodies, contacts, masses).
    """

    def __init__(self, assembly: Assembly, contact: Contact | None, modulus: float) -> None:
        self.assembly, self.contact, self.modulus = assembly, contact, modulus
        self._multigrid: Preconditioner | Factorised | None = None
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
        stale = self._multigrid is None or self.last_iterations > MANY_ITERATIONS and not self._fresh
        # Factors hold the contacts' stiffness of when they were made, unless whole contacts are added to them.
        aged = isinstance(self._multigrid, Factorised) and self._whole is None
        stale = stale or aged and self._extra > WORTH_FACTORS
        other = (
            abs(np.log((ratio + 1e-300) / (self._built + 1e-300))) > np.log(_OTHER_MASS)
            and max(ratio, self._built) * a.free_mass.max() > 1e-3 * self.modulus * self._length()
        )
        if stale or other:
            self._make(c_k, c_m)
        wanted = np.where(a.unknown, right, 0.0)
        apply = self.image(c_k, c_c, c_m)
        precondition = self._preconditioner(c_k, c_c, apply)
        found, self.last_iterations = _conjugate_gradients(apply, wanted, precondition, tolerance)
        self._fresh = False
        self._extra += max(self.last_iterations - FEW_ITERATIONS, 0)
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
        a, contact = self.assembly, self.contact
        matrix, whole = a.stiffness(), contact is not None and contact.whole
        if contact is not None and not whole:
            matrix = matrix + contact.tangent(contact.stiffness)
        extra = c_m / c_k * np.repeat(a.node_mass, 3)
        largest = 3 * int(np.diff(a.starts).max())
        small = len(a.free) <= MOST_UNKNOWNS and largest <= MOST_OF_A_BODY
        # Multigrid does not know the answers of bodies that are hardly held well enough to correct them.
        cage = a.cage if whole and small else None
        if a.cage is not None:
            extra += (1.0 if cage is None else _HARDLY) * a.cage.nodal
        from scipy.sparse import diags_array

        held = np.ones(3 * a.nodes, dtype=bool)
        held[a.free] = False
        sprung = (matrix + diags_array(extra)).tocsr()
        self._multigrid = Factorised(sprung, held) if small else Preconditioner(sprung, a.points, held, FEWEST_NODES)
        self._whole = LowRankContacts(contact, cage, self._multigrid, a.free) if contact is not None and whole else None
        self._built, self._fresh, self._extra = c_m / c_k, True, 0
        self.setups += 1
        self._extend(c_k, c_m)

    def _extend(self, c_k: float, c_m: float) -> None:
        """Displacement of the free nodes with each frame: the solution of the whole for a unit motion of the frame."""
        a, m = self.assembly, self.assembly.frame_size
        self._follow = self._ride.copy()
        apply, multigrid = self.image(c_k, 0.0, c_m), self._inverse(c_k, 0.0)
        for k in np.flatnonzero(a.frame_free):
            start = np.concatenate([np.eye(m)[k], self._ride[:, k]])
            more, used = _conjugate_gradients(
                lambda w: apply(np.concatenate([np.zeros(m), w]))[m:],
                -apply(start)[m:],
                multigrid,
                _FOLLOW_TOLERANCE,
            )
            self._follow[:, k] += more
            self.iterations += used

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
            for foundation, ride in a.foundations:
                pull = foundation @ (ride @ q)
                force -= pull
                pulled += ride.T @ (pull - foundation @ u)
            force *= c_k
            if blocks is not None and len(blocks):
                force += transposed @ np.einsum("iab,ib->ia", blocks, (move @ u).reshape(-1, 3)).ravel()
            out = a.reduced(force)
            out[:m] += c_k * pulled + frame @ q
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
            chosen = np.flatnonzero(a.frame_free)
            images = np.stack([operator(np.concatenate([np.eye(m)[k], follow[:, k]])) for k in chosen], axis=1)
            block = images[chosen] + follow[:, chosen].T @ images[m:]
            inverse[np.ix_(chosen, chosen)] = np.linalg.pinv(0.5 * (block + block.T), hermitian=True)

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
    found, residual = np.zeros_like(right), right.copy()
    direction, before, goal = np.zeros_like(right), 1.0, 0.0
    for done in range(MOST_ITERATIONS):
        corrected = precondition(residual)
        now = float(residual @ corrected)
        if done == 0:
            goal = tolerance**2 * now
        if now < 0.0:  # a preconditioner that is indefinite here: along the residual, or with what was found so far
            if done:
                return found, done
            corrected, now, goal = residual.copy(), float(residual @ residual), 0.0
        elif now <= goal:
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
