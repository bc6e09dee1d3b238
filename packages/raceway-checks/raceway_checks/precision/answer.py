"""Settings with their errors and run times: the front, the cheapest ones, orders; screen, files and pictures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np

from raceway import Answer, ConvergenceError, RacewayError, SceneError, door
from raceway.extend import (
    AXIAL_DISPLACEMENT, Fact, PRECISION, Part, Tables, Words, Z_REAL, given_axes, labelled_dataset, member, shown,
)  # fmt: skip
from raceway_checks.precision.settings import Judged, Reference, SettingRun, distance, main_size, minus

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

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
            bound = f"the reference is not {EXACT:g} times more accurate than {len(at_bound)} of the rows (marked ~)"
            lines.append(f"{bound}: their errors are known to its bound only, and so is the front there")
        for threshold, index in self.cheapest(self.base).items():
            percent = f"{100.0 * float(threshold):g} %"
            if index is None:
                lines.append(f"no setting is known to be within {percent}")
            else:
                row = self.judged[index]
                lines.append(f"cheapest within {percent}: {words_of(row['setting'])} ({_time_of(row)})")
        for model in self.models:
            if not model["base"] and model["difference"] is not None:
                lines.append(f"model error: {words_of(model['model'])} differs by {100.0 * model['difference']:.2g} %")
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
            words = "" if row is None else words_of(row["setting"])
            facts.append((f"cheapest within {100.0 * float(threshold):g} %", value, words))
        marks = dict.fromkeys(self.front(self.base), "on the front, ")
        rows = [
            (words_of(row["setting"]), _error_of(row) or "-", f"{marks.get(index, '')}{_time_of(row)}")
            for index, row in enumerate(self.judged)
        ]
        return f"Error against run time of {len(self.rows)} settings\n{self.title.splitlines()[0]}", [*facts, *rows]

    def table(self) -> list[dict[str, str]]:
        """One line a row, as short text for a screen."""
        front, texts = set(self.front(self.base)), list[dict[str, str]]()
        for index, row in enumerate(self.judged):
            cost = row["cost"]
            text = {"setting": ("* " if index in front else "  ") + words_of(row["setting"]), "error": _error_of(row)}
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


def words_of(setting: Tables) -> str:
    """A setting for people: the keys' last parts, or what kind of table it is."""

    def word(key: str, value: object) -> str:
        table, _, last = key.rpartition(".")
        if key == "inertia":
            return "without inertia"
        return f"{table} {shown(value)}" if last == "kind" else f"{last} {shown(value)}"

    return ", ".join(word(key, value) for key, value in setting.items()) or "the scene itself"
