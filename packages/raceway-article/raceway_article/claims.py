"""The article's claims, each with its rule, what was computed and the verdict that follows.

No claim is fitted: a verdict is what its rule states of the numbers.  Claims 4 to 6 are judged for K and for |Z|, of which the
article does not say which one its stiffness is.

A rule is a function of arrays, which returns None where numbers are missing.  A number that is missing is nan.  Where ``failed`` is
True a run failed or was refused: nothing is judged over such a gap.  The other numbers that are missing belong to unstable motions:
those between two numbers are bridged, those at an end leave no judgement.

For each exponent p a power law is linear in its other numbers.  The interval of p holds every exponent whose sum of squared
residuals stays below S (1 + t^2 / (n - m)) + 3.84 e^2: S is the least sum, e the root mean square of the runs' errors, n numbers,
m parameters, t Student's and 3.84 chi squared at 95 %.

Seber, Wild, Nonlinear Regression (1989), section 5.4 (intervals from the sum of squares).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from raceway_checks.verify.reference import Verified

from raceway.extend import Tables
from raceway_article.design import FRICTION_WORDS, MEASURES, ONE_WAY, ROTATING, TILT_WORDS, Curves
from raceway_article.rules import BRIDGED, FAILED, HOLDS, LEVEL, NOT, PARTLY, UNTESTED, Finding, Verdict
from raceway_article.courses import (
    ABOUT, NEAREST, Exponent, change_within, course, influence, influence_grows, is_about, load_effect, power_exponent,
    rises_with_load,
)  # fmt: skip

#: What the text of the article states: deviations of peak pressures; effects of the axial load in two zones of w*.
_LARGEST_DEVIATION, _HEAVIEST_DEVIATION = 0.0242, 0.0033
_LOW_ZONE, _HIGH_ZONE = (0.0, 0.25), (0.75, 1.0)
_LOW_EFFECT, _HIGH_EFFECT = 0.08, 0.34
#: Readings of claim 5: number -> claim, rule.
_READINGS = {
    "5a": ("With speed {} rises by about 8 % from w* = 0 to 0.25 and by about 34 % from 0.75 to 1.", "rise of k at one axial load: k(0.25)/k(0) − 1 and k(1)/k(0.75) − 1"),
    "5b": ("With speed {} rises by about 8 % up to w* = 0.25 and by about 34 % up to 1.", "rise at one axial load: k*(0.25) − 1 and k*(1) − 1"),
    "5c": ("Axial load changes {} by about 8 % up to w* = 0.25 and by about 34 % from 0.75.", "largest k over smallest, of all axial loads, where that is largest in the zone"),
    "5d": ("Axial load changes k* (k = {}) by about 8 % up to w* = 0.25 and by about 34 % from 0.75.", "largest k* over smallest, of all axial loads, where that is largest in the zone"),
}  # fmt: skip

#: Number, claim, rule, what was computed, outcomes of the rule.
_Row = tuple[str, str, str, str, list[Finding]]
_ORDER = ("friction", "tilt", "inertia", "bodies", "speed", "load")


def region_of(findings: Sequence[Finding], holds: bool | None) -> str:
    """The region with one outcome; "everywhere", "nowhere", or phrases between semicolons."""
    keys = [key for key in _ORDER if any(key in finding.at for finding in findings)]
    phrases = _phrases([(dict(finding.at), finding.holds is holds) for finding in findings], keys)
    if phrases is None:
        return "nowhere"
    return "; ".join(phrases) if phrases != [""] else "everywhere"


def _phrases(items: list[tuple[Tables, bool]], keys: list[str]) -> list[str] | None:
    """[""] for all of the items, None for none, else a phrase for each part."""
    if all(inside for _, inside in items):
        return [""]
    if not any(inside for _, inside in items) or not keys:
        return None
    key, *remaining = keys
    values: list[Any] = list(dict.fromkeys(at.get(key) for at, _ in items))
    below = {value: _phrases([item for item in items if item[0].get(key) == value], remaining) for value in values}
    if len({str(part) for part in below.values()}) == 1:
        return below[values[0]]
    phrases: list[str] = []
    for text in dict.fromkeys(str(part) for part in below.values() if part is not None):
        same = [value for value in values if str(below[value]) == text]
        if key == "tilt":
            name = "tilt " + " or ".join(TILT_WORDS[value].removeprefix("tilt ") for value in same)
        elif key == "friction":
            name = " or ".join(FRICTION_WORDS[value] for value in same)
        elif key == "inertia":
            name = "with ball inertia" if same[0] else "weightless balls"
        elif key == "bodies":
            name = f"{' or '.join(same)} bodies"
        else:
            name = _ranges(same, values, "N" if key == "load" else "r/min")
        phrases += [f"{name}, {phrase}" if phrase else name for phrase in below[same[0]] or []]
    return phrases


def _ranges(values: Sequence[float], every: Sequence[float], unit: str) -> str:
    """Neighbours as one range."""
    runs: list[list[float]] = [[]]
    for value in every:
        if value in values:
            runs[-1].append(value)
        elif runs[-1]:
            runs.append([])
    words = [f"{run[0]:g}" if len(run) == 1 else f"{run[0]:g} to {run[-1]:g}" for run in runs if run]
    return f"{' and '.join(words)} {unit}"


def _by_tilt(findings: Sequence[Finding], scale: float = 1.0, unit: str = "", form: str = ".3f") -> str:
    """The range of the values at each tilt boundary, for each kind of friction."""
    texts = {}
    for friction in dict.fromkeys(finding.at.get("friction") for finding in findings):
        with_friction = [finding for finding in findings if finding.at.get("friction") == friction]
        parts = []
        for tilt in dict.fromkeys(finding.at["tilt"] for finding in with_friction):
            values = [scale * f.value for f in with_friction if f.at["tilt"] == tilt and f.value is not None]
            ends = dict.fromkeys(f"{value:{form}}" for value in (min(values), max(values))) if values else {}
            parts.append(f"{TILT_WORDS[tilt]}: {' to '.join(ends)}{unit}" if ends else f"{TILT_WORDS[tilt]}: no number")
        texts[str(friction)] = "; ".join(parts)
    if len(texts) < 2:
        return "".join(texts.values())
    return ". ".join(f"{FRICTION_WORDS[friction].capitalize()}: {text}" for friction, text in texts.items())


def verdict_of(number: str, claim: str, rule: str, computed: str, findings: Sequence[Finding]) -> Verdict:
    """The verdict that follows from the outcomes of a rule.

    Failed places never count as holding: with one of them a claim that holds everywhere else holds only for the remaining ones.
    """
    outcomes = [finding.holds for finding in findings if finding.holds is not None]
    failures = region = ""
    if len(outcomes) < len(findings):
        reason = next(finding.why for finding in findings if finding.holds is None)
        failures = f"{region_of(findings, None)} (the first reason: {reason or 'a run is missing'})"
    if not outcomes:
        kind = FAILED
    elif not any(outcomes):
        kind = NOT
    elif all(finding.holds for finding in findings):
        kind = HOLDS
    else:
        kind, region = PARTLY, region_of(findings, True)
    return Verdict(number, claim, rule, computed, kind, region, failures, tuple(findings))


def verdicts(curves: Curves, static: Sequence[Verified]) -> list[Verdict]:
    """Every claim; ``static`` are rows of the static verification, as ``raceway verify`` computes them."""
    out = [*_not_testable(static), *(verdict_of(*row) for row in _unidirectional(curves))]
    for measure in MEASURES:
        rows = [*_hardening(curves, measure), *_axial(curves, measure), *_joint_effect(curves, measure)]
        mark = "" if measure == "K" else f" {measure}"
        out += [verdict_of(f"{number}{mark}", claim, rule, computed, found) for number, claim, rule, computed, found in rows]
    # Each claim for K, and at once for |Z|.
    return sorted(out, key=lambda verdict: verdict.number[0])


def _not_testable(static: Sequence[Verified]) -> list[Verdict]:
    """Claims 1 and 2: load cases and measured stiffnesses are lost, so that there are only our numbers to report."""
    pressures = [row for row in static if not row.quantity.startswith("mesh independence")]
    heaviest = [row for row in pressures if "inner" in row.quantity and "2000 N axial" in row.quantity]
    rule = "none: the load cases are not in the text that is left of the article, so that no case can be computed again"
    out = []
    for number, claim, rows, deviation in (
        ("1a", f"Peak pressures at rest are within {_LARGEST_DEVIATION:.2%} of Hertz in four load cases.", pressures,
         "largest deviation of the peak pressures in four load cases of our own"),
        ("1b", f"In the heaviest, that of the inner race is within {_HEAVIEST_DEVIATION:.2%}.", heaviest,
         "deviation of the inner race's peak pressure at 2000 N axial, the heaviest of ours"),
    ):  # fmt: skip
        errors = [row.error for row in rows if row.error is not None]
        finding = f"{deviation}: {max(errors):.2%}" if errors else "no number"
        failures = next((row.note for row in rows if row.error is None), "")
        out.append(Verdict(number, claim, rule, finding, UNTESTED if errors or not rows else FAILED, failed=failures))
    rule = "none: the table of measured stiffnesses is not in the text that is left of the article"
    finding = "K at the rig's speeds and loads is reported in a table of its own"
    return [*out, Verdict("2", "Stiffness is within 9.12 % of that measured on the rig.", rule, finding, UNTESTED)]


def _unidirectional(curves: Curves) -> list[_Row]:
    """Claim 3: under a force along one line the stiffness falls with speed."""
    falling = f"falls at every step of the speed, and by at least {LEVEL:.1%} over the range; {BRIDGED}"
    rule = f"unidirectional force, constant amplitude: {falling}"
    rows = []
    for number, measure in (("3a", "K"), ("3b", "|Z|")):
        findings = []
        for model, surface in curves.surfaces(ONE_WAY):
            for curve in surface.curves:
                values = curve.values(measure)
                falls = _is("falls", course(values, curve.errors, curve.failed))
                why = curve.missing if falls is None else ""
                findings.append(Finding({**model, "load": curve.load}, falls, _ratio(values), why))
        claim = f"Under a unidirectional force {measure} falls with speed."
        rows.append((number, claim, rule, f"k*(w* = 1): {_by_tilt(findings)}", findings))
    return rows


def _is(word: str, outcome: str | None) -> bool | None:
    return None if outcome is None else outcome == word


def _ratio(values: np.ndarray) -> float | None:
    """The last of the values over the first; None where a number is missing."""
    ratio = values[-1] / values[0]
    return float(ratio) if np.isfinite(ratio) else None


def _in_speed(_w: np.ndarray, speeds: np.ndarray, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    return power_exponent(speeds / speeds[-1], values / values[0], errors * values / values[0], constant=True)


def _above_lowest(w: np.ndarray, _speeds: np.ndarray, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    star = values / values[0]
    return power_exponent(w[1:], star[1:] - 1.0, (errors * star)[1:], constant=False)


def _hardening(curves: Curves, measure: str) -> list[_Row]:
    """Claim 4, "approximately quadratic", in two readings, and in either."""
    claim = f"Under a rotating force {measure} rises about quadratically with speed"
    rows: list[_Row] = []
    for number, law, fit in (("4a", f"{measure} = a + c w^p", _in_speed), ("4b", "k* − 1 = c w*^p", _above_lowest)):
        rule = (
            f"rotating force m e w²: {measure} rises at every step of the speed, by at least {LEVEL:.1%}, and by least squares {law} "
            f"has p from {NEAREST[0]:g} to {NEAREST[1]:g} and a 95 % interval without 1, the straight line; {BRIDGED}"
        )
        # Outcomes for every model and load, and the exponents where k rises
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
        exponents = [
            f"{region} p = {min(p.value for p in powers):.2f} to {max(p.value for p in powers):.2f}, "
            f"intervals from {min(p.low for p in powers):.2f} to {max(p.high for p in powers):.2f}"
            for region, powers in rising.items()
        ]
        powers = f". Where it rises: {'; '.join(exponents)}" if exponents else ""
        rows.append((number, f"{claim}: {law}.", rule, f"k*(w* = 1): {_by_tilt(findings)}{powers}", findings))
    either = [
        Finding(a.at, None if a.holds is None and not b.holds else bool(a.holds or b.holds), a.value, a.why or b.why)
        for a, b in zip(rows[0][-1], rows[1][-1], strict=True)
    ]
    return [("4", f"{claim}.", "4a or 4b", "see 4a and 4b", either), *rows]


class _Effect(NamedTuple):
    """An effect in the low and in the high zone of the speed, a fall with its sign; None where a number is missing."""

    at: Tables
    low: float | None
    high: float | None
    why: str


def _axial(curves: Curves, measure: str) -> list[_Row]:
    """Claim 5: about 8 % at low speeds and 34 % at high ones in every reading, and whether the effect grows."""
    # The two effects in every reading
    effects: dict[str, list[_Effect]] = {reading: [] for reading in _READINGS}
    for model, surface in curves.surfaces(ROTATING):
        w = np.array(curves.design.relative(surface.speeds))
        values, failures, missing = surface.values(measure), surface.failed, surface.missing
        for load, k, failure_of_load in zip(surface.loads, values, failures, strict=True):
            low_change = change_within(w, k, failure_of_load, *_LOW_ZONE)
            for reading, begin in (("5a", _HIGH_ZONE[0]), ("5b", 0.0)):
                high_change = change_within(w, k, failure_of_load, begin, _HIGH_ZONE[1])
                effects[reading].append(_Effect({**model, "load": load}, low_change, high_change, missing))
        for reading, k in (("5c", values), ("5d", values / values[:, :1])):
            low_change, high_change = (load_effect(w, k, failures, *zone) for zone in (_LOW_ZONE, _HIGH_ZONE))
            effects[reading].append(_Effect(model, low_change, high_change, missing))
    rows: list[_Row] = []
    expectation = f"about {_LOW_EFFECT:.0%} and about {_HIGH_EFFECT:.0%} (each within {ABOUT:.0%} of the number); {BRIDGED}"
    for number, (claim, words) in _READINGS.items():
        zones = [[Finding(e.at, _as_claimed(e), getattr(e, z), e.why) for e in effects[number]] for z in ("low", "high")]
        low, high = (_by_tilt(findings, 100.0, " %", ".1f") for findings in zones)
        finding = f"low zone: {low}. High zone: {high}"
        rows.append((number, claim.format(measure), f"{words}: {expectation}", finding, zones[1]))
    grows = []
    for at, low_effect, high_effect, why in effects["5c"]:
        growth = None if low_effect is None or high_effect is None else high_effect - low_effect
        grows.append(Finding(at, None if growth is None else growth > 0.0, growth, why))
    finding = f"change of this effect, low to high zone, in points of percent: {_by_tilt(grows, 100.0, '', '+.1f')}"
    rule = f"the effect of 5c is larger in the high zone than in the low one; {BRIDGED}"
    return [*rows, ("5e", f"The influence of axial load on {measure} grows with speed.", rule, finding, grows)]


def _as_claimed(effect: _Effect) -> bool | None:
    if effect.low is None or effect.high is None:
        return None
    return is_about(effect.low, _LOW_EFFECT) and is_about(effect.high, _HIGH_EFFECT)


def _joint_effect(curves: Curves, measure: str) -> list[_Row]:
    """Claim 6: k rises with axial load, with speed, the speed's influence with axial load, and all of this."""
    with_load, with_speed, grows, together = [], [], [], []
    for model, surface in curves.surfaces(ROTATING):
        values, errors, failures, why = surface.values(measure), surface.errors, surface.failed, surface.missing
        rising = rises_with_load(values, errors, failures)
        with_load += [
            Finding({**model, "speed": speed}, rises, _ratio(column), why)
            for speed, rises, column in zip(surface.speeds, rising, values.T, strict=True)
        ]
        courses = [_is("rises", course(*curve)) for curve in zip(values, errors, failures, strict=True)]
        with_speed += [
            Finding({**model, "load": load}, rises, _ratio(k), why)
            for load, rises, k in zip(surface.loads, courses, values, strict=True)
        ]
        more, change = influence_grows(values, failures), influence(values)
        growth = float(change[-1] - change[0]) if np.isfinite(change[[0, -1]]).all() else None
        grows.append(Finding(model, more, growth, why))
        parts = [*rising, *courses, more]
        together.append(Finding(model, None if None in parts else False not in parts, None, why))
    first, last = curves.design.loads[0], curves.design.loads[-1]
    step = f"rotating force m e w²: {measure} rises at every step of the"
    return [
        ("6a", f"{measure} rises with axial load.", f"{step} axial load, at each speed; {BRIDGED}",
         f"{measure} at {last:g} N over {measure} at {first:g} N: {_by_tilt(with_load)}", with_load),
        ("6b", f"Under a rotating force {measure} rises with speed.", f"{step} speed, at each axial load, by at least {LEVEL:.1%}; {BRIDGED}",
         f"k*(w* = 1): {_by_tilt(with_speed)}", with_speed),
        ("6c", f"The influence of speed on {measure} grows with axial load.",
         "the size of the change with speed, |k*(1) - 1|, rises at every step of the axial load; a failed run at any speed or "
         "an unstable motion at either end leaves no judgement",
         f"from {first:g} to {last:g} N that size changes by, in points of percent: {_by_tilt(grows, 100.0, '', '+.1f')}", grows),
        ("6", f"{measure} rises with load and speed, and the heavier the load, the more speed does.", "6a, 6b and 6c, at all speeds and axial loads", "see 6a, 6b and 6c", together),
    ]  # fmt: skip
