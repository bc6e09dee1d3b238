"""A comparison for people: what it found in words, as a table and as a picture."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import attrs

from raceway.errors import RacewayError
from raceway.framework.doors import member
from raceway.framework.shown import Fact, Shown, number_within
from raceway.storage.tables import Tables
from raceway.studies.compare.explain import explain, in_few_words
from raceway.studies.compare.findings import MOVING, Findings, Quantity, Row
from raceway.studies.many.axes import Axis, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset


@attrs.frozen(eq=False, slots=False, repr=False)
class Comparison(Shown, Findings):
    """One scene with some keys varied: the numbers, their effects, and both in words.

    Attributes
    ----------
    title : of the scene;  axes : keys that were varied, with their values
    rows : one a run, ``point`` and ``result`` (content of result.json, or status and reason), the last axis running fastest
    effects, trends : of each key and of two together on K and |Z|;  words : all of it in sentences
    fault : why finished runs could not be kept

    Examples
    --------
    >>> import raceway as rw
    >>> force = {"kind": "bidirectional", "speed_rpm": 12000, "amplitude": "constant", "force": "100 N"}
    >>> scene = {"bearing": {"preset": "B7206C"}, "excitation": force, "integrator": {"kind": "quasi_static"}}
    >>> found = rw.compare(scene, {"load.axial": ["0.5 kN", "1 kN"]})
    >>> found.effects[0]["term"], round(found.effects[0]["percent"])  # of K [%]
    (('load.axial',), 27)
    """

    fault: RacewayError | None = None

    @cached_property
    def words(self) -> list[str]:
        """The effects and trends, a sentence each."""
        return explain(self)

    @cached_property
    def short_words(self) -> list[str]:
        """Those of the words that a screen shows."""
        return in_few_words(self)

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        return {
            "title": self.title,
            "axes": [axis.to_dict() for axis in self.axes],
            "rows": [{"point": row.point, "result": row.result, "doubt": row.doubt} for row in self.rows],
            "effects": self.effects,
            "held": self.held,
            "trends": self.trends,
            "words": self.words,
        }

    def to_xarray(self) -> Dataset:
        """The numbers over the keys that were varied, NaN where a run gave none.

        Returns
        -------
        xarray.Dataset
            equivalent_stiffness and its error, dynamic_stiffness |Z| [N/m], equivalent_damping [N s/m], NaN where it is not
            resolved, and status, a dimension for each key

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        from raceway.studies.compare.labelled import labelled

        return labelled(self)

    def plot(self, quantity: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw one quantity over the axis of numbers with most values; without one, a dot for each run.

        Parameters
        ----------
        quantity : "equivalent_stiffness" (default) or "dynamic_stiffness"; of static scenes "kxx" (default), "kyy" or "x"
        ax : matplotlib axes; new ones without

        Raises
        ------
        RacewayError
            matplotlib is missing.
        """
        from raceway.studies.compare.picture import draw_on

        quantity = next(iter(self.quantities)) if quantity is None else member("quantity", quantity, self.quantities)
        return draw_on(self.to_dict(), quantity, ax)

    def _shown(self) -> tuple[str, list[Fact]]:
        names, (first, about) = _short_names(self.axes), next(iter(self.quantities.items()))
        label = about.label.removesuffix("(w)")
        changes = [
            (
                " x ".join(names[key] for key in one["term"]),
                f"{one['percent']:+.3g} %",
                f"of {label} on average" if one["order"] == 1 else f"interaction on {label}",
            )
            for one in self.effects
            if one["quantity"] == first
        ]
        runs = [(", ".join(f"{names[key]} {shown(row.point[key])}" for key in names), *_number_of(row)) for row in self.rows]
        words: Fact = ("words", "", f"{len(self.words)} sentences in .words")
        return f"{len(self.rows)} runs compared\n{self.title.splitlines()[0]}", [*changes[:3], words, *runs]

    def table(self) -> list[dict[str, str]]:
        """One row a run, as short text for a screen; why a run is in doubt is said in the words."""
        names, noted = _short_names(self.axes), any(row.doubt for row in self.rows)
        return [_screen_row(row, names, noted, self.quantities) for row in self.rows]

    def picture(self, folder: Path) -> list[Path]:
        """Draw all quantities into a folder; the files written.

        Raises
        ------
        RacewayError
            matplotlib is missing, or a folder that cannot be written.
        """
        from raceway.plugins.pictures import save_figure
        from raceway.studies.compare.picture import draw

        return [save_figure(draw(self.to_dict()), folder / "comparison.png", 100)]


def _number_of(row: Row) -> tuple[str, str]:
    """The first quantity with its error, and what is to be known of it."""
    name, about = next(iter(row.quantities.items()))
    value, z = row.value(name), row.value("dynamic_stiffness")
    if value is None:
        return "-", row.doubt or ""
    doubt = f"; in doubt: {row.doubt}" if row.doubt else ""
    if z is None:
        return f"{about.label} {about.scale * value:.4g} {about.unit}", about.words + doubt
    error = about.scale * row.error * z
    known = f"+- {error:.2g} {about.unit}" if row.estimated else "error not known"
    return f"K {number_within(about.scale * value, error, about.unit)}", known + doubt


def _screen_row(row: Row, names: dict[str, str], noted: bool, quantities: dict[str, Quantity]) -> dict[str, str]:
    text = {name: shown(row.point[key]) for key, name in names.items()}
    for name, about in quantities.items():
        value = row.value(name)
        text[f"{about.label.removesuffix('(w)')} {about.unit}"] = "" if value is None else f"{about.scale * value:.3f}"
    if quantities is MOVING:
        text["C N s/m"] = row.damping_words
        text["error %"] = "" if row.value("dynamic_stiffness") is None else f"{100.0 * row.error:.2g}"
    if noted:
        text["note"] = row.result["status"] if row.failed else "in doubt" if row.doubt else ""
    return text


def _short_names(axes: tuple[Axis, ...]) -> dict[str, str]:
    """Key -> its last part, or the whole key where two axes share that part: a table has to fit a screen."""
    last = [axis.key.rpartition(".")[2] for axis in axes]
    return {axis.key: name if last.count(name) == 1 else axis.key for axis, name in zip(axes, last, strict=True)}
