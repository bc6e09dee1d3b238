"""Sensitivities of one scene, for Python: ``raceway.sensitivities``; Sobol indices of samples."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import attrs
import numpy as np

from raceway.answers.answer import Answer, Part
from raceway.answers.picture import MOST_COLUMNS, label_axes, new_figure, wrapped
from raceway.answers.progress import ShowProgress, telling
from raceway.answers.quantities import quantity_of, read_in
from raceway.answers.table import sections
from raceway.bodies.model import build_model
from raceway.core.jit import working_processor_time
from raceway.errors import Mistake, SceneError
from raceway.framework.doors import KEY_VALUES, PATHS, TEXTS, door, member
from raceway.framework.shown import Fact, number
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.first_order import definitions, derivatives, described, first_order_band, tolerance_rows, values
from raceway.pipeline.gradient import Gradient, Gradients, NoDerivative
from raceway.pipeline.run import steady_plan
from raceway.scene.keys import Key, continuous_keys, key_of
from raceway.scene.scene import SceneSource, as_scene
from raceway.storage.files import without_nan
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@attrs.frozen(eq=False)
class _Sensitivity:
    """Of all quantities to one key."""

    gradient: Gradient
    derivatives: dict[str, float]  # quantity -> derivative, in its unit over the key's
    #: quantity -> per cent by which it grows when the number at the key grows by one per cent; empty where that is 0
    influence: dict[str, float]

    @property
    def key(self) -> Key:
        return self.gradient.statics.key

    @property
    def remark(self) -> str:
        return self.gradient.statics.remark


@attrs.frozen(eq=False, repr=False)
class Sensitivities(Answer):
    """How much each number of a scene changes the answer; largest relative influence on the first quantity first.

    Attributes
    ----------
    values : quantity -> number, SI;  definitions : quantity -> what it is;  rows : of keys that change something
    without_effect : keys that change nothing;  refused : (key, why it has no derivative)
    run_s, gradients_s : processor time of equilibrium and orbit, and of all derivatives [s];  models : built for these, beside columns
    warnings : what to know of the answer itself
    tolerances : the band over the scene's tolerances to first order, as result.json has it; None without tolerances

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sensitivities({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
    >>> found.rows[0].key.path, len(found.rows[0].gradient.statics.displacement)
    ('bearing.conformity_inner', 5)
    """

    stem: ClassVar[str] = "sensitivities"

    title: str
    values: dict[str, float]
    definitions: dict[str, str]
    rows: tuple[_Sensitivity, ...]
    without_effect: tuple[Key, ...]
    refused: tuple[tuple[Key, str], ...]
    run_s: float
    gradients_s: float
    models: int
    warnings: tuple[str, ...] = ()
    tolerances: Tables | None = None

    def __getitem__(self, path: str) -> _Sensitivity:
        rows = {row.key.path: row for row in self.rows}
        return rows[member("path", path, rows)]

    def _facts(self) -> tuple[str, list[Fact]]:
        first = next(iter(self.values))
        facts = [
            (row.key.path, f"{row.influence[first]:+.3g} %" if row.influence else "", f"{row.derivatives[first]:.4g}")
            for row in self.rows
        ]
        head: Fact = (first, number(self.values[first], quantity_of(first).unit), "its change by 1 % of a key; derivative")
        return self.title, [head, *facts]

    def to_dict(self) -> Tables:
        """Plain tables: quantities, keys with all derivatives, keys without effect or derivative, cost."""
        return dict(without_nan({
            "title": self.title,
            "quantities": {n: described(n, value, self.definitions) for n, value in self.values.items()},
            "keys": [_table(row) for row in self.rows],
            "without_effect": [key.path for key in self.without_effect],
            "refused": [{"key": key.path, "value": key.value, "reason": why} for key, why in self.refused],
            "warnings": list(self.warnings),
            "tolerances": self.tolerances,
            "cost": {"run_s": self.run_s, "gradients_s": self.gradients_s, "models": self.models},
        }))  # fmt: skip

    def texts(self, pictures: bool) -> dict[str, str]:
        """sensitivities.csv, a line a key: value, unit, relative influences, derivatives."""
        out, names = io.StringIO(), list(self.values)
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["key", "value", "unit", *(f"{n}_%_per_%" for n in names), *(f"d_{n}" for n in names), "remark"])
        for row in self.rows:
            shares = [row.influence.get(name, "") for name in names]
            slopes = [row.derivatives[name] for name in names]
            writer.writerow([row.key.path, row.key.value, row.key.unit, *shares, *slopes, row.remark])
        return {"csv": out.getvalue()}

    def draw(self) -> Figure | None:
        """Bars of relative influence."""
        if not self.rows:
            return None
        names = list(self.values)
        largest = [max((abs(share) for share in row.influence.values()), default=0.0) for row in self.rows]
        order = sorted(range(len(largest)), key=lambda k: -largest[k])
        keys = [self.rows[k] for k in order if largest[k] >= _LEAST * max(largest)][:_MOST]
        columns = min(len(names), MOST_COLUMNS)
        rows = -(-len(names) // columns)
        figure = new_figure(2.6 + 2.3 * columns, 0.5 + (1.1 + 0.32 * max(len(keys), 3)) * rows)
        panels = figure.subplots(rows, columns, sharey=True, squeeze=False).flat
        for panel in panels[len(names) :]:
            panel.set_visible(False)
        for panel, name in zip(panels, names, strict=False):
            shares = [row.influence.get(name, 0.0) for row in keys]
            colours = [_MORE if share >= 0.0 else _LESS for share in shares]
            panel.barh(range(len(keys)), shares, color=colours, height=0.66)
            panel.axvline(0.0, color="#555f6b", linewidth=0.8)
            reach = 1.55 * max((abs(share) for share in shares), default=1.0) or 1.0
            panel.set_xlim(-reach, reach)
            for position, share in enumerate(shares):
                if abs(share) >= _LEAST:
                    side = "left" if share >= 0.0 else "right"
                    panel.annotate(f"{share:+.2g}", (share, position), (3 if share >= 0.0 else -3, 0), textcoords="offset points", ha=side, va="center", fontsize=8)  # fmt: skip
            label_axes(panel, name.replace("_", " "), "% per % of key", "", 9.5)
            panel.set_yticks(range(len(keys)), [row.key.path for row in keys], fontsize=9)
            panel.set_ylim(len(keys) - 0.4, -0.6)
        figure.suptitle(wrapped(self.title), fontsize=11)
        return figure

    def report(self) -> Iterator[Part]:
        """Keys in the order of their influence; below, what has none, what has no derivative, and the cost."""
        for name, value in self.values.items():
            number, unit = read_in(value, quantity_of(name).unit)
            yield f"{name.replace('_', ' ')} {number:.5g} {unit}: {self.definitions[name]}"
        if self.tolerances is not None:
            yield sections(tolerance_rows(self.tolerances))
            yield "first order holds where the answer is nearly linear over the tolerances; --samples N samples them"
        influences = []
        for row in (row for row in self.rows if row.influence):
            cells = {"key": row.key.path, "value": f"{row.key.value:.6g} {row.key.unit}".strip()}
            for name in self.values:
                share = row.influence.get(name)
                words = "" if share is None else "0" if abs(share) < _SHOWN else f"{share:+.3g}"
                cells[f"{name.replace('_', ' ')} [% per %]"] = words
            influences.append(cells)
        yield influences
        yield from (f"warning: {text}" for text in self.warnings)
        yield f"cost: {self.gradients_s:.2g} s beside {self.run_s:.2g} s of the run" + (
            f", {self.models} models built" if self.models else ""
        )
        if zero := [row.key.path for row in self.rows if not row.influence]:
            yield f"0, so without a share; derivatives in the files: {', '.join(zero)}"
        yield from _by_reason("", [(row.key, row.remark) for row in self.rows if row.remark])
        if self.without_effect:
            yield f"without effect: {', '.join(key.path for key in self.without_effect)}"
        yield from _by_reason("no derivative by ", self.refused)


def _by_reason(head: str, keys: Iterable[tuple[Key, str]]) -> Iterator[str]:
    """Keys of which the same is to be said, in one sentence."""
    reasons: dict[str, list[str]] = {}
    for key, why in keys:
        reasons.setdefault(why, []).append(key.path)
    return (f"{head}{', '.join(paths)}: {why}" for why, paths in reasons.items())


def _table(row: _Sensitivity) -> Tables:
    statics, motion = row.gradient.statics, row.gradient.motion
    half = len(statics.contact_force) // 2
    table: Tables = {
        "key": row.key.path,
        **{name: getattr(row.key, name) for name in ("value", "unit", "help")},
        **{name: getattr(row, name) for name in ("influence", "derivatives")},
        **{name: getattr(statics, name).tolist() for name in ("displacement", "stiffness", "damping")},
        "ball_load_inner": statics.contact_force[:half].tolist(),
        "ball_load_outer": statics.contact_force[half:].tolist(),
        "step": statics.step,
        "remark": row.remark,
    }
    if motion is not None:
        table["z"] = {"real": motion.dynamic_stiffness.real, "imag": float(np.imag(motion.dynamic_stiffness))}
    return table


#: Influences below this part are shown as 0, files have them.
_SHOWN = 1e-6
_MORE, _LESS = "#0b5fa5", "#c8501e"
#: Keys at most, and influence over the largest one below which none is drawn.
_MOST, _LEAST = 14, 1e-3


@door
def sensitivities(
    scene: SceneSource,
    keys: Annotated[Iterable[str], TEXTS] = (),
    *,
    tolerances: Annotated[Mapping[str, str] | Iterable[str], KEY_VALUES] = (),
    progress: ShowProgress = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
) -> Sensitivities:
    """Derivatives of displacement, stiffness and ball loads, and of Z, K and C of the steady orbit, by numbers of a scene.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    keys : paths such as "load.axial"; none: every continuous key of the scene
    tolerances : key -> text, as ``raceway.band`` takes them, for the band to first order; none: the scene's table [tolerances]
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Sensitivities

    Notes
    -----
    Differences of neighbouring solutions, of rigid bodies all columns of one build.  The motion is the steady orbit that
    ``integrator.kind`` = "periodic" solves for, whatever the scene's integrator.

    Raises
    ------
    SceneError
        With every mistake of the scene; a key that is not continuous or has no derivative; bodies whose contacts have no derivative.
    ConvergenceError
        No equilibrium or no steady orbit.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sensitivities({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}}, ["load.axial"])
    >>> round(found["load.axial"].influence["kxx"], 2)  # kxx grows by 0.54 % where the load grows by 1 %
    0.54
    """
    read = as_scene(scene, plugins=plugins)
    choice = [key_of(read, path) for path in keys]
    chosen_keys = choice or continuous_keys(read)
    with telling(progress) as report:
        start, model = working_processor_time(), build_model(read, steady_plan(read))
        gradients = Gradients(model, equilibrium := solve_equilibrium(model))
        now = values(model, equilibrium, gradients.orbit)
        run_s, start = working_processor_time() - start, working_processor_time()
        answers = list(zip(chosen_keys, gradients.by_all(chosen_keys, report), strict=True))
    refusals = tuple((key, str(answer)) for key, answer in answers if isinstance(answer, NoDerivative))
    if choice and refusals:
        raise SceneError([Mistake(key.path, key.value, why) for key, why in refusals])
    by_key = [(key, answer) for key, answer in answers if not isinstance(answer, NoDerivative)]
    rows, first = list[_Sensitivity](), next(iter(now))
    for gradient in (gradient for _, gradient in by_key if not gradient.nothing):
        key = gradient.statics.key
        slopes = {name: x for name, x in derivatives(model, equilibrium, gradient).items() if name in now}
        shares = {name: slopes[name] * key.value / now[name] for name in now if now[name]} if key.value else {}
        rows.append(_Sensitivity(gradient, slopes, shares))
    rows.sort(key=lambda row: -abs(row.influence.get(first, 0.0)))  # the largest influence on the first number first
    took, warning = working_processor_time() - start, "" if gradients.orbit is None else gradients.orbit.warning
    nothing = tuple(key for key, gradient in by_key if gradient.nothing)
    models, band = sum(gradient.statics.models for _, gradient in by_key), first_order_band(model, equilibrium, tolerances)
    words, warnings = definitions(model, equilibrium), (warning,) if warning else ()
    return Sensitivities(read.title, now, words, tuple(rows), nothing, refusals, run_s, took, models, warnings, band)


@attrs.frozen(eq=False)
class Indices:
    """First-order and total Sobol indices, each (quantities, d)."""

    first: np.ndarray
    total: np.ndarray


def design(count: int, dimensions: int, seed: int) -> np.ndarray:
    """((d + 2) n, d) numbers in [0, 1): rows of A, of B, then of A with each column of B in turn; n is a power of 2."""
    from scipy.stats import qmc

    both = qmc.Sobol(2 * dimensions, seed=seed).random(count)
    a, b = both[:, :dimensions], both[:, dimensions:]
    return np.vstack([a, b, *[np.where(np.arange(dimensions) == k, b, a) for k in range(dimensions)]])


def indices(values: np.ndarray, dimensions: int) -> Indices:
    """Sobol indices of quantities (q, (d + 2) n) at the samples of ``design``."""
    from scipy.stats import sobol_indices

    count = values.shape[1] // (dimensions + 2)
    parts = values.reshape(len(values), dimensions + 2, count)
    deviations = parts - parts[:, :2].mean(axis=(1, 2))[:, None, None]
    func = {"f_A": deviations[:, 0], "f_B": deviations[:, 1], "f_AB": np.moveaxis(deviations[:, 2:], 1, 0)}
    sobol = sobol_indices(func=func, n=count)
    shape = len(values), dimensions  # scipy leaves out axes of length 1
    return Indices(np.reshape(sobol.first_order, shape), np.reshape(sobol.total_order, shape))
