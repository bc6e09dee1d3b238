"""The answer of ``raceway.fit``: numbers with their intervals, what the data do not determine, and data beside the fit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.commands.screen import Words, rows_table, written
from raceway.framework.doors import member
from raceway.framework.shown import Fact, Shown, number, number_within, read_in
from raceway.pipeline.result import without_nan, write_json
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.fit.estimate import CONFIDENCE, Combination, Estimate

if TYPE_CHECKING:
    from rich.console import RenderableType


@attrs.frozen(eq=False)
class Series:
    """One measured quantity beside the fit.

    Attributes
    ----------
    name, unit : of the quantity;  over, over_unit : of the abscissa
    x, measured, fitted : (n,)
    error : (n,) standard errors, those of the residuals' scatter where none were stated
    band : (n,) half-widths of the fitted curve at 95 %
    """

    name: str
    unit: str
    over: str
    over_unit: str
    x: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    error: np.ndarray
    band: np.ndarray

    def to_dict(self) -> Tables:
        out: Tables = {"name": self.name, "unit": self.unit, "over": self.over, "over_unit": self.over_unit}
        return out | {name: getattr(self, name).tolist() for name in ("x", "measured", "fitted", "error", "band")}


@attrs.frozen
class Derived:
    """A number that follows from the free ones: its half-width at 95 %, infinite where the data do not determine it."""

    name: str
    unit: str
    value: float
    half: float


@attrs.frozen(eq=False, repr=False)
class Fitted(Shown):
    """Free numbers of a scene or a linear model as measured data tell them.

    Attributes
    ----------
    title : of the scene or the model;  source : of the data;  kind : "table", "rig" or "record"
    stated : whether errors of the data were stated; else their scatter tells them
    estimate : numbers, covariance, what is not determined;  series : data beside the fit;  derived : K and C of a rig
    notes : what a reader of the numbers should know

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"load.axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> found = rw.fit(data, "examples/b7206.toml", ["bearing.contact_angle_deg"])
    >>> round(found["bearing.contact_angle_deg"], 1)  # [deg]
    17.0
    """

    title: str
    source: str
    kind: str
    stated: bool
    estimate: Estimate
    series: tuple[Series, ...]
    derived: tuple[Derived, ...] = ()
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        """A free number, in the unit of its key, or a derived one, in SI."""
        return self._found()[member("name", name, self._found())][0]

    def half_width(self, name: str) -> float:
        """Half-width of its interval at 95 %; infinite where the data do not determine it."""
        return self._found()[member("name", name, self._found())][1]

    @property
    def determined(self) -> bool:
        """Whether the data determine every free number."""
        return not self.estimate.undetermined

    @property
    def warnings(self) -> list[str]:
        """What a reader of the numbers should know."""
        one = self.estimate
        out = [told(combination, {free.name: free.unit for free in one.free}) for combination in one.undetermined]
        if one.freedom == 0 and not np.isfinite(one.half).all() and not one.undetermined:
            out.append("as many data as free numbers, and no stated errors: nothing tells how well the numbers are known")
        out += [
            f"{name} lies at the end of its range: the data ask for more than the scene's rules allow"
            for name in one.at_limit
        ]
        if one.widened > 1.0:
            out.append(
                f"the model misses the data by {one.widened:.2g} times their stated errors: intervals are that much wider, and the "
                "model or the errors are wrong"
            )
        return [*out, *self.notes]

    def to_dict(self) -> Tables:
        """Plain tables, as in fit.json."""
        one = self.estimate
        parts = [dict(zip(one.parts, halves, strict=True)) for halves in np.array([*one.parts.values()]).T.tolist()]
        free = [
            {
                "key": key.name, "unit": key.unit, "start": key.start, "value": float(value), "error": float(half),
                "low": float(value - half), "high": float(value + half), "determined": bool(np.isfinite(half)),
                "at_limit": key.name in one.at_limit, "parts": causes,
            }
            for key, value, half, causes in zip(one.free, one.values, one.half, parts, strict=True)
        ]  # fmt: skip
        content: Tables = {
            "title": self.title,
            "file": self.source,
            "kind": self.kind,
            "stated": self.stated,
            "confidence": CONFIDENCE,
            "free": free,
            "covariance": sum((moved.T @ moved for moved in one.shifts.values()), one.covariance).tolist(),
            "undetermined": [{"changes": c.changes, "moves_standard_errors": c.moves} for c in one.undetermined],
            "derived": [attrs.asdict(each) for each in self.derived],
            "fit": {
                "data": int(one.jacobian.shape[0]), "freedom": one.freedom, "scatter": one.scatter, "widened": one.widened,
                "evaluations": one.evaluations,
            },
            "series": [each.to_dict() for each in self.series],
            "warnings": self.warnings,
        }  # fmt: skip
        return dict(without_nan(content))

    def save(self, folder: Path) -> Path:
        """Write fit.json.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return write_json(self.to_dict(), folder / "fit.json")

    def picture(self, folder: Path) -> Path:
        """Draw fit.png: data, fit with its band, residuals, confidence region.

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        from raceway.plugins.pictures import save_figure
        from raceway.studies.fit.picture import draw

        return save_figure(draw(self.to_dict()), folder / "fit.png", 110)

    def _found(self) -> dict[str, tuple[float, float]]:
        one = self.estimate
        found = {free.name: (float(v), float(h)) for free, v, h in zip(one.free, one.values, one.half, strict=True)}
        return found | {each.name: (each.value, each.half) for each in self.derived}

    def _shown(self) -> tuple[str, list[Fact]]:
        one = self.estimate
        facts = [
            fact(free.name, *in_units(float(value), float(half), free.unit))
            for free, value, half in zip(one.free, one.values, one.half, strict=True)
        ]
        facts += [fact(each.name, *in_units(each.value, each.half, each.unit)) for each in self.derived]
        return f"Fitted to {self.source}\n{self.title.splitlines()[0]}", [
            *facts,
            *(("warning", "", text) for text in self.warnings),
        ]


def fact(name: str, value: float, half: float, unit: str) -> Fact:
    """A number with its half-width."""
    if not np.isfinite(half):
        return name, number(value, unit, 4), "not determined"
    return name, number_within(value, half, unit), f"+- {number(half, unit, 2)} at 95 %"


def in_units(value: float, half: float, unit: str) -> tuple[float, float, str]:
    """A number and its half-width in the unit that people read."""
    shown, word = read_in(value, unit)
    return shown, read_in(half, unit)[0], word


def told(one: Combination, units: dict[str, str]) -> str:
    """A combination of changes that the data do not determine, in one sentence."""
    parts = [f"{name} {change:+.3g} {units[name]}".rstrip() for name, change in one.changes.items()]
    if len(parts) == 1:
        (name,) = one.changes
        return f"the data do not determine {name}: {parts[0]} moves them by {one.moves:.2g} standard errors. Do not free it"
    return (
        f"the data do not determine {' and '.join(one.changes)} together: {' with '.join(parts)} moves them by {one.moves:.2g} "
        "standard errors. Free one of them less, or measure what tells them apart"
    )


#: Part of a half-width below which a cause of it is not shown.
_SMALL = 0.02


def fit_screen(content: ReadTables, files: list[str]) -> RenderableType:
    """Free numbers with their intervals, what follows from them; below, how well the model meets the data, and warnings."""
    from rich.console import Group

    rows = []
    for one in content["free"]:
        start = "" if content["kind"] == "record" else number(one["start"], one["unit"], 6)
        value, half, unit = in_units(one["value"], one["error"] or 0.0, one["unit"])
        row = {"free": one["key"], "from": start, "found": number(value, unit, 4), "at 95 %": "not determined"}
        if one["determined"]:
            row |= {"found": number_within(value, half, unit), "at 95 %": f"± {number(half, unit, 2)}"}
            if len(one["parts"]) > 1:
                row["of which"] = _parts(one)
        rows.append(row)
    for one in content["derived"]:
        row = {"free": one["name"], "from": "", "found": "", "at 95 %": "not determined"}
        if one["half"] is not None:
            value, half, unit = in_units(one["value"], one["half"], one["unit"])
            row |= {"found": number_within(value, half, unit), "at 95 %": f"± {number(half, unit, 2)}"}
        rows.append(row)
    fit = content["fit"]
    words = f"{fit['data']} data, {len(content['free'])} free, {fit['evaluations']} evaluations"
    if fit["scatter"] is not None and content["kind"] != "record":
        words += f"; {_scatter(content)}"
    lines = [Words(words), *(Words(text, "yellow") for text in content["warnings"])]
    return Group(rows_table(rows, f"{content['title']}\nfitted to {content['file']}"), *lines, *written(files))


def _parts(one: ReadTables) -> str:
    """Half-widths by cause, the larger ones first."""
    parts = sorted(one["parts"].items(), key=lambda part: -part[1])
    shown = [(cause, in_units(0.0, half, one["unit"])) for cause, half in parts if half > _SMALL * one["error"]]
    return ", ".join(f"{cause} {number(half, unit, 2)}" for cause, (_, half, unit) in shown)


def _scatter(content: ReadTables) -> str:
    scatter, stated = content["fit"]["scatter"], content["stated"]
    return (
        f"residuals {scatter:.2g} of the stated errors"
        if stated
        else f"residuals scatter by {100.0 * scatter:.2g} % of the data"
    )
