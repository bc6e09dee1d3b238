"""Bodies that share no node with each other: balls, or one ring as a whole."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numba import float64, int64, types, void

from raceway.core.elastic.copies import Copies
from raceway.core.elastic.superelements.part import Part
from raceway.core.jit import jit
from raceway.core.linear.fronts import Fronts
from raceway.core.linear.rigid_motions import rigid_motions
from raceway.core.signatures import CUBE, MATRIX

#: Solutions in single precision, each with the residual of those before: five digits more each.
REFINED = 3


class Loose:
    """Copies of a part, each seen from the nodes of its contacts.

    Parameters
    ----------
    part : Part
    flexibility : (3 k, 3 k) of one copy in the frame of the first, with the springs [m/N]
    hold : stiffness [N/m] of springs on the six mean motions of the contacts' nodes, where nothing else holds the body; the caller
        takes them off again

    Attributes
    ----------
    motions : (3 k, 6) what the springs act on, orthonormal; (3 k, 0) where ``hold`` is zero
    """

    def __init__(self, part: Part, flexibility: np.ndarray, hold: float = 0.0) -> None:
        self.part, self.flexibility, self.hold = part, flexibility, hold
        self._order = part.places(part.contact)
        self.motions = _mean_motions(part, hold)

    @classmethod
    def of(cls, part: Part, held: bool = False) -> Loose:
        """From a part just factored.

        Parameters
        ----------
        held : whether springs hold it: of the order of the contacts' nodes' own, with a mass too: that of a long step hardly holds a ball
        """
        schur, order = part.schur, part.places(part.contact)
        hold = float(np.trace(schur)) / len(schur) if held else 0.0
        stiffness, motions = schur[np.ix_(order, order)], _mean_motions(part, hold)
        return cls(part, inverse(stiffness + hold * motions @ motions.T), hold)

    @classmethod
    def of_arrays(cls, copies: Copies, contact: np.ndarray, arrays: Mapping[str, np.ndarray]) -> Loose:
        """The way back from ``arrays``."""
        part = Part(copies, contact, Fronts.of_arrays(arrays))
        return cls(part, arrays["flexibility"], float(arrays["hold"][0]))

    def arrays(self) -> dict[str, np.ndarray]:
        """What to keep."""
        return self.part.fronts.arrays() | {"flexibility": self.flexibility, "hold": np.array([self.hold])}

    @property
    def nodes(self) -> np.ndarray:
        """(copies, k) numbers of the contacts' nodes."""
        return self.part.nodes

    def respond(self, loads: np.ndarray) -> np.ndarray:
        """Displacements (1, 3 k) of the contacts' nodes under forces (1, 3 k) there, of a body that is one copy."""
        return loads @ self.flexibility

    def among(self, nodes: np.ndarray) -> np.ndarray:
        """(3 m, 3 m) flexibility of some of the contacts' nodes (m,) [m/N]."""
        places = (3 * nodes[:, None] + np.arange(3)).ravel()
        return self.flexibility[np.ix_(places, places)]

    @property
    def unknowns(self) -> np.ndarray:
        """(3 k,) of the contacts' nodes among those of the first copy."""
        return np.asarray(self.part.fronts.kept[self._order])

    def to_first(self, values: np.ndarray) -> np.ndarray:
        """Vectors (copies, 3 k) at the contacts' nodes, in the frame of the first copy."""
        return turned_vectors(values, self.part.copies.turns.transpose(0, 2, 1))

    def to_copies(self, values: np.ndarray) -> np.ndarray:
        """The way back."""
        return turned_vectors(values, self.part.copies.turns)

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What nodal forces (3 nodes,) are on the contacts' nodes (copies, 3 k), and what ``backward`` needs."""
        values = self.part.gathered(force)
        self.part.fronts.forward(values)
        return self.to_copies(values[self.unknowns].T.astype(float)), values

    def backward(self, carried: np.ndarray, moved: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (copies, 3 k)."""
        self.part.spread(self.inner(carried, self.to_first(moved)), out)

    def inner(self, carried: np.ndarray, moved: np.ndarray) -> np.ndarray:
        """(3 n, copies) displacements in the frame of the first copy, of those of the contacts (copies, 3 k) there."""
        carried[self.unknowns] = moved.T
        self.part.fronts.backward(carried)
        return carried

    def solved(self, force: np.ndarray, apply: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """(3 n, m) displacements of the first copy under forces (3 n, m), refined with ``apply``, which knows no springs."""
        found, places = np.zeros_like(force), self.unknowns
        for _ in range(REFINED):
            rest = force - apply(found)
            rest[places] -= self.hold * self.motions @ (self.motions.T @ found[places])
            values = np.ascontiguousarray(rest, dtype=np.float32)
            self.part.fronts.forward(values)
            moved = self.flexibility @ values[places].astype(float)
            found += self.inner(values, moved.T)
        return found


def _mean_motions(part: Part, hold: float) -> np.ndarray:
    if not hold:
        return np.zeros((part.size, 0))
    return np.asarray(np.linalg.qr(rigid_motions(part.copies.points[part.contact]))[0])


#: Kept arrays may be read-only.
_KEPT = types.Array(float64, 3, "C", readonly=True)


@jit(void(_KEPT, CUBE, int64[::1], int64[::1], MATRIX), allocates=True)
def gather_turned(blocks, turns, copies, nodes, out):  # type: ignore[no-untyped-def]
    """Flexibility of nodes (m,) of copies (m,), each turned to where it lies: out (3 m, 3 m).

    Parameters
    ----------
    blocks : (c, 3 k, 3 k) of copy i, in its frame, under forces on copy 0;  turns : (c, 3, 3)
    """
    work = np.empty((3, 3))
    for i in range(nodes.size):
        p = turns[copies[i]]
        for j in range(nodes.size):
            q, block = turns[copies[j]], blocks[(copies[i] - copies[j]) % blocks.shape[0]]
            row, column = 3 * nodes[i], 3 * nodes[j]
            for a in range(3):
                for d in range(3):
                    work[a, d] = (
                        p[a, 0] * block[row, column + d]
                        + p[a, 1] * block[row + 1, column + d]
                        + p[a, 2] * block[row + 2, column + d]
                    )
            for a in range(3):
                for b in range(3):
                    out[3 * i + a, 3 * j + b] = work[a, 0] * q[b, 0] + work[a, 1] * q[b, 1] + work[a, 2] * q[b, 2]


def turned_vectors(values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Vectors (copies, 3 k) of the nodes, turned copy by copy."""
    return np.einsum("cab,cnb->cna", turns, values.reshape(len(turns), -1, 3)).reshape(len(turns), -1)


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Of a symmetric, or Hermitian, positive definite matrix."""
    from scipy.linalg import cho_factor
    from scipy.linalg.lapack import dpotri, zpotri

    factor, lower = cho_factor(matrix, lower=True)
    found = (zpotri if np.iscomplexobj(factor) else dpotri)(factor, lower=lower)[0]
    return np.asarray(np.tril(found) + np.tril(found, -1).conj().T)
