"""Derivatives of a result by every continuous key of its scene."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.core.jit import working_processor_time
from raceway.framework.doors import member
from raceway.framework.shown import Fact, Shown, number
from raceway.pipeline.gradient import UNITS, Gradient, Gradients, definitions, derivatives, described, values
from raceway.pipeline.result import without_nan, write_json
from raceway.pipeline.simulate import OnProgress
from raceway.pipeline.static_gradient import NoDerivative
from raceway.scene.continuous import Key
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model


@attrs.frozen(eq=False)
class Sensitivity:
    """Of all quantities to one key.

    Attributes
    ----------
    derivatives : quantity -> derivative, in its unit over the key's
    influence : quantity -> per cent by which it grows when the number at the key grows by one per cent; empty where that is 0
    """

    gradient: Gradient
    derivatives: dict[str, float]
    influence: dict[str, float]

    @property
    def key(self) -> Key:
        return self.gradient.statics.key

    @property
    def remark(self) -> str:
        return self.gradient.statics.remark


@attrs.frozen(eq=False, repr=False)
class Sensitivities(Shown):
    """How much each number of a scene changes the answer; largest relative influence on the first quantity first.

    Attributes
    ----------
    values : quantity -> number, SI;  definitions : quantity -> what it is;  rows : of keys that change something
    without_effect : keys that change nothing;  refused : (key, why it has no derivative)
    run_s, gradients_s : processor time of equilibrium and orbit, and of all derivatives [s];  models : built for these
    warnings : what to know of the answer itself

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sensitivities({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}})
    >>> found.rows[0].key.path, len(found.rows[0].gradient.statics.displacement)
    ('bearing.conformity_inner', 5)
    """

    title: str
    values: dict[str, float]
    definitions: dict[str, str]
    rows: tuple[Sensitivity, ...]
    without_effect: tuple[Key, ...]
    refused: tuple[tuple[Key, str], ...]
    run_s: float
    gradients_s: float
    models: int
    warnings: tuple[str, ...] = ()

    def __getitem__(self, path: str) -> Sensitivity:
        rows = {row.key.path: row for row in self.rows}
        return rows[member("path", path, rows)]

    def _shown(self) -> tuple[str, list[Fact]]:
        first = next(iter(self.values))
        told = [
            (row.key.path, f"{row.influence[first]:+.3g} %" if row.influence else "", f"{row.derivatives[first]:.4g}")
            for row in self.rows
        ]
        head: Fact = (first, number(self.values[first], UNITS[first]), "its change by 1 % of a key; derivative")
        return self.title, [head, *told]

    def to_dict(self) -> Tables:
        """Plain tables: quantities, keys with all derivatives, keys without effect or derivative, cost."""
        return dict(
            without_nan(
                {
                    "title": self.title,
                    "quantities": {n: described(n, value, self.definitions) for n, value in self.values.items()},
                    "keys": [_table(row) for row in self.rows],
                    "without_effect": [key.path for key in self.without_effect],
                    "refused": [{"key": key.path, "value": key.value, "reason": why} for key, why in self.refused],
                    "warnings": list(self.warnings),
                    "cost": {"run_s": self.run_s, "gradients_s": self.gradients_s, "models": self.models},
                }
            )
        )

    def to_csv(self) -> str:
        """A line a key: value, unit, relative influences, derivatives."""
        out, names = io.StringIO(), list(self.values)
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["key", "value", "unit", *(f"{n}_%_per_%" for n in names), *(f"d_{n}" for n in names), "remark"])
        for row in self.rows:
            shares = [row.influence.get(name, "") for name in names]
            slopes = [row.derivatives[name] for name in names]
            writer.writerow([row.key.path, row.key.value, row.key.unit, *shares, *slopes, row.remark])
        return out.getvalue()

    def save(self, folder: Path) -> list[Path]:
        """Write sensitivities.json and sensitivities.csv.

        Raises
        ------
        RacewayError
            A folder that cannot be written.
        """
        table = write_json(self.to_dict(), folder / "sensitivities.json")
        return [table, write_whole(self.to_csv().encode(), folder / "sensitivities.csv")]

    def picture(self, folder: Path) -> list[Path]:
        """Draw sensitivities.png: bars of relative influence.

        Raises
        ------
        RacewayError
            matplotlib is missing, or the folder cannot be written.
        """
        from raceway.plugins.pictures import save_figure
        from raceway.studies.sensitivities.picture import draw

        return [save_figure(draw(self.to_dict()), folder / "sensitivities.png", 100)]


def sensitivities_of(
    model: Model, equilibrium: Equilibrium, keys: list[Key], run_s: float = 0.0, on_progress: OnProgress | None = None
) -> Sensitivities:
    """Of an equilibrium, and of the steady orbit about it, to keys.

    Parameters
    ----------
    run_s : processor time of the equilibrium, to which that of the orbit is added [s]
    on_progress : called as ``on_progress(what, done, total)``
    """
    begun = working_processor_time()
    gradients = Gradients(model, equilibrium)
    now = values(model, equilibrium, gradients.orbit)
    run_s, begun = run_s + working_processor_time() - begun, working_processor_time()
    rows, nothing, refused, models = [], [], [], 0
    for done, key in enumerate(keys):
        if on_progress is not None:
            on_progress("keys", done, len(keys))
        try:
            gradient = gradients.by(key)
        except NoDerivative as why:
            refused.append((key, str(why)))
            continue
        models += gradient.statics.models
        if gradient.nothing:
            nothing.append(key)
            continue
        slopes = {name: slope for name, slope in derivatives(model, equilibrium, gradient).items() if name in now}
        shares = {name: slopes[name] * key.value / now[name] for name in now if now[name]} if key.value else {}
        rows.append(Sensitivity(gradient, slopes, shares))
    first = next(iter(now))
    rows.sort(key=lambda row: -abs(row.influence.get(first, 0.0)))
    took = working_processor_time() - begun
    warning = "" if gradients.orbit is None else gradients.orbit.warning
    warnings = (warning,) if warning else ()
    words = definitions(model, equilibrium)
    return Sensitivities(
        model.scene.title, now, words, tuple(rows), tuple(nothing), tuple(refused), run_s, took, models, warnings
    )


def _table(row: Sensitivity) -> Tables:
    statics, motion = row.gradient.statics, row.gradient.motion
    half = len(statics.contact_force) // 2
    table: Tables = {
        "key": row.key.path,
        "value": row.key.value,
        "unit": row.key.unit,
        "help": row.key.help,
        "influence": row.influence,
        "derivatives": row.derivatives,
        "displacement": statics.displacement.tolist(),
        "stiffness": statics.stiffness.tolist(),
        "damping": statics.damping.tolist(),
        "ball_load_inner": statics.contact_force[:half].tolist(),
        "ball_load_outer": statics.contact_force[half:].tolist(),
        "step": statics.step,
        "remark": row.remark,
    }
    if motion is not None:
        table["z"] = {"real": motion.dynamic_stiffness.real, "imag": float(np.imag(motion.dynamic_stiffness))}
    return table
