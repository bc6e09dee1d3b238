"""A mesh that is factored once for all its copies, down to the nodes of its contacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numba import float64, int64, types, void

from raceway.core.fem.elastic.copies import Copies
from raceway.core.fem.elastic.fronts import Fronts, dissect, factored
from raceway.core.fem.elastic.linear_statics import rigid_motions
from raceway.core.fem.elastic.unknowns import of_nodes
from raceway.core.fem.hexahedron.operator import HexOperator
from raceway.core.jit import jit
from raceway.core.signatures import CUBE, MATRIX

#: Called with the work done and that of all.
_OnFront = Callable[[int, int], None]


class Part:
    """Factors of c K + d M of a mesh of hexahedra, for right sides of its copies.

    copies : Copies
    contact : (k,) nodes of the first copy that are retained beside its cut planes
    fronts : Fronts

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
        on_front: _OnFront | None = None,
    ) -> Part:
        """Factored.

        operator : HexOperator, whose material and formulation it has
        free : (n,) bool, nodes that are not held;  mass : d / c [1/s2]
        bed : (cells (b,), matrices (b, 24, 24)) that some cells stand on, or None
        """
        interface = np.unique(np.concatenate([contact, copies.before, copies.behind]))
        dissection = dissect(copies.points, copies.cells, interface[free[interface]])
        of_cells = operator.of_mesh(copies.points, copies.cells[dissection.order])
        additions: dict[int, np.ndarray] = {}
        if bed is not None:
            position = np.empty(len(dissection.order), dtype=np.int64)
            position[dissection.order] = np.arange(len(position))
            for cell, matrix in zip(position[bed[0]], bed[1], strict=True):
                additions[int(cell)] = additions.get(int(cell), 0.0) + matrix
        diagonal = np.arange(24)

        def matrices(part: slice) -> np.ndarray:
            out = of_cells.element_stiffness(part)
            if mass:
                out[:, diagonal, diagonal] += mass * np.repeat(of_cells.element_masses[part], 3, axis=1)
            if additions:
                for cell in range(part.start, part.stop):
                    if cell in additions:
                        out[cell - part.start] += additions[cell]
            return out

        return cls(copies, contact, factored(dissection, of_cells.cells, matrices, np.repeat(free, 3), on_front))

    @property
    def size(self) -> int:
        """Unknowns of a copy's contacts."""
        return 3 * len(self.contact)

    @property
    def schur(self) -> np.ndarray:
        """(k, k) of the retained unknowns, just after they were factored."""
        assert self.fronts.schur is not None
        return self.fronts.schur

    def places(self, nodes: np.ndarray) -> np.ndarray:
        """Where the unknowns of retained nodes stand among the retained ones, (3 nodes,)."""
        unknowns = of_nodes(nodes)
        position = np.searchsorted(self.fronts.kept, unknowns)
        assert np.array_equal(self.fronts.kept[np.minimum(position, len(self.fronts.kept) - 1)], unknowns), (
            "a held node is retained"
        )
        return np.asarray(position)

    def gathered(self, force: np.ndarray, kind: type = np.float32) -> np.ndarray:
        """(3 n, copies) of nodal forces (3 nodes,), each copy in the frame of the first."""
        local = np.einsum("cna,cab->cnb", force.reshape(-1, 3)[self.copies.nodes], self.copies.turns) * self.own[:, None]
        return np.ascontiguousarray(local.reshape(len(local), -1).T, dtype=kind)

    def spread(self, values: np.ndarray, out: np.ndarray) -> None:
        """Write displacements (3 n, copies) to the nodes of all copies in ``out`` (3 nodes,)."""
        displacement = values.T.reshape(len(self.copies.turns), -1, 3)
        out.reshape(-1, 3)[self.copies.nodes] = np.einsum("cnb,cab->cna", displacement, self.copies.turns)


#: Solutions in single precision, each with the residual of those before: five digits more each.
REFINED = 3


class Loose:
    """Copies of a part, each seen from the nodes of its contacts.

    part : Part;  flexibility : (3 k, 3 k) of one copy in the frame of the first, with the springs [m/N]
    hold : stiffness [N/m] of springs on the six mean motions of the contacts' nodes, where nothing else holds the body; the caller
        takes them off again

    nodes : (copies, k) numbers of the contacts' nodes
    motions : (3 k, 6) what the springs act on, orthonormal; (3 k, 0) where ``hold`` is zero
    """

    def __init__(self, part: Part, flexibility: np.ndarray, hold: float = 0.0) -> None:
        self.part, self.nodes, self.flexibility, self.hold = part, part.nodes, flexibility, hold
        self._order = part.places(part.contact)
        self.motions = _mean_motions(part, hold)

    @classmethod
    def of(cls, part: Part, held: bool = False) -> Loose:
        """From a part just factored.

        held : whether springs hold it: of the order of the contacts' nodes' own, with a mass too: that of a long step hardly holds a ball
        """
        schur, order = part.schur, part.places(part.contact)
        hold = float(np.trace(schur)) / len(schur) if held else 0.0
        stiffness, motions = schur[np.ix_(order, order)], _mean_motions(part, hold)
        return cls(part, _inverse(stiffness + hold * motions @ motions.T), hold)

    @classmethod
    def of_arrays(cls, copies: Copies, contact: np.ndarray, arrays: Mapping[str, np.ndarray]) -> Loose:
        """The way back from ``arrays``."""
        part = Part(copies, contact, Fronts.of_arrays(arrays))
        return cls(part, arrays["flexibility"], float(arrays["hold"][0]))

    def arrays(self) -> dict[str, np.ndarray]:
        """What to keep."""
        return self.part.fronts.arrays() | {"flexibility": self.flexibility, "hold": np.array([self.hold])}

    def respond(self, loads: np.ndarray) -> np.ndarray:
        """Displacements (1, 3 k) of the contacts' nodes under forces (1, 3 k) there, of a body that is one copy."""
        return loads @ self.flexibility

    def among(self, nodes: np.ndarray) -> np.ndarray:
        """(3 m, 3 m) flexibility of some of the contacts' nodes (m,) [m/N]."""
        places = of_nodes(nodes)
        return self.flexibility[np.ix_(places, places)]

    @property
    def unknowns(self) -> np.ndarray:
        """(3 k,) of the contacts' nodes among those of the first copy."""
        return np.asarray(self.part.fronts.kept[self._order])

    def to_first(self, values: np.ndarray) -> np.ndarray:
        """Vectors (copies, 3 k) at the contacts' nodes, in the frame of the first copy."""
        return _turned_vectors(values, self.part.copies.turns.transpose(0, 2, 1))

    def to_copies(self, values: np.ndarray) -> np.ndarray:
        """The way back."""
        return _turned_vectors(values, self.part.copies.turns)

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What nodal forces (3 nodes,) are on the contacts' nodes (copies, 3 k), and what ``backward`` needs."""
        values = self.part.gathered(force)
        self.part.fronts.forward(values)
        return self.to_copies(values[self.unknowns].T.astype(float)), values

    def backward(self, interior: np.ndarray, displacement: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (copies, 3 k)."""
        self.part.spread(self.inner(interior, self.to_first(displacement)), out)

    def inner(self, interior: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """(3 n, copies) displacements in the frame of the first copy, of those of the contacts (copies, 3 k) there."""
        interior[self.unknowns] = displacement.T
        self.part.fronts.backward(interior)
        return interior

    def solved(self, force: np.ndarray, apply: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """(3 n, m) displacements of the first copy under forces (3 n, m), refined with ``apply``, which knows no springs."""
        solution, places = np.zeros_like(force), self.unknowns
        for _ in range(REFINED):
            residual = force - apply(solution)
            residual[places] -= self.hold * self.motions @ (self.motions.T @ solution[places])
            values = np.ascontiguousarray(residual, dtype=np.float32)
            self.part.fronts.forward(values)
            displacement = self.flexibility @ values[places].astype(float)
            solution += self.inner(values, displacement.T)
        return solution


def _mean_motions(part: Part, hold: float) -> np.ndarray:
    if not hold:
        return np.zeros((part.size, 0))
    return np.asarray(np.linalg.qr(rigid_motions(part.copies.points[part.contact]))[0])


#: Kept arrays may be read-only.
_KEPT = types.Array(float64, 3, "C", readonly=True)


@jit(void(_KEPT, CUBE, int64[::1], int64[::1], MATRIX), allocates=True)
def gather_turned(blocks, turns, copies, nodes, out):  # type: ignore[no-untyped-def]
    """Flexibility of nodes (m,) of copies (m,), each turned to where it lies: out (3 m, 3 m).

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


def _turned_vectors(values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Vectors (copies, 3 k) of the nodes, turned copy by copy."""
    return np.einsum("cab,cnb->cna", turns, values.reshape(len(turns), -1, 3)).reshape(len(turns), -1)


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Of a symmetric, or Hermitian, positive definite matrix."""
    from scipy.linalg import cho_factor
    from scipy.linalg.lapack import dpotri, zpotri

    factor, lower = cho_factor(matrix, lower=True)
    result = (zpotri if np.iscomplexobj(factor) else dpotri)(factor, lower=lower)[0]
    return np.asarray(np.tril(result) + np.tril(result, -1).conj().T)


class Closed:
    """Sectors that make up a ring, seen from the nodes of its contacts.

    part : Part, a sector
    factors : (harmonics, p, p) complex64, lower triangles of what the cut plane's unknowns are in each harmonic
    across : (harmonics, p, 3 k) complex64, between the cut plane and the contacts' nodes
    blocks : (copies, 3 k, 3 k) displacements of sector c, in its frame, under forces on the first sector [m/N]

    With l_c the displacements on the first cut plane of sector c, in the frame of that sector, its second cut plane has Q
    l_(c+1): Q turns by one sector. A discrete Fourier transform over the sectors makes this Q exp(i theta_h) l_h, and the
    harmonics h are independent.

    Thomas, D. L.: Dynamics of rotationally periodic structures, International Journal for Numerical Methods in Engineering
    14 (1979) 81.
    """

    def __init__(self, part: Part, factors: np.ndarray, across: np.ndarray, blocks: np.ndarray) -> None:
        self.part, self.nodes, self._factors, self._across, self.blocks = part, part.nodes, factors, across, blocks
        self._before, self._behind, self._order = _places(part)
        self._next = part.copies.turns[1]
        self._loaded: tuple[np.ndarray, np.ndarray] | None = None

    @classmethod
    def of(cls, part: Part) -> Closed:
        """From a part just factored."""
        from scipy.linalg import cholesky
        from scipy.linalg.blas import ztrsm

        before, behind, order = _places(part)
        schur, count, onward = part.schur, len(part.copies.turns), part.copies.turns[1]
        cut = np.concatenate([before, behind])
        planes, across = schur[np.ix_(cut, cut)], schur[np.ix_(cut, order)]
        contacts = schur[np.ix_(order, order)]
        most = count // 2 + 1
        factors = np.empty((most, len(before), len(before)), dtype=np.complex64)
        mixed_all = np.empty((most, len(before), part.size), dtype=np.complex64)
        harmonics = np.empty((most, part.size, part.size), dtype=complex)
        for h in range(most):
            phase = np.exp(2j * np.pi * h / count)
            half = _fold(planes, phase, onward)
            matrix = _fold(half.conj().T, phase, onward).conj().T
            mixture = _fold(across, phase, onward)
            lower = cholesky(0.5 * (matrix + matrix.conj().T), lower=True)
            factors[h], mixed_all[h] = lower, mixture
            half = ztrsm(1.0, lower, mixture, lower=1)
            harmonics[h] = _inverse(contacts - half.conj().T @ half)
        return cls(part, factors, mixed_all, np.fft.irfft(harmonics, count, axis=0))

    @classmethod
    def of_arrays(cls, copies: Copies, contact: np.ndarray, arrays: Mapping[str, np.ndarray]) -> Closed:
        """The way back from ``arrays``."""
        part = Part(copies, contact, Fronts.of_arrays(arrays))
        return cls(part, arrays["planes"], arrays["across"], arrays["blocks"])

    def arrays(self) -> dict[str, np.ndarray]:
        """What to keep."""
        return self.part.fronts.arrays() | {"planes": self._factors, "across": self._across, "blocks": self.blocks}

    def respond(self, loads: np.ndarray) -> np.ndarray:
        """Displacements (copies, 3 k) of the contacts' nodes under forces (copies, 3 k) there.

        By reciprocity, row j of block -c is what a force j does c sectors on.
        """
        turns = self.part.copies.turns
        local = _turned_vectors(loads, turns.transpose(0, 2, 1))
        columns, rows = self._under(np.asarray(local.any(axis=0)))
        out, few = np.zeros_like(local), local[:, columns]
        for away in range(len(turns)):
            out += np.roll(few @ rows[-away], away, axis=0)
        return _turned_vectors(out, turns)

    def _under(self, load_places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Loaded columns (3 k,) bool, and their rows of the blocks: few in a contact, held until others are loaded."""
        if 2 * load_places.sum() > len(load_places):
            return np.ones_like(load_places), self.blocks
        cache = self._loaded
        if cache is None or (load_places & ~cache[0]).any() or 2 * load_places.sum() < cache[0].sum():
            cache = self._loaded = load_places, self.blocks[:, load_places]
        return cache

    def among(self, nodes: np.ndarray) -> np.ndarray:
        """(3 m, 3 m) flexibility of some of the contacts' nodes (m,), numbered through all sectors [m/N]."""
        k = self.part.size // 3
        out = np.empty((3 * len(nodes), 3 * len(nodes)))
        gather_turned(self.blocks, self.part.copies.turns, nodes // k, nodes % k, out)
        return out

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """What nodal forces (3 nodes,) are on the contacts' nodes (copies, 3 k), and what ``backward`` needs."""
        values = self.part.gathered(force)
        self.part.fronts.forward(values)
        on_interface = values[self.part.fronts.kept].astype(float)
        rows = np.concatenate([self._before, self._behind])
        spectrum = np.fft.rfft(on_interface[rows], axis=1)
        contact = np.fft.rfft(on_interface[self._order], axis=1)
        count = on_interface.shape[1]
        interior_spectrum = np.empty((len(self._before), spectrum.shape[1]), dtype=complex)
        for h in range(len(self._factors)):
            fold = _fold(spectrum[:, h : h + 1], np.exp(2j * np.pi * h / count), self._next)
            interior_spectrum[:, h] = self._on_planes(h, fold[:, 0])
            contact[:, h] -= self._across[h].conj().T @ interior_spectrum[:, h].astype(np.complex64)
        return _turned_vectors(np.fft.irfft(contact, count, axis=1).T, self.part.copies.turns), (values, interior_spectrum)

    def backward(self, interior: tuple[np.ndarray, np.ndarray], displacement: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (copies, 3 k)."""
        values, interior_spectrum = interior
        turns, interface = self.part.copies.turns, self.part.fronts.kept
        contact = _turned_vectors(displacement, turns.transpose(0, 2, 1)).T
        images = np.fft.rfft(contact, axis=1)
        plane = np.empty_like(interior_spectrum)
        for h in range(len(self._factors)):
            plane[:, h] = interior_spectrum[:, h] - self._on_planes(h, self._across[h] @ images[:, h].astype(np.complex64))
        before = np.fft.irfft(plane, len(turns), axis=1)
        values[interface[self._order]] = contact
        values[interface[self._before]] = before
        behind = self._next @ np.roll(before, -1, axis=1).reshape(-1, 3, len(turns))
        values[interface[self._behind]] = behind.reshape(-1, len(turns))
        self.part.fronts.backward(values)
        self.part.spread(values, out)

    def _on_planes(self, harmonic: int, right: np.ndarray) -> np.ndarray:
        """(p,) what the cut plane's unknowns are under forces (p,) in one harmonic."""
        from scipy.linalg import cho_solve

        lower = self._factors[harmonic]
        return np.asarray(cho_solve((lower, True), right.astype(np.complex64), check_finite=False))


def _places(part: Part) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places among the kept unknowns: of the free ones on the first cut plane, of their images, of the contacts' nodes."""
    copies = part.copies
    free = np.isin(3 * copies.before, part.fronts.kept)
    before, behind, contact = (part.places(nodes) for nodes in (copies.before[free], copies.behind[free], part.contact))
    return before, behind, contact


def _fold(rows: np.ndarray, phase: complex, onward: np.ndarray) -> np.ndarray:
    """P^H rows: of rows on both cut planes those of the first, P = (1; Q exp(i theta)), Q ``onward`` (3, 3)."""
    half = len(rows) // 2
    second = np.conj(phase) * (onward.T @ rows[half:].reshape(-1, 3, rows.shape[1])).reshape(half, -1)
    return np.asarray(rows[:half] + second)
