"""``raceway.fit``: numbers of a scene or a linear model from measured data, and its answer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.framework.doors import door, member
from raceway.framework.registry import registry_with
from raceway.framework.shown import Fact, number, number_within
from raceway.out.answer import Answer, Part
from raceway.out.progress import ShowProgress, telling
from raceway.out.quantities import read_in
from raceway.out.table import rows_table
from raceway.out.wrapping import Words
from raceway.scene.inputs import SceneSource, as_scene
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables
from raceway.studies.fit.column_headers import quantity_of
from raceway.studies.fit.estimate import CONFIDENCE, Combination, Estimate
from raceway.studies.fit.signals import Data, headers_of, signals_of, table_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Part of a half-width below which a cause of it is not shown.
_SMALL = 0.02


@attrs.frozen(eq=False)
class Series:
    """One measured quantity beside the fit.

    Attributes
    ----------
    name, unit : of the quantity;  over, over_unit : of the abscissa
    x, measured, fitted : (n,)
    error : (n,) standard errors, by the residuals where none were stated
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
        answer = self.estimate
        out = [_sentence(combination, self._numbers) for combination in answer.undetermined]
        if answer.freedom == 0 and not np.isfinite(answer.half).all() and not answer.undetermined:
            out.append("as many data as free numbers, and no stated errors: nothing tells how well the numbers are known")
        out += [
            f"{name} lies at the end of its range: the data ask for more than the scene's rules allow"
            for name in answer.at_limit
        ]
        if answer.widened > 1.0:
            out.append(
                f"the model misses the data by {answer.widened:.2g} times their stated errors: intervals are that much wider, and the "
                "model or the errors are wrong"
            )
        return [*out, *self.notes]

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
            "covariance": sum((moved.T @ moved for moved in answer.shifts.values()), answer.covariance).tolist(),
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
        from raceway.studies.fit.picture import draw

        return draw(self.to_dict())

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

    def _shown(self) -> tuple[str, list[Fact]]:
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


def _sentence(combination: Combination, numbers: Mapping[str, tuple[float, float, str]]) -> str:
    """Changes that the data do not determine."""
    parts = [f"{name} {change:+.3g} {numbers[name][2]}".rstrip() for name, change in combination.changes.items()]
    names, moves = " and ".join(combination.changes), f"moves them by {combination.moves:.2g} standard errors"
    if len(parts) == 1:
        return f"the data do not determine {names}: {parts[0]} {moves}. Do not free it"
    remedy = "Free one of them less, or measure what tells them apart"
    return f"the data do not determine {names} together: {' with '.join(parts)} {moves}. {remedy}"


@door
def fit(
    data: Data,
    scene: SceneSource | None = None,
    free: Iterable[str] | str = (),
    *,
    mass: float | None = None,
    slow_roll: Data | None = None,
    run_out: tuple[float, float] | None = None,
    columns: Mapping[str, str] | None = None,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> Fitted:
    """Numbers of a scene from measured data, by least squares with the scene's exact derivatives.

    Parameters
    ----------
    data : CSV file, mapping of column headers to arrays (n,) or pandas.DataFrame: a table of measured quantities over keys of the scene,
        ``load.axial [N], K [N/um], K error [N/um]``, errors as half-widths at 95 %; or the signals of a rig that ``identify`` reads;
        or a record of force and displacement, ``time_s, force_n, x_um``, of one axis or two
    scene : Scene, path, TOML text or dict of tables; with a table ``rig`` for signals; None for a record of force and displacement
    free : keys such as "bearing.contact_angle_deg", a search begins at the scene's numbers; of a record "K", "C", "mass"
    mass : that moves with a record's displacement, where it is known [kg]; None: it is free
    slow_roll, run_out : of a rig's signals, as ``identify`` takes them
    columns : header -> the header that is meant, or "ignore"
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Fitted
        ``fitted[key]`` the number, ``fitted.half_width(key)`` that of its interval at 95 %, ``warnings`` what the data do not determine

    Raises
    ------
    SceneError
        The fault of data, keys or scene.
    ConvergenceError
        The scene has no answer where the search begins, or the search does not converge.

    Examples
    --------
    >>> import raceway as rw
    >>> data = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    >>> fitted = rw.fit(data, {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, "bearing.contact_angle_deg")
    >>> fitted.determined, fitted.estimate.freedom
    (True, 2)
    """
    from raceway.studies.fit.linear import fit_record
    from raceway.studies.fit.rig import fit_rig
    from raceway.studies.fit.synchronous import stated_run_out
    from raceway.studies.fit.table import fit_table, measurements_in

    names = [part for word in free for part in word.split(",")]
    registry, sloped = registry_with(plugins), slow_roll is not None or run_out is not None
    with telling(progress) as report:
        report("reading", 0, 2)
        over_time = any(quantity_of((columns or {}).get(text, text)) == "time" for text in headers_of(data, "data"))
        record = signals_of(data, columns) if over_time else None
        if record is not None and any(name.startswith("force") for name in record.columns):
            _refuse(
                scene is not None, "scene", "a record of force and displacement is fitted by a linear model: leave it out"
            )
            _refuse(sloped, "slow roll", "belongs to the signals of a rig, without a force")
            report("searching", 1, 2)
            return fit_record(record, names, mass)
        _refuse(mass is not None, "mass", "belongs to a record of force and displacement; a scene has its own")
        if scene is None:
            raise SceneError.at("scene", None, "is missing: give --scene, whose answers the data are fitted by")
        read = as_scene(scene, plugins=plugins)
        if record is not None:
            subtracted = stated_run_out(slow_roll, run_out, columns)
            report("searching", 1, 2)
            return fit_rig(record, read, names, registry, subtracted)
        _refuse(sloped, "slow roll", "belongs to the signals of a rig over time; the data are a table")
        measured = measurements_in(*table_of(data, "data", "measurement"), read, columns)
        report("searching", 1, 2)
        return fit_table(measured, read, names)


def refuse_few(data: int, free: int, source: str) -> None:
    """``SceneError`` for fewer data than free numbers."""
    if data < free:
        numbers = "1 measured number" if data == 1 else f"{data} measured numbers"
        message = f"{numbers} for {free} free ones: free fewer keys, or measure at more loads or speeds"
        raise SceneError.at(source, None, message)


def _refuse(wrong: bool, path: str, why: str) -> None:
    """``SceneError`` at an argument that does not belong to the data."""
    if wrong:
        raise SceneError.at(path, None, why)
