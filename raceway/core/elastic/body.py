"""One elastic body: mesh, material and what supports it."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.mesh.hex_mesh import FACES


@attrs.frozen(eq=False)
class Frame:
    """A rigid frame of a few degrees of freedom, and the nodes that move with it.

    Attributes
    ----------
    nodes : (k,) int, of the body that the frame belongs to; tied to it, or on a bed between it and them
    centre : (3,) float, the reference point [m]
    motions : columns of ``rigid`` that are unknowns, 0 to 2 translations [m], 3 to 5 rotations [rad] about x, y, z
    mass, damping, stiffness : (k, k) of the frame itself, for instance of a rotor
    free : (k,) bool, which motions are unknowns; the others keep the value that a state gives them
    """

    nodes: np.ndarray
    centre: np.ndarray
    motions: tuple[int, ...]
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    free: np.ndarray

    @classmethod
    def massless(cls, nodes: np.ndarray, centre: np.ndarray, motions: tuple[int, ...]) -> Frame:
        k = len(motions)
        zero = np.zeros((k, k))
        return cls(np.asarray(nodes), np.asarray(centre, dtype=float), motions, zero, zero, zero, np.ones(k, dtype=bool))

    def basis(self, points: np.ndarray) -> np.ndarray:
        """(3 n, k) displacements of points (n, 3) under unit motions of the frame, linear in the rotations."""
        arm = points - self.centre
        out = np.zeros((len(points), 3, len(self.motions)))
        for column, motion in enumerate(self.motions):
            axis = np.eye(3)[motion % 3]
            out[:, :, column] = axis if motion < 3 else np.cross(axis, arm)
        return out.reshape(-1, len(self.motions))


@attrs.frozen(eq=False)
class Body:
    """One body.

    Attributes
    ----------
    name : str
    operator : HexOperator
    held : (n, 3) bool, displacements that are zero
    frame : Frame | None
    bed : (quads (k, 4) nodes, stiffness [N/m3]) | None: springs on a surface, to the ground or to the frame
    """

    name: str
    operator: HexOperator
    held: np.ndarray
    frame: Frame | None = None
    foundation: tuple[np.ndarray, float] | None = None

    @property
    def points(self) -> np.ndarray:
        return self.operator.points

    def quads(self, facets: np.ndarray) -> np.ndarray:
        """(k, 4) nodes of facets (k, 2)."""
        return np.asarray(self.operator.cells[facets[:, :1], FACES[facets[:, 1]]], dtype=np.int64)
