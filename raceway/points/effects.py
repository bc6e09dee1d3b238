"""Two-level full factorial analysis: what each axis does, alone and together with others.

With y = ln(quantity) at the 2^k corners (first or last value of each of k axes), s_i = -1 at the first and +1 at the last
value of axis i, the effect of a set T of axes is

    e_T = 2^(1 - k) * sum over corners of y * product of s_i, i in T.

For one axis this is the mean of y at the last value minus the mean at the first; exp(e) is the factor by which the quantity
changes on average (geometric mean), and effects of independent causes multiply.  For two axes it is half the difference
between the effect of one at the last and at the first value of the other: with e_A and e_AB the factor of A is
exp(e_A + e_AB) at the last value of B and exp(e_A - e_AB) at its first.  The effects are a change of basis, so that
y = mean + 1/2 sum_T e_T product of s_i holds at every corner.  The share of a term is e_T^2 over the sum of all squares.

A quantity with a relative error r lies within y -+ d, d = -ln(1 - r).  No e_T is off by more than 2^(1 - k) times the sum of all d;
an effect above that bound is resolved.

Box, Hunter, Hunter, Statistics for Experimenters (2nd ed., 2005), chapter 5 (definitions of effects and interactions).
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import combinations, product

import attrs
import numpy as np

from raceway.answers.quantities import C_ERROR, ERROR, FREQUENCY, KXX, KYY, MASS, RESIDUAL, C, K, Quantity, X, Z, named
from raceway.framework.doors import member
from raceway.points.axes import Axis, shown
from raceway.storage.tables import Tables


def factorial_effects(values: np.ndarray) -> np.ndarray:
    """Effects (2,) * k of a two-level factorial: index 1 in the places of the axes of T holds e_T, [0, ..., 0] the mean.

    values : (2,) * k array, y at the corners; index 0 is the first value of an axis, 1 the last
    """
    out = np.asarray(values, dtype=float)
    for axis in range(out.ndim):
        first, last = np.take(out, 0, axis=axis), np.take(out, 1, axis=axis)
        out = np.stack([0.5 * (first + last), 0.5 * (last - first)], axis=axis)
    out = 2.0 * out
    out[(0,) * out.ndim] *= 0.5
    return out


@attrs.frozen
class Effect:
    """One term."""

    term: tuple[str, ...]  # keys of its axes
    log_change: float  # e_T
    percent: float  # 100 (exp(e_T) - 1)
    difference: float | None  # mean at the last minus mean at the first value [N/m], main effects only
    share: float  # of the variation of ln(quantity)
    resolved: bool  # whether it exceeds what the corners' errors can make


@attrs.frozen(eq=False, slots=False)
class Factorial:
    """One quantity at all corners."""

    keys: tuple[str, ...]  # (k,) axes
    corners: np.ndarray  # (2,) * k, positive [N/m]
    #: (2,) * k, the corners' relative errors, below 1; default: none
    errors: np.ndarray = attrs.field(default=attrs.Factory(lambda self: np.zeros(self.corners.shape), takes_self=True))

    @property
    def error(self) -> float:
        """Largest shift of any effect by the corners' errors."""
        return float(2.0 * self._log_errors.mean())

    @cached_property
    def _log_errors(self) -> np.ndarray:
        return -np.log1p(-self.errors)

    @cached_property
    def effects(self) -> list[Effect]:
        """All terms, the largest first."""
        coefficients = factorial_effects(np.log(self.corners))
        squares = float((coefficients**2).sum() - coefficients[(0,) * coefficients.ndim] ** 2)
        terms = []
        for order in range(1, len(self.keys) + 1):
            for places in combinations(range(len(self.keys)), order):
                e = float(coefficients[tuple(int(k in places) for k in range(len(self.keys)))])
                difference = None
                if order == 1:
                    first, last = (float(np.take(self.corners, end, axis=places[0]).mean()) for end in (0, 1))
                    difference = last - first
                share = e * e / squares if squares > 0.0 else 0.0
                term = tuple(self.keys[k] for k in places)
                terms.append(Effect(term, e, 100.0 * float(np.expm1(e)), difference, share, abs(e) > self.error))
        return sorted(terms, key=lambda effect: -abs(effect.log_change))

    def log_change(self, key: str, levels: Mapping[str, int] | None = None) -> float:
        """Mean change of ln(quantity) along one axis, the axes in ``levels`` held at an end (0 first, 1 last)."""
        first, last = (self._mean(np.log(self.corners), {**(levels or {}), key: end}) for end in (0, 1))
        return last - first

    def log_error(self, key: str, levels: Mapping[str, int] | None = None) -> float:
        """Largest shift of that change by the corners' errors."""
        return sum(self._mean(self._log_errors, {**(levels or {}), key: end}) for end in (0, 1))

    def resolved_change(self, key: str, levels: Mapping[str, int] | None = None) -> float:
        """That change, or 0 where errors can make it."""
        change = self.log_change(key, levels)
        return change if abs(change) > self.log_error(key, levels) else 0.0

    def _mean(self, values: np.ndarray, levels: Mapping[str, int]) -> float:
        index: list[int | slice] = [slice(None)] * len(self.keys)
        for name, level in levels.items():
            index[self.keys.index(name)] = level
        return float(values[tuple(index)].mean())


def complete_factorial(usable: np.ndarray) -> tuple[int | None, ...] | None:
    """The largest factorial without holes: for each axis None (both ends) or the end it must be held at.

    usable : (2,) * k of bool

    As few axes as possible are held, and of those the last ones: people name what matters most first.  None when no two
    neighbouring corners are usable.
    """
    k = usable.ndim
    for fewest in range(k):
        for places in sorted(combinations(range(k), fewest), reverse=True):
            for ends in product((0, 1), repeat=fewest):
                place_ends: list[int | None] = [None] * k
                for axis, end in zip(places, ends, strict=True):
                    place_ends[axis] = end
                if usable[tuple(slice(None) if end is None else end for end in place_ends)].all():
                    return tuple(place_ends)
    return None


def trend(values: Sequence[float], errors: Sequence[float]) -> str:
    """ "rises", "falls", "level" or "not monotonic" of a series; differences within both ends' relative errors do not count."""
    y, e = np.asarray(values, dtype=float), np.asarray(errors, dtype=float)
    off = np.abs(y) * e
    change, margin = y[None, :] - y[:, None], off[None, :] + off[:, None]
    later = np.triu(np.ones(change.shape, dtype=bool), 1)
    up, down = bool((change > margin)[later].any()), bool((change < -margin)[later].any())
    return {(False, False): "level", (True, False): "rises", (False, True): "falls", (True, True): "not monotonic"}[up, down]


#: What is explained of runs with an excitation, and of static ones.
MOVING, STATIC = named(K, Z), named(KXX, KYY, X)
#: A row whose error is as large as its value, or whose motion is less 1x than other, is no basis for an explanation.
_MOST_ERROR, _MOST_RESIDUAL = 1.0, 1.0
#: Terms of third and higher order are listed from this size on.
_LEAST_HIGH_ORDER = 0.005


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
        value = (MOVING | STATIC)[quantity].of(self.result)
        return None if value is None else float(value)

    @property
    def damping(self) -> float | None:
        """C [N s/m]; None where the run has none, and where it is below its error.  Of a band the low end."""
        value, error = C.of(self.result), C_ERROR.of(self.result)
        return None if value is None or (error is not None and abs(value) <= error) else float(value)

    @property
    def damping_words(self) -> str:
        """C [N s/m] in short: one number, both ends of a band, or that it is not resolved."""
        if C.of(self.result) is None:
            return ""
        if band := self.result["identification"].get("band"):
            return " to ".join(f"{value:.4g}" for value in band[C.name])
        return "not resolved" if self.damping is None else f"{self.damping:.4g}"

    @property
    def error(self) -> float:
        """Estimated relative error of Z, 0 where none was estimated."""
        return float(ERROR.of(self.result) or 0.0)

    def error_of(self, quantity: str) -> float:
        """Relative error of a quantity: of K that of Z over its own size, since m w^2 has none; 0 of static ones, solved to rounding."""
        value, z = self.value(quantity), self.value(Z.name)
        return self.error * (z or 0.0) / value if value and quantity in MOVING else 0.0

    @property
    def estimated(self) -> bool:
        """Whether the run has estimated its error."""
        return ERROR.of(self.result) is not None

    @property
    def doubt(self) -> str | None:
        """Why the row is left out of the explanation; None when it is not."""
        if self.failed:
            return f"{self.result['status']}: {self.result['reason']}"
        for name, quantity in self.quantities.items():
            value = self.value(name)
            if value is None or not math.isfinite(value) or (value <= 0.0 and quantity.unit == K.unit):
                return f"{quantity.symbol} is not positive"
            if self.error_of(name) >= _MOST_ERROR:
                return f"the estimated error of {quantity.symbol} is as large as its value"
        if (RESIDUAL.of(self.result) or 0.0) > _MOST_RESIDUAL:
            return "the motion is larger at other frequencies than at the excitation's"
        return None


@attrs.frozen(eq=False)
class Course:
    """How a quantity runs along an axis, the others held."""

    quantity: str
    axis: str  # its key
    at: Tables  # the other axes' values
    trend: str  # "rises", "falls", "level", "not monotonic" or "unknown"
    percent: float | None  # change from the first to the last value, None where one of them is no number
    doubtful: int  # rows that are left out


@attrs.frozen(eq=False, slots=False)
class Findings:
    """Findings of a comparison."""

    title: str  # of the scene
    #: axes, rows : in the order given, the last axis running fastest
    axes: tuple[Axis, ...]
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()  # options that were left out, and the like

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
        return {axis.key: axis.ends[end] for axis, end in zip(self.varied, part, strict=True) if end is not None}

    @cached_property
    def factorials(self) -> dict[str, Factorial]:
        """For each quantity its corners; empty when there is nothing to analyse."""
        part = self._whole_part
        if part is None or all(end is not None for end in part):
            return {}
        index = tuple(slice(None) if end is None else end for end in part)
        keys = tuple(axis.key for axis, end in zip(self.varied, part, strict=True) if end is None)
        corners = self._corners[index]
        factorials = {}
        for name in self.quantities:
            values, errors = (np.array([of(row, name) for row in corners.flat]) for of in (Row.value, Row.error_of))
            if (values > 0.0).all():  # x may have either sign: then it has no logarithm
                factorials[name] = Factorial(keys, values.reshape(corners.shape), errors.reshape(corners.shape))
        return factorials

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
        return complete_factorial(np.array(usable).reshape(self._corners.shape))

    @cached_property
    def terms(self) -> list[tuple[str, Effect]]:
        """Of each quantity main effects and two-axis interactions, and the larger ones of higher order; the largest first."""
        return [
            (quantity, effect)
            for quantity, factorial in self.factorials.items()
            for effect in factorial.effects
            if len(effect.term) <= 2 or abs(effect.log_change) >= _LEAST_HIGH_ORDER
        ]

    @property
    def effects(self) -> list[Tables]:
        """The terms, as tables."""
        return [
            {"quantity": name, "order": len(effect.term), **attrs.asdict(effect), "error": self.factorials[name].error}
            for name, effect in self.terms
        ]

    @cached_property
    def courses(self) -> list[Course]:
        """Of each quantity along each axis of three or more numbers, for every combination of the others."""
        courses = []
        for axis in (axis for axis in self.varied if axis.numeric and len(axis.values) >= 3):
            series: dict[tuple[str, ...], list[Row]] = {}
            other_keys = [varied_axis.key for varied_axis in self.axes if varied_axis is not axis]
            for row in self.rows:
                series.setdefault(tuple(repr(row.point[key]) for key in other_keys), []).append(row)
            for rows in series.values():
                at = {key: rows[0].point[key] for key in other_keys}
                good = sorted((row for row in rows if row.doubt is None), key=lambda row: row.point[axis.key])
                if axis.values[0] > axis.values[-1]:
                    good.reverse()
                at_ends = all(any(_same(row.point[axis.key], end) for row in good) for end in axis.ends)
                for quantity in self.factorials or self.quantities:
                    values = [row.value(quantity) or 0.0 for row in good]
                    reaches = len(good) > 1 and min(values) > 0.0 and at_ends
                    runs = trend(values, [row.error_of(quantity) for row in good]) if len(good) > 1 else "unknown"
                    percent = 100.0 * (values[-1] / values[0] - 1.0) if reaches else None
                    courses.append(Course(quantity, axis.key, at, runs, percent, len(rows) - len(good)))
        return courses

    @property
    def trends(self) -> list[Tables]:
        """The courses, as tables."""
        return [attrs.asdict(course, recurse=False) for course in self.courses]


def _same(a: object, b: object) -> bool:
    return isinstance(a, bool) == isinstance(b, bool) and a == b


#: A change of less than half a percent "hardly matters".
_HARDLY = math.log(1.005)
_MOST_INTERACTIONS = 5


def explain(comparison: Findings) -> list[str]:
    """The ranking of main effects first, then doubts, interactions, and how numbers run along an axis where others change that."""
    words = in_few_words(comparison)
    for quantity in list(comparison.factorials)[1:]:
        words += [*_main_effects(comparison, quantity), *_interactions(comparison, quantity)]
    if comparison.factorials:
        words += [*_courses(comparison), *_inertia(comparison)]
    # What was run, and how far the runs' own errors reach.
    few = [axis.values if len(axis.values) <= 6 else (*axis.values[:2], "...", axis.values[-1]) for axis in comparison.axes]
    axes = [f"{axis.key} ({', '.join(map(shown, values))})" for axis, values in zip(comparison.axes, few, strict=True)]
    text = f"{len(comparison.rows)} run{'s' * (len(comparison.rows) != 1)} of one scene that differ only in {enumeration(axes)}."
    if comparison.factorials:
        factorial, error = next(iter(comparison.factorials.values())), max(f.error for f in comparison.factorials.values())
        text += f" The effects compare the first with the last value of each axis ({factorial.corners.size} runs)"
        text += ", as geometric means over the other settings"
        text += f", at {_settings(comparison.held)}" if comparison.held else ""
        text += f"; the runs' own errors move them by at most {100.0 * error:.2g} %." if error else "."
        unknown = sum(r.doubt is None and not r.estimated and bool(r.result["identification"]) for r in comparison.rows)
        text += f" {unknown} runs without an estimated error are taken as exact." if unknown else ""
    return [*words, text]


def in_few_words(comparison: Findings) -> list[str]:
    """Effects on the first quantity, the largest first, doubts and its interactions: for a screen; ``explain`` has the rest."""
    reasons: dict[str, list[str]] = {}
    for row in comparison.rows:
        if row.doubt is not None:
            point = ", ".join(shown(row.point[axis.key]) for axis in comparison.axes)
            reasons.setdefault(row.doubt, []).append(f"({point})")
    words = []
    for reason, settings in reasons.items():
        points = ", ".join(settings[:4]) + (f" and {len(settings) - 4} more" if len(settings) > 4 else "")
        words.append(
            f"Left out of the explanation, {len(settings)} of {len(comparison.rows)} runs, {points}: {reason.rstrip('.')}."
        )
    if comparison.held and words:
        words.append(f"Some are at the ends of the axes, so the effects hold for {_settings(comparison.held)} only.")
    notes = [*words, *(f"Note: {note}." for note in comparison.notes)]
    if not comparison.factorials:
        fault = "too many of the runs at the ends of the axes cannot be used"
        return [f"No effects: {fault if comparison.varied else 'every axis has one value'}.", *notes]
    first = next(iter(comparison.factorials))
    ranking, *further = _main_effects(comparison, first)
    return [ranking, *further, *notes, *_interactions(comparison, first)]


def percent(log_change: float) -> str:
    """A change of ln(quantity) in percent, signed."""
    value = 100.0 * math.expm1(log_change)
    return f"{value:+.1f} %" if abs(value) >= 1.0 else f"{value:+.2f} %"


def _span(log_changes: Iterable[float]) -> str:
    changes = list(log_changes)
    low, high = percent(min(changes)), percent(max(changes))
    return low if low == high else f"{low} to {high}"


def enumeration(parts: Sequence[str]) -> str:
    """``a, b and c``."""
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def _axis_ends(axis: Axis) -> str:
    return f"{axis.key} from {shown(axis.ends[0])} to {shown(axis.ends[1])}"


def _settings(point: Tables) -> str:
    """``a = 1 and b = 2``."""
    return enumeration([f"{key} = {shown(value)}" for key, value in point.items()])


def _courses(comparison: Findings) -> list[str]:
    """How the first quantity runs along each axis of numbers, at each value of the axis that changes this most."""
    quantity, factorial = next(iter(comparison.factorials.items()))
    label, words = comparison.quantities[quantity].symbol, []
    for axis in (axis for axis in comparison.varied if axis.numeric and axis.key in factorial.keys):
        along = [c for c in comparison.courses if (c.axis, c.quantity) == (axis.key, quantity)]
        changes = {c: math.log1p(c.percent / 100.0) for c in along if c.percent is not None}
        if len(changes) < 2 or max(changes.values()) - min(changes.values()) < _HARDLY:
            continue
        interactions = dict.fromkeys((key for key in factorial.keys if key != axis.key), 0.0)
        for effect in factorial.effects:
            if len(effect.term) == 2 and axis.key in effect.term:
                other = next(key for key in effect.term if key != axis.key)
                interactions[other] = max(interactions[other], abs(effect.log_change))
        partner = comparison.axis(max(interactions, key=lambda key: interactions[key]))
        for value in partner.values:
            here = [c for c in changes if c.at[partner.key] == value]
            parts = []
            for kind in ("rises", "falls", "level", "not monotonic"):
                part = [changes[c] for c in here if c.trend == kind]
                verb = kind if kind in ("rises", "falls") else f"is {kind}"
                parts += [f"{verb} in {len(part)} of {len(here)} settings ({_span(part)})"] if part else []
            left_out = sum(c.doubtful for c in here)
            note = f"; doubtful runs between the ends left out: {left_out}" if left_out else ""
            if parts:
                text = f"With {partner.key} = {shown(value)}, {label} along {_axis_ends(axis)} {enumeration(parts)}{note}."
                words.append(text)
    return words


def _inertia(comparison: Findings) -> list[str]:
    """By how much |Z| is less than K, with the mass that was used."""
    runs = [row.result for row in comparison.rows if row.doubt is None]
    if not all(run["identification"] for run in runs):
        return []
    masses = [MASS.of(run) for run in runs]
    force = [m * (2.0 * math.pi * FREQUENCY.of(run)) ** 2 for m, run in zip(masses, runs, strict=True)]
    mass = f"{min(masses):.3f}" if max(masses) - min(masses) < 5e-4 else f"{min(masses):.3f} to {max(masses):.3f}"
    return [
        f"|Z| is K less m w^2, with m = {mass} kg: {1e-6 * min(force):.2f} to {1e-6 * max(force):.2f} N/µm; damping adds to it."
    ]


def _main_effects(comparison: Findings, quantity: str) -> list[str]:
    factorial, about = comparison.factorials[quantity], comparison.quantities[quantity]
    label, unit = about.symbol, about.read_unit
    values = [about.read(row.value(quantity) or 0.0) for row in comparison.rows if row.doubt is None]
    beyond = {key: span for key in factorial.keys if (span := _between(comparison, quantity, comparison.axis(key)))}
    main = [e for e in factorial.effects if len(e.term) == 1]
    parts, unclear, weak, inert = [], [], [], []
    largest = factorial.effects[0]
    for effect in sorted(main, key=lambda e: -max(map(abs, (e.log_change, *beyond.get(e.term[0], ("", []))[1])))):
        key = effect.term[0]
        if key in beyond or (effect.resolved and abs(effect.log_change) >= _HARDLY):
            if key in beyond:
                share = f"; to {beyond[key][0]} by {_span(beyond[key][1])}"
            elif beyond:  # shares are those of the ends
                share = ""
            elif effect is not largest and largest.share > 0.9:
                share = f"; {100.0 * effect.share / (1.0 - largest.share):.2g} % of the rest"
            else:
                share = f"; {100.0 * effect.share:.3g} % of the variation"
            ends = [[factorial.resolved_change(key, {by: end}) for end in (0, 1)] for by in factorial.keys if by != key]
            remark = ", a mean of rises and falls" if any(low * high < 0.0 for low, high in ends) else ""
            change = f"{percent(effect.log_change)} ({about.read(effect.difference or 0.0):+.2f} {unit}{share}{remark})"
            parts.append(f"{_axis_ends(comparison.axis(key))} changes it by {change}")
        elif abs(effect.log_change) + factorial.error >= _HARDLY and not effect.resolved:
            # An end of another axis may resolve what its mean does not.
            clear_ends = [
                f"; with {other} = {shown(comparison.axis(other).ends[end])} {percent(change_there)}"
                for other, end in product(factorial.keys, (0, 1))
                if other != key and (change_there := factorial.resolved_change(key, {other: end}))
            ]
            unclear.append(f"{key} ({percent(effect.log_change)}{''.join(clear_ends)})")
        elif max(abs(e.log_change) for e in factorial.effects if key in e.term) + factorial.error < _HARDLY:
            inert.append(f"{key} ({percent(effect.log_change)})")
        else:
            weak.append(f"{key} ({percent(effect.log_change)})")
    none = "no axis affects it" if unclear else "no axis moves it"
    order = "On average" if len(parts) < 2 else "On average, strongest first:"
    words = [f"{label} lies between {min(values):.2f} and {max(values):.2f} {unit}. {order} {'; '.join(parts) or none}."]
    within = f"within the runs' errors of {100.0 * factorial.error:.2g} %"
    for keys, sentence in (
        (unclear, ", {within} and so not resolved: {keys}."),
        (weak, " on average hardly depends on {keys}, but does so together with other axes (see below)."),
        (inert, " hardly depends on {keys}: no effect of it, alone or with others, reaches 0.5 %."),
    ):
        words += [label + sentence.format(within=within, keys=enumeration(keys))] if keys else []
    return words


def _between(comparison: Findings, quantity: str, axis: Axis) -> tuple[str, list[float]] | None:
    """The value amid an axis that is farthest beyond what its ends span, with ln of its changes from the first; None without one."""
    lines: dict[str, dict[str, float]] = {}
    for row in comparison.rows:
        if row.doubt is None and (value := row.value(quantity) or 0.0) > 0.0:
            setting = repr([number for key, number in row.point.items() if key != axis.key])
            lines.setdefault(setting, {})[repr(row.point[axis.key])] = math.log(value)
    first, *amid, last = map(repr, axis.values)
    farthest, least = None, _HARDLY + comparison.factorials[quantity].error
    for value, name in zip(axis.values[1:-1], amid, strict=True):
        changes = [
            (values[name] - values[first], values[last] - values[first])
            for values in lines.values()
            if {first, name, last} <= values.keys()
        ]
        if (far := max((max(to - max(end, 0.0), min(end, 0.0) - to) for to, end in changes), default=0.0)) > least:
            farthest, least = (shown(value), [to for to, _ in changes]), far
    return farthest


def _interactions(comparison: Findings, quantity: str) -> list[str]:
    factorial, label = comparison.factorials[quantity], comparison.quantities[quantity].symbol
    large = [e for e in factorial.effects if len(e.term) == 2 and abs(e.log_change) >= _HARDLY and e.resolved]
    words = []
    for effect in large[:_MOST_INTERACTIONS]:
        # (the axis that is held, the axis that is moved): numbers are moved, else the weaker of the two.
        main = {e.term[0]: abs(e.log_change) for e in factorial.effects if len(e.term) == 1}
        axes = (comparison.axis(key) for key in effect.term)
        partner, other = sorted(axes, key=lambda axis: (axis.numeric, -main[axis.key]))
        changes = [factorial.log_change(other.key, {partner.key: end}) for end in (0, 1)]
        words.append(
            f"{label}, interaction of {partner.key} and {other.key}: with {partner.key} = {shown(partner.ends[0])}, "
            f"{_axis_ends(other)} changes it by {percent(changes[0])}, with {shown(partner.ends[1])} by {percent(changes[1])}."
        )
    high = [e for e in factorial.effects if len(e.term) > 2 and abs(e.log_change) >= _HARDLY and e.resolved]
    if high:
        terms = "; ".join(f"{' x '.join(e.term)} ({percent(e.log_change)})" for e in high[:3])
        words.append(f"{label}, three or more axes together: {terms}.")
    if not large and not high and len(factorial.keys) > 1:
        most = max(abs(e.log_change) for e in factorial.effects if len(e.term) > 1)
        none = f"{label} has no interaction above 0.5 %: the axes act independently."
        unknown = f"{label}: no interaction is resolved from the runs' errors (the largest would be {percent(most)})."
        words.append(none if most + factorial.error < _HARDLY else unknown)
    return words
