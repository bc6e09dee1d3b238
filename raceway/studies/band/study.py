"""The band of an answer over the tolerances of its scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import attrs
import numpy as np

from raceway.bodies.model import build_model
from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.registry import Registry
from raceway.framework.shown import Fact, Shown, number
from raceway.pipeline.gradient import UNITS, Gradients, definitions, described, values
from raceway.pipeline.result import without_nan, write_json
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import OnProgress
from raceway.planning.plan import make_plan
from raceway.scene.continuous import with_number
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.scene.tolerance import Tolerance
from raceway.storage.tables import Tables
from raceway.studies.band.sobol import Indices, design, indices
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, row_key

#: Samples of a piece of work, which is what a killed worker loses; limits of the band.
_CHUNK, _LIMITS = 256, (0.025, 0.975)
#: Bins of a histogram.
_BINS = 24
#: By so much a Sobol index of few samples may lie beyond 0 and 1 before that is told.
_ROUGH = 0.05


@attrs.frozen(eq=False, repr=False)
class Band(Shown):
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
        found = []
        if far:
            found.append(
                f"the nominal {', '.join(far)} lies outside the band: the answer jumps within the tolerances, to another motion or other "
                "contacts; raceway follow shows where"
            )
        shares = [one for some in (self.first, self.total) for name in some for one in some[name]]
        if any(abs(one - 0.5) > 0.5 + _ROUGH for one in shares):
            found.append(f"indices beyond 0 and 1 by more than {_ROUGH:g}: too few samples, take a larger --count")
        return found

    def _shown(self) -> tuple[str, list[Fact]]:
        rows = [
            (name, number(value, UNITS[name]), f"95 % of samples from {self.low[name]:.5g} to {self.high[name]:.5g}")
            for name, value in self.nominal.items()
        ]
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
            {"key": one.key.path, "value": one.key.value, "unit": one.key.unit, "low": one.low, "high": one.high}
            for one in self.tolerances
        ]
        content = {"title": self.title, "quantities": quantities, "tolerances": varied}
        return dict(
            without_nan(
                content | {"samples": self.samples, "lost": self.lost, "why_lost": self.why, "remarks": self.remarks}
            )
        )

    def save(self, folder: Path) -> Path:
        """Write band.json.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        return write_json(self.to_dict(), folder / "band.json")

    def picture(self, folder: Path) -> Path:
        """Draw band.png: histograms with their limits, and Sobol indices.

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        from raceway.plugins.pictures import save_figure
        from raceway.studies.band.picture import draw

        return save_figure(draw(self.to_dict()), folder / "band.png", 100)


def band_of(
    scene: Scene,
    tolerances: Sequence[Tolerance],
    count: int,
    seed: int,
    registry: Registry,
    processes: int = 0,
    kept: Path | None = None,
    plugins: Sequence[Path] = (),
    on_progress: OnProgress | None = None,
) -> Band:
    """The band by (d + 2) ``count`` samples, d the number of tolerances.

    Parameters
    ----------
    kept : file of finished chunks, read and added to

    Raises
    ------
    SceneError, ConvergenceError
        The scene itself has no answer.
    ConvergenceError
        No sample has one.
    """
    nominal, words = _answer(scene)
    unit = design(count, len(tolerances), seed)
    low, high = (np.array([getattr(one, end) for one in tolerances]) for end in ("low", "high"))
    numbers = low + unit * (high - low)
    paths = [one.key.path for one in tolerances]
    chunks = [numbers[k : k + _CHUNK] for k in range(0, len(numbers), _CHUNK)]
    key = row_key(scene, registry, f"band {paths} {low.tolist()} {high.tolist()} {count} {seed}")
    items = [Item(f"{key} {k}", "samples", (scene.source, paths, chunk.tolist())) for k, chunk in enumerate(chunks)]
    done, _ = work_through(sampled, items, RowStore(kept), local(registry, processes), registry, plugins, on_progress)
    rows = [row for chunk in done for row in chunk["rows"]]
    return _summary(scene.title, tuple(tolerances), nominal, words, rows, len(tolerances))


def sampled(given: tuple[Tables, list[str], list[list[float]]], registry: Registry) -> Tables:
    """Answers at some points: quantity -> number each, or the reason why there is none.

    A worker reads the scene itself: classes of one-off plug-ins can not be sent to it.
    """
    tables, paths, points = given
    scene = scene_from_dict(tables, registry)
    return {"rows": [_row(scene, paths, point) for point in points]}


def _row(scene: Scene, paths: list[str], point: list[float]) -> Tables:
    try:
        for path, value in zip(paths, point, strict=True):
            scene = with_number(scene, path, value)
        return dict(_answer(scene)[0])
    except (RacewayError, ValueError) as why:
        return {"why": str(why)}


def _answer(scene: Scene) -> tuple[dict[str, float], dict[str, str]]:
    """Numbers, and what they are."""
    model = build_model(scene, make_plan(scene))
    equilibrium = settle(model)
    return values(model, equilibrium, Gradients(model, equilibrium).orbit), definitions(model, equilibrium)


def _summary(
    title: str, tolerances: tuple[Tolerance, ...], nominal: dict[str, float], words: dict[str, str], rows: list[Tables], dimensions: int
) -> Band:  # fmt: skip
    lost = [row["why"] for row in rows if "why" in row]
    names = [name for name in nominal if all(name in row for row in rows if "why" not in row)]
    if len(lost) == len(rows):
        raise ConvergenceError(f"no sample has an answer: {lost[0]}")
    table = np.array([[row.get(name, np.nan) for row in rows] for name in names])
    ends = table[:, : 2 * (len(rows) // (dimensions + 2))]  # A and B: the rest repeats their numbers
    low, high = np.nanquantile(ends, _LIMITS, axis=1)
    first: dict[str, list[float]] = {}
    total: dict[str, list[float]] = {}
    if not lost:
        varied = [k for k in range(len(names)) if np.ptp(ends[k]) > 1e-9 * abs(nominal[names[k]])]
        found = indices(table[varied], dimensions) if varied else Indices(np.empty((0, 0)), np.empty((0, 0)))
        for place, k in enumerate(varied):
            first[names[k]], total[names[k]] = found.first[place].tolist(), found.total[place].tolist()
    return Band(
        title,
        tolerances,
        {name: nominal[name] for name in names},
        words,
        dict(zip(names, low.tolist(), strict=True)),
        dict(zip(names, high.tolist(), strict=True)),
        first,
        total,
        {name: _histogram(values) for name, values in zip(names, ends, strict=True)},
        len(rows),
        len(lost),
        lost[0] if lost else "",
    )


def _histogram(values: np.ndarray) -> tuple[list[float], list[int]]:
    counts, edges = np.histogram(values[np.isfinite(values)], _BINS)
    return edges.tolist(), counts.tolist()
