"""``raceway stability``: stiff and extreme cases, each with an expectation, over all laws and transient integrators.

A case writes rows: a number beside its limit, or a message that must come.
"""

from __future__ import annotations

import math
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway import Answer, RacewayError, SceneError, scene_from_dict
from raceway.extend import (
    Fact, Item, Part, ReadTables, Registry, Store, Tables, Words, local, micro, nearest, program_key,
    registry_with, tables_key, work_through, written,
)  # fmt: skip
from raceway_checks.clocks import processor_time
from raceway_checks.stability.catalogue import Case, catalogue

if TYPE_CHECKING:
    from raceway.extend import OnProgress

AS_EXPECTED, FAILED = "as expected", "failed"
PROCESSES = 2
#: A case that takes longer has hung [s].  The longest takes 20 s, and compiling for the first time on busy cores some minutes.
_PATIENCE_S = 900.0
#: Of a message in a table [characters].
_LONGEST = 200
#: A value, or a value and the drift of the energy.
Measured = float | tuple[float, float | None]


@attrs.frozen
class _Row:
    """One line of the report."""

    case: str
    setting: Mapping[str, object]  # integrator, law, step, what else was varied
    quantity: str  # what ``predicted`` and ``observed`` are, with the unit
    expected: str  # the expectation in words, its bound in it
    predicted: float | None
    observed: float | None
    energy_drift: float | None  # change of the energy over the motion's energy; None where it is not balanced
    verdict: str
    reason: str  # why the bound is what it is
    note: str = ""  # why the row failed, or what one should know


@attrs.frozen
class Limit:
    """Bounds of a number, in words too; ``near``: the value that it is expected to equal."""

    words: str
    least: float = -math.inf
    most: float = math.inf
    near: float | None = None

    @classmethod
    def equal(cls, near: float, within: float) -> Limit:
        """A value, relatively ``within``."""
        return cls(f"equal within {within:.2g}", near - within * abs(near), near + within * abs(near), near)

    @classmethod
    def at_most(cls, most: float) -> Limit:
        return cls(f"at most {most:.3g}", most=most)

    @classmethod
    def at_least(cls, least: float) -> Limit:
        return cls(f"at least {least:.3g}", least)


@attrs.frozen
class Rows:
    """What a case writes: its name, the setting of all its rows, the rows so far."""

    case: str
    setting: Mapping[str, object] = attrs.field(factory=dict)
    written: list[_Row] = attrs.field(factory=list)

    def check(
        self, quantity: str, value: Measured | Callable[[], Measured], why: str, limit: Limit, at: Mapping[str, object] | None = None, note: str = ""
    ) -> _Row:  # fmt: skip
        """A number against its limit; an error of a function, or no number, fails.

        why : the reason of the limit;  at : setting of this row alone
        """
        observation = drift = None
        try:
            outcome = value() if callable(value) else value
            observation, drift = outcome if isinstance(outcome, tuple) else (outcome, None)
            if not all(math.isfinite(number) for number in (observation, drift or 0.0)):
                note, observation, drift = f"not a number: {observation}, energy {drift}", None, None
        except RacewayError as error:
            note = f"refused, unexpectedly: {short(error)}"
        good = observation is not None and limit.least <= observation <= limit.most
        number = None if observation is None else float(observation)
        row = self._row(good, quantity, limit.words, why, note, at)
        self.written[-1] = attrs.evolve(row, predicted=limit.near, observed=number, energy_drift=drift)
        return self.written[-1]

    def refused(self, words: str, why: str, work: Callable[[], object], at: Mapping[str, object] | None = None) -> _Row:
        """What must be refused, with a message that holds ``words``."""
        good, note = False, "it was computed instead"
        try:
            work()
        except RacewayError as error:
            good, note = words in str(error), short(error)
        return self._row(good, "message", f"refused: '{words}'", why, note, at)

    def warned(self, words: str, why: str, warnings: Iterable[str]) -> _Row:
        """A warning that holds ``words``."""
        text = next((text for text in warnings if words in text), None)
        return self._row(text is not None, "warning", f"warned: '{words}'", why, text or "no such warning")

    def lost(self, why: str, at: Mapping[str, object] | None = None) -> _Row:
        """A case, or a part of it, that ended without an answer."""
        return self._row(False, "answer", "an answer or a refusal", "", why, at)

    def _row(
        self, good: bool, quantity: str, expectation: str, why: str, note: str = "", at: Mapping[str, object] | None = None
    ) -> _Row:
        verdict = AS_EXPECTED if good else FAILED
        row = _Row(self.case, {**self.setting, **(at or {})}, quantity, expectation, None, None, None, verdict, why, note)
        self.written.append(row)
        return row


def short(error: BaseException) -> str:
    """The first line of a message, not too long for a table."""
    text = (str(error).splitlines() or [type(error).__name__])[0]
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


@attrs.frozen(eq=False, repr=False, slots=False)
class Stability(Answer):
    """Rows of a catalogue."""

    stem: ClassVar[str] = "stability"

    title: str
    rows: tuple[_Row, ...]
    cases: int  # how many were run or taken from what is stored
    left_out: int  # how many were not asked for
    reused: int  # how many of them were stored
    #: seconds, cpu_s : wall time; processor time of all processes, compiling too
    seconds: float
    cpu_s: float
    processes: int
    fault: RacewayError | None = None  # why rows could not be stored, or None
    by_row: bool = False  # whether a screen has a line for each row instead of each case

    @property
    def failed(self) -> tuple[_Row, ...]:
        return tuple(row for row in self.rows if row.verdict == FAILED)

    def to_dict(self) -> Tables:
        names = ("title", "cases", "left_out", "reused", "seconds", "cpu_s", "processes")
        plain = {name: getattr(self, name) for name in names}
        return {**plain, "failed": len(self.failed), "rows": [attrs.asdict(row) for row in self.rows]}

    @property
    def passed(self) -> bool:
        return not self.failed

    def failure(self) -> RacewayError | None:
        return self.fault

    def texts(self, pictures: bool) -> dict[str, str]:
        """The study as Markdown: what failed first, then a table for each case."""
        bad = [attrs.asdict(row) for row in self.failed]
        run = f"{self._count_words}, {self.seconds:.0f} s on {self.processes} processes ({self.reused} stored cases)"
        counts = f"{run}; {self.left_out} cases not asked for."
        lines = [f"# {self.title}", "", counts, *(["", "## Failed", "", *_case_table(bad)] if bad else [])]
        for name in dict.fromkeys(row.case for row in self.rows):
            lines += ["", f"## {name}", "", *_case_table(attrs.asdict(row) for row in self.rows if row.case == name)]
        return {"md": "\n".join(lines) + "\n"}

    @property
    def _count_words(self) -> str:
        return f"{len(self.rows) - len(self.failed)} of {len(self.rows)} rows as expected, {self.cases} cases"

    def _facts(self) -> tuple[str, list[Fact]]:
        bad: list[Fact] = [("failed", row.case, row.note or row.reason) for row in self.failed]
        return self.title, [("rows", "", self._count_words), *bad]

    def report(self) -> Iterator[Part]:
        """A line for each case, or for each row; what is not as expected in full."""
        yield Words(self.title, "bold")
        verdicts: dict[str, list[str]] = {}
        for row in self.rows:
            verdicts.setdefault(micro(row.case), []).append(row.verdict)
        yield (
            [_cells(row) for row in self.rows]
            if self.by_row
            else [
                {"case": case, "rows": str(len(of_case)), "as expected": str(of_case.count(AS_EXPECTED))}
                for case, of_case in verdicts.items()
            ]
        )
        for row in self.failed:
            cells = ", ".join(cell for name, cell in _cells(row).items() if cell and name != "verdict")
            yield Words(f"failed: {cells}. {row.note or row.reason}", "red")
        yield f"{self._count_words}{f', {self.reused} stored' if self.reused else ''}, {self.seconds:.0f} s"
        if self.left_out and not self.by_row:
            yield f"left out: {self.left_out} cases that take longer; --all runs them"


def _cells(row: _Row) -> dict[str, str]:
    setting = ", ".join(micro(f"{key} {value}") for key, value in row.setting.items())
    numbers = {name: _number_text(getattr(row, name)) for name in ("predicted", "observed")}
    words = {"case": micro(row.case), "setting": setting, "quantity": row.quantity, "expected": row.expected}
    return {**words, **numbers, "verdict": row.verdict}


def stability(
    scene: ReadTables | None = None, only: str | None = None, every: bool = False, processes: int = PROCESSES,
    *, kept: Path | None = None, plugins: Sequence[Path] = (), progress: OnProgress | None = None,
) -> Stability:  # fmt: skip
    """Run every law and transient integrator on stiff and extreme cases; exit code 1 when a case is not as expected.

    Without --only or --all the quick cases are run; with SCENE, the cases that apply to any scene. Writes stability.json and
    stability.md. Finished cases are stored in DIR/points.sqlite and reused.

    Parameters
    ----------
    scene : plain tables; the full catalogue when None
    only : cases whose name contains these words, row by row
    every : all cases (ten minutes), not only the quick ones
    processes : parallel processes; 0: this process, without a guard against hangs
    kept : folder that finished cases are stored in and taken from
    plugins : one-off plug-in files, which each process loads
    progress : called as ``progress(what, done, total)`` after each case; an exception stops the study

    Raises
    ------
    SceneError
        A name that no case has, or a scene that cannot be put through the catalogue.
    """
    start, cpu = time.monotonic(), processor_time()
    registry = registry_with(plugins)
    if scene is not None:
        scene_from_dict(scene, registry)  # mistakes are refused before anything is run
    cases = catalogue(registry, scene)
    subset = [case for case in cases if (case.quick or every if only is None else only in case.name)]
    if not subset:
        names = list(dict.fromkeys(case.name for case in cases))
        raise SceneError.at("only", only, f"no case is called so{nearest(only or '', names)}; cases: {'; '.join(names)}")
    with written(kept) as store:
        rows, reused = measured(subset, processes, registry, store, plugins, progress)
    title = "Stiff and extreme cases" if scene is None else f"Stiff and extreme cases of {scene.get('title', 'the scene')}"
    seconds, left_out = (time.monotonic() - start, processor_time() - cpu), len(cases) - len(subset)
    return Stability(title, tuple(rows), len(subset), left_out, reused, *seconds, processes, store.fault, only is not None)


def measured(
    cases: Sequence[Case], processes: int, registry: Registry, store: Store, plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None, patience: float = _PATIENCE_S,
) -> tuple[list[_Row], int]:  # fmt: skip
    """Rows of all cases, and how many cases were stored before; none can stop the others by hanging or dying.

    processes : how many work at a time; 0 works in this process, without guard against a hang
    patience : time after which a case of another process is given up [s]
    """
    program = program_key(registry)
    items = [Item(tables_key(attrs.asdict(case), registry, program=program), case.name, case) for case in cases]
    executor = local(registry, processes, **({"patience": patience} if processes else {}))
    answers, reused = work_through(
        _case_answer, items, store, executor, registry, plugins, on_progress,
        lambda item, reason: {"rows": [attrs.asdict(Rows(item.name, item.task.setting).lost(reason))]},
    )  # fmt: skip
    return [_Row(**row) for answer in answers for row in answer["rows"]], reused


def _case_answer(case: Case, registry: Registry) -> Tables:
    return {"rows": [attrs.asdict(row) for row in case_rows(case, registry)]}


def case_rows(case: Case, registry: Registry) -> list[_Row]:
    """The rows of a case; whatever its code raises becomes a failed row."""
    rows, (module, _, function) = Rows(case.name, case.setting), case.measure.partition(":")
    arguments, bench = dict(case.arguments), None
    try:
        if "tables" in arguments:
            from raceway_checks.stability.systems import Bench

            bench = Bench(arguments.pop("tables"), arguments.pop("changes", {}), registry)
        path = module if "." in module else f"raceway_checks.stability.{module}"
        getattr(import_module(path), function)(rows, bench, **arguments)
    except Exception as why:  # a traceback is what no case may end in: it is the finding
        last = traceback.extract_tb(why.__traceback__)[-1]
        rows.lost(f"{type(why).__name__} in {Path(last.filename).name}, line {last.lineno}: {short(why)}")
    return rows.written


def _case_table(rows: Iterable[Tables]) -> list[str]:
    lines = ["| setting | quantity | expected | predicted | observed | energy drift | verdict | why |", "|---" * 8 + "|"]
    for row in rows:
        setting = ", ".join(f"{key} {_number_text(value)}" for key, value in row["setting"].items()) or "-"
        numbers = [_number_text(row[name]) for name in ("predicted", "observed", "energy_drift")]
        why = "; ".join(text for text in (row["reason"], row["note"]) if text)
        cells = [setting, row["quantity"], row["expected"], *numbers, row["verdict"], why]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return lines


def _number_text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)
