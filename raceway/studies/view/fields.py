"""Displacement and stress fields of elastic bodies: fields.vtu for ParaView, stress.png of a section through the most loaded ball."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.core.hexahedron.recovery import centre_stress
from raceway.storage.files import write_whole
from raceway.studies.view.mesh_picture import _png
from raceway.studies.view.scene import new_plotter, pyvista_of, quietly

if TYPE_CHECKING:
    from types import ModuleType

    from raceway.bodies.elastic.report import ElasticBodies
    from raceway.pipeline.result import Result

_SIZE = (1600, 1200)
_HEXAHEDRON = 12  # VTK's number of the cell


@attrs.frozen(eq=False)
class Fields:
    """Fields of all bodies in one mesh, at the static equilibrium.

    Attributes
    ----------
    points : (n, 3) float, undeformed nodes [m];  cells : (m, 8) int
    body : (m,) int, 0 the inner ring, 1 the outer ring, 2 + k ball k
    displacement : (n, 3) float [m], rigid motions of rings and balls included
    stress : (m, 6) float, at the elements' centres [Pa]: xx yy zz xy yz zx
    """

    points: np.ndarray
    cells: np.ndarray
    body: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray

    @classmethod
    def of(cls, result: Result) -> Fields:
        """Of a result with elastic bodies."""
        # ``traits.every_node``, by which the caller chooses, is true of these bodies alone.
        bodies: ElasticBodies = result.model.bearing  # type: ignore[assignment]
        ring: Any = result.model.system
        assembly = bodies.bearing.system.assembly
        moved = assembly.nodal(ring.equilibrium).reshape(-1, 3)
        parts = list(zip(assembly.bodies, assembly.starts[:-1], assembly.starts[1:], strict=True))
        operators = [body.operator for body in assembly.bodies]
        return cls(
            points=assembly.points,
            cells=np.concatenate([body.operator.cells.astype(np.int64) + begin for body, begin, _ in parts]),
            body=np.repeat(np.arange(len(operators)), [len(one.cells) for one in operators]),
            displacement=moved,
            stress=np.concatenate(
                [
                    centre_stress(one.points, one.cells, moved[begin:end], one.moduli, one.formulation)
                    for one, (_, begin, end) in zip(operators, parts, strict=True)
                ]
            ),
        )

    @property
    def von_mises(self) -> np.ndarray:
        """(m,) equivalent stress [Pa]."""
        xx, yy, zz, xy, yz, zx = self.stress.T
        normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        return np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2))

    @property
    def largest_shear(self) -> np.ndarray:
        """(m,) half the difference of the outer principal stresses [Pa]."""
        xx, yy, zz, xy, yz, zx = self.stress.T
        matrix = np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=1).reshape(-1, 3, 3)
        principal = np.linalg.eigvalsh(matrix)
        return np.asarray(0.5 * (principal[:, 2] - principal[:, 0]))


def write_fields(result: Result, folder: Path) -> list[Path]:
    """Write fields.vtu and stress.png.

    Raises
    ------
    RacewayError
        pyvista or its system libraries are missing, or the folder cannot be written.
    """
    pyvista = pyvista_of("")
    fields = Fields.of(result)
    grid = _grid(pyvista, fields)
    balls = result.equilibrium.contact_force[: result.model.system.ball_count]
    most = int(np.argmax(balls))
    title = f"{result.title}\nvon Mises stress at the elements' centres, section through ball {most}, {balls[most]:.4g} N, x to the right"
    image = quietly(pyvista, _section, pyvista, grid, float(result.model.azimuth[most]), title)
    return [write_whole(_vtu(grid), folder / "fields.vtu"), write_whole(_png(image), folder / "stress.png")]


def _grid(pyvista: ModuleType, fields: Fields) -> Any:
    """pyvista's grid with the fields in SI units, units in their names."""
    grid = pyvista.UnstructuredGrid({_HEXAHEDRON: fields.cells}, fields.points)
    grid.point_data["displacement [m]"] = fields.displacement
    grid.cell_data["body"] = fields.body
    grid.cell_data["stress xx yy zz xy yz zx [Pa]"] = fields.stress
    grid.cell_data["von Mises stress [Pa]"] = fields.von_mises
    grid.cell_data["largest shear stress [Pa]"] = fields.largest_shear
    return grid


def _vtu(grid: Any) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        grid.save(path)
        return path.read_bytes()


def _section(pyvista: ModuleType, grid: Any, azimuth: float, title: str) -> np.ndarray:
    """(rows, columns, 3) bytes: the plane of the axis and a ball, seen along the orbit."""
    across = np.array([0.0, -np.sin(azimuth), np.cos(azimuth)])
    outward = np.array([0.0, np.cos(azimuth), np.sin(azimuth)])
    half = grid.extract_cells(np.flatnonzero(grid.cell_centers().points @ outward > 0.0))
    section = half.slice(normal=across, origin=(0.0, 0.0, 0.0))
    section.cell_data["stress"] = 1e-6 * section.cell_data["von Mises stress [Pa]"]
    plotter = new_plotter(pyvista, _SIZE)
    bar = {
        "title": "MPa", "color": "#20262c", "title_font_size": 28, "label_font_size": 26, "fmt": "%.0f", "vertical": True,
        "position_x": 0.9, "position_y": 0.15, "height": 0.7, "width": 0.06,
    }  # fmt: skip
    plotter.add_mesh(
        section, scalars="stress", cmap="inferno", show_edges=True, edge_opacity=0.25, line_width=0.5, lighting=False,
        scalar_bar_args=bar,
    )  # fmt: skip
    plotter.add_text(title, position="upper_left", font_size=13, color="#20262c")
    centre = np.asarray(section.center)
    plotter.camera_position = [tuple(centre + across), tuple(centre), tuple(outward)]
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    plotter.camera.zoom(1.1)
    image = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return image
