"""Whether everything that a figure draws lies inside its axes, and can be read."""

import ast
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.text import Text

from raceway.extend import figure_png

#: Points on the very edge are inside; part of an axis' length, in its own scale.
ROUNDING = 1e-9


def outside(figure: Figure) -> list[str]:
    """What lies outside its axes, a line each; empty where all is seen.

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


def unreadable(figure: Figure) -> list[str]:
    """Letters below 9 pixels of 600, but in wide figures of pages; labels of axes of more than five words, or that are keys; words on words."""
    least = min(1.05 * figure.get_figwidth(), 11.0)
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    small = [f"{text.get_text()!r} in {text.get_fontsize():g} pt" for text in texts if text.get_fontsize() < least - 1e-6]
    labels = [label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel())]
    ticks = [tick for axes in figure.axes for side in axes.get_xticklabels() + axes.get_yticklabels() for tick in [side]]
    words = [
        text
        for text in texts
        if text not in ticks and text.get_text() != "\n" and (text.axes is None or text.axes.get_visible())
    ]
    boxes = [(text.get_text(), Text.get_window_extent(text).shrunk(0.94, 0.8)) for text in words]
    small += [f"{a!r} lies on {b!r}" for k, (a, one) in enumerate(boxes) for b, other in boxes[:k] if one.overlaps(other)]
    return small + [
        label
        for label in labels
        if len(label.partition("[")[0].split()) > 5 or re.search(r"[a-z]\.[a-z]|_(rpm|deg|hz)", label)
    ]


def assert_readable(figures: Iterable[Figure]) -> None:
    """All that they draw lies inside its axes and is read at 600 pixels."""
    figures = list(figures)
    for figure in figures:
        figure_png(figure)  # its limits are known, and its letters readable
    assert figures and [line for figure in figures for line in outside(figure)] == []
    assert [fault for figure in figures for fault in unreadable(figure)] == []


def makers(folder: Path) -> set[str]:
    """Modules below a folder that make figures, by their last folder and name."""
    making = set()
    for path in folder.rglob("*.py"):
        if not re.search("new_figure|draw_panels|Figure", text := path.read_text(encoding="utf-8")):
            continue
        called = [node.func for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
        names = {getattr(call, "id", getattr(call, "attr", None)) for call in called}
        if names & {"new_figure", "draw_panels", "Figure"}:
            making.add("/".join(path.parts[-2:]).removesuffix(".py"))
    return making
