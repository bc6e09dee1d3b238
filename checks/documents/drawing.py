"""A drawing of the parameters of a bearing: a section, the balls seen along the axis, and the pairs of rows.

Proportions are drawn for the eye: conformities and clearances of a bearing differ from those of a ball by percents.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

#: Keys that the drawing names, all of [bearing].
KEYS = (
    "ball_diameter", "pitch_diameter", "ball_count", "conformity_inner", "conformity_outer", "contact_angle_deg",
    "radial_clearance", "bore", "outer_diameter", "width", "shoulder_height", "first_ball_azimuth_deg",
    "arrangement", "row_distance",
)  # fmt: skip
_ANGLE = np.radians(25.0)
_RACE, _BALL, _INK, _MARK = "#d5dbe3", "#f1d9a7", "#1f2933", "#b3261e"
_DIRECTION = np.array([np.sin(_ANGLE), np.cos(_ANGLE)])  # from the inner to the outer contact, as [x, r]
_HALF_PITCH, _RADIUS = 2.7, 1.0
_WORDS = (
    "Red points: centres of the grooves. Forces, displacements, tilts and stiffness entries belong to the reference point, where the "
    "axis meets the plane of the inner centres.\n"
    "radial_clearance may stand for contact_angle_deg: $\\cos\\alpha_0 = 1 -$ radial_clearance / (2 B),  "
    "B = (conformity_inner + conformity_outer $-$ 1) ball_diameter."
)


def draw(path: Path) -> None:
    """Write the drawing as SVG, the same bytes for the same matplotlib."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    settings = {"svg.hashsalt": "raceway", "svg.fonttype": "path", "font.size": 10, "font.family": "DejaVu Sans"}
    with mpl.rc_context(settings):
        figure = Figure(figsize=(12.6, 7.4), facecolor="white")
        _section(figure.add_axes((0.0, 0.13, 0.58, 0.8)))
        _front(figure.add_axes((0.58, 0.5, 0.41, 0.43)))
        _pairs(figure.add_axes((0.58, 0.13, 0.41, 0.3)))
        figure.text(0.03, 0.06, _WORDS, va="center")
        figure.savefig(path, metadata={"Date": None, "Creator": None})


def _section(axes: Axes) -> None:
    """Half a section: rings, ball, line of contact, frame."""
    from matplotlib.patches import Arc, Circle, FancyArrowPatch

    axes.set_title("Section")
    width, groove = 1.75, 1.13
    inner, outer = (groove - _RADIUS) * _DIRECTION, -(groove - _RADIUS) * _DIRECTION
    for centre, seat, land, sign in ((inner, -1.75, -0.62, -1.0), (outer, 1.75, 0.62, 1.0)):
        half = np.sqrt(groove**2 - (land - centre[1]) ** 2)
        ends = np.arctan2(land - centre[1], np.array([-half, half]))
        turn = np.linspace(ends[0], ends[1] + (2 * np.pi if sign < 0 and ends[1] < ends[0] else 0.0), 80)
        arc = centre + groove * np.column_stack([np.cos(turn), np.sin(turn)])
        outline = np.vstack([[-width, seat], [-width, land], arc, [width, land], [width, seat]])
        axes.fill(*outline.T, facecolor=_RACE, edgecolor=_INK, lw=1.2)
        _dot(axes, centre, _MARK)
    axes.add_patch(Circle((0, 0), _RADIUS, facecolor=_BALL, edgecolor=_INK, lw=1.2))
    for centre in (inner, outer):
        _dot(axes, centre, _MARK)
    line = np.outer([-1.9, 1.9], _DIRECTION)
    axes.plot(*line.T, color=_MARK, lw=1.0, ls="-.")
    axes.plot([0, 0], [-1.95, 1.95], color=_INK, lw=0.8, ls="-.")
    axes.add_patch(Arc((0, 0), 1.5, 1.5, theta1=90 - np.degrees(_ANGLE), theta2=90, color=_MARK))
    _note(axes, (0.17, 0.73), (2.75, 1.75), "contact_angle_deg\nfrom the radial plane")
    # Radii of the grooves, from their centres.
    for centre, angle, name, place in (
        (inner, 246, "conformity_inner", (-5.2, -0.75)),
        (outer, 66, "conformity_outer", (-5.2, 0.75)),
    ):
        tip = centre + groove * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        axes.add_patch(FancyArrowPatch(centre, tip, arrowstyle="->", mutation_scale=11, color=_MARK, shrinkA=0, shrinkB=0))
        radius = "$r_i$" if name.endswith("inner") else "$r_o$"
        _note(axes, 0.55 * centre + 0.45 * tip, place, f"{name}\n= {radius} / ball_diameter")
    _dimension(axes, (-_RADIUS, -0.42), (_RADIUS, -0.42), "ball_diameter", above=-0.16)
    _dimension(axes, (-width, 2.15), (width, 2.15), "width", above=0.1)
    top = outer[1] + groove
    _dimension(axes, (width + 0.25, 0.62), (width + 0.25, top), "", above=None)
    _note(axes, (width + 0.25, 0.8), (2.75, 0.8), "shoulder_height")
    axes.plot([width, width + 0.33], [0.62, 0.62], color=_INK, lw=0.6)
    axes.plot([0.1, width + 0.33], [top, top], color=_INK, lw=0.6, ls=":")
    bottom = -_HALF_PITCH
    axes.plot([-3.4, 3.6], [bottom, bottom], color=_INK, lw=0.9, ls="-.")
    for x, top, name in ((-2.15, 1.75, "outer_diameter / 2"), (-2.9, -1.75, "bore / 2")):
        _dimension(axes, (x, bottom), (x, top), name, above=None, side=-1)
        axes.plot([x - 0.08, -width], [top, top], color=_INK, lw=0.6)
    _dimension(axes, (2.4, bottom), (2.4, 0.0), "pitch_diameter / 2", above=None)
    axes.plot([_RADIUS, 2.5], [0, 0], color=_INK, lw=0.6, ls=":")
    origin = np.array([inner[0], bottom])
    for tip, name in (((1.0, 0.0), "x, axial"), ((0.0, 0.62), "y, radial")):
        axes.annotate(
            "", origin + tip, origin, arrowprops={"arrowstyle": "-|>", "color": _MARK, "lw": 1.8, "shrinkA": 0, "shrinkB": 0}
        )
        axes.annotate(name, origin + tip, (4, 3), textcoords="offset points", color=_MARK, weight="bold")
    axes.plot([inner[0]] * 2, [bottom, inner[1]], color=_MARK, lw=0.6, ls=":")
    axes.annotate("", (1.6, -1.25), (0.55, -1.25), arrowprops={"arrowstyle": "-|>", "color": _INK, "lw": 2.2})
    axes.annotate("load.axial", (0.55, -1.58), color=_INK)
    axes.set(xlim=(-5.3, 4.9), ylim=(-3.0, 2.6), aspect="equal")
    axes.axis("off")


def _front(axes: Axes) -> None:
    """The balls seen against x, from the side that the axial load pushes to, so that y turns towards z."""
    from matplotlib.patches import Arc, Circle

    axes.set_title("Along the axis: x points at the reader")
    for radius in (0.72, 1.0, 1.28):
        axes.add_patch(Circle((0, 0), radius, fill=False, ec=_INK, lw=0.8, ls="-." if radius == 1.0 else "-"))
    count, first = 12, np.radians(20.0)
    for k in range(count):
        place = np.array([np.cos(first + 2 * np.pi * k / count), np.sin(first + 2 * np.pi * k / count)])
        axes.add_patch(Circle(place, 0.2, facecolor=_BALL, edgecolor=_INK, lw=1.0))
        if k < 3:
            axes.text(*place, str(k), ha="center", va="center")
    for tip, name in (((1.95, 0), "y"), ((0, 1.85), "z")):
        axes.annotate(
            "", tip, (0, 0), arrowprops={"arrowstyle": "-|>", "color": _MARK, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
        )
        axes.annotate(name, tip, (5, -3), textcoords="offset points", color=_MARK, weight="bold")
    axes.plot([0, np.cos(first)], [0, np.sin(first)], color=_INK, lw=0.7)
    axes.add_patch(Arc((0, 0), 1.0, 1.0, theta1=0, theta2=20, color=_INK))
    _note(axes, (0.49, 0.08), (1.35, -0.75), "first_ball_azimuth_deg\nof ball 0, from y to z")
    _note(axes, (-0.8, 0.62), (-2.6, 1.1), "ball_count")
    axes.annotate("tilt about y", (1.55, 0.28), color=_MARK)
    axes.add_patch(Arc((1.5, 0), 0.16, 0.42, theta1=-60, theta2=240, color=_MARK, lw=1.3))
    axes.annotate("tilt about z", (0.32, 1.5), color=_MARK)
    axes.add_patch(Arc((0, 1.5), 0.42, 0.16, theta1=-30, theta2=240, color=_MARK, lw=1.3))
    axes.set(xlim=(-2.9, 3.4), ylim=(-1.4, 2.0), aspect="equal")
    axes.axis("off")


def _pairs(axes: Axes) -> None:
    """Lines of contact of the three pairs."""
    from matplotlib.patches import Circle, Rectangle

    axes.set_title("arrangement: lines of contact of two rows")
    for k, (name, signs, words) in enumerate(
        (("DB", (1, -1), "back to back"), ("DF", (-1, 1), "face to face"), ("DT", (1, 1), "in tandem"))
    ):
        left = 4.0 * k
        for row, sign in enumerate(signs):
            x = left + 1.3 * row
            for low, high in ((0.45, 1.0), (-1.0, -0.45)):
                axes.add_patch(Rectangle((x - 0.6, low), 1.2, high - low, facecolor=_RACE, edgecolor=_INK, lw=0.8))
            axes.add_patch(Circle((x, 0), 0.55, facecolor=_BALL, edgecolor=_INK, lw=0.8))
            slope = sign * np.tan(_ANGLE)
            axes.plot([x - 2.0 * slope, x + 1.35 * slope], [-2.0, 1.35], color=_MARK, lw=1.1, ls="-.")
        axes.text(left + 0.65, 1.62, f'"{name}"', ha="center", weight="bold")
        axes.text(left + 0.65, -2.6, words, ha="center")
    _dimension(axes, (0.0, -1.3), (1.3, -1.3), "row_distance", above=-0.38)
    axes.plot([-1.2, 10.8], [-2.0, -2.0], color=_INK, lw=0.8, ls="-.")
    axes.text(10.75, -1.9, "axis", ha="right", va="bottom", fontsize=8)
    axes.set(xlim=(-1.4, 11.0), ylim=(-2.9, 2.0), aspect="equal")
    axes.axis("off")


def _dot(axes: Axes, place: Any, colour: str) -> None:
    axes.plot(*place, "o", color=colour, ms=4, zorder=5)


def _note(axes: Axes, place: Any, words_at: Any, words: str) -> None:
    """Words with a thin line to what they are about."""
    axes.annotate(words, place, words_at, arrowprops={"arrowstyle": "-", "color": _INK, "lw": 0.7}, va="center", color=_INK)


def _dimension(axes: Axes, start: Any, end: Any, words: str, above: float | None, side: int = 1) -> None:
    """A line with an arrow at each end; the words beside it, or ``above`` its middle."""
    axes.annotate("", end, start, arrowprops={"arrowstyle": "<->", "color": _INK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0})
    middle = 0.5 * (np.array(start) + np.array(end))
    if above is None:
        axes.text(middle[0] + 0.09 * side, middle[1], words, rotation=90, ha="left" if side > 0 else "right", va="center")
    else:
        axes.text(middle[0], middle[1] + above, words, ha="center", va="center")
