"""A comparison in sentences.  Every statement is made from the computed effects; none is assumed.

Changes are geometric means over the settings that a sentence does not name.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from raceway.studies.compare.causes import IN_SHORT, causes, leading_axis
from raceway.studies.compare.effects import Effect, Factorial
from raceway.studies.compare.inertia import inertia
from raceway.studies.compare.phrases import HARDLY, LABELS, listed, percent, settings, step
from raceway.studies.many.axes import Axis, shown

if TYPE_CHECKING:
    from raceway.studies.compare.findings import Findings

_MOST_INTERACTIONS = 5


def explain(comparison: Findings) -> list[str]:
    """The sentences, in the order in which a person asks."""
    words = [_what_was_run(comparison), *_doubts(comparison), *(f"Note: {note}." for note in comparison.notes)]
    if not comparison.factorials:
        return [*words, _why_no_effects(comparison)]
    for quantity in LABELS:
        words += _main_effects(comparison, quantity)
        words += _interactions(comparison, quantity)
    leading = leading_axis(comparison)
    return words + (causes(comparison, leading) if leading else []) + inertia(comparison, leading)


def in_few_words(comparison: Findings) -> list[str]:
    """What decides, then doubts and the effects on K: for a screen; ``explain`` has the rest."""
    leading = leading_axis(comparison)
    decisive = [text for text in (causes(comparison, leading) if leading else []) if text.startswith(IN_SHORT)]
    found = _main_effects(comparison, "equivalent_stiffness") if comparison.factorials else [_why_no_effects(comparison)]
    return [*decisive, *_doubts(comparison), *(f"Note: {note}." for note in comparison.notes), *found]


def _what_was_run(comparison: Findings) -> str:
    axes = [f"{axis.key} ({', '.join(shown(v) for v in _few(axis))})" for axis in comparison.axes]
    text = f"{len(comparison.rows)} run{'s' * (len(comparison.rows) != 1)} of one scene that differ only in {listed(axes)}."
    if not comparison.factorials:
        return text
    one, error = next(iter(comparison.factorials.values())), max(f.error for f in comparison.factorials.values())
    text += f" The effects compare the first with the last value of each axis ({one.corners.size} runs)"
    text += ", as geometric means over the other settings"
    text += f", at {settings(comparison.held)}" if comparison.held else ""
    text += f"; the runs' own errors move them by at most {100.0 * error:.2g} %." if error else "."
    unknown = sum(row.doubt is None and not row.estimated for row in comparison.rows)
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
            f"Some of them stand at the ends of the axes, so the effects hold for {settings(comparison.held)} only."
        )
    return words


def _why_no_effects(comparison: Findings) -> str:
    if not comparison.varied:
        return "No effects: every axis has one value."
    return "No effects: too many of the runs at the ends of the axes cannot be used."


def _main_effects(comparison: Findings, quantity: str) -> list[str]:
    factorial, label = comparison.factorials[quantity], LABELS[quantity]
    low, high = factorial.corners.min() / 1e6, factorial.corners.max() / 1e6
    parts, hidden, weak, inert = [], [], [], []
    largest = factorial.effects[0]
    for effect in (e for e in factorial.effects if len(e.term) == 1):
        key = effect.term[0]
        small = abs(effect.log_change) + factorial.error < HARDLY
        if small and max(abs(e.log_change) for e in factorial.effects if key in e.term) + factorial.error < HARDLY:
            inert.append(f"{key} ({percent(effect.log_change)})")
        elif not small and not effect.resolved:
            hidden.append(f"{key} ({percent(effect.log_change)}{_where_resolved(comparison, factorial, key)})")
        elif abs(effect.log_change) < HARDLY:
            weak.append(f"{key} ({percent(effect.log_change)})")
        else:
            share = f"{100.0 * effect.share:.3g} % of the variation"
            if effect is not largest and largest.share > 0.9:
                share = f"{100.0 * effect.share / (1.0 - largest.share):.2g} % of the rest"
            mixed = ", a mean of rises and falls" if _mixed(factorial, key) else ""
            change = f"{percent(effect.log_change)} ({(effect.difference or 0.0) / 1e6:+.2f} N/µm; {share}{mixed})"
            parts.append(f"{step(comparison.axis(key))} changes it by {change}")
    none = "no axis is seen to move it" if hidden else "no axis moves it"
    words = [f"{label} lies between {low:.2f} and {high:.2f} N/µm. On average {'; '.join(parts) or none}."]
    if hidden:
        words.append(
            f"{label}, within the runs' errors of {100.0 * factorial.error:.2g} % and so not resolved: {listed(hidden)}."
        )
    if weak:
        words.append(
            f"{label} on average hardly depends on {listed(weak)}, but does so together with other axes (see below)."
        )
    if inert:
        words.append(f"{label} hardly depends on {listed(inert)}: no effect of it, alone or with others, reaches 0.5 %.")
    return words


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
    factorial, label = comparison.factorials[quantity], LABELS[quantity]
    large = [e for e in factorial.effects if len(e.term) == 2 and abs(e.log_change) >= HARDLY and e.resolved]
    words = []
    for effect in large[:_MOST_INTERACTIONS]:
        given, moved = _ordered(comparison, factorial, effect)
        changes = [factorial.log_change(moved.key, {given.key: end}) for end in (0, 1)]
        words.append(
            f"{label}, interaction of {given.key} and {moved.key}: with {given.key} = {shown(given.ends[0])}, "
            f"{step(moved)} changes it by {percent(changes[0])}, with {shown(given.ends[1])} by {percent(changes[1])}."
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
