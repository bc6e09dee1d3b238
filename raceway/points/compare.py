"""One scene with some keys varied, for Python and the command line alike: ``raceway.compare``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Interrupted, Part
from raceway.answers.picture import draw_panels, given_axes, signed, within
from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import ENDS, K_ERROR, C, Quantity, Z, named
from raceway.answers.table import Words
from raceway.errors import RacewayError, SceneError
from raceway.framework.doors import KEY_VALUES, PATH, PATHS, door, member
from raceway.framework.loading.registry import Registry, registry_with
from raceway.framework.shown import Fact, number_within
from raceway.pipeline.run import run
from raceway.pipeline.uncertainty import interval
from raceway.planning.plan import make_plan
from raceway.plugins.formats import labelled_dataset
from raceway.points.axes import Axis, Vary, noun, places_of, points, shown
from raceway.points.base import axes_of, refuse_mistakes, tables_at
from raceway.points.dataset import axis_labels
from raceway.points.effects import MOVING, Findings, Row, enumeration, explain, in_few_words
from raceway.points.engine import Item, local, work_through
from raceway.points.plot import MOST_PANELS, comparison_panels
from raceway.points.store import row_key, tables_key, written
from raceway.points.workload import key_facts
from raceway.scene.scene import SceneSource, plain_tables, scene_from_dict
from raceway.scene.tables import AutoIntegrator
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

#: Differences that one sentence tells by themselves.
_FEW = 3


@attrs.frozen(eq=False, slots=False, repr=False)
class Comparison(Answer, Findings):
    """One scene with some keys varied: the numbers, their effects, and both in words.

    Attributes
    ----------
    title : of the scene;  axes : keys that were varied, with their values
    rows : one a run, ``point`` and ``result`` (content of result.json, or status and reason), the last axis running fastest
    effects, trends : of each key and of two together on K and |Z|;  words : all of it in sentences
    fault : why finished runs could not be stored

    Examples
    --------
    >>> import raceway as rw
    >>> force = {"kind": "bidirectional", "speed_rpm": 12000, "amplitude": "constant", "force": "100 N"}
    >>> scene = {"bearing": {"preset": "B7206C"}, "excitation": force, "integrator": {"kind": "quasi_static"}}
    >>> found = rw.compare(scene, {"load.axial": ["0.5 kN", "1 kN"]})
    >>> found.effects[0]["term"], round(found.effects[0]["percent"])  # of K [%]
    (('load.axial',), 26)
    """

    stem: ClassVar[str] = "compare"

    fault: RacewayError | None = None

    def failure(self) -> RacewayError | None:
        """Why finished runs could not be stored."""
        return self.fault

    @cached_property
    def words(self) -> list[str]:
        """The effects and trends, a sentence each."""
        return [*difference_words(self), *explain(self)]

    @cached_property
    def short_words(self) -> list[str]:
        """Those of the words that a screen shows."""
        return [*difference_words(self), *in_few_words(self)]

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
            equivalent_stiffness, its error and ends of its interval, dynamic_stiffness |Z| [N/m], equivalent_damping [N s/m], NaN where it is not
            resolved, and status, a dimension for each key

        Raises
        ------
        RacewayError
            xarray is missing.
        """
        keys = [axis.key for axis in self.axes]
        shape = tuple(len(axis.values) for axis in self.axes)
        moving = self.quantities is MOVING
        ends = {name: ENDS[name] for name in (("K_low", "K_high") if moving else ("kyy_low", "kyy_high"))}
        quantities = self.quantities | ends | (named(K_ERROR, C) if moving else {})
        numbers = {name: np.full(shape, np.nan) for name in quantities}
        status = np.full(shape, "waiting", dtype=object)
        for row in self.rows:
            entry = tuple(axis.values.index(row.point[axis.key]) for axis in self.axes)
            status[entry] = row.result["status"] if row.failed else "done"
            values = {name: row.value(name) for name in self.quantities}
            values |= {name: end.of(row.result) for name, end in ends.items()}
            if moving:
                z = values[Z.name] if row.estimated else None
                values |= {C.name: row.damping, K_ERROR.name: None if z is None else row.error * z}
            for name, value in values.items():
                numbers[name][entry] = np.nan if value is None else value
        variables = {name: (keys, values, quantities[name].labels) for name, values in numbers.items()}
        coordinates = {axis.key: (axis.key, axis_labels(axis.values)) for axis in self.axes}
        return labelled_dataset({**variables, "status": (keys, status)}, coordinates, {"title": self.title})

    @door
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
        name = next(iter(self.quantities)) if quantity is None else member("quantity", quantity, self.quantities)
        (panel,), axis = comparison_panels(self, self.quantities[name], 1)
        panel.draw(axes := given_axes(ax, 8.0, 5.0))
        if axis is not None:
            axes.legend(title=axis.label, frameon=False, fontsize=9)
        return axes

    def _facts(self) -> tuple[str, list[Fact]]:
        names, (first, about) = _short_names(self.axes), next(iter(self.quantities.items()))
        label = about.symbol
        changes: list[Fact] = []
        for effect in (effect for name, effect in self.terms if name == first):
            meaning = f"of {label} on average" if len(effect.term) == 1 else f"interaction on {label}"
            changes.append((" x ".join(names[key] for key in effect.term), f"{effect.percent:+.3g} %", meaning))
        runs = [(", ".join(f"{names[key]} {shown(row.point[key])}" for key in names), *_number_of(row)) for row in self.rows]
        words: Fact = ("words", "", f"{len(self.words)} sentences in .words")
        return f"{len(self.rows)} runs compared\n{self.title.splitlines()[0]}", [*changes[:3], words, *runs]

    def table(self) -> list[dict[str, str]]:
        """One row a run, as short text for a screen; a star marks what is unreliable, of which a sentence below says why."""
        names, texts = _short_names(self.axes), list[dict[str, str]]()
        quantities, first = self.quantities, next(iter(self.quantities.values()))
        for row in self.rows:
            text = {name: shown(row.point[key]) for key, name in names.items()}
            for name, about in quantities.items():
                value = row.value(name)
                told = row.result["status"] if row.failed else "" if value is None else f"{about.read(value):.3f}"
                text[f"{about.symbol} {about.read_unit}"] = f"{told}*" if row.doubt and value is not None else told
            text[f"{first.symbol} within"] = _within(row, first)
            if quantities is MOVING:
                text[f"{C.symbol} {C.unit}"] = row.damping_words
                text["error %"] = "" if row.value(Z.name) is None else f"{100.0 * row.error:.2g}"
            texts.append(text)
        return texts

    def draw(self) -> Figure:
        """K; of static scenes kxx, kyy and x."""
        quantities = [about for about in self.quantities.values() if about is not Z]
        parts = [comparison_panels(self, about) for about in quantities]
        rows, axis = [panels for panels, _ in parts], parts[0][1]
        rows = [sum(rows, [])] if len(rows[0]) == 1 else [row[k : k + 2] for row in rows for k in range(0, len(row), 2)]
        along = noun(places_of(self.varied or self.axes, MOST_PANELS)[0].key)
        title = f"{enumeration([about.symbol for about in quantities])} over {along}: {self.title}"
        return draw_panels(rows, title, "" if axis is None else axis.label)

    def report(self) -> Iterator[Part]:
        """The effects, the largest first, a line for each point, and the other words."""
        yield Words(self.title, "bold")
        yield from self.short_words[:1]
        yield self.table()
        yield from self.short_words[1:]
        yield Words("all quantities, courses and inertia in words: compare.json", "dim")


def difference_words(comparison: Findings) -> list[str]:
    """One sentence: by how many per cent curves of the picture differ from the first, and whether that is within their intervals."""
    about, pairs = next(iter(comparison.quantities.values())), dict[str, list[tuple[str, np.ndarray]]]()
    panels, axis = comparison_panels(comparison, about)
    for panel, line, base in ((one, line, line.base) for one in panels for line in one.curves):
        if axis is not None and base is not None and (known := np.isfinite(line.y) & np.isfinite(base.y)).any():
            value, first = line.label.partition(", ")[0], base.label.partition(", ")[0]
            what = "" if axis.key.endswith((".kind", ".preset")) else f"{noun(axis.key)} "
            numbers = np.array([[one.y, one.low, one.high] for one in (base, line)])[..., known]
            where = f" with {panel.title}" if panel.title else ""
            pairs.setdefault(f"{what}{value} against {first} {axis.unit}".rstrip(), []).append((where, numbers))
    if not pairs:
        return []
    along, text, every = places_of(comparison.varied, MOST_PANELS)[0], list[str](), list[np.ndarray]()
    for pair, parts in pairs.items():
        every.append(np.concatenate([numbers for _, numbers in parts], axis=2))
        spans = []
        for where, numbers in parts if len(parts) <= _FEW else [(f" over {len(parts)} settings", every[-1])]:
            changes = 100.0 * (numbers[1, 0] / numbers[0, 0] - 1.0)
            ends = sorted((changes.min(), changes.max()), reverse=bool(changes[0] > changes[-1]))
            spans.append(f"{' to '.join(dict.fromkeys(map(signed, ends)))} %{where}")
        text.append(f"{pair}: {about.symbol} {', '.join(spans)}")
    words = "; ".join(text)
    if along.numeric:
        words += f"{',' if len(panels) > 1 else ''} from {shown(min(along.values))} to {shown(max(along.values))} {along.unit}".rstrip()
    (base, base_low, base_high), (y, low, high) = np.concatenate(every, axis=2)
    if np.isfinite([low, high, base_low, base_high]).all():
        inside = np.array([(base_low <= y) & (y <= base_high), (low <= base) & (base <= high)])
        both = inside.all(axis=0)
        which = "both" if both.all() else "neither" if not inside.any() else f"both at {both.sum()} of {both.size} points"
        own, apart = within(curve for panel in panels for curve in panel.curves)
        words += f", within the uncertainty of {which} ({about.symbol} {own}); difference {apart}"
    return [f"{words}."]


def _number_of(row: Row) -> tuple[str, str]:
    """The first quantity with its error, and what is to be known of it."""
    name, about = next(iter(row.quantities.items()))
    value, z = row.value(name), row.value(Z.name)
    if value is None:
        return "-", row.doubt or ""
    doubt = f"; unreliable: {row.doubt}" if row.doubt else ""
    if z is None:
        return f"{about.symbol} {about.text(value, 4)}", f"{_within(row, about)}; {about.words}{doubt}"
    error, within = row.error * z, _within(row, about)
    words = f"numerical +- {about.text(error, 2)}" if row.estimated else "numerical error not known"
    number = number_within(about.read(value), about.read(error), about.read_unit)
    return f"{about.symbol} {number}", f"{within}; {words}{doubt}"


def _within(row: Row, about: Quantity) -> str:
    """The interval of a quantity; what distinguishes runs, whose unknowns are alike, is seen below it."""
    entry = (row.result.get("uncertainty") or {}).get(about.name)
    return interval(entry).partition(":")[0] if entry else ""


def _short_names(axes: tuple[Axis, ...]) -> dict[str, str]:
    """Key -> its last part, or the whole key where two axes share that part: a table has to fit a screen."""
    last = [axis.key.rpartition(".")[2] for axis in axes]
    return {axis.key: name if last.count(name) == 1 else axis.key for axis, name in zip(axes, last, strict=True)}


def _item(tables: ReadTables, registry: Registry) -> Item:
    try:
        key = row_key(scene_from_dict(tables, registry), registry, "compare")
    except SceneError:  # refused as it is run
        key = tables_key(tables, registry, "compare")
    return Item(key, "runs", tables)


def _by_one_method(
    scenes: list[Tables], registry: Registry, notes: list[str], results: Iterable[ReadTables] | None = None
) -> list[Tables]:
    """Tables of all points with the integrator that all can take, where planning chose several; the same list where it chose one.

    results : of the points that were run;  None: they are planned, and what is refused is so as it is run, too
    """
    methods = {(result.get("plan", {}).get("integrator") or {}).get("kind") for result in results or ()}
    for tables in scenes if results is None else ():
        with suppress(RacewayError):
            problem = make_plan(scene_from_dict(tables, registry)).problem
            methods |= {problem.integrator.kind} if problem.recorded else set()
    several = sorted(name for name in methods if name)
    automatic = all(tables.get("integrator", {}).get("kind", "auto") == "auto" for tables in scenes)
    if len(several) < 2 or not automatic:
        return scenes
    kind, kinds = AutoIntegrator.TRANSIENT, " at some points, ".join(several)
    notes.append(f"integrator.kind = 'auto' would be {kinds} at others: all points take '{kind}'")
    return [tables_at(tables, {"integrator.kind": kind}, registry) for tables in scenes]


def _result(tables: ReadTables, registry: Registry) -> Tables:
    try:
        return run(scene_from_dict(tables, registry), registry).to_dict()
    except RacewayError as error:
        return {"status": error.status, "reason": str(error)}


@door
def compare(
    scene: SceneSource,
    vary: Annotated[Vary, KEY_VALUES],
    *,
    out: Annotated[str | Path | None, PATH] = None,
    kept: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Comparison:
    """Vary keys of a scene, all others constant; report the effect of each key and of pairs.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    vary : key of the scene -> its values (list, array (n,), or the text "a,b,c" or "start:stop:count"); every combination is run
    out : folder in which finished runs are stored and reused, and compare.json is written; None: nothing is written
    kept : folder of the finished runs instead of ``out``
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Comparison
        ``rows`` with the numbers of each run, ``effects`` of each key and of two together, ``words`` that explain them

    Raises
    ------
    SceneError
        A mistake in the scene or in a value; nothing has been run.
    RacewayError
        A folder that cannot be written.
    Interrupted
        On Ctrl-C, with the finished runs; they are in ``out``, too.

    Notes
    -----
    A run that is refused or fails has a row with its reason, and the others go on.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "amplitude": "constant", "force": 100.0},
    ...     "integrator": {"kind": "quasi_static"},
    ... }
    >>> found = rw.compare(scene, {"supports.tilt": ["locked", "free"]})
    >>> (1e-6 * found.to_xarray().equivalent_stiffness).round(0).values.tolist()  # K [N/um]
    [236.0, 31.0]
    """
    registry, notes = registry_with(plugins), list[str]()
    folder = None if out is None else writable(Path(out))
    tables = plain_tables(scene, registry=registry)
    axes = axes_of(vary, tables, registry)
    title, places = refuse_mistakes(tables, axes, registry), list(points(axes))
    scenes = [tables_at(tables, point, registry, notes) for point in places]
    first = scene_from_dict(scenes[0], registry)
    axes = tuple(attrs.evolve(axis, unit=key_facts(first, axis.key)[0]) for axis in axes)
    scenes = _by_one_method(scenes, registry, notes)
    items = [_item(scene, registry) for scene in scenes]

    def comparison(results: Iterable[Tables]) -> Comparison:
        rows = tuple(Row(point, result) for point, result in zip(places, results, strict=True) if result)
        return Comparison(title, axes, rows, tuple(notes), store.fault)

    with telling(progress) as report, written(kept or folder) as store:
        try:
            results, _ = work_through(_result, items, store, local(registry, 0), registry, on_progress=report)
            alike = _by_one_method(scenes, registry, notes, results)
            if alike is not scenes:  # a steady orbit was not found, or is unstable
                items = [_item(scene, registry) for scene in alike]
                results, _ = work_through(_result, items, store, local(registry, 0), registry, on_progress=report)
        except KeyboardInterrupt as stop:
            partial = comparison(store.get(item.key).content for item in items)
            raise Interrupted(partial if partial.rows else None) from stop
        answer = comparison(results)
    if folder is not None:
        answer.save(folder)
    return answer
