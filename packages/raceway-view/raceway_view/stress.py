"""Displacement and stress fields of elastic bodies: fields.vtu for ParaView, stress.png of a section through the most loaded ball."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.extend import (
    BelowContact, ElasticBodies, ElasticPoints, axis_shear, axis_stresses, below_contacts, cells_near, centre_stress,
    figure_png, largest_shear, new_figure, pressures, von_mises,
)  # fmt: skip
from raceway_view.pictures import INK, Grid, Plotter, look_from, pyvista_of, quietly, rendered
from raceway import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEXAHEDRON = 12  # VTK's number of the cell
#: Names of the fields of both scalar stresses in grids.
_STRESSES = ("von Mises stress [Pa]", "largest shear stress [Pa]")
#: Colours end at what so much of the section's area stays below: a contact, a thousandth of it, has ten times the stress.
_SHOWN = 0.95


@attrs.frozen(eq=False)
class StressFields:
    """Fields of all bodies in one mesh, at the static equilibrium."""

    points: np.ndarray  # (n, 3) float, undeformed nodes [m]
    cells: np.ndarray  # (m, 8) int
    body: np.ndarray  # (m,) int, 0 the inner ring, 1 the outer ring, 2 + k ball k
    displacement: np.ndarray  # (n, 3) float [m], rigid motions of rings and balls included
    stress: np.ndarray  # (m, 6) float, at the elements' centres [Pa]: xx yy zz xy yz zx

    @classmethod
    def of(cls, result: Result, near: Mapping[int, tuple[np.ndarray, float]] | None = None) -> StressFields:
        """Of a result with elastic bodies: of all elements, or of those near some places.

        near : number of a body -> places (k, 3) [m] and the distance within which an element has a node [m]
        """
        # ``traits.every_node``, by which the caller chooses, is true of these bodies alone.
        bodies: ElasticBodies = result.model.bearing  # type: ignore[assignment]
        ring: Any = result.model.system
        assembly = bodies.bearing.system.assembly
        displacement = assembly.nodal(ring.equilibrium).reshape(-1, 3)
        parts, begin = [], 0
        spans = zip(assembly.bodies, assembly.starts[:-1], assembly.starts[1:], strict=True)
        for index, (body, first, last) in enumerate(spans):
            if near is not None and index not in near:
                continue
            u = displacement[first:last]
            points, cells = body.operator.points, body.operator.cells
            if near is not None:
                places, reach = near[index]
                cells = cells[np.unique(np.concatenate([cells_near(points, cells, centre, reach) for centre in places]))]
                node_numbers, numbers = np.unique(cells, return_inverse=True)
                points, u, cells = points[node_numbers], u[node_numbers], numbers.reshape(-1, 8).astype(np.uint32)
            stress = centre_stress(points, cells, u, body.operator.moduli, body.operator.formulation)
            parts.append(StressFields(points, cells.astype(np.int64) + begin, np.full(len(cells), index), u, stress))
            begin += len(points)
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in attrs.fields(cls)))

    @property
    def von_mises(self) -> np.ndarray:
        """(m,) equivalent stress [Pa]."""
        return von_mises(self.stress)

    @property
    def largest_shear(self) -> np.ndarray:
        """(m,) half the difference of the outer principal stresses [Pa]."""
        return largest_shear(self.stress)


def contacts_left_out(result: Result) -> str:
    """What all elements' stresses lack of the contacts' own, for titles; empty where the mesh resolves the most loaded ones."""
    words = "structure only, without contact stresses"  # resultants press on footprints far wider than Hertz's
    if not result.model.traits.resultants:
        if all(side.resolved for side in below_contacts(result.model.bearing, result.model, result.equilibrium)):  # type: ignore[arg-type]
            return ""
        words = "the mesh does not resolve contact stresses"
    peak = pressures(result.model, result.equilibrium.contact_force).max()
    return f"{words} (Hertz's pressure up to {1e-6 * peak:.4g} MPa)"


def field_files(result: Result) -> dict[str, bytes]:
    """fields.vtu and stress.png; RacewayError without pyvista or its system libraries."""
    grid = _new_grid(pyvista_of(), StressFields.of(result))
    balls = result.equilibrium.contact_force[: result.model.system.ball_count]
    most = int(np.argmax(balls))
    title = f"{result.title}\nvon Mises stress at the elements' centres, section through ball {most}, {balls[most]:.4g} N, x to the right"
    title += f"\n{contacts_left_out(result)}".rstrip()
    # PNG of the plane of the axis and a ball, seen along the orbit
    azimuth = float(result.model.azimuth[most])
    across = np.array([0.0, -np.sin(azimuth), np.cos(azimuth)])
    outward = np.array([0.0, np.cos(azimuth), np.sin(azimuth)])

    def draw(_pyvista: ModuleType, plotter: Plotter) -> None:
        half = grid.extract_cells(np.flatnonzero(grid.cell_centers().points @ outward > 0.0))
        section = half.slice(normal=across, origin=(0.0, 0.0, 0.0))
        stress = section.cell_data["stress"] = 1e-6 * section.cell_data[_STRESSES[0]]
        # The value that a share of the whole area stays below.
        values = np.asarray(stress)
        areas = section.compute_cell_sizes(length=False, volume=False).cell_data["Area"]
        order = np.argsort(values)
        area_below = np.cumsum(areas[order])
        top = float(values[order][np.searchsorted(area_below, _SHOWN * area_below[-1])])
        bar = {
            "title": "MPa", "color": INK, "title_font_size": 28, "label_font_size": 26, "fmt": "%.0f", "vertical": True,
            "position_x": 0.9, "position_y": 0.15, "height": 0.7, "width": 0.06,
        }  # fmt: skip
        plotter.add_mesh(
            section, scalars="stress", cmap="inferno", clim=(0.0, top), show_edges=True, edge_opacity=0.25, line_width=0.5, lighting=False,
            scalar_bar_args=bar,
        )  # fmt: skip
        words = f"{title}\ncolours end at {top:.3g} MPa; the largest of an element here is {stress.max():.4g} MPa"
        plotter.add_text(words, position="upper_left", font_size=13, color=INK)
        centre = np.asarray(section.center)
        plotter.enable_parallel_projection()
        look_from(plotter, [tuple(centre + across), tuple(centre), tuple(outward)], 1.1)

    return {"fields.vtu": _vtu(grid), "stress.png": rendered(draw)}


def _new_grid(pyvista: ModuleType, fields: StressFields) -> Grid:
    """pyvista's grid with the fields in SI units, units in their names."""
    grid = pyvista.UnstructuredGrid({_HEXAHEDRON: fields.cells}, fields.points)
    grid.point_data["displacement [m]"] = fields.displacement
    grid.cell_data["body"] = fields.body
    grid.cell_data["stress xx yy zz xy yz zx [Pa]"] = fields.stress
    for name, stress in zip(_STRESSES, (fields.von_mises, fields.largest_shear), strict=True):
        grid.cell_data[name] = stress
    return grid


def _vtu(grid: Grid) -> bytes:
    """The content of a file for ParaView."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        grid.save(path)
        return path.read_bytes()


#: Half the picture's width and height in minor semi-axes; elements within so many major semi-axes of a contact are kept.
_WIDE, _NEAR = 3.0, 1.5
#: The section's distance from the contact's centre in major semi-axes: no plane of nodes, where two elements meet.
_BESIDE = 0.01
_UM, _MPA, _MARK = 1e6, 1e-6, "#00a0c8"


def contact_stress_files(result: Result) -> dict[str, bytes]:
    """contact.vtu and stress_contact.png where contacts at points are loaded; RacewayError without pyvista, matplotlib."""
    bodies: ElasticPoints = result.model.bearing  # type: ignore[assignment]
    sides = below_contacts(bodies, result.model, result.equilibrium)
    if not sides:
        return {}
    figure, grid = _drawn(result, sides)
    return {"contact.vtu": _vtu(grid), "stress_contact.png": figure_png(figure, 110)}


def _drawn(result: Result, sides: list[BelowContact]) -> tuple[Figure, Grid]:
    """The figure of the contacts of ``below_contacts``, and pyvista's grid of the elements near them."""
    pyvista = pyvista_of()
    near: dict[int, tuple[np.ndarray, float]] = {}
    for side in sides:
        places = np.concatenate([near[side.index][0] if side.index in near else np.empty((0, 3)), side.axis.pole[None]])
        near[side.index] = places, _NEAR * max(contact.semi_axes[0] for contact in sides)
    grid = _new_grid(pyvista, StressFields.of(result, near))
    races = [[side for side in sides if side.race == race] for race in dict.fromkeys(side.race for side in sides)]
    figure = new_figure(10.4, 4.4 * len(races))
    panels = figure.subplots(len(races), 3, squeeze=False, width_ratios=(1.0, 1.0, 0.75))
    cuts = quietly(pyvista, lambda: [_contact_section(grid, pair) for pair in races])
    for column, name in enumerate(("von Mises stress", "largest shear stress")):
        top = max(float(values[column].max(initial=0.0)) for _, values in cuts)
        for row, (pair, (polygons, values)) in enumerate(zip(races, cuts, strict=True)):
            _draw_section(panels[row, column], pair, polygons, values[column], top, name)
    for row, pair in enumerate(races):
        # Stresses on the contact's normal beside Hertz's at the same load
        axes = panels[row, 2]
        for side, sign in zip(pair, (1.0, -1.0), strict=False):
            profile, in_ball = side.profile, sign > 0.0
            depth = profile.depth
            exact = axis_stresses(depth, side.semi_axes, side.peak_pressure, side.poisson)
            full = np.concatenate([exact, np.zeros_like(exact)], axis=1)
            shear = axis_shear(depth, side.semi_axes, side.peak_pressure, side.poisson)
            # Above the first element's centre the fit extrapolates.
            inside = depth >= (0.5 * profile.lengths[0, 2] if side.resolved else 0.0)
            if side.resolved:
                stresses = np.stack([profile.von_mises, profile.shear])
            else:  # of the elements at the depths of the profile, nan outside of all
                places = side.axis.at_depth(depth) + _BESIDE * np.asarray(side.semi_axes) @ side.axis.axes[:2]
                body = grid.extract_cells(grid.cell_data["body"] == side.index)
                cell = np.atleast_1d(body.find_containing_cell(places))
                stresses = np.stack([np.where(cell < 0, np.nan, body.cell_data[name][cell]) for name in _STRESSES])
            for values, hertz, colour, word in (
                (stresses[0], von_mises(full), "#b5651d", "von Mises"),
                (stresses[1], shear, "#0b5fa5", "largest shear"),
            ):
                mesh, theory = (f"{word}, mesh", f"{word}, Hertz") if in_ball else (None, None)
                axes.plot(_MPA * values[inside], sign * _UM * depth[inside], color=colour, linewidth=1.6, label=mesh)
                axes.plot(_MPA * hertz, sign * _UM * depth, color=colour, linewidth=1.0, linestyle="--", label=theory)
            words = f"Hertz {_MPA * side.hertz[0]:.4g} MPa at {_UM * side.hertz[1]:.3g} µm"
            if side.resolved:
                size, at = profile.largest()
                words = f"{side.body}: {_MPA * size:.4g} MPa at {_UM * at:.3g} µm\n{words}"
            else:
                words = f"{side.body}: not resolved by this mesh;\nsteps are its elements\n{words}"
            height, up = (0.98, "top") if in_ball else (0.02, "bottom")
            axes.text(0.97, height, words, transform=axes.transAxes, ha="right", va=up, fontsize=8)
        axes.axhline(0.0, color=INK, linewidth=0.8)
        wide = _UM * _WIDE * pair[0].semi_axes[1]
        axes.set_ylim(-wide, wide)
        axes.set_xlim(0.0, 1.9 * axes.get_xlim()[1])  # room for words
        axes.set_xlabel("MPa")
        _depth_axis(axes)
        axes.set_title("on the contact's normal", fontsize=11)
        axes.legend(fontsize=8, loc="center right")
    subtitle = "plane of the rolling direction and the contact's normal; ball above, ring below"
    if any(side.resolved for side in sides):
        subtitle += "; + largest shear stress on the normal"
    figure.suptitle(f"{result.title}\n{subtitle}", fontsize=12)
    return figure, grid


def _contact_section(grid: Grid, pair: list[BelowContact]) -> tuple[list[np.ndarray], np.ndarray]:
    """Polygons (k, 2) of the deformed elements, along the rolling direction and into the ball [m], and two stresses (2, n) [Pa]."""
    ball = pair[0]
    bodies = grid.extract_cells(np.isin(grid.cell_data["body"], [side.index for side in pair]))
    displacement = bodies.point_data["displacement [m]"]
    # The contact's centre as the ball's nearest node has moved.
    nearest = int(np.linalg.norm(bodies.points - ball.axis.pole, axis=1).argmin())
    pole = ball.axis.pole + displacement[nearest]
    bodies.points = bodies.points + displacement
    beside = pole + _BESIDE * ball.semi_axes[0] * ball.axis.axes[0]
    cut = bodies.slice(normal=ball.axis.axes[0], origin=beside)
    plane = ((cut.points - pole) @ ball.axis.axes.T)[:, 1:]
    polygons, visible, at = [], np.zeros(cut.n_cells, dtype=bool), 0
    for cell in range(cut.n_cells):
        count = int(cut.faces[at])
        corners = _clip(plane[cut.faces[at + 1 : at + 1 + count]], _WIDE * ball.semi_axes[1])
        at += 1 + count
        visible[cell] = len(corners) > 0
        if visible[cell]:
            polygons.append(corners)
    return polygons, np.stack([np.asarray(cut.cell_data[name])[visible] for name in _STRESSES])


def _clip(corners: np.ndarray, half: float) -> np.ndarray:
    """(k, 2) what of a convex polygon lies in the square of half width ``half``: cut by its four sides in turn (Sutherland, Hodgman)."""
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            inside = half - sign * corners[:, axis]
            clipped = []
            for k in range(len(corners)):
                last, now = inside[k - 1], inside[k]
                if (last < 0.0) != (now < 0.0):
                    clipped.append(corners[k - 1] + last / (last - now) * (corners[k] - corners[k - 1]))
                if now >= 0.0:
                    clipped.append(corners[k])
            corners = np.array(clipped).reshape(-1, 2)
    return corners


def _draw_section(
    axes: Axes, pair: list[BelowContact], polygons: list[np.ndarray], values: np.ndarray, top: float, name: str
) -> None:
    """One stress in the section, ball above, ring below."""
    from matplotlib.collections import PolyCollection

    outlines = [_UM * polygon for polygon in polygons]
    collection = PolyCollection(outlines, array=_MPA * values, cmap="inferno", edgecolor=INK, linewidth=0.15)
    collection.set_clim(0.0, _MPA * top)
    axes.add_collection(collection)
    wide = _UM * _WIDE * pair[0].semi_axes[1]
    for side, sign in zip(pair, (1.0, -1.0), strict=False):
        depth = sign * _UM * side.hertz[1]
        axes.axhline(depth, color=_MARK, linewidth=0.9, linestyle="--")
        up = "bottom" if sign > 0.0 else "top"
        axes.text(-0.97 * wide, depth, f"Hertz {abs(depth):.3g} µm", color=_MARK, va=up, fontsize=9)
        if side.resolved:
            axes.plot(0.0, sign * _UM * side.profile.largest()[1], "+", color=_MARK, markersize=9)
    axes.figure.colorbar(collection, ax=axes, label="MPa", shrink=0.85)
    axes.set_xlim(-wide, wide)
    axes.set_ylim(-wide, wide)
    axes.set_aspect("equal")
    axes.set_xlabel("rolling direction [µm]")
    _depth_axis(axes)
    axes.set_title(f"{name}\n{pair[0].race} race, ball {pair[0].ball}, {pair[0].load:.4g} N", fontsize=11)


def _depth_axis(axes: Axes) -> None:
    """Depths below both surfaces, counted from where they touch."""
    axes.yaxis.set_major_formatter(lambda height, _: f"{abs(height):g}")
    axes.set_ylabel("depth, ring down [µm]")
