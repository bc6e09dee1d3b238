"""Labels beside points of a figure that lie neither on each other nor on a point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Text, the point that it belongs to in the axes' data, its colour.
Label = tuple[str, tuple[float, float], str]

_SIZE = 7.5
#: Mean width of a letter and height of a line over the size of the letters.
_WIDE, _HIGH = 0.56, 1.15
#: Half the width of a marker, and from a point to its label, near and further away [points of 1/72 inch].
_MARKER, _AWAY = 4.0, (6.0, 15.0, 26.0)
#: Where labels are tried, from their point: the right above first.
_DIRECTIONS = np.array([(1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (0, -1), (1, 0), (-1, 0)], dtype=float)


def put_beside(axes: Axes, labels: Sequence[Label]) -> None:
    """Write each label at the first place that is free, with a thin line where that is not beside its point.

    A label without a free place is left out.
    """
    figure = axes.figure.figure  # the whole one, of which the axes may have a part
    figure.draw_without_rendering()  # only then axes and limits have their places
    scale = 72.0 / figure.dpi
    points = [scale * axes.transData.transform(point) for _, point, _ in labels]
    low, high = scale * axes.bbox.get_points()
    taken = [(point, np.full(2, _MARKER)) for point in points]
    for (text, at, tone), point in zip(labels, points, strict=True):
        half = 0.5 * _SIZE * np.array([_WIDE * len(text), _HIGH])
        for middle, away in _places(point, half):
            inside = (middle - half >= low).all() and (middle + half <= high).all()
            if inside and not any((np.abs(middle - other) < half + size).all() for other, size in taken):
                taken.append((middle, half))
                line = {"arrowstyle": "-", "color": tone, "linewidth": 0.5, "shrinkB": 3.0} if away > _AWAY[0] else None
                axes.annotate(
                    text, at, tuple(middle - point), textcoords="offset points", fontsize=_SIZE, color=tone, ha="center", va="center",
                    arrowprops=line, in_layout=False,
                )  # fmt: skip
                break


def _places(point: np.ndarray, half: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """Middles of a label around its point, near ones first, and how far away they are."""
    return [
        (point + direction * half + away * direction / np.linalg.norm(direction), away)
        for away in _AWAY
        for direction in _DIRECTIONS
    ]
