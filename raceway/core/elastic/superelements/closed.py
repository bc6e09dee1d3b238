"""A ring of equal sectors: its cut planes are closed harmonic by harmonic.

With l_c the displacements on the first cut plane of sector c, in the frame of that sector, its second cut plane has Q l_(c+1): Q turns by one
sector.  A discrete Fourier transform over the sectors makes this Q exp(i theta_h) l_h, and the harmonics h are independent.

Reference
---------
Thomas, D. L.: Dynamics of rotationally periodic structures, International Journal for Numerical Methods in Engineering 14 (1979) 81.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from raceway.core.elastic.copies import Copies
from raceway.core.elastic.superelements.loose import gather_turned, inverse, turned_vectors
from raceway.core.elastic.superelements.part import Part
from raceway.core.linear.fronts import Fronts


class Closed:
    """Sectors that make up a ring, seen from the nodes of its contacts.

    Parameters
    ----------
    part : Part, a sector
    factors : (harmonics, p, p) complex64, lower triangles of what the cut plane's unknowns are in each harmonic
    across : (harmonics, p, 3 k) complex64, between the cut plane and the contacts' nodes
    blocks : (copies, 3 k, 3 k) displacements of sector c, in its frame, under forces on the first sector [m/N]
    """

    def __init__(self, part: Part, factors: np.ndarray, across: np.ndarray, blocks: np.ndarray) -> None:
        self.part, self._factors, self._across, self.blocks = part, factors, across, blocks
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
        many = count // 2 + 1
        factors = np.empty((many, len(before), len(before)), dtype=np.complex64)
        mixed_all = np.empty((many, len(before), part.size), dtype=np.complex64)
        harmonics = np.empty((many, part.size, part.size), dtype=complex)
        for h in range(many):
            phase = np.exp(2j * np.pi * h / count)
            half = _folded(planes, phase, onward)
            matrix = _folded(half.conj().T, phase, onward).conj().T
            mixed = _folded(across, phase, onward)
            lower = cholesky(0.5 * (matrix + matrix.conj().T), lower=True)
            factors[h], mixed_all[h] = lower, mixed
            half = ztrsm(1.0, lower, mixed, lower=1)
            harmonics[h] = inverse(contacts - half.conj().T @ half)
        return cls(part, factors, mixed_all, np.fft.irfft(harmonics, count, axis=0))

    @classmethod
    def of_arrays(cls, copies: Copies, contact: np.ndarray, arrays: Mapping[str, np.ndarray]) -> Closed:
        """The way back from ``arrays``."""
        part = Part(copies, contact, Fronts.of_arrays(arrays))
        return cls(part, arrays["planes"], arrays["across"], arrays["blocks"])

    def arrays(self) -> dict[str, np.ndarray]:
        """What to keep."""
        return self.part.fronts.arrays() | {"planes": self._factors, "across": self._across, "blocks": self.blocks}

    @property
    def nodes(self) -> np.ndarray:
        """(copies, k) numbers of the contacts' nodes."""
        return self.part.nodes

    def respond(self, loads: np.ndarray) -> np.ndarray:
        """Displacements (copies, 3 k) of the contacts' nodes under forces (copies, 3 k) there.

        Notes
        -----
        By reciprocity, row j of block -c is what a force j does c sectors on.
        """
        turns = self.part.copies.turns
        local = turned_vectors(loads, turns.transpose(0, 2, 1))
        columns, rows = self._under(np.asarray(local.any(axis=0)))
        out, few = np.zeros_like(local), local[:, columns]
        for away in range(len(turns)):
            out += np.roll(few @ rows[-away], away, axis=0)
        return turned_vectors(out, turns)

    def _under(self, loaded: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Loaded columns (3 k,) bool, and their rows of the blocks: few in a contact, held until others are loaded."""
        if 2 * loaded.sum() > len(loaded):
            return np.ones_like(loaded), self.blocks
        known = self._loaded
        if known is None or (loaded & ~known[0]).any() or 2 * loaded.sum() < known[0].sum():
            known = self._loaded = loaded, self.blocks[:, loaded]
        return known

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
        kept = values[self.part.fronts.kept].astype(float)
        rows = np.concatenate([self._before, self._behind])
        left = np.fft.rfft(kept[rows], axis=1)
        contact = np.fft.rfft(kept[self._order], axis=1)
        count = kept.shape[1]
        solved = np.empty((len(self._before), left.shape[1]), dtype=complex)
        for h in range(len(self._factors)):
            folded = _folded(left[:, h : h + 1], np.exp(2j * np.pi * h / count), self._next)
            solved[:, h] = self._on_planes(h, folded[:, 0])
            contact[:, h] -= self._across[h].conj().T @ solved[:, h].astype(np.complex64)
        return turned_vectors(np.fft.irfft(contact, count, axis=1).T, self.part.copies.turns), (values, solved)

    def backward(self, carried: tuple[np.ndarray, np.ndarray], moved: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (copies, 3 k)."""
        values, solved = carried
        turns, kept = self.part.copies.turns, self.part.fronts.kept
        contact = turned_vectors(moved, turns.transpose(0, 2, 1)).T
        images = np.fft.rfft(contact, axis=1)
        plane = np.empty_like(solved)
        for h in range(len(self._factors)):
            plane[:, h] = solved[:, h] - self._on_planes(h, self._across[h] @ images[:, h].astype(np.complex64))
        before = np.fft.irfft(plane, len(turns), axis=1)
        values[kept[self._order]] = contact
        values[kept[self._before]] = before
        behind = self._next @ np.roll(before, -1, axis=1).reshape(-1, 3, len(turns))
        values[kept[self._behind]] = behind.reshape(-1, len(turns))
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


def _folded(rows: np.ndarray, phase: complex, onward: np.ndarray) -> np.ndarray:
    """P^H rows: of rows on both cut planes those of the first, P = (1; Q exp(i theta)), Q ``onward`` (3, 3)."""
    half = len(rows) // 2
    second = np.conj(phase) * (onward.T @ rows[half:].reshape(-1, 3, rows.shape[1])).reshape(half, -1)
    return np.asarray(rows[:half] + second)
