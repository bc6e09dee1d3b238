"""The band of a scene, for Python: ``raceway.band``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.picture import MOST_COLUMNS, label_axes, new_figure, wrapped
from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import Z_IMAG, Z_REAL, C, quantity_of, read_in
from raceway.answers.table import Words
from raceway.bodies.model import build_model
from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.doors import KEY_VALUES, PATH, PATHS, TEXTS, door
from raceway.framework.loading.registry import Registry, default_registry
from raceway.framework.options import at_least
from raceway.framework.shown import Fact, number
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.first_order import definitions, described, resolved, values
from raceway.pipeline.gradient import Gradients
from raceway.pipeline.quantities import stated_quantities
from raceway.pipeline.run import run, steady_plan
from raceway.planning.plan import make_plan
from raceway.points.column_quantities import stated_columns
from raceway.points.engine import Item, local, work_through
from raceway.points.function import function
from raceway.points.sensitivities import Indices, Sensitivities, design, indices, sensitivities
from raceway.points.store import row_key, written
from raceway.points.workload import Workload, of_columns, run_times
from raceway.scene.inputs import without
from raceway.scene.keys import continuous_keys, with_number
from raceway.scene.scene import Scene, SceneSource, as_scene, scene_from_dict
from raceway.scene.tolerance import Tolerance, stated_tolerances, tolerances_of
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SAMPLES, _LIMIT_COLOUR, _TOTAL, _FIRST = "#b9c9da", "#0b5fa5", "#b9c9da", "#0b5fa5"

#: Samples of a piece of work, which is what a killed worker loses; limits of the band.
_CHUNK, _LIMITS = 256, (0.025, 0.975)
#: Derivatives by all keys, over a run; least time of a run [s].
_DERIVATIVES, _RUN_S = 3.5, 2e-3
#: Bins of a histogram.
_BINS = 24
#: By so much a Sobol index of few samples may lie beyond 0 and 1 before that is told.
_ROUGH = 0.05


@attrs.frozen(eq=False, repr=False)
class Band(Answer):
    """95 % of the samples of each quantity, and what causes their spread.

    Attributes
    ----------
    nominal, low, high : quantity -> number, SI;  definitions : quantity -> what it is, at the nominal;  tolerances : what was varied
    first, total : quantity -> Sobol indices (d,) of the tolerances
    histograms : quantity -> edges of bins (b + 1,), SI, and samples in them (b,)
    samples : that were computed;  lost : of them without an answer;  why : of the first of these

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.band({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}, ["load.axial=±10 %"], count=4)
    >>> found.samples, found.lost
    (12, 0)
    """

    stem: ClassVar[str] = "band"

    title: str
    tolerances: tuple[Tolerance, ...]
    nominal: dict[str, float]
    definitions: dict[str, str]
    low: dict[str, float]
    high: dict[str, float]
    first: dict[str, list[float]]
    total: dict[str, list[float]]
    histograms: dict[str, tuple[list[float], list[int]]]
    samples: int
    lost: int
    why: str

    @property
    def remarks(self) -> list[str]:
        """Where band or indices must not be taken at their word."""
        far = [name for name, value in self.nominal.items() if not self.low[name] <= value <= self.high[name]]
        sentences = []
        if far:
            sentences.append(
                f"the nominal {', '.join(far)} lies outside the band: the answer jumps within the tolerances to another motion or contact "
                "state; raceway follow shows where"
            )
        shares = [share for of in (self.first, self.total) for indices_of in of.values() for share in indices_of]
        if any(abs(share - 0.5) > 0.5 + _ROUGH for share in shares):
            sentences.append(f"indices beyond 0 and 1 by more than {_ROUGH:g}: too few samples, use more --samples")
        return sentences

    def _facts(self) -> tuple[str, list[Fact]]:
        words = {name: f"95 % of samples from {low:.5g} to {self.high[name]:.5g}" for name, low in self.low.items()}
        rows = [(name, number(value, quantity_of(name).unit), words[name]) for name, value in self.nominal.items()]
        return self.title, rows

    def to_dict(self) -> Tables:
        """Plain tables: quantities with their band and indices, tolerances, samples."""
        quantities = {
            name: {
                **described(name, value, self.definitions),
                "low": self.low[name],
                "high": self.high[name],
                "first_order": self.first.get(name),
                "total": self.total.get(name),
                "histogram": dict(zip(("edges", "counts"), self.histograms[name], strict=True)),
            }
            for name, value in self.nominal.items()
        }
        varied = [
            {"key": each.key.path, "value": each.key.value, "unit": each.key.unit, "low": each.low, "high": each.high}
            for each in self.tolerances
        ]
        content = {"title": self.title, "quantities": quantities, "tolerances": varied, "samples": self.samples}
        return dict(without_nan(content | {"lost": self.lost, "why_lost": self.why, "remarks": self.remarks}))

    def draw(self) -> Figure:
        """Histograms with their limits, and Sobol indices."""
        keys, with_indices = [tolerance.key.path for tolerance in self.tolerances], bool(self.total)
        heights = [2.2, 0.8 + 0.35 * len(keys)] if with_indices else [2.2]
        columns = min(len(self.nominal), MOST_COLUMNS)
        blocks = -(-len(self.nominal) // columns)
        figure = new_figure(1.2 + 2.9 * columns, 0.7 + (sum(heights) + 0.6 * len(heights)) * blocks)
        rows = figure.subplots(len(heights) * blocks, columns, squeeze=False, height_ratios=heights * blocks)
        for k, (name, nominal) in enumerate(self.nominal.items()):
            block, column = divmod(k, columns)
            axes = rows[len(heights) * block, column]
            ends, (bounds, counts) = (nominal, self.low[name], self.high[name]), self.histograms[name]
            (value, unit), (low, _), (high, _) = (read_in(end, quantity_of(name).unit) for end in ends)
            edges = [read_in(edge, quantity_of(name).unit)[0] for edge in bounds]
            axes.stairs(counts, edges, fill=True, color=_SAMPLES)
            for end, label in ((low, "95 % of samples"), (high, None)):
                axes.axvline(end, color=_LIMIT_COLOUR, linewidth=1.2, label=label)
            axes.axvline(value, color="#555f6b", linewidth=1.0, linestyle="--", label="nominal")
            words, samples = name.replace("_", " "), "samples" if column == 0 else ""
            label_axes(axes, f"{words}\n{low:.5g} to {high:.5g} {unit}", f"{words} [{unit}]", samples, 9.0)
            axes.locator_params(axis="x", nbins=4)
            if with_indices:
                panel = rows[2 * block + 1, column]
                places = np.arange(len(keys))
                panel.set(xlim=(0.0, 1.05), ylim=(len(keys) - 0.4, -0.6))
                panel.set_yticks(places, keys if column == 0 else [""] * len(keys), fontsize=8)
                label_axes(panel, "", "Sobol' index [-]", "", 9.0)
                # Estimates of small indices scatter about 0, those of a single cause about 1.
                none = np.zeros(len(keys))
                total, first = (np.clip(of.get(name, none), 0.0, 1.0) for of in (self.total, self.first))
                panel.barh(places, total, color=_TOTAL, height=0.7, label="total")
                panel.barh(places, first, color=_FIRST, height=0.3, label="first order")
        for panel in rows[-len(heights) :, len(self.nominal) - columns * (blocks - 1) :].flat:
            panel.set_visible(False)
        handles, labels = rows[0, 0].get_legend_handles_labels()
        if with_indices:
            handles, labels = (a + b for a, b in zip((handles, labels), rows[1, 0].get_legend_handles_labels(), strict=True))
        figure.legend(handles, labels, loc="outside lower right", ncols=4, fontsize=8, frameon=False)
        figure.suptitle(wrapped(self.title), fontsize=11)
        return figure

    def report(self) -> Iterator[Part]:
        """A line a quantity; below it the tolerances, the definitions, and the samples that have no answer."""
        yield Words(self.title, "italic")
        yield [self._row(name) for name in self.nominal]
        for tolerance in self.tolerances:
            (low, unit), (high, _) = (read_in(end, tolerance.key.unit) for end in (tolerance.low, tolerance.high))
            yield f"{tolerance.key.path}: {low:.6g} to {high:.6g} {unit}".rstrip()
        yield from (f"{name.replace('_', ' ')}: {self.definitions[name]}" for name in self.nominal)
        yield f"{self.samples} samples"
        if self.lost:
            yield f"{self.lost} have no answer, so that no indices are given: {self.why}"
        yield from (f"warning: {text}" for text in self.remarks)

    def _row(self, name: str) -> dict[str, str]:
        ends = (self.nominal[name], self.low[name], self.high[name])
        (value, unit), (low, _), (high, _) = (read_in(end, quantity_of(name).unit) for end in ends)
        row = {"quantity": f"{name.replace('_', ' ')} [{unit}]", "nominal": f"{value:.5g}"}
        row |= {"2.5 %": f"{low:.5g}", "97.5 %": f"{high:.5g}"}
        indices = self.total.get(name)
        return row | {
            f"total index, {tolerance.key.path}": "" if indices is None else f"{indices[k]:.3f}"
            for k, tolerance in enumerate(self.tolerances)
        }


def _loop_rows(scene: Scene, paths: Sequence[str], numbers: np.ndarray, nominal: Mapping[str, float]) -> list[Tables]:
    """Answers at points (n, d) as ``sampled`` gives them, from compiled loops; empty at points that these leave."""
    names = {symbol: quantity_of(symbol).name for symbol in nominal}
    outputs = list(names.values())
    if scene.excitation is not None:
        outputs += [Z_REAL.name, Z_IMAG.name]
        scene = _steady(scene)
    loop = function(scene, paths, outputs)
    if loop.why_slow:
        return [{}] * len(numbers)
    columns = loop.looped(dict(zip(paths, numbers.T.copy(), strict=True)))
    if C.symbol in nominal:
        columns[C.name][~resolved(columns[Z_REAL.name], columns[Z_IMAG.name])] = np.nan
    table = np.stack([columns[name] for name in names.values()], axis=1)
    return [{symbol: x for symbol, x in zip(names, row, strict=True) if np.isfinite(x)} for row in table.tolist()]


def sampled(task: tuple[Tables, Sequence[str], list[list[float]]], registry: Registry) -> Tables:
    """Answers at some points: quantity -> number each, or the reason why there is none.

    A worker reads the scene itself: classes of one-off plug-ins can not be sent to it.
    """
    tables, paths, points = task
    scene = scene_from_dict(tables, registry)
    return {"rows": [_row(scene, paths, point) for point in points]}


def _row(scene: Scene, paths: Sequence[str], point: list[float]) -> Tables:
    try:
        for path, value in zip(paths, point, strict=True):
            scene = with_number(scene, path, value)
        return dict(_scene_numbers(scene)[0])
    except (RacewayError, ValueError) as why:
        return {"why": str(why)}


def _scene_numbers(scene: Scene) -> tuple[dict[str, float], dict[str, str]]:
    """Numbers, and what they are; of plug-ins of quantities those with one number a point."""
    model = build_model(scene, steady_plan(scene))
    equilibrium = solve_equilibrium(model)
    numbers, words = values(model, equilibrium, Gradients(model, equilibrium).orbit), definitions(model, equilibrium)
    columns = stated_columns(scene, default_registry())
    moving = scene.excitation is not None
    at_scene = run(_steady(scene)).quantities if moving else stated_quantities(model, equilibrium, None).values
    numbers |= {name: float(at_scene[name]) for name in columns if name in at_scene and np.isfinite(at_scene[name])}
    return numbers, words | {name: quantity.words for name, quantity in columns.items()}


def _steady(scene: Scene) -> Scene:
    """The scene on its steady orbit: whatever its own integrator is, samples are such."""
    tables = {**without(scene.to_dict(), "identifier"), "integrator": {"kind": "periodic"}}
    return scene_from_dict(tables, default_registry())


def band_of_samples(
    title: str, tolerances: tuple[Tolerance, ...], nominal: dict[str, float], words: dict[str, str], rows: list[Tables], dimensions: int
) -> Band:  # fmt: skip
    reasons = [row["why"] for row in rows if "why" in row]
    names = [name for name in nominal if all(name in row for row in rows if "why" not in row)]
    if len(reasons) == len(rows):
        raise ConvergenceError(f"no sample has an answer: {reasons[0]}")
    table = np.array([[row.get(name, np.nan) for row in rows] for name in names])
    ends = table[:, : 2 * (len(rows) // (dimensions + 2))]  # A and B: the rest repeats their numbers
    low, high = np.nanquantile(ends, _LIMITS, axis=1)
    histograms = [np.histogram(values[np.isfinite(values)], _BINS) for values in ends]
    first: dict[str, list[float]] = {}
    total: dict[str, list[float]] = {}
    if not reasons:
        effective = [k for k in range(len(names)) if np.ptp(ends[k]) > 1e-9 * abs(nominal[names[k]])]
        sobol = indices(table[effective], dimensions) if effective else Indices(np.empty((0, 0)), np.empty((0, 0)))
        for row_of, k in enumerate(effective):
            first[names[k]], total[names[k]] = sobol.first[row_of].tolist(), sobol.total[row_of].tolist()
    return Band(
        title, tolerances, {name: nominal[name] for name in names}, words,
        dict(zip(names, low.tolist(), strict=True)), dict(zip(names, high.tolist(), strict=True)), first, total,
        {name: (edges.tolist(), counts.tolist()) for name, (counts, edges) in zip(names, histograms, strict=True)},
        len(rows), len(reasons), reasons[0] if reasons else "",
    )  # fmt: skip


@door
def band(
    scene: SceneSource,
    tolerances: Annotated[Mapping[str, str] | Iterable[str], KEY_VALUES] = (),
    *,
    count: Annotated[int, at_least(0)] = 512,
    seed: Annotated[int, at_least(0)] = 1,
    processes: Annotated[int, at_least(0)] = 0,
    kept: Annotated[str | Path | None, PATH] = None,
    progress: ShowProgress = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
) -> Band:
    """The range of stiffness, displacement and ball loads over tolerances of a scene, and which of them causes it.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    tolerances : key -> text, such as {"load.axial": "±10 %", "bearing.contact_angle_deg": "±1 deg"}; or texts KEY=TEXT; none: the
        scene's table [tolerances]
    count : n, a power of 2: (d + 2) n samples for d tolerances;  seed : of the samples
    processes : that work at a time on samples which compiled loops leave, see ``raceway.function``; 0: in this one
    kept : folder of finished samples of those, read and added to
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Band

    Raises
    ------
    SceneError
        With every mistake of the scene; a tolerance that is none.
    ConvergenceError
        The scene, or every sample of it, has no answer.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.band({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}, {"load.axial": "±10 %"}, count=64)
    >>> round((found.high["kxx"] / found.low["kxx"] - 1.0) * 100.0, 1)  # 95 % of an even 20 %, to a power near 1/2 [%]
    10.9
    """
    read = as_scene(scene, plugins=plugins)
    if count < 2 or count & (count - 1):
        why = "must be a power of 2, at least 2: the samples of a Sobol' sequence are balanced then"
        raise SceneError.at("samples", count, why)
    widths, registry = tolerances_of(read, tolerances or stated_tolerances(read)), default_registry()
    nominal, words = _scene_numbers(read)
    paths, low, high = zip(*((tolerance.key.path, tolerance.low, tolerance.high) for tolerance in widths), strict=True)
    numbers = np.array(low) + design(count, len(widths), seed) * np.subtract(high, low)
    rows = _loop_rows(read, paths, numbers, nominal)
    left = numbers[[not row for row in rows]]
    tasks = [(read.source, paths, left[k : k + _CHUNK].tolist()) for k in range(0, len(left), _CHUNK)]
    items = [Item(row_key(read, registry, f"band {task[1:]}"), "samples", task) for task in tasks]
    files = [Path(file) for file in plugins]
    with telling(progress) as report, written(kept) as store:
        chunk_rows, _ = work_through(sampled, items, store, local(registry, processes), registry, files, report)
    single = (row for chunk in chunk_rows for row in chunk["rows"])
    return band_of_samples(read.title, widths, nominal, words, [row or next(single) for row in rows], len(widths))


@door
def uncertainty(
    scene: SceneSource,
    tolerances: Annotated[Mapping[str, str] | Iterable[str], KEY_VALUES] = (),
    keys: Annotated[Iterable[str], TEXTS] = (),
    *,
    samples: Annotated[int, at_least(0)] = 0,
    seed: Annotated[int, at_least(0)] = 1,
    processes: Annotated[int, at_least(0)] = 0,
    plan: bool = False,
    kept: Annotated[str | Path | None, PATH] = None,
    progress: ShowProgress = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
) -> Band | Sensitivities | Workload:
    """How much the numbers and tolerances of a scene change its answer: K, C, stiffness, displacement and ball loads.

    First-order derivatives by every number and the 95 % band over the tolerances. With --samples the band of samples and its Sobol
    indices, for large tolerances, interactions and contacts that open.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    tolerances : as ``band`` takes them
    keys : to differentiate by; none: every number of the scene
    samples : n, a power of 2: (d + 2) n samples for d tolerances; 0: derivatives alone
    seed : of the samples;  processes : that work on samples at a time; 0: in this one
    plan : print how many samples or derivatives and how long, and stop
    kept : folder of finished samples, read and added to
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``
    plugins : files of one-off plug-ins that the scene uses

    Raises
    ------
    SceneError, ConvergenceError
        As ``band`` and ``sensitivities``.
    """
    if samples:
        if keys:
            why = "requests derivatives, which samples do not provide: omit it, or the samples"
            raise SceneError.at("keys", ", ".join(keys), why)
        if plan:
            read = as_scene(scene, plugins=plugins)
            widths = tolerances_of(read, tolerances or stated_tolerances(read))
            count, steady = (len(widths) + 2) * samples, read if read.excitation is None else _steady(read)
            loop = function(steady, [t.key.path for t in widths], ["K" if steady.excitation else "kyy"], threads=1)
            if loop.why_slow:
                seconds, _ = run_times(count, lambda _: steady, planned=1)
                return Workload(
                    read.title, count, seconds / max(processes, 1), runs=count, noun="samples", why_runs=loop.why_slow
                )
            return of_columns(read.title, loop, count, noun="samples")
        return band(
            scene, tolerances, count=samples, seed=seed, processes=processes, kept=kept, progress=progress, plugins=plugins
        )
    if plan:
        read = as_scene(scene, plugins=plugins)
        once, count = make_plan(read), len(tuple(keys)) or len(continuous_keys(read))
        seconds = once.predicted_once_s + _DERIVATIVES * max(once.predicted_wall_s - once.predicted_once_s, _RUN_S)
        return Workload(read.title, count, seconds, looped=count, noun="derivatives")
    return sensitivities(scene, keys, tolerances=tolerances, progress=progress, plugins=plugins)
