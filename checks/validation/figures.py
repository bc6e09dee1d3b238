"""Whether everything that a figure draws lies inside its axes."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.figure import Figure

#: Points on the very edge are inside; part of an axis' length, in its own scale.
ROUNDING = 1e-9


def outside(figure: Figure) -> list[str]:
    """What lies outside its axes, a line each; empty where all is seen.

    Notes
    -----
    Looked at are lines, collections and patches along each direction in which their points are data: a line across the whole
    axes has one such direction.  Angles of polar axes have no limits.
    """
    found = []
    for number, axes in enumerate(axes for axes in figure.axes if axes.get_visible()):
        for what, points in _drawn(axes):
            for name, values in points.items():
                if axes.name == "polar" and name == "x":
                    continue
                limits = getattr(axes, f"get_{name}lim")()
                bad = _beyond(values, limits, getattr(axes, f"{name}axis").get_transform().transform)
                if bad.size:
                    where = f"axes {number} ({axes.get_title()!r}), {what}"
                    found.append(f"{where}: {bad.size} points outside {name} = {limits}, for instance {bad[0]:g}")
    return found


def _beyond(values: Any, limits: tuple[float, float], scale: Any) -> np.ndarray:
    """The finite ones of the values (n,) that lie outside."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    low, high = np.sort(scale(np.array(limits, dtype=float)))
    with np.errstate(invalid="ignore", divide="ignore"):
        at = scale(values)
    room = ROUNDING * (high - low)
    return values[(at < low - room) | (at > high + room)]


def _drawn(axes: Any) -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """What is drawn, and its points along x and y, as far as they are data."""
    if axes.name == "3d":
        box = axes.xy_dataLim.get_points()
        yield "surfaces", {"x": box[:, 0], "y": box[:, 1], "z": axes.zz_dataLim.get_points()[:, 0]}
        return
    for line in axes.lines:
        yield f"line {line.get_label()!r}", _data(axes, line.get_transform(), np.column_stack(line.get_data()))
    for collection in axes.collections:
        points, transform = _of_collection(collection)
        yield f"{type(collection).__name__} {collection.get_label()!r}", _data(axes, transform, points)
    for patch in axes.patches:
        points = patch.get_patch_transform().transform(patch.get_path().vertices)
        yield f"{type(patch).__name__} {patch.get_label()!r}", _data(axes, patch.get_data_transform(), points)


def _of_collection(collection: Any) -> tuple[np.ndarray, Any]:
    if isinstance(collection, PathCollection):
        return np.asarray(collection.get_offsets()), collection.get_offset_transform()
    if isinstance(collection, QuadMesh):
        return collection.get_coordinates().reshape(-1, 2), collection.get_transform()
    points = [path.vertices for path in collection.get_paths() if len(path.vertices)]
    return np.concatenate(points) if points else np.empty((0, 2)), collection.get_transform()


def _data(axes: Any, transform: Any, points: np.ndarray) -> dict[str, np.ndarray]:
    known = transform.contains_branch_seperately(axes.transData)
    return {name: values for name, values, is_data in zip("xy", np.asarray(points).T, known, strict=True) if is_data}
