"""Layout of a sweep's pictures: the quantity, the axes for x, colour and panels, the kind of picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.studies.many.axes import is_number, shown
from raceway.studies.sweep.selection import LIST, Selection, listed

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from raceway.storage.tables import Tables

#: First that is there: what a sweep is made for, then what a static scene has.
_DEFAULTS = ("equivalent_stiffness", "z_real", "stiffness:y,y", "axial_displacement")
_FIRST_X = ("excitation.speed_rpm", "kinematics.spin_speed_rpm")
_MOST_COLOURS = 8
_MOST_PANELS = 6


@attrs.frozen(eq=False)
class Layout:
    """A picture of one quantity.

    Attributes
    ----------
    data : dimensions among ``x``, ``y`` and ``panels``, or ``point``; units and description in its attributes
    x, y : keys; in curves y is what the colours stand for and may be None
    panels : key of one panel a value, or None
    """

    data: DataArray
    name: str
    kind: str
    x: str
    y: str | None
    panels: str | None
    title: str
    remark: str

    def write(self, path: Path) -> Path:
        """Draw it.

        Raises
        ------
        RacewayError
            matplotlib is missing, or the file cannot be written.
        """
        from raceway.studies.sweep.picture import draw, write

        return write(draw(self.data, self.kind, self.x, self.y, self.panels, self.title, self.remark), path)


def layout(
    selection: Selection, value: str | None = None, kind: str | None = None, x: str | None = None, y: str | None = None
) -> Layout:
    """Choose what was left open.

    Parameters
    ----------
    value : variable, with labels of its other dimensions after a colon: ``p0``, ``stiffness:y,y``, ``displacement:x``
    kind : "curves", "map" or "surface"

    Raises
    ------
    SceneError
        Unknown names, axes that do not vary or have no numbers, and axes left over, each with what to type.
    RacewayError
        Nothing varies, or nothing is finished.
    """
    if not names(selection.dataset):
        raise RacewayError("no point is done yet: compute them with raceway sweep ... --resume")
    data, name = quantity(selection.dataset, value)
    axes = selection.axes
    if not axes:
        raise RacewayError("nothing varies in this part of the sweep: leave out an --at, or see the values with --json")
    if not bool(data.notnull().any()):
        raise RacewayError(f"no point of this part has a {name}: {selection.gaps or 'none was finished'}")
    _refuse_strangers(selection, x, y)
    numeric = [key for key, values in axes.items() if all(is_number(v) for v in values)]
    kind = kind or _kind(axes, numeric)
    x = x or _best(axes, [key for key in numeric or axes if key != y], kind)
    rest = [key for key in axes if key != x]
    if kind != "curves":
        y = y or next(iter(sorted((key for key in rest if key in numeric), key=lambda key: -len(axes[key]))), None)
        _refuse_flat(kind, x, y, numeric)
    else:
        y = y or _colour(axes, rest)
    over = [key for key in rest if key != y]
    panels = over[0] if len(over) == 1 and len(axes[over[0]]) <= _MOST_PANELS and LIST not in data.dims else None
    _refuse_rest(axes, [key for key in over if key != panels], kind)
    if kind == "surface" and LIST in data.dims:
        raise RacewayError("the points of this sweep fill no grid, and a surface needs one: choose --kind map or curves")
    fixed = ", ".join(f"{key} = {shown(v)}" for key, v in selection.fixed.items())
    remark = "; ".join(part for part in (fixed, f"without result: {selection.gaps}" if selection.gaps else "") if part)
    return Layout(data, name, kind, x, y, panels, selection.title, remark)


def quantity(dataset: Dataset, text: str | None) -> tuple[DataArray, str]:
    """A variable by its name, with the labels of its other dimensions chosen.

    Raises
    ------
    SceneError
        A name that is not there, or labels that do not fit.
    """
    if text is None:
        text = next((name for name in _DEFAULTS if name.partition(":")[0] in dataset), None)
        if text is None:
            raise RacewayError(f"choose what to draw with --value: {', '.join(names(dataset))}")
    name, _, labels = text.partition(":")
    if name not in dataset or dataset[name].dtype.kind not in "fiu":
        known = names(dataset)
        raise SceneError.at(
            "--value", text, f"is not a quantity of this sweep{nearest(name, known)}; there are {', '.join(known)}"
        )
    data = dataset[name]
    own = [str(dim) for dim in data.dims if "." not in str(dim) and dim != LIST]
    given = [label.strip() for label in labels.split(",") if label.strip()]
    if len(given) != len(own):
        choices = [[str(label) for label in data[dim].values] for dim in own]
        wanted = ",".join(options[min(1, len(options) - 1)] for options in choices)
        message = (
            f"takes {len(own)} labels after a colon{f', for instance {name}:{wanted}' if own else ''}; {len(given)} given"
        )
        raise SceneError.at("--value", text, message)
    for dim, label in zip(own, given, strict=True):
        known = [str(one) for one in data[dim].values]
        if label not in known:
            raise SceneError.at("--value", text, f"has no '{label}'{nearest(label, known)}; there are {', '.join(known)}")
        data = data.isel({dim: known.index(label)})
    data = data.copy()  # its attributes change
    if own:
        data.name = text
        data.attrs["units"] = unit_of(name, str(data.attrs.get("units", "")), given)
    return data, text


def unit_of(name: str, unit: str, labels: Sequence[str]) -> str:
    """The unit of one entry where a variable mixes translations and tilts."""
    tilts = sum(label.startswith("tilt") for label in labels)
    if name == "stiffness" and len(labels) == 2:
        if not tilts:
            return "N/m"
        return "N m/rad" if tilts == 2 else ("N/rad" if labels[1].startswith("tilt") else "N m/m")
    if name == "displacement":
        return "rad" if tilts else "m"
    return unit


def names(dataset: Dataset) -> list[str]:
    """Variables with numbers."""
    return [str(name) for name, data in dataset.data_vars.items() if data.dtype.kind in "fiu"]


def _kind(axes: Tables, numeric: list[str]) -> str:
    both = len(axes) == 2 and len(numeric) == 2
    return "map" if both and min(len(values) for values in axes.values()) > _MOST_COLOURS else "curves"


def _best(axes: Tables, keys: list[str], kind: str) -> str:
    if not keys:
        raise RacewayError(f"{kind}: no axis is left for x: leave out --y, or an --at")
    return min(keys, key=lambda key: (key not in _FIRST_X, -len(axes[key])))


def _colour(axes: Tables, rest: list[str]) -> str | None:
    """The axis with most values that still can be told apart; panels take the other one."""
    fitting = [key for key in rest if len(axes[key]) <= _MOST_COLOURS]
    return max(fitting or rest, key=lambda key: len(axes[key]), default=None)


def _refuse_strangers(selection: Selection, x: str | None, y: str | None) -> None:
    mistakes = []
    known = list(selection.axes)
    for option, key in (("--x", x), ("--y", y)):
        if key is None or key in known:
            continue
        if key in selection.fixed:
            why = f"has the one value {shown(selection.fixed[key])} here"
        else:
            why = f"is not an axis of this sweep{nearest(key, known)}"
        mistakes.append(Mistake(option, key, f"{why}; axes that vary: {', '.join(known)}"))
    if x is not None and x == y:
        mistakes.append(Mistake("--y", y, "is the axis of --x already: choose another, or leave one out"))
    if mistakes:
        raise SceneError(mistakes)


def _refuse_flat(kind: str, x: str, y: str | None, numeric: list[str]) -> None:
    if y is None:
        raise SceneError.at("--kind", kind, f"takes two axes with numbers, and only {x} varies: choose --kind curves")
    for option, key in (("--x", x), ("--y", y)):
        if key not in numeric:
            raise SceneError.at(option, key, f"has words for values, and a {kind} takes numbers: choose --kind curves")


def _refuse_rest(axes: Tables, over: list[str], kind: str) -> None:
    if over:
        raise SceneError(
            [
                Mistake(key, None, f"varies, too ({listed(axes[key])}), and {kind} have no place for it: choose one with "
                        f"--at {key}={shown(axes[key][0])}")
                for key in over
            ]
        )  # fmt: skip
