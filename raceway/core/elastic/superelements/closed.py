"""A ring of equal sectors: its cut planes are closed harmonic by harmonic.

With l_c the displacements on the first cut plane of sector c, in the frame of that sector, its second cut plane has Q l_(c+1): Q turns by one
sector.  A discrete Fourier transform over the sectors makes this Q exp(i theta_h) l_h, and the harmonics h are independent.

Reference
---------
Thomas, D. L.: Dynamics of rotationally periodic structures, International Journal for Numerical Methods in Engineering 14 (1979) 81.
"""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.superelements.loose import turned_vectors
from raceway.core.elastic.superelements.part import Part


class Closed:
    """Sectors that make up a ring, seen from the nodes of its contacts.

    Parameters
    ----------
    part : Part, a sector

    Attributes
    ----------
    blocks : (copies, 3 k, 3 k) displacements of sector c, in its frame, under forces on the first sector [m/N]
    """

    def __init__(self, part: Part) -> None:
        from scipy.linalg import cho_factor, cho_solve

        self.part = part
        copies, kept = part.copies, part.fronts.kept
        free = np.isin(3 * copies.before, kept)
        before, behind = copies.before[free], copies.behind[free]
        self._before, self._behind, self._order = (part.places(nodes) for nodes in (before, behind, part.contact))
        self._next = copies.turns[1]
        schur, count = part.fronts.schur, len(copies.turns)
        cut = np.concatenate([self._before, self._behind])
        planes, across = schur[np.ix_(cut, cut)], schur[np.ix_(cut, self._order)]
        contacts = schur[np.ix_(self._order, self._order)]
        self._factors, self._across = [], []
        harmonics = np.empty((count // 2 + 1, part.size, part.size), dtype=complex)
        for h in range(count // 2 + 1):
            phase = np.exp(2j * np.pi * h / count)
            half = self._folded(planes, phase)
            matrix = self._folded(half.conj().T, phase).conj().T
            mixed = self._folded(across, phase)
            factor = cho_factor(0.5 * (matrix + matrix.conj().T), lower=True)
            self._factors.append(factor)
            self._across.append(mixed)
            harmonics[h] = np.linalg.inv(contacts - mixed.conj().T @ cho_solve(factor, mixed))
        self.blocks = np.ascontiguousarray(np.fft.irfft(harmonics, count, axis=0))

    @property
    def nodes(self) -> np.ndarray:
        """(copies, k) numbers of the contacts' nodes."""
        return self.part.nodes

    def respond(self, loads: np.ndarray) -> np.ndarray:
        """Displacements (copies, 3 k) of the contacts' nodes under forces (copies, 3 k) there."""
        turns = self.part.copies.turns
        local = turned_vectors(loads, turns.transpose(0, 2, 1))
        out = np.zeros_like(local)
        for away, block in enumerate(self.blocks):
            out += np.roll(local @ block.T, away, axis=0)
        return turned_vectors(out, turns)

    def among(self, nodes: np.ndarray) -> np.ndarray:
        """(3 m, 3 m) flexibility of some of the contacts' nodes (m,), numbered through all sectors [m/N]."""
        turns, count, k = self.part.copies.turns, len(self.blocks), self.part.size // 3
        found = [np.flatnonzero(nodes // k == sector) for sector in range(count)]
        rows = [(3 * (nodes[one] % k)[:, None] + np.arange(3)).ravel() for one in found]
        out = np.empty((len(nodes), 3, len(nodes), 3))
        for i in range(count):
            for j in range(count):
                block = self.blocks[(i - j) % count][np.ix_(rows[i], rows[j])].reshape(len(found[i]), 3, len(found[j]), 3)
                turned = np.einsum("ab,ibjc,dc->iajd", turns[i], block, turns[j], optimize=True)
                out[np.ix_(found[i], np.arange(3), found[j], np.arange(3))] = turned
        return out.reshape(3 * len(nodes), 3 * len(nodes))

    def forward(self, force: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
        """What nodal forces (3 nodes,) are on the contacts' nodes (copies, 3 k), and what ``backward`` needs."""
        from scipy.linalg import cho_solve

        values = self.part.gathered(force)
        self.part.fronts.forward(values)
        kept = values[self.part.fronts.kept].astype(float)
        rows = np.concatenate([self._before, self._behind])
        left = np.fft.rfft(kept[rows], axis=1)
        contact = np.fft.rfft(kept[self._order], axis=1)
        count = kept.shape[1]
        solved = np.empty((len(self._before), left.shape[1]), dtype=complex)
        for h, factor in enumerate(self._factors):
            folded = self._folded(left[:, h : h + 1], np.exp(2j * np.pi * h / count))
            solved[:, h] = cho_solve(factor, folded)[:, 0]
            contact[:, h] -= self._across[h].conj().T @ solved[:, h]
        return turned_vectors(np.fft.irfft(contact, count, axis=1).T, self.part.copies.turns), (values, solved)

    def backward(self, carried: tuple[np.ndarray, np.ndarray], moved: np.ndarray, out: np.ndarray) -> None:
        """Displacements of all nodes, into ``out`` (3 nodes,), of those of the contacts (copies, 3 k)."""
        from scipy.linalg import cho_solve

        values, solved = carried
        turns, kept = self.part.copies.turns, self.part.fronts.kept
        contact = turned_vectors(moved, turns.transpose(0, 2, 1)).T
        images = np.fft.rfft(contact, axis=1)
        plane = np.empty_like(solved)
        for h, factor in enumerate(self._factors):
            plane[:, h] = solved[:, h] - cho_solve(factor, self._across[h] @ images[:, h])
        before = np.fft.irfft(plane, len(turns), axis=1)
        values[kept[self._order]] = contact
        values[kept[self._before]] = before
        behind = self._next @ np.roll(before, -1, axis=1).reshape(-1, 3, len(turns))
        values[kept[self._behind]] = behind.reshape(-1, len(turns))
        self.part.fronts.backward(values)
        self.part.spread(values, out)

    def _folded(self, rows: np.ndarray, phase: complex) -> np.ndarray:
        """P^H rows: of rows on both cut planes those of the first, P = (1; Q exp(i theta))."""
        half = len(self._before)
        second = np.conj(phase) * (self._next.T @ rows[half:].reshape(-1, 3, rows.shape[1])).reshape(half, -1)
        return np.asarray(rows[:half] + second)
