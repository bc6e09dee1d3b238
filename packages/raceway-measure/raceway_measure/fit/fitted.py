"""Fitted numbers of a scene or a linear model, with their intervals: the answer of ``raceway.fit``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway import Answer, RacewayError, SceneError, door
from raceway.extend import PATH, Fact, Part, Tables, Words, member, number, number_within, read_in, rows_table, without_nan
from raceway_measure.fit.estimate import CONFIDENCE, Estimate
from raceway_measure.fit.response import FrequencyResponse

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Part of a half-width below which a cause of it is not shown.
_SMALL = 0.02


@attrs.frozen(eq=False)
class Series:
    """One measured quantity beside the fit."""

    #: name, unit : of the quantity
    name: str
    unit: str
    #: over, over_unit : of the abscissa
    over: str
    over_unit: str
    #: x, measured, fitted : (n,)
    x: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    error: np.ndarray  # (n,) standard errors, by the residuals where none were stated
    band: np.ndarray  # (n,) half-widths of the fitted curve at 95 %


@attrs.frozen
class Derived:
    """A number that follows from the free ones: its half-width at 95 %, infinite where the data do not determine it."""

    name: str
    unit: str
    value: float
    half: float


@attrs.frozen(eq=False, repr=False)
class Fitted(Answer):
    """Free numbers of a scene or a linear model by measured data.

    Attributes
    ----------
    title : of the scene or the model;  source : of the data;  kind : "table", "rig" or "record"
    stated : whether errors of the data were stated; else their residuals determine them
    estimate : numbers, covariance, what is not determined;  series : data beside the fit;  derived : K and C of a rig
    notes : sentences that a reader of the numbers needs
    response : displacement over force over frequency, of a linear model in one direction

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"load.axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> fitted = rw.fit(data, "examples/b7206.toml", ["bearing.contact_angle_deg"])
    >>> round(fitted["bearing.contact_angle_deg"], 1)  # [deg]
    17.0
    """

    stem: ClassVar[str] = "fit"
    title: str
    source: str
    kind: str
    stated: bool
    estimate: Estimate
    series: tuple[Series, ...]
    derived: tuple[Derived, ...] = ()
    notes: tuple[str, ...] = ()
    response: FrequencyResponse | None = None

    @property
    def _numbers(self) -> dict[str, tuple[float, float, str]]:
        """Name -> value, half-width and unit, of free and of derived numbers."""
        free, answer = self.estimate.free, self.estimate
        rows = zip(free, answer.values, answer.half, strict=True)
        numbers = {key.name: (float(value), float(half), key.unit) for key, value, half in rows}
        return numbers | {number.name: (number.value, number.half, number.unit) for number in self.derived}

    def __getitem__(self, name: str) -> float:
        """A free number, in the unit of its key, or a derived one, in SI."""
        return self._numbers[member("name", name, self._numbers)][0]

    def half_width(self, name: str) -> float:
        """Half-width of its interval at 95 %; infinite where the data do not determine it."""
        return self._numbers[member("name", name, self._numbers)][1]

    @property
    def determined(self) -> bool:
        """Whether the data determine every free number."""
        return not self.estimate.undetermined

    @property
    def warnings(self) -> list[str]:
        """Sentences that a reader of the numbers needs."""
        answer, out = self.estimate, []
        for combination in answer.undetermined:
            parts = [f"{name} {by:+.3g} {self._numbers[name][2]}".rstrip() for name, by in combination.changes.items()]
            names, moves = " and ".join(combination.changes), f"moves them by {combination.moves:.2g} standard errors"
            together, remedy = "", "Do not free it"
            if len(parts) > 1:
                together, remedy = " together", "Free one of them less, or measure what separates them"
            out.append(f"the data do not determine {names}{together}: {' with '.join(parts)} {moves}. {remedy}")
        if answer.freedom == 0 and not np.isfinite(answer.half).all() and not answer.undetermined:
            out.append("as many data as free numbers, and no stated errors: no uncertainty can be estimated")
        beyond = "lies at the end of its range: the data require a value beyond the scene's rules"
        out += [f"{name} {beyond}" for name in answer.at_limit]
        if answer.widened > 1.0:
            effect = "intervals are widened by it, and the model or the stated errors are wrong"
            out.append(f"the model misses the data by {answer.widened:.2g} times their stated errors: {effect}")
        return [*out, *self.notes]

    @door
    def to_uff(self, path: Annotated[str | Path, PATH]) -> Path:
        """Write the measured receptance as a universal file (UFF type 58), for tools such as sdypy; of a linear model in one direction.

        Raises
        ------
        RacewayError
            Data without a frequency response, or pyuff is not installed.
        """
        if self.response is None or len(self.series) > 2:
            raise RacewayError("only a linear model in one direction has a frequency response: fit K, C or mass of one axis")
        return self.response.to_uff(path)

    def to_dict(self) -> Tables:
        """Plain tables, as in fit.json."""
        answer = self.estimate
        parts = [dict(zip(answer.parts, halves, strict=True)) for halves in np.array([*answer.parts.values()]).T.tolist()]
        free = [
            {
                "key": key.name, "unit": key.unit, "start": key.start, "value": float(value), "error": float(half),
                "low": float(value - half), "high": float(value + half), "determined": bool(np.isfinite(half)),
                "at_limit": key.name in answer.at_limit, "parts": causes,
            }
            for key, value, half, causes in zip(answer.free, answer.values, answer.half, parts, strict=True)
        ]  # fmt: skip
        content: Tables = {
            "title": self.title,
            "file": self.source,
            "kind": self.kind,
            "stated": self.stated,
            "confidence": CONFIDENCE,
            "free": free,
            "covariance": sum((shift.T @ shift for shift in answer.shifts.values()), answer.covariance).tolist(),
            "undetermined": [{"changes": c.changes, "moves_standard_errors": c.moves} for c in answer.undetermined],
            "derived": [attrs.asdict(number) for number in self.derived],
            "fit": {
                "data": int(answer.jacobian.shape[0]), "freedom": answer.freedom, "scatter": answer.scatter, "widened": answer.widened,
                "evaluations": answer.evaluations,
            },
            "series": [
                attrs.asdict(row, value_serializer=lambda _, __, v: v.tolist() if isinstance(v, np.ndarray) else v)
                for row in self.series
            ],
            "warnings": self.warnings,
        }  # fmt: skip
        return dict(without_nan(content))

    def draw(self) -> Figure:
        """Data, fit with its band, residuals, confidence region."""
        from raceway_measure.fit.picture import draw_fit

        return draw_fit(self.to_dict())

    def report(self) -> list[Part]:
        """Numbers with their intervals by cause; below, how well the model meets the data, and warnings."""
        estimate, starts, parts = self.estimate, {}, self.estimate.parts
        if self.kind != "record":
            starts = {key.name: number(key.start, key.unit, 6) for key in estimate.free}
        rows = []
        for k, (name, (value, half, unit)) in enumerate(self._numbers.items()):
            _, read, width = interval(name, value, half, unit)
            width = width.removesuffix(" at 95 %").replace("+-", "±")
            rows.append({"free": name, "from": starts.get(name, ""), "found": read, "at 95 %": width})
            if k < len(estimate.free) and len(parts) > 1 and np.isfinite(half):
                shares = sorted(((float(sizes[k]), cause) for cause, sizes in parts.items()), reverse=True)
                large = [f"{cause} {number(*read_in(size, unit), 2)}" for size, cause in shares if size > _SMALL * half]
                rows[-1]["of which"] = ", ".join(large)
        words = f"{len(estimate.residuals)} data, {len(estimate.free)} free, {estimate.evaluations} evaluations"
        if estimate.scatter is not None and self.kind != "record":
            of = "of the stated errors" if self.stated else "of the data"
            size = f"{estimate.scatter:.2g}" if self.stated else f"{100.0 * estimate.scatter:.2g} %"
            words += f"; residuals {size} {of}"
        table = rows_table(rows, f"{self.title}\nfitted to {self.source}")
        return [table, words, *(Words(text, "yellow") for text in self.warnings)]

    def _facts(self) -> tuple[str, list[Fact]]:
        facts = [interval(name, *numbers) for name, numbers in self._numbers.items()]
        title = f"Fitted to {self.source}\n{self.title.splitlines()[0]}"
        return title, [*facts, *(("warning", "", text) for text in self.warnings)]


def interval(name: str, value: float, half: float, unit: str, remark: str = "") -> Fact:
    """A number with its half-width at 95 %, in the unit in which people read it."""
    (value, word), size = read_in(value, unit), read_in(half, unit)[0]
    if not np.isfinite(half):
        return name, number(value, word, 4), "not determined"
    words = f"+- {number(size, word, 2)} at 95 %"
    return name, number_within(value, size, word), f"{words}; {remark}" if remark else words


def refuse_few(data: int, free: int, source: str) -> None:
    """``SceneError`` for fewer data than free numbers."""
    if data < free:
        few = f"{data} measured number{'s do' if data > 1 else ' does'} not determine {free} free numbers"
        raise SceneError.at(source, None, f"{few}: free fewer keys, or measure at more loads or speeds")
