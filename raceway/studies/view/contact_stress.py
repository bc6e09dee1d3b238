"""Stresses below the most loaded contact of each race: stress_contact.png, a section close up, and contact.vtu for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from raceway.bodies.elastic.subsurface import BelowContact, below_contacts
from raceway.core.contact.subsurface import axis_shear, axis_stresses
from raceway.core.hexahedron.recovery import von_mises
from raceway.plugins.pictures import new_figure, save_figure
from raceway.storage.files import write_whole
from raceway.studies.view.fields import Fields, new_grid, vtu
from raceway.studies.view.scene import pyvista_of, quietly

if TYPE_CHECKING:
    from types import ModuleType

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from raceway.pipeline.result import Result

#: Half the picture's width and height in minor semi-axes; elements within so many major semi-axes of a contact are kept.
_WIDE, _NEAR = 3.0, 1.5
#: The section's distance from the contact's centre in major semi-axes: no plane of nodes, where two elements meet.
_BESIDE = 0.01
_UM, _MPA, _INK, _MARK = 1e6, 1e-6, "#20262c", "#00a0c8"


def write_contact_stress(result: Result, folder: Path) -> list[Path]:
    """Write contact.vtu and stress_contact.png; nothing where no contact at points is loaded.

    Raises
    ------
    RacewayError
        pyvista or matplotlib is missing, or the folder cannot be written.
    """
    bodies: Any = result.model.bearing
    sides = below_contacts(bodies, result.model, result.equilibrium)
    if not sides:
        return []
    figure, grid = drawn(result, sides)
    return [write_whole(vtu(grid), folder / "contact.vtu"), save_figure(figure, folder / "stress_contact.png", 110)]


def drawn(result: Result, sides: list[BelowContact]) -> tuple[Figure, Any]:
    """The figure of the contacts of ``below_contacts``, and pyvista's grid of the elements near them."""
    pyvista = pyvista_of("")
    near: dict[int, tuple[np.ndarray, float]] = {}
    for side in sides:
        places = np.concatenate([near[side.index][0] if side.index in near else np.empty((0, 3)), side.axis.pole[None]])
        near[side.index] = places, _NEAR * max(one.semi_axes[0] for one in sides)
    grid = new_grid(pyvista, Fields.of(result, near))
    races = [[side for side in sides if side.race == race] for race in dict.fromkeys(side.race for side in sides)]
    figure = new_figure(15.6, 5.6 * len(races))
    panels = figure.subplots(len(races), 3, squeeze=False, width_ratios=(1.0, 1.0, 0.75))
    cuts = [quietly(pyvista, _contact_section, pyvista, grid, pair) for pair in races]
    for column, name in enumerate(("von Mises stress", "largest shear stress")):
        top = max(float(values[column].max(initial=0.0)) for _, values in cuts)
        for row, (pair, (polygons, values)) in enumerate(zip(races, cuts, strict=True)):
            _draw(panels[row, column], pair, polygons, values[column], top, name)
    for row, pair in enumerate(races):
        _along_the_normal(panels[row, 2], pair, grid)
    told = "plane of the rolling direction and the contact's normal; ball above, ring below"
    if any(side.resolved for side in sides):
        told += "; + largest shear stress on the normal"
    figure.suptitle(f"{result.title}\n{told}", fontsize=12)
    return figure, grid


def _contact_section(pyvista: ModuleType, grid: Any, pair: list[BelowContact]) -> tuple[list[np.ndarray], np.ndarray]:
    """Polygons (k, 2) of the deformed elements, along the rolling direction and into the ball [m], and two stresses (2, n) [Pa]."""
    ball = pair[0]
    kept = grid.extract_cells(np.isin(grid.cell_data["body"], [side.index for side in pair]))
    moved = kept.point_data["displacement [m]"]
    # The contact's centre as the ball's nearest node has moved.
    nearest = int(np.linalg.norm(kept.points - ball.axis.pole, axis=1).argmin())
    pole = ball.axis.pole + moved[nearest]
    kept.points = kept.points + moved
    beside = pole + _BESIDE * ball.semi_axes[0] * ball.axis.axes[0]
    cut = kept.slice(normal=ball.axis.axes[0], origin=beside)
    plane = ((cut.points - pole) @ ball.axis.axes.T)[:, 1:]
    polygons, chosen, at = [], np.zeros(cut.n_cells, dtype=bool), 0
    for cell in range(cut.n_cells):
        count = int(cut.faces[at])
        corners = _within(plane[cut.faces[at + 1 : at + 1 + count]], _WIDE * ball.semi_axes[1])
        at += 1 + count
        chosen[cell] = len(corners) > 0
        if chosen[cell]:
            polygons.append(corners)
    names = ("von Mises stress [Pa]", "largest shear stress [Pa]")
    return polygons, np.stack([np.asarray(cut.cell_data[name])[chosen] for name in names])


def _within(corners: np.ndarray, half: float) -> np.ndarray:
    """(k, 2) what of a convex polygon lies in the square of half width ``half``: cut by its four sides in turn (Sutherland, Hodgman)."""
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            inside = half - sign * corners[:, axis]
            kept = []
            for k in range(len(corners)):
                here, there = inside[k - 1], inside[k]
                if (here < 0.0) != (there < 0.0):
                    kept.append(corners[k - 1] + here / (here - there) * (corners[k] - corners[k - 1]))
                if there >= 0.0:
                    kept.append(corners[k])
            corners = np.array(kept).reshape(-1, 2)
    return corners


def _draw(
    axes: Axes, pair: list[BelowContact], polygons: list[np.ndarray], values: np.ndarray, top: float, name: str
) -> None:
    """One stress in the section, ball above, ring below."""
    from matplotlib.collections import PolyCollection

    shown = PolyCollection(
        [_UM * one for one in polygons], array=_MPA * values, cmap="inferno", edgecolor=_INK, linewidth=0.15
    )
    shown.set_clim(0.0, _MPA * top)
    axes.add_collection(shown)
    wide = _UM * _WIDE * pair[0].semi_axes[1]
    for side, sign in zip(pair, (1.0, -1.0), strict=False):
        depth = sign * _UM * side.hertz[1]
        axes.axhline(depth, color=_MARK, linewidth=0.9, linestyle="--")
        up = "bottom" if sign > 0.0 else "top"
        axes.text(-0.97 * wide, depth, f"Hertz {abs(depth):.3g} µm", color=_MARK, va=up, fontsize=9)
        if side.resolved:
            axes.plot(0.0, sign * _UM * side.profile.largest()[1], "+", color=_MARK, markersize=9)
    axes.figure.colorbar(shown, ax=axes, label="MPa", shrink=0.85)
    axes.set_xlim(-wide, wide)
    axes.set_ylim(-wide, wide)
    axes.set_aspect("equal")
    axes.set_xlabel("rolling direction [µm]")
    _depth_axis(axes)
    one = pair[0]
    axes.set_title(f"{name}\n{one.race} race, ball {one.ball}, {one.load:.4g} N", fontsize=11)


def _depth_axis(axes: Axes) -> None:
    """Depths below both surfaces, counted from where they touch."""
    axes.yaxis.set_major_formatter(lambda height, _: f"{abs(height):g}")
    axes.set_ylabel("depth: in ring ↓  in ball ↑ [µm]")


def _along_the_normal(axes: Axes, pair: list[BelowContact], grid: Any) -> None:
    """Stresses on the contact's normal beside Hertz's at the same load: fitted where the mesh resolves them, else of its elements."""
    for side, sign in zip(pair, (1.0, -1.0), strict=False):
        profile, told = side.profile, sign > 0.0
        depth = profile.depth
        exact = axis_stresses(depth, side.semi_axes, side.peak_pressure, side.poisson)
        full = np.concatenate([exact, np.zeros_like(exact)], axis=1)
        shear = axis_shear(depth, side.semi_axes, side.peak_pressure, side.poisson)
        # Above the first element's centre the fit extrapolates.
        inside = depth >= (0.5 * profile.lengths[0, 2] if side.resolved else 0.0)
        found = np.stack([profile.von_mises, profile.shear]) if side.resolved else _elements_on(side, grid)
        for values, hertz, colour, word in (
            (found[0], von_mises(full), "#b5651d", "von Mises"),
            (found[1], shear, "#0b5fa5", "largest shear"),
        ):
            mesh, theory = (f"{word}, mesh", f"{word}, Hertz") if told else (None, None)
            axes.plot(_MPA * values[inside], sign * _UM * depth[inside], color=colour, linewidth=1.6, label=mesh)
            axes.plot(_MPA * hertz, sign * _UM * depth, color=colour, linewidth=1.0, linestyle="--", label=theory)
        words = f"Hertz {_MPA * side.hertz[0]:.4g} MPa at {_UM * side.hertz[1]:.3g} µm"
        if side.resolved:
            size, at = profile.largest()
            words = f"{side.body}: {_MPA * size:.4g} MPa at {_UM * at:.3g} µm\n{words}"
        else:
            words = f"{side.body}: not resolved by this mesh;\nsteps are its elements\n{words}"
        axes.text(
            0.97,
            0.98 if told else 0.02,
            words,
            transform=axes.transAxes,
            ha="right",
            va="top" if told else "bottom",
            fontsize=8,
        )
    axes.axhline(0.0, color=_INK, linewidth=0.8)
    wide = _UM * _WIDE * pair[0].semi_axes[1]
    axes.set_ylim(-wide, wide)
    axes.set_xlim(0.0, 1.9 * axes.get_xlim()[1])  # room for words
    axes.set_xlabel("MPa")
    _depth_axis(axes)
    axes.set_title("on the contact's normal", fontsize=11)
    axes.legend(fontsize=8, loc="center right")


def _elements_on(side: BelowContact, grid: Any) -> np.ndarray:
    """(2, n) von Mises and largest shear stresses [Pa] of the elements at the depths of the profile, nan outside of all."""
    places = side.axis.at_depth(side.profile.depth) + _BESIDE * np.asarray(side.semi_axes) @ side.axis.axes[:2]
    body = grid.extract_cells(grid.cell_data["body"] == side.index)
    cell = np.atleast_1d(body.find_containing_cell(places))
    names = "von Mises stress [Pa]", "largest shear stress [Pa]"
    return np.stack([np.where(cell < 0, np.nan, body.cell_data[name][cell]) for name in names])
