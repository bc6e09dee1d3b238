"""Causes of the change of K(w) along the leading axis: usually stiffness over speed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from raceway.studies.compare.effects import Factorial
from raceway.studies.compare.phrases import HARDLY, listed, named, percent, span, step
from raceway.studies.many.axes import Axis, shown

if TYPE_CHECKING:
    from raceway.studies.compare.findings import Findings


#: Beginning of the sentence that says what decides.
IN_SHORT = "In short:"


def leading_axis(comparison: Findings) -> Axis | None:
    """The axis of numbers with most values among those with effects; the first of equals."""
    keys = next(iter(comparison.factorials.values())).keys if comparison.factorials else ()
    numeric = [axis for axis in comparison.axes if axis.key in keys and axis.numeric]
    return max(numeric, key=lambda axis: len(axis.values), default=None)


def partners(factorial: Factorial, key: str) -> list[str]:
    """The other axes, those first that change the effect of ``key`` most."""

    def strength(other: str) -> float:
        return max((abs(e.log_change) for e in factorial.effects if set(e.term) == {key, other}), default=0.0)

    return sorted((other for other in factorial.keys if other != key), key=lambda other: -strength(other))


def causes(comparison: Findings, leading: Axis) -> list[str]:
    """Course, what decides its size, what turns its sense, and direction and amplitude law taken apart."""
    factorial = comparison.factorials["equivalent_stiffness"]
    others = partners(factorial, leading.key)
    if not others:
        return []
    partner = comparison.axis(others[0])
    return [
        *_course(comparison, leading, partner),
        *_size(comparison, leading, partner, others[1:]),
        *_turns(factorial, leading),
        *_amplitude_and_direction(comparison, leading),
        _in_short(comparison, leading, partner, others[1:]),
    ]


def _course(comparison: Findings, leading: Axis, partner: Axis) -> list[str]:
    """Course of K along the leading axis at each value of its strongest partner."""
    trends = [t for t in comparison.trends if t["axis"] == leading.key and t["quantity"] == "equivalent_stiffness"]
    words = []
    for value in partner.values:
        here = [t for t in trends if t["at"][partner.key] == value and t["percent"] is not None]
        if not here:
            continue
        parts = []
        for kind, verb in {
            "rises": "rises",
            "falls": "falls",
            "level": "is level",
            "not monotonic": "is not monotonic",
        }.items():
            changes = [math.log1p(t["percent"] / 100.0) for t in here if t["trend"] == kind]
            if changes:
                parts.append(f"{verb} in {len(changes)} of {len(here)} settings ({span(changes)})")
        left_out = sum(t["doubtful"] for t in here)
        note = f"; doubtful runs between the ends left out: {left_out}" if left_out else ""
        words.append(f"With {partner.key} = {shown(value)}, K(w) along {step(leading)} {listed(parts)}{note}.")
    return words


def _size(comparison: Findings, leading: Axis, partner: Axis, others: list[str]) -> list[str]:
    """Cause of the size of the change, at each end of the strongest partner."""
    factorial = comparison.factorials["equivalent_stiffness"]
    words = []
    for end, value in enumerate(partner.ends):
        given = {partner.key: end}
        pairs = {key: [factorial.log_change(leading.key, {**given, key: e}) for e in (0, 1)] for key in others}
        least = {key: _least(factorial, leading.key, key, given) for key in others}
        strong: list[str] = []
        weak: list[str] = []
        for key, (first, last) in sorted(pairs.items(), key=lambda item: -abs(item[1][1] - item[1][0])):
            ends = comparison.axis(key).ends
            text = f"{named(key)}: {shown(ends[0])} {percent(first)}, {shown(ends[1])} {percent(last)}"
            (strong if abs(last - first) >= least[key] else weak).append(text)
        mean = percent(factorial.log_change(leading.key, given))
        text = f"With {partner.key} = {shown(value)}, {step(leading)} changes K(w) by {mean} on average."
        text += f" What decides how much, the strongest first: {'; '.join(strong)}." if strong else ""
        text += f" Without notable influence on it: {'; '.join(weak)}." if weak else ""
        words.append(text)
    return words


def sense_flips(factorial: Factorial, leading: Axis) -> tuple[np.ndarray, dict[str, int]]:
    """Sense of the change along the leading axis (-1, 0 hardly any, 1) in each setting; how often each axis turns it."""
    others = [key for key in factorial.keys if key != leading.key]
    sense = np.zeros((2,) * len(others))
    for ends in np.ndindex(sense.shape):
        change = factorial.resolved_change(leading.key, dict(zip(others, ends, strict=True)))
        sense[ends] = np.sign(change) if abs(change) >= HARDLY else 0.0
    return sense, {key: int((sense.take(0, axis=k) * sense.take(1, axis=k) < 0).sum()) for k, key in enumerate(others)}


def _turns(factorial: Factorial, leading: Axis) -> list[str]:
    """Which axis, swapped alone, turns a rise along the leading axis into a fall or the reverse."""
    sense, flips = sense_flips(factorial, leading)
    others = list(flips)
    rises, falls = int((sense > 0).sum()), int((sense < 0).sum())
    text = (
        f"Along {leading.key}, K(w) rises in {rises}, falls in {falls} and hardly changes (less than 0.5 % or than its error) in "
        f"{sense.size - rises - falls} of {sense.size} settings."
    )
    turning = sorted((key for key in others if flips[key]), key=lambda key: -flips[key])
    never = [named(key) for key in others if not flips[key]]
    if turning:
        counts = [f"{named(key)} in {flips[key]} of {sense.size // 2} pairs of settings" for key in turning]
        text += f" What turns a rise into a fall when it alone is swapped: {listed(counts)}."
        text += f" What never does: {listed(never)}." if never else ""
    elif rises and falls:
        text += " No axis swapped alone turns a rise into a fall."
    return [text]


def _amplitude_and_direction(comparison: Findings, leading: Axis) -> list[str]:
    """Speed, amplitude law and direction taken apart, where a study varies the latter two along the speed."""
    factorial = comparison.factorials["equivalent_stiffness"]
    kind, law = "excitation.kind", "excitation.amplitude"
    if leading.key != "excitation.speed_rpm" or not {kind, law} <= set(factorial.keys):
        return []
    kinds, laws = comparison.axis(kind).ends, comparison.axis(law).ends
    if set(laws) != {"constant", "unbalance"} or set(kinds) != {"unidirectional", "bidirectional"}:
        return []
    constant, fixed = laws.index("constant"), kinds.index("unidirectional")
    words, by_direction, by_law = [], [], []
    for given, where in comparison.settings(("supports.tilt", "kinematics.ball_inertia")):
        alone, turned, grown, both = (
            factorial.log_change(leading.key, {**given, kind: direction, law: amplitude})
            for amplitude in (constant, 1 - constant)
            for direction in (fixed, 1 - fixed)
        )
        by_direction += [turned - alone, both - grown]
        by_law += [grown - alone, both - turned]
        words.append(
            f"{where or 'Taken apart'}: the speed alone (unidirectional, constant amplitude) changes K(w) by "
            f"{percent(alone)}; with only the direction swapped by {percent(turned)}, with only the amplitude law "
            f"swapped by {percent(grown)}, with both by {percent(both)}."
        )
    words.append(
        f"A bidirectional instead of a unidirectional force multiplies the ratio of K(w) at {shown(leading.ends[1])} "
        f"to that at {shown(leading.ends[0])} r/min by {_factors(by_direction)}; a force that grows as m e w^2 instead of a "
        f"constant one by {_factors(by_law)}."
    )
    return words


def _factors(log_changes: list[float]) -> str:
    low, high = (f"{math.exp(value):.3f}" for value in (min(log_changes), max(log_changes)))
    return low if low == high else f"{low} to {high}"


def _in_short(comparison: Findings, leading: Axis, partner: Axis, others: list[str]) -> str:
    """Cause of the sense and of the size of the change, in one sentence."""
    factorial = comparison.factorials["equivalent_stiffness"]
    flips = sense_flips(factorial, leading)[1]
    turning = [named(key) for key in sorted(flips, key=lambda key: -flips[key]) if flips[key]]
    parts = []
    for end, value in enumerate(partner.ends):
        shift = {key: _shift(factorial, leading.key, key, {partner.key: end}) for key in others}
        first = max(shift, key=lambda key: abs(shift[key]), default=None)
        large = first is not None and abs(shift[first]) >= _least(factorial, leading.key, first, {partner.key: end})
        cause = f"mostly by {named(first)}" if first is not None and large else "by none of the other axes"
        parts.append(f"with {partner.key} = {shown(value)} {cause}")
    sense = f"whether K(w) rises or falls along {leading.key} is decided by {listed(turning)}; " if turning else ""
    return f"{IN_SHORT} {sense}how much it changes is decided {listed(parts)}."


def _least(factorial: Factorial, along: str, key: str, given: dict[str, int]) -> float:
    """Least shift of the change along an axis that counts."""
    return max(HARDLY, sum(factorial.log_error(along, {**given, key: end}) for end in (0, 1)))


def _shift(factorial: Factorial, along: str, key: str, given: dict[str, int]) -> float:
    """By how much one axis shifts the change along another."""
    return factorial.log_change(along, {**given, key: 1}) - factorial.log_change(along, {**given, key: 0})
