"""The section of a body of revolution: quadrilaterals in the half plane of radius and axis."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.errors import MeshError


def _floats(value: object) -> np.ndarray:
    return np.ascontiguousarray(value, dtype=np.float64)


def _integers(value: object) -> np.ndarray:
    return np.ascontiguousarray(value, dtype=np.int64)


@attrs.frozen(eq=False)
class Profile:
    """Nodes and quadrilaterals of a section.

    Attributes
    ----------
    points : (N, 2) float, radius r > 0 and place x along the axis [m]
    quads : (M, 4) int, turned on input so that their nodes run from +x to +r
    race : (n,) int, nodes of the loaded surface in the order of ``angles``
    seat : (k,) int, nodes of the bore or the outer cylinder, in their order along x; empty for a ball
    angles : (n,) float [rad], ascending.  Of a ring: contact angles, so that race node i lies at
        r = centre_r + sign groove cos(angle), x = centre_x + sign groove sin(angle), with sign -1 for the inner ring and 1 for
        the outer one, and the bearing's free contact angle is positive.  Of a ball: latitudes, x = R sin, r = R cos
    depth : int, nodes of each line from the surface into the body: node ``race[i] + k``, k < depth, lies k layers below
    """

    points: np.ndarray = attrs.field(converter=_floats)
    quads: np.ndarray = attrs.field(converter=_integers)
    race: np.ndarray = attrs.field(converter=_integers)
    seat: np.ndarray = attrs.field(converter=_integers)
    angles: np.ndarray = attrs.field(converter=_floats)
    depth: int = 1

    def __attrs_post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 2 or self.quads.ndim != 2 or self.quads.shape[1] != 4:
            raise MeshError(f"a profile has points (N, 2) and quads (M, 4), not {self.points.shape} and {self.quads.shape}")
        if not np.isfinite(self.points).all() or self.points[:, 0].min() <= 0.0:
            raise MeshError("a profile's points must be finite and lie off the axis (radius above 0)")
        if len(self.angles) != len(self.race):
            raise MeshError(f"{len(self.race)} race nodes with {len(self.angles)} angles")
        r, x = self.points[self.quads, 0], self.points[self.quads, 1]
        area = (x[:, 2] - x[:, 0]) * (r[:, 3] - r[:, 1]) - (r[:, 2] - r[:, 0]) * (x[:, 3] - x[:, 1])
        turned = self.quads[:, ::-1] if area.sum() < 0.0 else self.quads
        object.__setattr__(self, "quads", np.ascontiguousarray(turned))
        corner = corner_areas(self.points, turned)
        if not (corner > 0.0).all():
            bad = int(np.argmin(corner.min(axis=1)))
            at = self.points[self.quads[bad]].mean(axis=0)
            raise MeshError(
                f"the profile folds over itself at r = {1e3 * at[0]:.4g} mm, x = {1e3 * at[1]:.4g} mm: the wall is too thin or "
                "its outline too jagged for a mesh of quadrilaterals there"
            )


def corner_areas(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """(M, 4) Cross products of the edges that meet at each corner [m2]: positive where the corner is convex."""
    p = points[quads]
    onward, back = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    area = onward[..., 1] * back[..., 0] - onward[..., 0] * back[..., 1]
    # Quadrilaterals that all run the other way are as good: the profile turns them.
    return np.asarray(area if area.sum() > 0.0 else -area)


def dofs(nodes: np.ndarray, components: tuple[int, ...] = (0, 2)) -> np.ndarray:
    """(len(components) n, 2) degrees of freedom (node, component), one component after the other: 0 r, 1 theta, 2 x."""
    nodes = np.asarray(nodes, dtype=np.int64)
    return np.concatenate([np.column_stack([nodes, np.full(len(nodes), c)]) for c in components])


def mapped(top: np.ndarray, bottom: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A block of quadrilaterals between two lines.

    Parameters
    ----------
    top, bottom : (m, 2) float, ends of the lines into the body [m]
    depth : (k,) float from 0 to 1

    Returns
    -------
    points : (m k, 2), line after line, each from top to bottom
    quads : ((m - 1) (k - 1), 4)
    """
    lines, rows = len(top), len(depth)
    points = top[:, None] * (1.0 - depth)[None, :, None] + bottom[:, None] * depth[None, :, None]
    first = (np.arange(lines - 1)[:, None] * rows + np.arange(rows - 1)).ravel()
    return points.reshape(-1, 2), np.stack([first, first + rows, first + rows + 1, first + 1], axis=1)
