"""The article's claims, each with its rule, what was computed and the verdict that follows.

No claim is fitted: a verdict is what its rule states of the numbers.  Claims 4 to 6 are judged for K and for |Z|, of which the
article does not say which one its stiffness is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article import rules
from raceway.studies.article.design import FRICTION_WORDS, MEASURES, ONE_WAY, ROTATING, TILT_WORDS, Curves
from raceway.studies.article.rules import BRIDGED, LEVEL, Exponent, Finding, Verdict, by_tilt, course, judge

#: What the text of the article states: deviations of peak pressures; effects of the axial load in two zones of w*.
_LARGEST_DEVIATION, _HEAVIEST_DEVIATION = 0.0242, 0.0033
_LOW_ZONE, _HIGH_ZONE = (0.0, 0.25), (0.75, 1.0)
_LOW_EFFECT, _HIGH_EFFECT = 0.08, 0.34
#: Readings of claim 5: number -> effect, rule.
_READINGS = {
    "5a": ("effect of speed inside each zone", "rise of k at one axial load: k(0.25)/k(0) − 1 and k(1)/k(0.75) − 1"),
    "5b": ("effect of speed up to the end of each zone", "rise at one axial load: k*(0.25) − 1 and k*(1) − 1"),
    "5c": ("effect of the axial load on k", "largest k over smallest, of all axial loads, where that is largest in the zone"),
    "5d": ("effect of the axial load on k*", "largest k* over smallest, of all axial loads, where that is largest in the zone"),
}  # fmt: skip

#: Number, claim, rule, what was computed, outcomes of the rule.
_Row = tuple[str, str, str, str, list[Finding]]


def verdicts(curves: Curves, static: Sequence[ReadTables]) -> list[Verdict]:
    """Every claim.

    Parameters
    ----------
    static : rows of the static verification, as ``raceway verify`` computes them
    """
    out = [*_not_testable(static), *(judge(*row) for row in _unidirectional(curves))]
    for measure in MEASURES:
        rows = [*_hardening(curves, measure), *_axial(curves, measure), *_combined(curves, measure)]
        mark, ending = ("", "") if measure == "K" else (f" {measure}", f" k = {measure}.")
        for number, claim, rule, computed, findings in rows:
            out.append(judge(f"{number}{mark}", f"{claim}{ending}", rule, computed, findings))
    # Each claim for K, and at once for |Z|.
    return sorted(out, key=lambda verdict: verdict.number[0])


def _not_testable(static: Sequence[ReadTables]) -> list[Verdict]:
    """Claims 1 and 2: load cases and measured stiffnesses are lost, so that there are only our numbers to report."""
    pressures = [row for row in static if not row["quantity"].startswith("mesh independence")]
    heaviest = [row for row in pressures if "inner" in row["quantity"] and "2000 N axial" in row["quantity"]]
    rule = "none: the load cases are not in the text that is left of the article, so that no case can be computed again"
    out = []
    for number, claim, rows, deviation in (
        ("1a", f"Static peak pressures are within {_LARGEST_DEVIATION:.2%} of exact Hertz in four load cases.", pressures,
         "largest deviation of the peak pressures in four load cases of our own"),
        ("1b", f"In the heaviest case the inner race's is within {_HEAVIEST_DEVIATION:.2%}.", heaviest,
         "deviation of the inner race's peak pressure at 2000 N axial, the heaviest of ours"),
    ):  # fmt: skip
        errors = [row["error"] for row in rows if row["error"] is not None]
        computed = f"{deviation}: {max(errors):.2%}" if errors else "no number"
        failed = next((row["note"] for row in rows if row["error"] is None), "")
        out.append(
            Verdict(number, claim, rule, computed, rules.UNTESTED if errors or not rows else rules.FAILED, failed=failed)
        )
    rule = "none: the table of measured stiffnesses is not in the text that is left of the article"
    computed = "K at the rig's speeds and loads is reported in a table of its own"
    return [*out, Verdict("2", "Stiffness is within 9.12 % of the rig's.", rule, computed, rules.UNTESTED)]


def _unidirectional(curves: Curves) -> list[_Row]:
    """Claim 3: under a force along one line the stiffness falls with speed."""
    rule = (
        f"unidirectional force, constant amplitude: falls at every step of the speed, and by at least {LEVEL:.1%} over the range; "
        f"{BRIDGED}"
    )
    rows = []
    for number, measure, words in (
        ("3a", "K", "K = Re Z + m w²"),
        ("3b", "|Z|", "|Z|, which holds the inertia of the mass"),
    ):
        findings = []
        for model, surface in curves.surfaces(ONE_WAY):
            for curve in surface.curves:
                values = curve.values(measure)
                falls = _is("falls", course(values, curve.errors, curve.failed))
                why = curve.missing if falls is None else ""
                findings.append(Finding({**model, "load": curve.load}, falls, _ratio(values), why))
        claim = f"Unidirectional: the radial stiffness falls with speed; k = {words}."
        rows.append((number, claim, rule, f"k*(w* = 1): {by_tilt(findings)}", findings))
    return rows


def _is(word: str, outcome: str | None) -> bool | None:
    return None if outcome is None else outcome == word


def _ratio(values: np.ndarray) -> float | None:
    """The last of the values over the first; None where a number is missing."""
    ratio = values[-1] / values[0]
    return float(ratio) if np.isfinite(ratio) else None


#: Exponent of K over the speed, from relative and absolute speeds, values and relative errors (n,).
_Fit = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], Exponent | None]


def _in_speed(_w: np.ndarray, speeds: np.ndarray, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    return rules.exponent(speeds / speeds[-1], values / values[0], errors * values / values[0], constant=True)


def _above_lowest(w: np.ndarray, _speeds: np.ndarray, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    star = values / values[0]
    return rules.exponent(w[1:], star[1:] - 1.0, (errors * star)[1:], constant=False)


def _hardening(curves: Curves, measure: str) -> list[_Row]:
    """Claim 4, "approximately quadratic", in two readings, and in either."""
    claim = "Bidirectional: rises roughly quadratically with speed"
    rows: list[_Row] = []
    for number, words, law, fit in (
        ("4a", "in the speed", f"{measure} = a + c w^p", _in_speed),
        ("4b", "in the speed above the lowest", "k* − 1 = c w*^p", _above_lowest),
    ):
        rule = (
            f"rotating force m e w²: {measure} rises at every step of the speed, by at least {LEVEL:.1%}, and by least squares {law} "
            f"has p from {rules.NEAREST[0]:g} to {rules.NEAREST[1]:g} and a 95 % interval without 1, the straight line; {BRIDGED}"
        )
        findings, powers = _powers(curves, measure, fit)
        rows.append((number, f"{claim}; read as {words}.", rule, f"k*(w* = 1): {by_tilt(findings)}{powers}", findings))
    either = [
        Finding(a.at, None if a.holds is None and not b.holds else bool(a.holds or b.holds), a.value, a.why or b.why)
        for a, b in zip(rows[0][-1], rows[1][-1], strict=True)
    ]
    return [("4", f"{claim}.", "4a or 4b", "see 4a and 4b", either), *rows]


def _powers(curves: Curves, measure: str, fit: _Fit) -> tuple[list[Finding], str]:
    """Outcomes for every model and load, and the exponents where k rises, in words."""
    findings: list[Finding] = []
    rising: dict[str, list[Exponent]] = {}
    for model, surface in curves.surfaces(ROTATING):
        speeds, w = np.array(surface.speeds), np.array(curves.design.relative(surface.speeds))
        for curve in surface.curves:
            values, errors = curve.values(measure), curve.errors
            rises = _is("rises", course(values, errors, curve.failed))
            power = fit(w, speeds, values, errors) if rises else None
            quadratic = rises if not rises else None if power is None else power.roughly_quadratic
            why = "" if quadratic is not None else curve.missing or "too few speeds for an exponent's interval"
            findings.append(Finding({**model, "load": curve.load}, quadratic, _ratio(values), why))
            if power is not None:
                region = f"{FRICTION_WORDS[model['friction']]}, {TILT_WORDS[model['tilt']]}"
                rising.setdefault(region, []).append(power)
    words = [
        f"{region} p = {min(p.value for p in powers):.2f} to {max(p.value for p in powers):.2f}, "
        f"intervals from {min(p.low for p in powers):.2f} to {max(p.high for p in powers):.2f}"
        for region, powers in rising.items()
    ]
    return findings, f". Where it rises: {'; '.join(words)}" if words else ""


class _Effect(NamedTuple):
    """An effect in the low and in the high zone of the speed, a fall with its sign; None where a number is missing."""

    at: Tables
    low: float | None
    high: float | None
    why: str


def _effects(curves: Curves, measure: str) -> dict[str, list[_Effect]]:
    """The two effects in every reading, wherever it can be taken."""
    effects: dict[str, list[_Effect]] = {number: [] for number in _READINGS}
    for model, surface in curves.surfaces(ROTATING):
        w, values, failed, why = (
            np.array(curves.design.relative(surface.speeds)),
            surface.values(measure),
            surface.failed,
            surface.missing,
        )
        for load, k, lost in zip(surface.loads, values, failed, strict=True):
            low = rules.change_within(w, k, lost, *_LOW_ZONE)
            for number, begin in (("5a", _HIGH_ZONE[0]), ("5b", 0.0)):
                high = rules.change_within(w, k, lost, begin, _HIGH_ZONE[1])
                effects[number].append(_Effect({**model, "load": load}, low, high, why))
        for number, k in (("5c", values), ("5d", values / values[:, :1])):
            low, high = (rules.spread(w, k, failed, *zone) for zone in (_LOW_ZONE, _HIGH_ZONE))
            effects[number].append(_Effect(model, low, high, why))
    return effects


def _axial(curves: Curves, measure: str) -> list[_Row]:
    """Claim 5: about 8 % at low speeds and 34 % at high ones in every reading, and whether the effect grows."""
    effects, rows = _effects(curves, measure), list[_Row]()
    expected = (
        f"about {_LOW_EFFECT:.0%} and about {_HIGH_EFFECT:.0%} (each within {rules.ABOUT:.0%} of the number); {BRIDGED}"
    )
    claim = "Axial load: about 8 % effect for w* from 0 to 0.25, about 34 % from 0.75 to 1"
    for number, (effect, words) in _READINGS.items():
        zones = []
        for zone in ("low", "high"):
            zones.append([Finding(e.at, _as_claimed(e), getattr(e, zone), e.why) for e in effects[number]])
        low, high = (by_tilt(findings, 100.0, " %", ".1f") for findings in zones)
        computed = f"low zone: {low}. High zone: {high}"
        rows.append((number, f"{claim}; read as {effect}.", f"{words}: {expected}", computed, zones[1]))
    grows = []
    for at, low_effect, high_effect, why in effects["5c"]:
        growth = None if low_effect is None or high_effect is None else high_effect - low_effect
        grows.append(Finding(at, None if growth is None else growth > 0.0, growth, why))
    computed = (
        f"change of that effect from the low to the high zone, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}"
    )
    rule = f"the effect of 5c is larger in the high zone than in the low one; {BRIDGED}"
    return [*rows, ("5e", "The influence of the axial load grows with speed.", rule, computed, grows)]


def _as_claimed(effect: _Effect) -> bool | None:
    if effect.low is None or effect.high is None:
        return None
    return rules.about(effect.low, _LOW_EFFECT) and rules.about(effect.high, _HIGH_EFFECT)


def _combined(curves: Curves, measure: str) -> list[_Row]:
    """Claim 6: k rises with axial load, with speed, the speed's influence with axial load, and all of this."""
    with_load, with_speed, grows, together = [], [], [], []
    for model, surface in curves.surfaces(ROTATING):
        values, errors, failed, why = surface.values(measure), surface.errors, surface.failed, surface.missing
        rising = rules.rises_with_load(values, errors, failed)
        with_load += [
            Finding({**model, "speed": speed}, rises, _ratio(column), why)
            for speed, rises, column in zip(surface.speeds, rising, values.T, strict=True)
        ]
        courses = [_is("rises", course(*curve)) for curve in zip(values, errors, failed, strict=True)]
        with_speed += [
            Finding({**model, "load": load}, rises, _ratio(k), why)
            for load, rises, k in zip(surface.loads, courses, values, strict=True)
        ]
        more, change = rules.influence_grows(values, failed), rules.influence(values)
        growth = float(change[-1] - change[0]) if np.isfinite(change[[0, -1]]).all() else None
        grows.append(Finding(model, more, growth, why))
        parts = [*rising, *courses, more]
        together.append(Finding(model, None if None in parts else False not in parts, None, why))
    first, last = curves.design.loads[0], curves.design.loads[-1]
    step = f"rotating force m e w²: {measure} rises at every step of the"
    return [
        ("6a", "The stiffness rises with axial load.", f"{step} axial load, at each speed; {BRIDGED}",
         f"{measure} at {last:g} N over {measure} at {first:g} N: {by_tilt(with_load)}", with_load),
        ("6b", "The stiffness rises with speed.", f"{step} speed, at each axial load, by at least {LEVEL:.1%}; {BRIDGED}",
         f"k*(w* = 1): {by_tilt(with_speed)}", with_speed),
        ("6c", "The speed's influence grows with axial load.",
         "the size of the change with speed, |k*(1) - 1|, rises at every step of the axial load; a failed run at any speed or "
         "an unstable motion at either end leaves no judgement",
         f"from {first:g} to {last:g} N that size changes by, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}", grows),
        ("6", "All of this together.", "6a, 6b and 6c, at all speeds and axial loads", "see 6a, 6b and 6c", together),
    ]  # fmt: skip
