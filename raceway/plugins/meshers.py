"""Structured hexahedra of a whole bearing: rings with the true groove, balls as cubed spheres, graded to the contacts."""

from math import ceil, inf, pi
from typing import ClassVar

import attrs
import numpy as np

from raceway.core.contact.geometry import BallBearing
from raceway.core.contact.hertz import contact_modulus
from raceway.core.fem.mesh.hex_mesh import HexMesh, azimuth, ball_names, graded, growing, placed
from raceway.core.fem.mesh.part_meshes import CUBE, RingShape, ball_cells, ball_mesh, ring_mesh, ring_shape
from raceway.core.fem.mesh.quality import Prediction, refuse_coarse, refuse_memory
from raceway.errors import MeshError
from raceway.framework.options import between, option, positive, word_or
from raceway.scene.bearing import Bearing

#: Load of a ball [N] whose ellipse the patches follow where neither the scene nor the option says it.
BALL_LOAD = 300.0


@attrs.frozen
class Structured:
    """Structured hexahedra: rings swept from their profile, balls as cubed spheres, both graded to the contacts."""

    name: ClassVar[str] = "structured"
    swept: ClassVar[bool] = True

    element_size: float = option(0.5e-3, unit="m", help="longest edge of a cell", rule=positive())
    nodes_per_semi_axis: int = option(
        4,
        help="cells along each semi-axis of a ball's contact ellipse, and the major one of a race's; 0: no refinement, for elastic bodies with resultants",
        rule=between(0, 64),
    )
    growth: float = option(1.3, help="ratio of neighbouring cells between patch and bulk", rule=between(1.02, 3.0))
    patch: float = option(1.25, help="refined zone, in semi-axes of the contact ellipse", rule=between(0.5, 5.0))
    azimuth_cells: int | str = option(
        "auto",
        help="cells around each ring, a multiple of the balls; 'auto': from element_size; 'graded': fine at each ball along its minor semi-axis, and in depth",
        rule=word_or(between(3, 1_000_000), "auto", "graded"),
    )
    ball_load: float | None = option(
        None, unit="N", help="ball load of the refined ellipses; default: the scene's, else 300", rule=positive()
    )

    def mesh(self, bearing: Bearing) -> dict[str, HexMesh]:
        """inner_ring, outer_ring and every ball of each row, in the bearing's coordinates.

        MeshError: Dimensions that are missing or do not fit, elements larger than the wall or too many for the memory.
        """
        self.predict(bearing)  # refuses what cannot work
        bodies: dict[str, HexMesh] = {}
        u, v, w, layers, patch = self._ball_lines(bearing)
        ball = ball_mesh(0.5 * bearing.ball_diameter, u, v, w, layers, patch)
        for suffix, (side, offset) in zip(self._suffixes(bearing), bearing.rows, strict=True):
            for inner, word in ((True, "inner_ring"), (False, "outer_ring")):
                bodies[word + suffix] = self._ring(bearing, inner, side, offset)
            for index, word in enumerate(ball_names(bearing)):
                points = placed(ball.points, bearing, azimuth(bearing, index), side, offset)
                bodies[word + suffix] = attrs.evolve(ball, points=points)
        return bodies

    def predict(self, bearing: Bearing) -> Prediction:
        """Number of cells of each body and bytes, exactly as ``mesh`` would make them; nothing is meshed.

        MeshError: As ``mesh``.
        """
        if not bearing.equal_rows:
            raise MeshError("bearing.row holds rows of different bearings: mesh each by itself, as a scene of one row")
        volume = pi / 6.0 * bearing.ball_diameter**3 * bearing.ball_count
        for inner, word in ((True, "inner"), (False, "outer")):
            shape = ring_shape(bearing, inner)
            refuse_coarse(self.element_size, shape.wall, f"wall of the {word} ring under its groove")
            volume += shape.volume
        refuse_coarse(self.element_size, 0.5 * bearing.ball_diameter, "radius of a ball")
        # From the volume first: with tiny elements even the lines of the mesh would not fit.
        lowest = Prediction.of({"all": volume * len(bearing.rows) / self.element_size**3})
        refuse_memory(lowest, "mesh.element_size", self.element_size, "take larger elements")
        bodies: dict[str, float] = {}
        u, v, w, layers, _ = self._ball_lines(bearing)
        ball = ball_cells(len(u) - 1, len(v) - 1, len(w) - 1, len(layers) - 1)
        for suffix in self._suffixes(bearing):
            for inner, word in ((True, "inner_ring"), (False, "outer_ring")):
                shape = ring_shape(bearing, inner)
                *lines, depth, _ = self._ring_lines(bearing, shape)
                profile = sum(len(line) - 1 for line in lines) * (len(depth) - 1)
                bodies[word + suffix] = profile * len(self._azimuths(bearing, shape))
            bodies.update({name + suffix: ball for name in ball_names(bearing)})
        prediction = Prediction.of(bodies)
        remedy = "take larger elements, fewer nodes_per_semi_axis or azimuth_cells, or a larger growth"
        refuse_memory(prediction, "mesh.element_size", self.element_size, remedy)
        return prediction

    def _suffixes(self, bearing: Bearing) -> list[str]:
        count = len(bearing.rows)
        return [f"_row{row + 1}" if count > 1 else "" for row in range(count)]

    def _semi_axes(self, bearing: Bearing, inner: bool) -> tuple[float, float]:
        """Semi-axes [m] of a contact ellipse, along the groove and along the rolling direction."""
        rings, balls = bearing.rings, bearing.balls
        modulus = contact_modulus(rings.young, rings.poisson, balls.young, balls.poisson)
        major, minor = BallBearing.of(bearing).ellipses(modulus)[0 if inner else 1].semi_axes(self.ball_load or BALL_LOAD)
        return float(major), float(minor)

    def _ball_lines(self, bearing: Bearing) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, tuple[float, float]]:
        """Lines of the cube along u, v, w, layers, and the semi-axes of the patch along u, v."""
        # Both contacts of a ball share the cube's lines: the larger ellipse sets the zone, the smaller one the size.
        pairs = [self._semi_axes(bearing, inner) for inner in (True, False)]
        radius, size = 0.5 * bearing.ball_diameter, self.element_size
        arc = 0.25 * pi * radius
        lines = []
        for axis in (1, 0):
            zone, fine = self.patch * max(p[axis] for p in pairs), self._fine(min(p[axis] for p in pairs))
            zone = min(zone, 0.8 * arc) if self.nodes_per_semi_axis else arc
            lines.append(graded(-1.0, 1.0, -zone / arc, zone / arc, fine / arc, size / arc, self.growth))
        half = growing(1.0, size / arc, size / arc, self.growth)
        w = np.concatenate([-half[:0:-1], half])
        length = (1.0 - CUBE) * radius
        fine = self._fine(min(p[1] for p in pairs))
        layers = 1.0 - growing(1.0, fine / length, size / length, self.growth)[::-1]
        across, along = (max(self.patch * max(p[axis] for p in pairs), min(fine, size)) for axis in (1, 0))
        return lines[0], lines[1], w, layers, (across, along)

    def _fine(self, semi_axis: float) -> float:
        """Length of cells along a semi-axis [m]; infinite where nothing is refined."""
        return semi_axis / self.nodes_per_semi_axis if self.nodes_per_semi_axis else inf

    def _ring_lines(
        self, bearing: Bearing, shape: RingShape
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, tuple[float, float]]:
        """Points of the left land, the groove, the right land, the layers, and the refined band's angles."""
        major, minor = self._semi_axes(bearing, shape.inner)
        size, (low, high) = self.element_size, shape.edges
        half = self.patch * major / shape.groove
        band = max(shape.contact - half, 0.98 * low), min(shape.contact + half, 0.98 * high)
        if not self.nodes_per_semi_axis:
            band = low, high
        fine = self._fine(major)
        arc = graded(low, high, *band, fine / shape.groove, size / shape.groove, self.growth)
        lower, right = (shape.outline.shares(side, size) for side in ("left", "right"))
        # As fine in depth as along the groove: a uniform azimuth does not follow the minor semi-axis.
        if self.azimuth_cells == "graded":
            fine = self._fine(minor)
        thickness = shape.thickness
        layers = growing(1.0, min(fine, size) / thickness, size / thickness, self.growth)
        return lower, arc, right, layers, band

    def _azimuths(self, bearing: Bearing, shape: RingShape) -> np.ndarray:
        """(n,) azimuths of the nodes around a ring, less that of the first ball [rad]: each ball meets the same nodes."""
        setting, count = self.azimuth_cells, bearing.ball_count
        pitch = 2.0 * pi / count
        if setting == "graded" and self.nodes_per_semi_axis:
            minor = self._semi_axes(bearing, shape.inner)[1]
            radius = abs(shape.centre_r + shape.sign * shape.groove)
            half = self.patch * minor / radius
            fine, coarse = self._fine(minor) / radius, self.element_size / max(shape.seat, shape.land)
            sector = graded(-0.5 * pitch, 0.5 * pitch, -half, half, fine, coarse, self.growth)[:-1]
        else:
            cells = ceil(2.0 * pi * max(shape.seat, shape.land) / self.element_size) if isinstance(setting, str) else setting
            cells = max(ceil(cells / count), ceil(12 / count))
            sector = pitch * np.arange(cells) / cells
        return np.asarray((sector[None, :] + pitch * np.arange(count)[:, None]).ravel())

    def _ring(self, bearing: Bearing, inner: bool, side: float, offset: float) -> HexMesh:
        shape = ring_shape(bearing, inner)
        left, arc, right, layers, band = self._ring_lines(bearing, shape)
        start = side * azimuth(bearing, 0)
        mesh = ring_mesh(shape, left, arc, right, layers, start + self._azimuths(bearing, shape), band)
        if side < 0.0:  # half a turn about y, not a mirror image: cells keep their sense; psi becomes -psi
            facets = dict(mesh.facet_sets)
            facets["face_negative"], facets["face_positive"] = facets["face_positive"], facets["face_negative"]
            nodes = dict(mesh.node_sets)
            nodes["face_negative"], nodes["face_positive"] = nodes["face_positive"], nodes["face_negative"]
            mesh = attrs.evolve(mesh, points=mesh.points * [-1.0, 1.0, -1.0], node_sets=nodes, facet_sets=facets)
        return mesh if offset == 0.0 else attrs.evolve(mesh, points=mesh.points + np.array([offset, 0.0, 0.0]))
