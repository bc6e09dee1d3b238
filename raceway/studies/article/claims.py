"""The article's claims: what each asks, the rule that decides, what was computed, and the verdict that follows.

No claim is fitted: a verdict is what its rule says of the numbers, and the rules know nothing of what is wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import attrs
import numpy as np

from raceway.studies.article.curves import ONE_WAY, ROTATING, Curves, modelled
from raceway.studies.article.design import Setting
from raceway.studies.article.regions import Finding, by_tilt, where
from raceway.studies.article.rules import (
    ABOUT,
    LEVEL,
    MISFIT,
    about,
    change_within,
    course,
    influence,
    influence_grows,
    parabola,
    rises_quadratically,
    rises_with_load,
    spread,
)

HOLDS, PARTLY, NOT, FAILED, UNTESTED = "holds", "holds only for", "does not hold", "failed", "cannot be tested"
#: What the text of the article gives.
LARGEST_DEVIATION, HEAVIEST_DEVIATION = 0.0242, 0.0033
LOW_ZONE, HIGH_ZONE = (0.0, 0.25), (0.75, 1.0)
LOW_EFFECT, HIGH_EFFECT = 0.08, 0.34
#: What every rule does with numbers that are missing; the rules do it, here it is said.
_BRIDGED = "unstable motions between the ends are left out, a failed run leaves no judgement"


@attrs.frozen
class Verdict:
    """A claim, or one reading of it.

    Attributes
    ----------
    number : of the claim, with a letter where it has several parts or readings
    claim, rule, computed : in words
    kind : one of HOLDS, PARTLY, NOT, FAILED, UNTESTED
    region : where it holds, of PARTLY
    failed : where runs failed or their motion is unstable, with the first reason; "" where none
    """

    number: str
    claim: str
    rule: str
    computed: str
    kind: str
    region: str = ""
    failed: str = ""
    findings: tuple[Finding, ...] = ()

    @property
    def words(self) -> str:
        return f"{self.kind} {self.region}" if self.region else self.kind

    def as_dict(self) -> dict[str, Any]:
        plain = attrs.asdict(self, filter=lambda field, _: field.name != "findings")
        return {**plain, "verdict": self.words, "findings": [one.as_dict() for one in self.findings]}


def judge(number: str, claim: str, rule: str, computed: str, findings: Sequence[Finding]) -> Verdict:
    """The verdict that follows from a rule's outcome at every place.

    Notes
    -----
    Failed places never count as holding: with one of them a claim that holds everywhere else holds only for the rest.
    """
    judged = [one for one in findings if one.holds is not None]
    failed = ""
    if len(judged) < len(findings):
        reason = next(one.why for one in findings if one.holds is None)
        failed = f"{where(findings, None)} (the first reason: {reason or 'a run is missing'})"
    if not judged:
        kind = FAILED
    elif not any(one.holds for one in judged):
        kind = NOT
    else:
        kind = HOLDS if all(one.holds for one in findings) else PARTLY
    region = where(findings, True) if kind == PARTLY else ""
    return Verdict(number, claim, rule, computed, kind, region, failed, tuple(findings))


def verdicts(curves: Curves, static: Sequence[Mapping[str, Any]]) -> list[Verdict]:
    """Every claim.

    Parameters
    ----------
    static : rows of the static verification, as ``raceway verify`` gives them
    """
    return [
        *_static(static),
        _rig(),
        *_one_way(curves),
        _rotating(curves),
        *_axial(curves),
        *_both(curves),
    ]


def _static(rows: Sequence[Mapping[str, Any]]) -> list[Verdict]:
    pressures = [row for row in rows if not row["quantity"].startswith("mesh independence")]
    found = [Finding({"case": row["quantity"]}, None if row["error"] is None else row["error"] <= LARGEST_DEVIATION,
                     row["error"], row["note"]) for row in pressures]  # fmt: skip
    heaviest = [one for one in found if "inner" in one.at["case"] and "2000 N axial" in one.at["case"]]
    heavy = [attrs.evolve(one, holds=None if one.value is None else one.value <= HEAVIEST_DEVIATION) for one in heaviest]
    rule = "computed nodal pressure against exact Hertz at the same load: largest relative deviation at most {:.2%}"
    largest = max((one.value for one in found if one.value is not None), default=None)
    text = "no number" if largest is None else f"largest deviation {largest:.2%} of {len(found)} pressures"
    heavy_text = "; ".join(f"{one.value:.2%}" for one in heavy if one.value is not None) or "no number"
    return [
        judge("1a", "Static peak pressures are within 2.42 % of exact Hertz in four load cases.",
              rule.format(LARGEST_DEVIATION), text, found),
        judge("1b", "In the heaviest case the inner race's is within 0.33 %.",
              "2000 N axial, inner race: " + rule.format(HEAVIEST_DEVIATION), heavy_text, heavy),
    ]  # fmt: skip


def _rig() -> Verdict:
    return Verdict(
        "2",
        "Stiffness is within 9.12 % of the rig's.",
        "none: the table of measured stiffnesses is not in the text that is left of the article",
        "K at the rig's speeds and loads is reported in a table of its own",
        UNTESTED,
    )


def _course(
    curves: Curves, excitation: Mapping[str, Any], measure: str, judged: Callable[..., bool | None]
) -> list[Finding]:
    """A rule of (values, errors, failed) for curves over speed, at every way to model and every load; the value is k*(1)."""
    found = []
    for model in modelled(curves.design.bodies):
        setting = Setting(**excitation, **model)
        for load in curves.design.loads:
            values, errors = curves.values(setting, load, measure), curves.errors(setting, load)
            ratio = values[-1] / values[0]
            at = {**model, "load": load}
            value = float(ratio) if np.isfinite(ratio) else None
            outcome = judged(values, errors, curves.failed(setting, load))
            found.append(Finding(at, outcome, value, curves.why_not(setting, load) if outcome is None else ""))
    return found


def _one_way(curves: Curves) -> list[Verdict]:
    rule = (
        f"unidirectional force, constant amplitude: falls at every step of the speed, and by at least {LEVEL:.1%} over the range; "
        f"{_BRIDGED}"
    )

    def falls(values: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> bool | None:
        found = course(values, errors, failed)
        return None if found is None else found == "falls"

    out = []
    for letter, measure, words in (("a", "K", "K = Re Z + m w²"), ("b", "|Z|", "|Z|, which holds the inertia of the mass")):
        found = _course(curves, ONE_WAY, measure, falls)
        text = f"k*(w* = 1): {by_tilt(found)}"
        claim = f"Unidirectional: the radial stiffness falls with speed; k = {words}."
        out.append(judge(f"3{letter}", claim, rule, text, found))
    return out


def _rotating(curves: Curves) -> Verdict:
    w = np.array(curves.design.relative_speeds)
    found = _course(curves, ROTATING, "K", lambda *numbers: rises_quadratically(w, *numbers))
    shares = []
    for one in found:
        if one.holds:
            model: dict[str, Any] = {key: one.at[key] for key in ("tilt", "inertia", "bodies")}
            setting = Setting(**ROTATING, **model)
            shares.append(parabola(w, curves.normalised(setting, one.at["load"])).bend_share)
    first, last = curves.design.speeds[0], curves.design.speeds[-1]
    text = f"k*(w* = 1): {by_tilt(found)}"
    if shares:
        text += (
            f". Where it rises, {min(shares):.0%} to {max(shares):.0%} of the rise is quadratic in w* (a law in w² alone: "
        )
        text += f"{(last - first) / (last + first):.0%})"
    rule = (
        f"rotating force m e w²: K rises at every step of the speed, by at least {LEVEL:.1%}, and the parabola "
        f"1 + a w* + b w*² has b > 0 and leaves at most {MISFIT:.0%} of the rise; {_BRIDGED}"
    )
    return judge("4", "Bidirectional: rises roughly quadratically with speed.", rule, text, found)


@attrs.frozen
class _Effect:
    """An effect in the low and in the high zone of the speed; None where a number is missing."""

    at: dict[str, Any]
    low: float | None
    high: float | None
    why: str

    @property
    def as_claimed(self) -> bool | None:
        if self.low is None or self.high is None:
            return None
        return about(self.low, LOW_EFFECT) and about(self.high, HIGH_EFFECT)

    @property
    def growth(self) -> float | None:
        return None if self.low is None or self.high is None else self.high - self.low


_READINGS = {
    "a": ("effect of speed inside each zone", "size of the change of K at one axial load: K(0.25)/K(0) and K(1)/K(0.75)"),
    "b": ("effect of speed up to the end of each zone", "size of the change at one axial load: k*(0.25) and k*(1)"),
    "c": ("effect of the axial load on K", "largest K over smallest, of all axial loads, where that is largest in the zone"),
    "d": (
        "effect of the axial load on k*",
        "largest k* over smallest, of all axial loads, where that is largest in the zone",
    ),
}


def _effects(curves: Curves) -> dict[str, list[_Effect]]:
    """The two effects in every reading, wherever it can be taken."""
    w = np.array(curves.design.relative_speeds)
    found: dict[str, list[_Effect]] = {letter: [] for letter in _READINGS}
    for model in modelled(curves.design.bodies):
        setting = Setting(**ROTATING, **model)
        surface, _, failed = curves.surface(setting)
        why = _why(curves, setting)
        for load, values, lost in zip(curves.design.loads, surface, failed, strict=True):
            at = {**model, "load": load}
            for letter, begin in (("a", HIGH_ZONE[0]), ("b", 0.0)):
                low = change_within(w, values, lost, *LOW_ZONE)
                high = change_within(w, values, lost, begin, HIGH_ZONE[1])
                found[letter].append(_Effect(at, low, high, why))
        for letter, values in (("c", surface), ("d", surface / surface[:, :1])):
            low, high = spread(w, values, failed, *LOW_ZONE), spread(w, values, failed, *HIGH_ZONE)
            found[letter].append(_Effect(model, low, high, why))
    return found


def _axial(curves: Curves) -> list[Verdict]:
    """Both readings of the two percentages, each in two ways to take a change."""
    effects = _effects(curves)
    asked = f"about {LOW_EFFECT:.0%} and about {HIGH_EFFECT:.0%} (each within {ABOUT:.0%} of the number); {_BRIDGED}"
    claim = "Axial load: about 8 % effect for w* from 0 to 0.25, about 34 % from 0.75 to 1"
    out = []
    for letter, (of, words) in _READINGS.items():
        low = [Finding(one.at, one.as_claimed, one.low, one.why) for one in effects[letter]]
        high = [Finding(one.at, one.as_claimed, one.high, one.why) for one in effects[letter]]
        text = f"low zone: {by_tilt(low, 100.0, ' %', '.1f')}. High zone: {by_tilt(high, 100.0, ' %', '.1f')}"
        out.append(judge(f"5{letter}", f"{claim}; read as {of}.", f"{words}: {asked}", text, high))
    grows = [Finding(one.at, None if one.growth is None else one.growth > 0.0, one.growth, one.why) for one in effects["c"]]
    text = f"change of that effect from the low to the high zone, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}"
    rule = f"the effect of 5c is larger in the high zone than in the low one; {_BRIDGED}"
    out.append(judge("5e", "The influence of the axial load grows with speed.", rule, text, grows))
    return out


def _why(curves: Curves, setting: Setting) -> str:
    """What is missing at any axial load."""
    return "; ".join(filter(None, (curves.why_not(setting, load) for load in curves.design.loads)))


def _both(curves: Curves) -> list[Verdict]:
    rises, with_load, grows, whole = [], [], [], []
    for model in modelled(curves.design.bodies):
        setting = Setting(**ROTATING, **model)
        surface, errors, failed = curves.surface(setting)
        why = _why(curves, setting)
        parts: list[bool | None] = []
        rising = rises_with_load(surface, errors, failed)
        for speed, holds, column in zip(curves.design.speeds, rising, surface.T, strict=True):
            parts.append(holds)
            ratio = column[-1] / column[0]
            with_load.append(Finding({**model, "speed": speed}, holds, float(ratio) if np.isfinite(ratio) else None, why))
        for load, values, error, lost in zip(curves.design.loads, surface, errors, failed, strict=True):
            run = course(values, error, lost)
            parts.append(None if run is None else run == "rises")
            ratio = values[-1] / values[0]
            rises.append(Finding({**model, "load": load}, parts[-1], float(ratio) if np.isfinite(ratio) else None, why))
        more = influence_grows(surface, failed)
        change = influence(surface)
        value = float(change[-1] - change[0]) if np.isfinite(change[[0, -1]]).all() else None
        grows.append(Finding(model, more, value, why))
        parts.append(more)
        together = None if None in parts else False not in parts
        whole.append(Finding(model, together, None, why))
    first, last = curves.design.loads[0], curves.design.loads[-1]
    step = "rotating force m e w²: K rises at every step of the"
    return [
        judge("6a", "The stiffness rises with axial load.", f"{step} axial load, at each speed; {_BRIDGED}",
              f"K at {last:g} N over K at {first:g} N: {by_tilt(with_load)}", with_load),
        judge("6b", "The stiffness rises with speed.", f"{step} speed, at each axial load, by at least {LEVEL:.1%}; {_BRIDGED}",
              f"k*(w* = 1): {by_tilt(rises)}", rises),
        judge("6c", "The speed's influence grows with axial load.",
              "the size of the change with speed, |k*(1) - 1|, rises at every step of the axial load; a failed run at any speed or "
              "an unstable motion at either end leaves no judgement",
              f"from {first:g} to {last:g} N that size changes by, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}",
              grows),
        judge("6", "All of this together.", "6a, 6b and 6c, at all speeds and axial loads", "see 6a, 6b and 6c", whole),
    ]  # fmt: skip
