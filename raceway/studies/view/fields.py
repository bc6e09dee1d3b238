"""Displacement and stress fields of elastic bodies: fields.vtu for ParaView, stress.png of a section through the most loaded ball."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.bodies.elastic.subsurface import below_contacts
from raceway.core.elastic.contacts.stress_profile import cells_near
from raceway.core.hexahedron.recovery import centre_stress, largest_shear, von_mises
from raceway.pipeline.settle import pressures
from raceway.storage.files import write_whole
from raceway.studies.view.mesh_picture import _png
from raceway.studies.view.scene import new_plotter, pyvista_of, quietly

if TYPE_CHECKING:
    from types import ModuleType

    from raceway.bodies.elastic.report import ElasticBodies
    from raceway.core.hexahedron.operator import HexOperator
    from raceway.pipeline.result import Result

_SIZE = (1600, 1200)
_HEXAHEDRON = 12  # VTK's number of the cell
#: Colours end at what so much of the section's area stays below: a contact, a thousandth of it, has ten times the stress.
_SHOWN = 0.95


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
    def of(cls, result: Result, near: Mapping[int, tuple[np.ndarray, float]] | None = None) -> Fields:
        """Of a result with elastic bodies: of all elements, or of those near some places.

        Parameters
        ----------
        near : number of a body -> places (k, 3) [m] and the distance within which an element has a node [m]
        """
        # ``traits.every_node``, by which the caller chooses, is true of these bodies alone.
        bodies: ElasticBodies = result.model.bearing  # type: ignore[assignment]
        ring: Any = result.model.system
        assembly = bodies.bearing.system.assembly
        moved = assembly.nodal(ring.equilibrium).reshape(-1, 3)
        parts, begin = [], 0
        for index, (body, first, last) in enumerate(
            zip(assembly.bodies, assembly.starts[:-1], assembly.starts[1:], strict=True)
        ):
            if near is not None and index not in near:
                continue
            part = _of_body(index, body.operator, moved[first:last], None if near is None else near[index])
            parts.append(attrs.evolve(part, cells=part.cells + begin))
            begin += len(part.points)
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in attrs.fields(cls)))

    @property
    def von_mises(self) -> np.ndarray:
        """(m,) equivalent stress [Pa]."""
        return von_mises(self.stress)

    @property
    def largest_shear(self) -> np.ndarray:
        """(m,) half the difference of the outer principal stresses [Pa]."""
        return largest_shear(self.stress)


def _of_body(index: int, body: HexOperator, u: np.ndarray, near: tuple[np.ndarray, float] | None) -> Fields:
    points, cells = body.points, body.cells
    if near is not None:
        places, reach = near
        cells = cells[np.unique(np.concatenate([cells_near(points, cells, place, reach) for place in places]))]
        used, kept = np.unique(cells, return_inverse=True)
        points, u, cells = points[used], u[used], kept.reshape(-1, 8).astype(np.uint32)
    stress = centre_stress(points, cells, u, body.moduli, body.formulation)
    return Fields(points, cells.astype(np.int64), np.full(len(cells), index), u, stress)


def contacts_left_out(result: Result) -> str:
    """What all elements' stresses lack of the contacts' own, for titles; empty where the mesh resolves the most loaded ones."""
    words = "structure only, without the contacts' own stresses"  # resultants press on footprints far wider than Hertz's
    if not result.model.traits.resultants:
        if all(side.resolved for side in below_contacts(result.model.bearing, result.model, result.equilibrium)):  # type: ignore[arg-type]
            return ""
        words = "the mesh does not resolve the contacts' own stresses"
    peak = pressures(result.model, result.equilibrium.contact_force).max()
    return f"{words} (Hertz's pressure up to {1e-6 * peak:.4g} MPa)"


def write_fields(result: Result, folder: Path) -> list[Path]:
    """Write fields.vtu and stress.png.

    Raises
    ------
    RacewayError
        pyvista or its system libraries are missing, or the folder cannot be written.
    """
    pyvista = pyvista_of("")
    grid = new_grid(pyvista, Fields.of(result))
    balls = result.equilibrium.contact_force[: result.model.system.ball_count]
    most = int(np.argmax(balls))
    title = f"{result.title}\nvon Mises stress at the elements' centres, section through ball {most}, {balls[most]:.4g} N, x to the right"
    title += f"\n{contacts_left_out(result)}".rstrip()
    image = quietly(pyvista, _section_image, pyvista, grid, float(result.model.azimuth[most]), title)
    return [write_whole(vtu(grid), folder / "fields.vtu"), write_whole(_png(image), folder / "stress.png")]


def new_grid(pyvista: ModuleType, fields: Fields) -> Any:
    """pyvista's grid with the fields in SI units, units in their names."""
    grid = pyvista.UnstructuredGrid({_HEXAHEDRON: fields.cells}, fields.points)
    grid.point_data["displacement [m]"] = fields.displacement
    grid.cell_data["body"] = fields.body
    grid.cell_data["stress xx yy zz xy yz zx [Pa]"] = fields.stress
    grid.cell_data["von Mises stress [Pa]"] = fields.von_mises
    grid.cell_data["largest shear stress [Pa]"] = fields.largest_shear
    return grid


def vtu(grid: Any) -> bytes:
    """The content of a file for ParaView."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        grid.save(path)
        return path.read_bytes()


def _below(values: np.ndarray, areas: np.ndarray, share: float) -> float:
    """The value that a share of the whole area stays below."""
    order = np.argsort(values)
    summed = np.cumsum(areas[order])
    return float(values[order][np.searchsorted(summed, share * summed[-1])])


def _section_image(pyvista: ModuleType, grid: Any, azimuth: float, title: str) -> np.ndarray:
    """(rows, columns, 3) bytes: the plane of the axis and a ball, seen along the orbit."""
    across = np.array([0.0, -np.sin(azimuth), np.cos(azimuth)])
    outward = np.array([0.0, np.cos(azimuth), np.sin(azimuth)])
    half = grid.extract_cells(np.flatnonzero(grid.cell_centers().points @ outward > 0.0))
    section = half.slice(normal=across, origin=(0.0, 0.0, 0.0))
    stress = section.cell_data["stress"] = 1e-6 * section.cell_data["von Mises stress [Pa]"]
    top = _below(np.asarray(stress), section.compute_cell_sizes(length=False, volume=False).cell_data["Area"], _SHOWN)
    title += f"\ncolours end at {top:.3g} MPa; the largest of an element here is {stress.max():.4g} MPa"
    plotter = new_plotter(pyvista, _SIZE)
    bar = {
        "title": "MPa", "color": "#20262c", "title_font_size": 28, "label_font_size": 26, "fmt": "%.0f", "vertical": True,
        "position_x": 0.9, "position_y": 0.15, "height": 0.7, "width": 0.06,
    }  # fmt: skip
    plotter.add_mesh(
        section, scalars="stress", cmap="inferno", clim=(0.0, top), show_edges=True, edge_opacity=0.25, line_width=0.5, lighting=False,
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
