"""A comparison in sentences.  Every statement is made from the computed effects; none is assumed.

Changes are geometric means over the settings that a sentence does not name.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from raceway.storage.tables import Tables
from raceway.studies.compare.effects import Effect, Factorial
from raceway.studies.many.axes import Axis, shown

if TYPE_CHECKING:
    from raceway.studies.compare.findings import Findings

#: A change of less than half a percent "hardly matters".
HARDLY = math.log(1.005)
_MOST_INTERACTIONS = 5


def explain(comparison: Findings) -> list[str]:
    """The ranking of main effects first, then doubts, interactions, and how numbers run along an axis where others change that."""
    words = in_few_words(comparison)
    for quantity in list(comparison.factorials)[1:]:
        words += [*_main_effects(comparison, quantity), *_interactions(comparison, quantity)]
    if comparison.factorials:
        words += [*_courses(comparison), *_inertia(comparison)]
    return [*words, _what_was_run(comparison)]


def in_few_words(comparison: Findings) -> list[str]:
    """Effects on the first quantity, the largest first, doubts and its interactions: for a screen; ``explain`` has the rest."""
    notes = [*_doubts(comparison), *(f"Note: {note}." for note in comparison.notes)]
    if not comparison.factorials:
        return [_why_no_effects(comparison), *notes]
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


def _listed(parts: Sequence[str]) -> str:
    """``a, b and c``."""
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def _step(axis: Axis) -> str:
    return f"{axis.key} from {shown(axis.ends[0])} to {shown(axis.ends[1])}"


def _settings(point: Tables) -> str:
    """``a = 1 and b = 2``."""
    return _listed([f"{key} = {shown(value)}" for key, value in point.items()])


def _courses(comparison: Findings) -> list[str]:
    """How the first quantity runs along each axis of numbers, at each value of the axis that changes this most."""
    quantity, factorial = next(iter(comparison.factorials.items()))
    label, words = comparison.quantities[quantity].label, []
    for axis in (axis for axis in comparison.varied if axis.numeric and axis.key in factorial.keys):
        trends = [
            t for t in comparison.trends if (t["axis"], t["quantity"]) == (axis.key, quantity) and t["percent"] is not None
        ]
        changes = [math.log1p(t["percent"] / 100.0) for t in trends]
        if len(trends) < 2 or max(changes) - min(changes) < HARDLY:
            continue
        others = [key for key in factorial.keys if key != axis.key]
        partner = comparison.axis(max(others, key=lambda key: _together(factorial, axis.key, key)))
        for value in partner.values:
            here = [t for t in trends if t["at"][partner.key] == value]
            parts = []
            for kind in ("rises", "falls", "level", "not monotonic"):
                part = [math.log1p(t["percent"] / 100.0) for t in here if t["trend"] == kind]
                verb = kind if kind in ("rises", "falls") else f"is {kind}"
                parts += [f"{verb} in {len(part)} of {len(here)} settings ({_span(part)})"] if part else []
            left_out = sum(t["doubtful"] for t in here)
            note = f"; doubtful runs between the ends left out: {left_out}" if left_out else ""
            if parts:
                words.append(f"With {partner.key} = {shown(value)}, {label} along {_step(axis)} {_listed(parts)}{note}.")
    return words


def _together(factorial: Factorial, one: str, other: str) -> float:
    """Size of the interaction of two axes."""
    return max((abs(e.log_change) for e in factorial.effects if set(e.term) == {one, other}), default=0.0)


def _inertia(comparison: Findings) -> list[str]:
    """By how much |Z| is less than K, with the mass that was used."""
    runs = [row.result["identification"] for row in comparison.rows if row.doubt is None]
    if not all(runs):
        return []
    masses = [run["mass_used_kg"] for run in runs]
    force = [m * (2.0 * math.pi * run["frequency_hz"]) ** 2 for m, run in zip(masses, runs, strict=True)]
    mass = f"{min(masses):.3f}" if max(masses) - min(masses) < 5e-4 else f"{min(masses):.3f} to {max(masses):.3f}"
    return [
        f"|Z| is K(w) less m w^2, with m = {mass} kg: {1e-6 * min(force):.2f} to {1e-6 * max(force):.2f} N/µm; damping adds to it."
    ]


def _what_was_run(comparison: Findings) -> str:
    axes = [f"{axis.key} ({', '.join(shown(v) for v in _few(axis))})" for axis in comparison.axes]
    text = f"{len(comparison.rows)} run{'s' * (len(comparison.rows) != 1)} of one scene that differ only in {_listed(axes)}."
    if not comparison.factorials:
        return text
    one, error = next(iter(comparison.factorials.values())), max(f.error for f in comparison.factorials.values())
    text += f" The effects compare the first with the last value of each axis ({one.corners.size} runs)"
    text += ", as geometric means over the other settings"
    text += f", at {_settings(comparison.held)}" if comparison.held else ""
    text += f"; the runs' own errors move them by at most {100.0 * error:.2g} %." if error else "."
    unknown = sum(row.doubt is None and not row.estimated and bool(row.result["identification"]) for row in comparison.rows)
    return text + (f" Of {unknown} runs no error was estimated: they count as exact." if unknown else "")


def _few(axis: Axis) -> Sequence[object]:
    return axis.values if len(axis.values) <= 6 else (*axis.values[:2], "...", axis.values[-1])


def _doubts(comparison: Findings) -> list[str]:
    reasons: dict[str, list[str]] = {}
    for row in comparison.rows:
        if row.doubt is not None:
            point = ", ".join(shown(row.point[axis.key]) for axis in comparison.axes)
            reasons.setdefault(row.doubt, []).append(f"({point})")
    words = []
    for reason, found in reasons.items():
        points = ", ".join(found[:4]) + (f" and {len(found) - 4} more" if len(found) > 4 else "")
        words.append(
            f"Left out of the explanation, {len(found)} of {len(comparison.rows)} runs, {points}: {reason.rstrip('.')}."
        )
    if comparison.held and words:
        words.append(
            f"Some of them stand at the ends of the axes, so the effects hold for {_settings(comparison.held)} only."
        )
    return words


def _why_no_effects(comparison: Findings) -> str:
    if not comparison.varied:
        return "No effects: every axis has one value."
    return "No effects: too many of the runs at the ends of the axes cannot be used."


def _main_effects(comparison: Findings, quantity: str) -> list[str]:
    factorial, about = comparison.factorials[quantity], comparison.quantities[quantity]
    label, unit = about.label, about.unit
    values = [about.scale * (row.value(quantity) or 0.0) for row in comparison.rows if row.doubt is None]
    beyond = {key: span for key in factorial.keys if (span := _between(comparison, quantity, comparison.axis(key)))}
    main = [e for e in factorial.effects if len(e.term) == 1]
    parts, hidden, weak, inert = [], [], [], []
    largest = factorial.effects[0]
    for effect in sorted(main, key=lambda e: -max(map(abs, (e.log_change, *beyond.get(e.term[0], ("", []))[1])))):
        key = effect.term[0]
        if key in beyond or (effect.resolved and abs(effect.log_change) >= HARDLY):
            if key in beyond:
                share = f"; to {beyond[key][0]} by {_span(beyond[key][1])}"
            elif beyond:  # shares are those of the ends
                share = ""
            elif effect is not largest and largest.share > 0.9:
                share = f"; {100.0 * effect.share / (1.0 - largest.share):.2g} % of the rest"
            else:
                share = f"; {100.0 * effect.share:.3g} % of the variation"
            mixed = ", a mean of rises and falls" if _mixed(factorial, key) else ""
            change = f"{percent(effect.log_change)} ({about.scale * (effect.difference or 0.0):+.2f} {unit}{share}{mixed})"
            parts.append(f"{_step(comparison.axis(key))} changes it by {change}")
        elif abs(effect.log_change) + factorial.error >= HARDLY and not effect.resolved:
            hidden.append(f"{key} ({percent(effect.log_change)}{_where_resolved(comparison, factorial, key)})")
        elif max(abs(e.log_change) for e in factorial.effects if key in e.term) + factorial.error < HARDLY:
            inert.append(f"{key} ({percent(effect.log_change)})")
        else:
            weak.append(f"{key} ({percent(effect.log_change)})")
    none = "no axis is seen to move it" if hidden else "no axis moves it"
    order = "On average" if len(parts) < 2 else "On average, the strongest first:"
    words = [f"{label} lies between {min(values):.2f} and {max(values):.2f} {unit}. {order} {'; '.join(parts) or none}."]
    if hidden:
        words.append(
            f"{label}, within the runs' errors of {100.0 * factorial.error:.2g} % and so not resolved: {_listed(hidden)}."
        )
    if weak:
        words.append(
            f"{label} on average hardly depends on {_listed(weak)}, but does so together with other axes (see below)."
        )
    if inert:
        words.append(f"{label} hardly depends on {_listed(inert)}: no effect of it, alone or with others, reaches 0.5 %.")
    return words


def _between(comparison: Findings, quantity: str, axis: Axis) -> tuple[str, list[float]] | None:
    """The value amid an axis that is farthest beyond what its ends span, with ln of its changes from the first; None without one."""
    lines: dict[str, dict[str, float]] = {}
    for row in comparison.rows:
        if row.doubt is None and (value := row.value(quantity) or 0.0) > 0.0:
            others = repr([number for key, number in row.point.items() if key != axis.key])
            lines.setdefault(others, {})[repr(row.point[axis.key])] = math.log(value)
    first, *amid, last = map(repr, axis.values)
    farthest, least = None, HARDLY + comparison.factorials[quantity].error
    for value, name in zip(axis.values[1:-1], amid, strict=True):
        changes = [
            (one[name] - one[first], one[last] - one[first]) for one in lines.values() if {first, name, last} <= one.keys()
        ]
        if (far := max((max(to - max(end, 0.0), min(end, 0.0) - to) for to, end in changes), default=0.0)) > least:
            farthest, least = (shown(value), [to for to, _ in changes]), far
    return farthest


def _mixed(factorial: Factorial, key: str) -> bool:
    """Whether an axis raises the quantity at some value of another axis and lowers it at the other."""
    return any(
        factorial.resolved_change(key, {other: 0}) * factorial.resolved_change(key, {other: 1}) < 0.0
        for other in factorial.keys
        if other != key
    )


def _where_resolved(comparison: Findings, factorial: Factorial, key: str) -> str:
    """At which end of another axis the change along one is resolved although its mean is not."""
    words = []
    for other in (name for name in factorial.keys if name != key):
        for end in (0, 1):
            if change := factorial.resolved_change(key, {other: end}):
                words.append(f"with {other} = {shown(comparison.axis(other).ends[end])} {percent(change)}")
    return "".join(f"; {text}" for text in words)


def _interactions(comparison: Findings, quantity: str) -> list[str]:
    factorial, label = comparison.factorials[quantity], comparison.quantities[quantity].label
    large = [e for e in factorial.effects if len(e.term) == 2 and abs(e.log_change) >= HARDLY and e.resolved]
    words = []
    for effect in large[:_MOST_INTERACTIONS]:
        given, moved = _ordered(comparison, factorial, effect)
        changes = [factorial.log_change(moved.key, {given.key: end}) for end in (0, 1)]
        words.append(
            f"{label}, interaction of {given.key} and {moved.key}: with {given.key} = {shown(given.ends[0])}, "
            f"{_step(moved)} changes it by {percent(changes[0])}, with {shown(given.ends[1])} by {percent(changes[1])}."
        )
    high = [e for e in factorial.effects if len(e.term) > 2 and abs(e.log_change) >= HARDLY and e.resolved]
    if high:
        terms = "; ".join(f"{' x '.join(e.term)} ({percent(e.log_change)})" for e in high[:3])
        words.append(f"{label}, three or more axes together: {terms}.")
    if not large and not high and len(factorial.keys) > 1:
        most = max(abs(e.log_change) for e in factorial.effects if len(e.term) > 1)
        if most + factorial.error < HARDLY:
            words.append(f"{label} has no interaction above 0.5 %: the axes act independently.")
        else:
            words.append(
                f"{label}: no interaction is resolved from the runs' errors (the largest would be {percent(most)})."
            )
    return words


def _ordered(comparison: Findings, factorial: Factorial, effect: Effect) -> tuple[Axis, Axis]:
    """(the axis that is held, the axis that is moved): numbers are moved, else the weaker of the two."""
    own = {e.term[0]: abs(e.log_change) for e in factorial.effects if len(e.term) == 1}
    a, b = sorted((comparison.axis(key) for key in effect.term), key=lambda axis: (axis.numeric, -own[axis.key]))
    return a, b
