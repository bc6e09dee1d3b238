"""A mesh that is factored once for all its copies, down to the nodes of its contacts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.core.elastic.copies import Copies
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.linear.dissection import dissect
from raceway.core.linear.fronts import Fronts, factored

#: Called with the work done and that of all.
OnFront = Callable[[int, int], None]


class Part:
    """Factors of c K + d M of a mesh of hexahedra, for right sides of its copies.

    Parameters
    ----------
    copies : Copies
    contact : (k,) nodes of the first copy that are kept beside its cut planes
    fronts : Fronts

    Attributes
    ----------
    nodes : (copies, k) numbers of the contacts' nodes
    own : (n,) bool, nodes whose forces belong to the copy: not the images on its second cut plane
    """

    def __init__(self, copies: Copies, contact: np.ndarray, fronts: Fronts) -> None:
        self.copies, self.contact, self.fronts = copies, np.asarray(contact), fronts
        self.nodes = copies.nodes[:, self.contact]
        self.own = np.ones(len(copies.points), dtype=bool)
        self.own[copies.behind] = False

    @classmethod
    def of(
        cls,
        copies: Copies,
        operator: HexOperator,
        contact: np.ndarray,
        free: np.ndarray,
        mass: float = 0.0,
        bed: tuple[np.ndarray, np.ndarray] | None = None,
        on_front: OnFront | None = None,
    ) -> Part:
        """Factored.

        Parameters
        ----------
        operator : HexOperator, whose material and formulation it has
        free : (n,) bool, nodes that are not held
        mass : d / c [1/s2]
        bed : (cells (b,), matrices (b, 24, 24)) that some cells stand on, or None
        on_front : OnFront, optional
        """
        kept = np.unique(np.concatenate([contact, copies.before, copies.behind]))
        dissection = dissect(copies.points, copies.cells, kept[free[kept]])
        ordered = operator.of_mesh(copies.points, copies.cells[dissection.order])
        added: dict[int, np.ndarray] = {}
        if bed is not None:
            place = np.empty(len(dissection.order), dtype=np.int64)
            place[dissection.order] = np.arange(len(place))
            for cell, matrix in zip(place[bed[0]], bed[1], strict=True):
                added[int(cell)] = added.get(int(cell), 0.0) + matrix
        diagonal = np.arange(24)

        def matrices(part: slice) -> np.ndarray:
            out = ordered.element_stiffness(part)
            if mass:
                out[:, diagonal, diagonal] += mass * np.repeat(ordered.element_masses[part], 3, axis=1)
            if added:
                for cell in range(part.start, part.stop):
                    if cell in added:
                        out[cell - part.start] += added[cell]
            return out

        return cls(copies, contact, factored(dissection, ordered.cells, matrices, np.repeat(free, 3), on_front))

    @property
    def size(self) -> int:
        """Unknowns of a copy's contacts."""
        return 3 * len(self.contact)

    @property
    def schur(self) -> np.ndarray:
        """(kept, kept) of the kept unknowns, just after they were factored."""
        assert self.fronts.schur is not None
        return self.fronts.schur

    def places(self, nodes: np.ndarray) -> np.ndarray:
        """Where the unknowns of kept nodes stand among the kept ones, (3 nodes,)."""
        wanted = (3 * nodes[:, None] + np.arange(3)).ravel()
        found = np.searchsorted(self.fronts.kept, wanted)
        assert np.array_equal(self.fronts.kept[np.minimum(found, len(self.fronts.kept) - 1)], wanted), "a held node is kept"
        return np.asarray(found)

    def gathered(self, force: np.ndarray, kind: type = np.float32) -> np.ndarray:
        """(3 n, copies) of nodal forces (3 nodes,), each copy in the frame of the first."""
        found = np.einsum("cna,cab->cnb", force.reshape(-1, 3)[self.copies.nodes], self.copies.turns) * self.own[:, None]
        return np.ascontiguousarray(found.reshape(len(found), -1).T, dtype=kind)

    def spread(self, values: np.ndarray, out: np.ndarray) -> None:
        """Write displacements (3 n, copies) to the nodes of all copies in ``out`` (3 nodes,)."""
        found = values.T.reshape(len(self.copies.turns), -1, 3)
        out.reshape(-1, 3)[self.copies.nodes] = np.einsum("cnb,cab->cna", found, self.copies.turns)
