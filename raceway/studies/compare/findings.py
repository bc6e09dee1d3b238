"""Findings of a comparison in numbers: rows, effects, trends."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import attrs
import numpy as np

from raceway.framework.doors import member
from raceway.storage.tables import Tables
from raceway.studies.compare.effects import Factorial, trend, whole_part
from raceway.studies.many.axes import Axis


@attrs.frozen
class Quantity:
    """What is explained: label, its place in result.json, unit on the screen with the factor to it, SI unit and words."""

    label: str
    path: tuple[Any, ...]
    unit: str
    scale: float
    si: str
    words: str


#: Of runs with an excitation, and of static ones.
MOVING = {
    "equivalent_stiffness": Quantity(
        "K(w)", ("identification", "equivalent_stiffness"), "N/µm", 1e-6, "N/m", "K = Re Z + m w^2"
    ),
    "dynamic_stiffness": Quantity(
        "|Z|", ("identification", "dynamic_stiffness", "abs"), "N/µm", 1e-6, "N/m", "size of Z = F/x"
    ),
}
STATIC = {
    "kxx": Quantity("kxx", ("equilibrium", "stiffness", 0, 0), "N/µm", 1e-6, "N/m", "axial tangent stiffness, tilts held"),
    "kyy": Quantity("kyy", ("equilibrium", "stiffness", 1, 1), "N/µm", 1e-6, "N/m", "radial tangent stiffness, tilts held"),
    "x": Quantity("x", ("equilibrium", "displacement", "x"), "µm", 1e6, "m", "axial displacement"),
}
#: A row whose error is as large as its value, or whose motion is less 1x than other, is no basis for an explanation.
MOST_ERROR, MOST_RESIDUAL = 1.0, 1.0
#: Terms of third and higher order are listed from this size on.
LEAST_HIGH_ORDER = 0.005


@attrs.frozen
class Row:
    """One point: the values of the axes, and result.json or ``{"status", "reason"}``."""

    point: Tables
    result: Tables

    @property
    def failed(self) -> bool:
        return "reason" in self.result

    @property
    def quantities(self) -> dict[str, Quantity]:
        """``STATIC`` of a scene without excitation, else ``MOVING``."""
        return STATIC if not self.failed and self.result.get("identification") is None else MOVING

    def value(self, quantity: str) -> float | None:
        """One of ``quantities`` in SI; None where the run has none."""
        value: Any = self.result
        for step in (MOVING | STATIC)[quantity].path:
            if value is not None:
                value = value[step] if isinstance(value, list) else value.get(step)
        return value

    @property
    def damping(self) -> float | None:
        """C [N s/m]; None where the run has none, and where it is below its error.  Of a band the low end."""
        found = self.result.get("identification") or {}
        value, error = found.get("equivalent_damping"), found.get("equivalent_damping_error")
        return None if value is None or (error is not None and abs(value) <= error) else float(value)

    @property
    def damping_words(self) -> str:
        """C [N s/m] in short: one number, both ends of a band, or that it is not resolved."""
        found = self.result.get("identification") or {}
        if found.get("equivalent_damping") is None:
            return ""
        if found.get("band"):
            return " to ".join(f"{value:.4g}" for value in found["band"]["equivalent_damping"])
        return "not resolved" if self.damping is None else f"{self.damping:.4g}"

    @property
    def error(self) -> float:
        """Estimated relative error of Z, 0 where none was estimated."""
        return float((self.result.get("error") or {}).get("total") or 0.0)

    def error_of(self, quantity: str) -> float:
        """Relative error of a quantity: of K that of Z over its own size, since m w^2 has none; 0 of static ones, solved to rounding."""
        own, z = self.value(quantity), self.value("dynamic_stiffness")
        return self.error * (z or 0.0) / own if own and quantity in MOVING else 0.0

    @property
    def estimated(self) -> bool:
        """Whether the run has estimated its error."""
        return (self.result.get("error") or {}).get("total") is not None

    @property
    def doubt(self) -> str | None:
        """Why the row is left out of the explanation; None when it is not."""
        if self.failed:
            return f"{self.result['status']}: {self.result['reason']}"
        for name, quantity in self.quantities.items():
            value = self.value(name)
            if value is None or not math.isfinite(value) or (value <= 0.0 and quantity.si == "N/m"):
                return f"{quantity.label} is not positive"
            if self.error_of(name) >= MOST_ERROR:
                return f"the estimated error of {quantity.label} is as large as its value"
        if ((self.result.get("identification") or {}).get("residual") or 0.0) > MOST_RESIDUAL:
            return "the motion is larger at other frequencies than at the excitation's"
        return None


@attrs.frozen(eq=False, slots=False)
class Findings:
    """Findings of a comparison.

    Attributes
    ----------
    title : of the scene;  axes, rows : in the order given, the last axis running fastest
    notes : options that were left out, and the like
    """

    title: str
    axes: tuple[Axis, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()

    def axis(self, key: str) -> Axis:
        """The axis of a key that was varied."""
        axes = {axis.key: axis for axis in self.axes}
        return axes[member("key", key, axes)]

    @property
    def quantities(self) -> dict[str, Quantity]:
        """What is compared: of the first run that gave an answer."""
        return next((row.quantities for row in self.rows if not row.failed), MOVING)

    @property
    def varied(self) -> list[Axis]:
        """Axes with more than one value."""
        return [axis for axis in self.axes if len(axis.values) > 1]

    @cached_property
    def held(self) -> Tables:
        """Axes that the effects hold at one end, because corners of the other end cannot be used."""
        part = self._whole_part
        if part is None:
            return {}
        held = zip(self.varied, part, strict=True)
        return {axis.key: axis.ends[end] for axis, end in held if end is not None}

    @cached_property
    def factorials(self) -> dict[str, Factorial]:
        """For each quantity its corners; empty when there is nothing to analyse."""
        part = self._whole_part
        if part is None or all(end is not None for end in part):
            return {}
        index = tuple(slice(None) if end is None else end for end in part)
        keys = tuple(axis.key for axis, end in zip(self.varied, part, strict=True) if end is None)
        corners = self._corners[index]
        found = {}
        for name in self.quantities:
            values, errors = (np.array([of(row, name) for row in corners.flat]) for of in (Row.value, Row.error_of))
            if (values > 0.0).all():  # x may have either sign: then it has no logarithm
                found[name] = Factorial(keys, values.reshape(corners.shape), errors.reshape(corners.shape))
        return found

    @cached_property
    def _corners(self) -> np.ndarray:
        """Rows (2,) * k at the ends of the k axes with more than one value; None where a run is missing."""
        corners = np.full((2,) * len(self.varied), None, dtype=object)
        for row in self.rows:
            ends = [[i for i in (0, 1) if _same(row.point[axis.key], axis.ends[i])] for axis in self.varied]
            if all(ends):
                corners[tuple(end[0] for end in ends)] = row
        return corners

    @cached_property
    def _whole_part(self) -> tuple[int | None, ...] | None:
        if not self.varied:
            return None
        usable = [row is not None and row.doubt is None for row in self._corners.flat]
        return whole_part(np.array(usable).reshape(self._corners.shape))

    @cached_property
    def effects(self) -> list[Tables]:
        """Main effects and two-axis interactions, and the larger ones of higher order; the largest first."""
        found = []
        for quantity, factorial in self.factorials.items():
            for effect in factorial.effects:
                if len(effect.term) <= 2 or abs(effect.log_change) >= LEAST_HIGH_ORDER:
                    plain = attrs.asdict(effect)
                    found.append({"quantity": quantity, "order": len(effect.term), **plain, "error": factorial.error})
        return found

    @cached_property
    def trends(self) -> list[Tables]:
        """Trend of each quantity along each axis of three or more numbers, for every combination of the others."""
        found = []
        for axis in self.varied:
            if not axis.numeric or len(axis.values) < 3:
                continue
            series: dict[tuple[str, ...], list[Row]] = {}
            others = [other.key for other in self.axes if other is not axis]
            for row in self.rows:
                series.setdefault(tuple(repr(row.point[key]) for key in others), []).append(row)
            for rows in series.values():
                at = {key: rows[0].point[key] for key in others}
                good = sorted((row for row in rows if row.doubt is None), key=lambda row: row.point[axis.key])
                if axis.values[0] > axis.values[-1]:
                    good.reverse()
                for quantity in self.factorials or self.quantities:
                    found.append({"quantity": quantity, "axis": axis.key, "at": at, **_trend(quantity, good, rows, axis)})
        return found


def _same(a: object, b: object) -> bool:
    return isinstance(a, bool) == isinstance(b, bool) and a == b


def _trend(quantity: str, good: list[Row], rows: list[Row], axis: Axis) -> Tables:
    values = [row.value(quantity) or 0.0 for row in good]
    reaches = (
        len(good) > 1
        and min(values) > 0.0
        and all(any(_same(row.point[axis.key], end) for row in good) for end in axis.ends)
    )
    return {
        "trend": trend(values, [row.error_of(quantity) for row in good]) if len(good) > 1 else "unknown",
        "percent": 100.0 * (values[-1] / values[0] - 1.0) if reaches else None,
        "doubtful": len(rows) - len(good),
    }
