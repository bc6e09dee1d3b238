"""Many points before any of them is computed: mistakes, the plug-ins and files that they use, size and cost."""

import hashlib
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.table import Row, Words, sections
from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.shown import duration
from raceway.planning.parts import START_S, slowness
from raceway.planning.plan import column_time, make_plan
from raceway.points.axes import Design
from raceway.points.base import Base
from raceway.points.engine import plugins_of
from raceway.points.function import BLOCK, Function
from raceway.points.store import Store, connected, exists, files_of
from raceway.scene.keys import continuous_keys
from raceway.scene.scene import Scene
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage.files import size_words
from raceway.storage.tables import Tables

_MOST_MISTAKES = 10


@attrs.frozen
class _Survey:
    """Requirements of a sweep."""

    scene: Scene  # at the first point
    used: frozenset[tuple[str, str]]  # (kind, name) of plug-ins
    files: dict[str, str]  # path -> hash of its content
    notes: tuple[str, ...]  # options that are left out where another kind does not know them


def survey(base: Base, design: Design) -> _Survey:
    """Check every value of a grid, each at the first values of the others, or every point of a list.

    SceneError: The scene's mistakes, and those of the values: an unknown key, a wrong type.  What only two values together make
        impossible is a failed point.
    """
    notes: list[str] = []
    first = base.scene_at(design.point(0), notes)
    plugins, files, mistakes = set(plugins_of(first)), set(files_of(first)), []
    numbers = {key.path for key in continuous_keys(first)} & {axis.key for axis in design.axes if axis.numeric}
    for where, axis_key, point in _others(design, numbers):
        try:
            scene = base.scene_at(point, notes)
        except SceneError as error:
            own = list[Mistake](error.mistakes if design.listed else ())
            # Of a grid those that the value makes by itself: of a swept key, or of its whole table where no other axis has a part.
            for mistake in () if design.listed else error.mistakes:
                if mistake.path in point:
                    own.append(mistake)
                elif [key for key in point if key.startswith(f"{mistake.path}.")] == [axis_key]:
                    own.append(Mistake(axis_key, point[axis_key], f"{mistake.path}: {mistake.message}"))
            mistakes += [Mistake(f"{where}{m.path}", m.value, m.message) for m in own]
            if len(mistakes) >= _MOST_MISTAKES:
                break
            continue
        plugins |= set(plugins_of(scene))
        files |= set(files_of(scene))
    if mistakes:
        raise SceneError(mistakes)
    paths = {name: Path(name) for name in sorted(files)}
    digests = {k: hashlib.sha256(p.read_bytes()).hexdigest()[:24] if p.is_file() else "missing" for k, p in paths.items()}
    return _Survey(first, frozenset(plugins), digests, tuple(notes))


def _others(design: Design, continuous: Collection[str]) -> Iterator[tuple[str, str, Tables]]:
    """(where, key that differs from the first point, point); of numbers at continuous keys the ends: rules are intervals."""
    first = design.point(0)
    ends = {a.key: (int(a.column.argmin()), int(a.column.argmax())) for a in design.axes if a.key in continuous}
    if design.listed:
        numbers = chain(*ends.values()) if len(ends) == len(design.axes) else range(design.size)
        yield from ((f"point {n + 1}: ", "", design.point(n)) for n in dict.fromkeys(numbers) if n)
        return
    for axis in design.axes:
        for n in ends.get(axis.key, range(len(axis.values))):
            if n:
                yield "", axis.key, {**first, axis.key: axis.values[n]}


def key_facts(scene: Scene, key: str) -> tuple[str, str]:
    """(unit, words) of a key of the scene; empty for one that declares none."""
    table, _, path = key.partition(".")
    names = path.split(".")
    parts: list[type | None] = [TABLES.get(table), type(getattr(scene, table, None))]
    if table in PLUGIN_TABLES and table in TABLES:
        frame = getattr(scene, table)
        slot = next(f.name for f in attrs.fields(type(frame)) if "plugin" in f.metadata)
        parts.append(type(getattr(frame, slot)))
    for cls in parts:
        holder = cls
        for name in names[:-1]:
            holder = type(getattr(getattr(scene, table), name, None)) if holder is not None else None
        field = attrs.fields_dict(holder).get(names[-1]) if holder is not None and attrs.has(holder) else None
        if field is not None:
            return str(field.metadata.get("unit", "")), str(field.metadata.get("help", ""))
    return "", ""


#: Least time of a run, an equilibrium with what is stated beside it, and time to store a number [s].
_RUN_S, _STORED_S = 2e-3, 0.5e-6
#: Memory of a process with its kernels; of a number while files are written, and on the disk, in both files [bytes].
_STARTED_BYTES, _HELD, _ON_DISK = 280 * 2**20, 23.0, 16.5


@attrs.frozen(eq=False, repr=False, slots=False)
class Workload(Answer):
    """What a command with many points would compute.

    points : in all, of which ``stored`` are finished and ``refused`` by rules;  ``looped`` : in compiled loops;  runs : one by one
    seconds : wall time, with compiled kernels in the cache;  at_most : whether it is an upper limit
    bytes : resident memory of a process at the peak;  disk_bytes : of what is written, without pictures
    noun : of a point;  why_runs : why no compiled loop computes them;  remarks : sentences below
    """

    stem: ClassVar[str] = "plan"
    title: str
    points: int
    seconds: float
    looped: int = 0
    runs: int = 0
    refused: int = 0
    stored: int = 0
    at_most: bool = False
    bytes: float = 0.0
    disk_bytes: float = 0.0
    noun: str = "points"
    why_runs: str = ""
    remarks: tuple[str, ...] = ()

    def to_dict(self) -> Tables:
        """All numbers; times in seconds, sizes in bytes."""
        return {
            "title": self.title,
            **{name: getattr(self, name) for name in ("points", "looped", "runs", "refused", "stored")},
            "predicted_wall_s": self.seconds,
            "predicted_at_most": self.at_most,
            "predicted_bytes": self.bytes or None,
            "predicted_disk_bytes": self.disk_bytes or None,
            "remarks": [*([f"runs: {self.why_runs}"] if self.runs and self.why_runs else []), *self.remarks],
        }

    def report(self) -> Iterator[Part]:
        """Size, memory and time, then how the points are computed."""
        most = "at most " if self.at_most else ""
        rows: list[Row] = [
            ("Size and cost, predicted", "", ""),
            (self.noun, f"{most}{self.points}", ""),
            ("wall time", f"{most}{duration(self.seconds)}", "with compiled kernels in the cache"),
            *([("memory", size_words(self.bytes), "at the peak")] if self.bytes else []),
            *([("on the disk", size_words(self.disk_bytes), "without pictures")] if self.disk_bytes else []),
            ("How they are computed", "", ""),
        ]
        ways = {"compiled loop": self.looped, "runs": self.runs, "refused": self.refused, "stored": self.stored}
        reasons = {"runs": self.why_runs, "refused": "by rules of the scene", "stored": "finished before"}
        taken = {name: count for name, count in ways.items() if count or name != "stored"}
        rows += [(name, f"{most if count else ''}{count}", reasons.get(name, "")) for name, count in taken.items()]
        yield Words(self.title, "bold")
        yield sections(rows)
        yield from self.remarks


def run_times(count: int, scene_at: Callable[[int], Scene], planned: int = 100) -> tuple[float, int]:
    """Predicted time of runs, one after another in a process [s], and how many of them rules refuse: of so many ``planned`` ones."""
    seconds, refusals, bodies = 0.0, 0, dict[str, float]()
    looked_at = np.unique(np.linspace(0, count - 1, min(count, planned)).astype(int)).tolist()
    for number in looked_at:
        try:
            plan = make_plan(scene := scene_at(number))
        except RacewayError:
            refusals += 1
            continue
        bodies[scene.bodies.name] = max(plan.predicted_once_s, bodies.get(scene.bodies.name, 0.0))
        seconds += max(plan.predicted_wall_s - plan.predicted_once_s, _RUN_S)
    share = count / max(len(looked_at), 1)
    return seconds * share + sum(bodies.values()), round(refusals * share)


def of_columns(
    title: str, function: Function, points: int, stored: int = 0, numbers: int = 0, noun: str = "points"
) -> Workload:
    """Points of a compiled loop, of each of which so many ``numbers`` are stored."""
    left = points - stored
    threads = max(min(function.threads, -(-left // BLOCK[function.moving])), 1)
    each = column_time(make_plan(function.scene), function.moving) / threads + slowness() * _STORED_S * numbers
    remarks = "Points without a regular solution in the loop are run in addition, as raceway plan SCENE predicts each."
    return Workload(
        title, points, slowness() * START_S + left * each, looped=left, stored=stored, noun=noun, remarks=(remarks,),
        bytes=(_STARTED_BYTES + _HELD * numbers * points) * bool(numbers), disk_bytes=_ON_DISK * numbers * points,
    )  # fmt: skip


def stored_rows(folder: Path | None, keys: Iterable[str]) -> int:
    """How many of a study's rows its folder holds."""
    if folder is None or not exists(folder):
        return 0
    with closing(connected(folder)) as connection:
        return len(Store(folder, connection).keys("done") & set(keys))
