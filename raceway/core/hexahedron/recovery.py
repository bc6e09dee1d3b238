"""Stresses and hourglass energy of a displacement, by numpy over batches of elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from raceway.core.hexahedron.mass import batches
from raceway.core.hexahedron.shape import HOURGLASS, Floats, centre_gradients, mean_gradients


def centre_stress(points: Floats, cells: NDArray[np.uint32], u: Floats, moduli: Floats, formulation: str) -> Floats:
    """(m, 6) Stresses at the elements' centres [Pa] of displacements u (n, 3) [m], xx yy zz xy yz zx.

    "one_point" knows its mean gradient only, "mean_dilatation" takes the volume change from it; incompatible modes
    have no gradient at the centre.
    """
    out = np.empty((len(cells), 6))
    lame, shear = moduli[0], moduli[1]
    for part in batches(len(cells)):
        corners, moved = points[cells[part]], u[cells[part]]
        mean, _ = mean_gradients(corners)
        at = mean if formulation == "one_point" else centre_gradients(corners)
        gradient = np.einsum("kni,knj->kij", moved, at)
        trace = np.trace(gradient, axis1=1, axis2=2)
        change = np.einsum("kni,kni->k", moved, mean) if formulation == "mean_dilatation" else trace
        for k in range(3):
            out[part, k] = (lame + 2.0 * shear / 3.0) * change + 2.0 * shear * (gradient[:, k, k] - trace / 3.0)
            after = (k + 1) % 3
            out[part, 3 + k] = shear * (gradient[:, k, after] + gradient[:, after, k])
    return out


class HourglassEnergy:
    """Energy of the hourglass control of the one-point element; see ``raceway.core.hexahedron.one_point``.

    Parameters
    ----------
    points : (n, 3) [m];  cells : (m, 8);  moduli : (3,), the last one the hourglass modulus [Pa]

    Notes
    -----
    sum_k s_k |u^T gamma_k|^2 / 2; vectors and stiffnesses are kept, 264 bytes an element, for records ask at every step.
    """

    def __init__(self, points: Floats, cells: NDArray[np.uint32], moduli: Floats) -> None:
        self._cells = cells
        self._vectors, self._stiffness = np.empty((len(cells), 8, HOURGLASS.shape[1])), np.empty(len(cells))
        for part in batches(len(cells)):
            corners = points[cells[part]]
            mean, volume = mean_gradients(corners)
            self._vectors[part] = HOURGLASS - mean @ np.einsum("kni,na->kia", corners, HOURGLASS)
            self._stiffness[part] = moduli[2] * volume * np.einsum("kni,kni->k", mean, mean) / 8.0

    def of(self, u: Floats) -> float:
        """Energy [J] of displacements u (n, 3) [m]."""
        total = 0.0
        for part in batches(len(self._cells)):
            held = self._vectors[part].transpose(0, 2, 1) @ u[self._cells[part]]
            total += 0.5 * float(np.vdot(self._stiffness[part], np.square(held).sum(axis=(1, 2))))
        return total
