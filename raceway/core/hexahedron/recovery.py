"""Stresses of a displacement, and what they come to, by numpy over batches of elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from raceway.core.hexahedron.mass import batches
from raceway.core.hexahedron.shape import Floats, centre_gradients, mean_gradients


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


def von_mises(stress: Floats) -> Floats:
    """(m,) Equivalent stress [Pa] of stresses (m, 6), xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2)))


def largest_shear(stress: Floats) -> Floats:
    """(m,) Half the difference of the outer principal stresses [Pa] of stresses (m, 6)."""
    out = np.empty(len(stress))
    for part in batches(len(stress)):
        xx, yy, zz, xy, yz, zx = stress[part].T
        matrix = np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=1).reshape(-1, 3, 3)
        principal = np.linalg.eigvalsh(matrix)
        out[part] = 0.5 * (principal[:, 2] - principal[:, 0])
    return out
