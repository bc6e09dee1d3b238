"""Error against run time of a scene's settings, for Python and the command line alike: ``raceway.precision``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway import Answer, ConvergenceError, RacewayError, SceneError, at_least, door
from raceway.extend import (
    AXIAL_DISPLACEMENT, DURATION, Fact, KEY_VALUES, PATH, PATHS, PRECISION, Part, Registry, SceneSource,
    ShowProgress, Store, Tables, Vary, Words, Z_REAL, given_axes, labelled_dataset, member, parse_change,
    plain_tables, registry_with, resolve, shown, telling, tidy, writable, written,
)  # fmt: skip
from raceway_checks.precision.settings import (
    Design, Judged, Reference, Runner, Setting, SettingRun, distance, find_reference, main_size, make_design, minus,
    needs_motion, setting_at,
)  # fmt: skip
from raceway_checks.precision.timing import Measured, measured_once

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from raceway.extend import OnProgress

#: Of a row in precision.json, in its order.
_COLUMNS = (
    "family", "setting", "model", "value", "error", "at_bound", "order", "expected_order", "errors", "quantities", "time_s",
    "wall_s", "cpu_s", "compile_s", "steps", "status", "reason", "own_error", "reused", "base", "cost",
)  # fmt: skip
THRESHOLDS = (0.01, 0.001, 0.0001)
#: A reference counts as exact for rows whose error is this many times its bound.
EXACT = 10.0
#: Errors below this many times the reference's bound say nothing about an order.
_ORDER_MARGIN = 5.0
#: Axes along which errors have an order: the exponent of 1 / value (True) or of the value itself.
_LADDERS = {"integrator.steps_per_turn": True, "mesh.element_size": False}


@attrs.frozen(eq=False, slots=False, repr=False)
class Precision(Answer):
    """Findings of a precision study.

    Attributes
    ----------
    rows : a setting each, as it was run;  judged : the same beside their references
    references : by physics; ``base`` is the physics that the front and the other models refer to
    left_out : (family, values, reason) of the default design
    fault : why rows could not be stored on disk;  named_reference : whether the user named the reference

    Examples
    --------
    >>> import raceway as rw
    >>> force = {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3.2e-4}
    >>> scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000}, "rotor": {"mass": 2}, "excitation": force}
    >>> found = rw.precision(scene, {"integrator.steps_per_turn": [90]}, reference={"integrator.steps_per_turn": 720}, repeats=1)
    >>> found.to_xarray().error.item() < 1e-4  # of Z, relative
    True
    """

    stem: ClassVar[str] = "precision"

    title: str
    rows: tuple[SettingRun, ...]
    references: dict[str, Reference]
    base: str
    left_out: tuple[tuple[str, Tables, str], ...]
    notes: tuple[str, ...] = ()
    fault: RacewayError | None = None
    named_reference: bool = False

    @cached_property
    def judged(self) -> list[Judged]:
        """The rows beside the references of their physics."""
        rows: list[Judged] = [
            {**row, "value": None, "error": None, "errors": {}, "at_bound": False, "order": None} for row in self.rows
        ]
        for row in (row for row in rows if row["quantities"]):
            values, reference = row["quantities"], self.references[row["physics"]]
            row["value"] = main_size(values)
            if reference.values:
                apart = minus(values, reference.values)
                row["errors"] = {name: abs(share) for name, share in reference.relative(apart).items()}
                row["error"] = error = distance(apart) / reference.size
                row["at_bound"] = not error > EXACT * reference.bound
        # The order between each row and the next coarser one of its ladder.
        for key, inverse in _LADDERS.items():
            ladders: dict[str, list[int]] = {}  # finished rows that differ in this key only
            for index, row in enumerate(rows):
                value = row["setting"].get(key)
                if row["error"] and isinstance(value, int | float) and not isinstance(value, bool):
                    others_fixed = {name: number for name, number in row["setting"].items() if name != key}
                    ladders.setdefault(f"{row['family']} {others_fixed!r}", []).append(index)
            for places in ladders.values():
                places.sort(key=lambda k: rows[k]["setting"][key], reverse=not inverse)
                for coarse, fine in zip(places, places[1:], strict=False):
                    bound = _ORDER_MARGIN * self.references[rows[fine]["physics"]].bound
                    errors = [rows[k]["error"] or 0.0 for k in (coarse, fine)]
                    if min(errors) > bound:
                        ratio = rows[fine]["setting"][key] / rows[coarse]["setting"][key]
                        rows[fine]["order"] = math.log(errors[0] / errors[1]) / math.log(ratio if inverse else 1.0 / ratio)
        return rows

    def _timed(self, physics: str) -> list[tuple[float, float, int]]:
        """Time [s], error and place of the rows of a model that were judged."""
        return [
            (cost["time_s"], error, k)
            for k, row in enumerate(self.judged)
            if row["physics"] == physics and (error := row["error"]) is not None and (cost := row["cost"]) is not None
        ]

    def front(self, physics: str) -> list[int]:
        """Places of the rows that no other row of the same model beats in both error and run time, the fastest first.

        Errors below the reference's bound count as the bound: nobody knows which of them is smaller.
        """
        bound = self.references[member("physics", physics, self.references)].bound
        fastest, best = list[int](), math.inf
        for _, error, index in sorted((time, max(error, bound), k) for time, error, k in self._timed(physics)):
            if error < best:
                fastest.append(index)
                best = error
        return fastest

    @door
    def cheapest(self, physics: str) -> dict[str, int | None]:
        """For each threshold the place of the fastest row whose error, with the reference's bound, is below it."""
        rows, fastest = self._timed(physics), dict[str, int | None]()
        for threshold in THRESHOLDS:
            good = [(time, k) for time, error, k in rows if error + self.references[physics].bound <= threshold]
            fastest[f"{threshold:.10f}".rstrip("0")] = min(good)[1] if good else None
        return fastest

    @property
    def converged(self) -> bool:
        """Whether any row has an error below the coarsest threshold, or at least numbers where there is no reference."""
        bounds = {physics: reference.bound for physics, reference in self.references.items()}
        errors = [error + bounds[row["physics"]] for row in self.judged if (error := row["error"]) is not None]
        states = [row["status"] == "completed" for row in self.rows]
        return any(error <= THRESHOLDS[0] for error in errors) if errors else any(states)

    @property
    def models(self) -> list[Tables]:
        """Each model: what sets it apart, its reference, its difference from the base, its own front."""
        base = self.references[self.base]
        entries = []
        for physics, reference in self.references.items():
            rows = [row for row in self.rows if row["physics"] == physics]
            if not rows:
                continue
            apart = minus(reference.values, base.values)
            comparable = Z_REAL.name in apart or (AXIAL_DISPLACEMENT.name in apart and Z_REAL.name not in base.values)
            entries.append({
                "model": rows[0]["model"],
                "base": physics == self.base,
                "reference": _reference_table(reference),
                "difference": distance(apart) / base.size if comparable else None,
                "differences": base.relative(apart),
                "front": self.front(physics),
                "cheapest": self.cheapest(physics),
            })  # fmt: skip
        return entries

    @cached_property
    def words(self) -> list[str]:
        """The reference, the cheapest settings and the models' differences, a sentence each."""
        reference = self.references[self.base]
        lines = [f"reference: {reference.how}; relative bound {reference.bound:.1g}"]
        at_bound = [row for row in self.judged if row["at_bound"] and row["physics"] == self.base]
        if at_bound:
            lines.append(
                f"the reference is not {EXACT:g} times more accurate than {len(at_bound)} of the rows (marked ~): their errors "
                "are known to its bound only, and so is the front there"
            )
        for threshold, index in self.cheapest(self.base).items():
            percent = f"{100.0 * float(threshold):g} %"
            if index is None:
                lines.append(f"no setting is known to be within {percent}")
            else:
                row = self.judged[index]
                lines.append(f"cheapest within {percent}: {_words_of(row['setting'])} ({_time_of(row)})")
        for model in self.models:
            if not model["base"] and model["difference"] is not None:
                lines.append(f"model error: {_words_of(model['model'])} differs by {100.0 * model['difference']:.2g} %")
        return [*lines, *self.notes]

    def to_dict(self) -> Tables:
        """Everything, as plain tables for JSON."""
        rows = list[Tables]()
        for row in self.judged:
            known: Tables = {**(row["cost"] or {}), **row, "base": row["physics"] == self.base}
            rows.append({name: known.get(name) for name in _COLUMNS})
        return {
            "title": self.title,
            "reference": _reference_table(self.references[self.base]),
            "rows": rows,
            "front": self.front(self.base),
            "cheapest": self.cheapest(self.base),
            "models": self.models,
            "left_out": [{"family": f, "setting": v, "why": why} for f, v, why in self.left_out],
            "words": self.words,
        }

    def to_xarray(self) -> Dataset:
        """Error, time [s] and size of Z [N/m] of every setting, over ``setting``, its words.

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        rows = self.to_dict()["rows"]
        variables = {
            quantity.name: ("setting", np.array([row[quantity.name] for row in rows], dtype=float), quantity.labels)
            for quantity in PRECISION
        }
        names = np.array([text["setting"].lstrip("* ") for text in self.table()], dtype=object)
        more = {name: ("setting", np.array([row[name] for row in rows], dtype=object)) for name in ("family", "status")}
        return labelled_dataset({**variables, **more}, {"setting": names}, {"title": self.title})

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw relative error over the run's time [s], with the front of what no other setting beats.

        Parameters
        ----------
        ax : matplotlib axes; new ones without

        Raises
        ------
        RacewayError
            matplotlib is missing.
        """
        from raceway_checks.precision.picture import draw_on, put_beside

        panel = given_axes(ax, 9.0, 6.0)
        labels = draw_on(panel, self.to_dict())
        panel.legend(frameon=False, fontsize=8)
        put_beside(panel, labels)
        return panel

    def _facts(self) -> tuple[str, list[Fact]]:
        reference = self.references[self.base]
        facts: list[Fact] = [("reference", f"{reference.bound:.1g}", f"relative bound; {reference.how}")]
        for threshold, index in self.cheapest(self.base).items():
            row = None if index is None else self.judged[index]
            value = "none" if row is None else _time_of(row)
            words = "" if row is None else _words_of(row["setting"])
            facts.append((f"cheapest within {100.0 * float(threshold):g} %", value, words))
        marks = dict.fromkeys(self.front(self.base), "on the front, ")
        rows = [
            (_words_of(row["setting"]), _error_of(row) or "-", f"{marks.get(index, '')}{_time_of(row)}")
            for index, row in enumerate(self.judged)
        ]
        return f"Error against run time of {len(self.rows)} settings\n{self.title.splitlines()[0]}", [*facts, *rows]

    def table(self) -> list[dict[str, str]]:
        """One line a row, as short text for a screen."""
        front, texts = set(self.front(self.base)), list[dict[str, str]]()
        for index, row in enumerate(self.judged):
            cost = row["cost"]
            text = {"setting": ("* " if index in front else "  ") + _words_of(row["setting"]), "error": _error_of(row)}
            text["own estimate"] = "" if row["own_error"] is None else f"{row['own_error']:.1e}"
            text["order"] = "" if row["order"] is None else f"{row['order']:.2f}"
            for name, key in (("wall ms", "wall_s"), ("cpu ms", "cpu_s")):
                text[name] = "" if cost is None else f"{1e3 * cost[key]:.1f}"
            text["steps"] = "" if cost is None else str(cost["steps"])
            texts.append(text | {"status": "" if row["status"] == "completed" else row["status"]})
        return texts

    def texts(self, pictures: bool) -> dict[str, str]:
        """precision.md."""
        from raceway_checks.precision.picture import page

        return {"md": page(self.to_dict(), pictures)}

    def draw(self) -> Figure:
        """Error against run time."""
        from raceway_checks.precision.picture import draw

        return draw(self.to_dict())

    def report(self) -> Iterator[Part]:
        """A line for each setting, and what they come to in words."""
        rows = self.table()
        yield Words(self.title, "bold")
        # A column of blanks would cost the settings their room.
        yield [{name: row[name] for name in rows[0] if any(each[name] for each in rows)} for row in rows]
        yield Words("* on the front; ~ known to the reference's bound only", "dim")
        yield from self.words

    def failure(self) -> RacewayError | None:
        """Rows that could not be stored, a reference that is no better than they are, or no row that converged."""
        if self.fault is not None:
            return self.fault
        rows = self.judged
        errors = [row for row in rows if row["error"] is not None]
        if self.named_reference and errors and all(row["at_bound"] for row in errors):
            message = "is not more accurate than the rows: refine it, or omit it for an automatic one"
            return SceneError.at("reference", None, message)
        if self.converged:
            return None
        reasons = [row["reason"] for row in rows if row["reason"]]
        why = f"; the first reason: {reasons[0]}" if reasons else ": all errors are above 1 %"
        return ConvergenceError(f"no setting converged{why}")


def _reference_table(reference: Reference) -> Tables:
    exists = bool(reference.values)
    return {
        "value": reference.size if exists else None,
        "error": reference.bound if exists and math.isfinite(reference.bound) else None,
        "how": reference.how,
        "quantities": {
            name: {"value": value, "error": bound if math.isfinite(bound := reference.bounds[name]) else None}
            for name, value in reference.values.items()
        },
    }


def _time_of(row: Judged) -> str:
    return row["status"] if row["cost"] is None else f"{1e3 * row['cost']['time_s']:.3g} ms"


def _error_of(row: Judged) -> str:
    """With a mark where it is known to the reference's bound only; empty where there is none."""
    return "" if row["error"] is None else f"{'~' if row['at_bound'] else ''}{row['error']:.1e}"


def _words_of(setting: Tables) -> str:
    """A setting for people: the keys' last parts, or what kind of table it is."""

    def word(key: str, value: object) -> str:
        table, _, last = key.rpartition(".")
        if key == "inertia":
            return "without inertia"
        return f"{table} {shown(value)}" if last == "kind" else f"{last} {shown(value)}"

    return ", ".join(word(key, value) for key, value in setting.items()) or "the scene itself"


#: Runs of each setting, and the longest predicted run [s].
REPEATS = 3
_LIMIT_S = 30.0


def _study(
    design: Design, reference: Tables, repeats: int, limit_s: float, store: Store, registry: Registry, report: OnProgress
) -> Precision:
    """Every setting run, then the reference of each physics."""
    groups: dict[str, list[Setting]] = {}
    for setting in design.settings:
        if setting.scene is not None:
            groups.setdefault(setting.physics, []).append(setting)
    total = len(design.settings) + len(groups)
    results, references = list[SettingRun](), dict[str, Reference]()

    def tell(label: str) -> None:
        report(label, len(results) + len(references), total)

    for setting in design.settings:
        tell(_words_of(setting.values))
        row: Measured = {"status": "refused", "reason": setting.reason, "quantities": {}, "own_error": None, "cost": None}
        order, is_old = None, False
        if setting.scene is not None:
            method = resolve(setting.scene).integrator.method
            order = method.order if needs_motion(setting.scene) and method.inertial else None
            row, is_old = measured_once(setting.scene, repeats, repeats, registry, store)
        results.append(
            {
                "family": setting.family, "model": setting.model, "physics": setting.physics, "setting": setting.values,
                "expected_order": order, **row, "reused": is_old,
            }
        )  # fmt: skip
    runner = Runner(registry, store, limit_s, tell)
    for physics, group in groups.items():
        references[physics] = find_reference(group, runner, reference)
    references = {design.base: Reference({}, {}, "no setting could be run")} | references
    return Precision(
        design.title, tuple(results), references, design.base, design.left_out, design.notes, store.fault, bool(reference)
    )


@door
def precision(
    scene: SceneSource,
    vary: Annotated[Vary | None, KEY_VALUES] = None,
    *,
    reference: Annotated[Vary, KEY_VALUES] = (),
    repeats: Annotated[int, at_least(1)] = REPEATS,
    limit_s: Annotated[float, DURATION] = _LIMIT_S,
    out: Annotated[str | Path | None, PATH] = None,
    kept: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Precision:
    """Run a scene with many numerical settings; report run time and error of each against a reference with a known bound.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    vary : key of the scene -> its values, whose combinations are run; None: a design made for the scene
    reference : key -> value of the reference; None: chosen automatically
    repeats : runs per setting; the fastest is reported
    limit_s : settings that are predicted to take longer are left out [s]
    out : folder in which finished rows are stored and reused, and precision.json and .md are written; None: nothing is written
    kept : folder of the finished rows instead of ``out``
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Precision
        ``judged`` rows with error and time [s], the ``front`` of those that no other beats, the ``cheapest`` within an error

    Raises
    ------
    SceneError
        A mistake in the scene, a value or the reference; nothing has been run.
    RacewayError
        A folder that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3.2e-4},
    ...     "rotor": {"mass": 2.0},
    ... }
    >>> found = rw.precision(scene, {"integrator.steps_per_turn": [45, 90]}, reference={"integrator.steps_per_turn": 720}, repeats=1)
    >>> found.judged[1]["error"] < found.judged[0]["error"]
    True
    """
    registry = registry_with(plugins)
    folder = None if out is None else writable(Path(out))
    design = make_design(plain_tables(scene, registry=registry), vary or (), limit_s, registry)
    # What the user names is checked with the first setting that can run.
    reference_changes = tidy(reference) if isinstance(reference, Mapping) else dict(parse_change(text) for text in reference)
    first = next((setting for setting in design.settings if setting.scene is not None), None)
    if reference_changes and first is not None:
        trial = setting_at(first.tables, "reference", reference_changes, registry)
        if trial.scene is None:
            raise SceneError.at("reference", None, trial.reason)
    with telling(progress) as report, written(kept or folder) as store:
        study = _study(design, reference_changes, repeats, limit_s, store, registry, report)
    if folder is not None:
        study.save(folder)
    return study
