"""The article's claims: what each asks, the rule that decides, what was computed, and the verdict that follows.

No claim is fitted: a verdict is what its rule says of the numbers, and the rules know nothing of what is wanted.  Claims 1 to 3
are here, 4 and 6 in ``claims_rotating``, 5 in ``claims_axial``; 4 to 6 are judged for K and for |Z|, of which the article does not
say which one its stiffness is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import attrs
import numpy as np

from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.design import FRICTION_WORDS, MEASURES, ONE_WAY, ROTATING, TILT_WORDS, Curves, Setting
from raceway.studies.article.rules import (
    ABOUT,
    BRIDGED,
    FAILED,
    LEVEL,
    NEAREST,
    UNTESTED,
    Exponent,
    Finding,
    Verdict,
    about,
    by_tilt,
    change_within,
    course,
    exponent,
    influence,
    influence_grows,
    judge,
    rises_with_load,
    spread,
)


def suffix(measure: str) -> str:
    """What a number of a claim ends with where |Z| is taken for the stiffness."""
    return "" if measure == "K" else f" {measure}"


def in_words(claim: str, measure: str) -> str:
    return claim if measure == "K" else f"{claim} k = |Z|."


def hardening(curves: Curves, measure: str) -> list[Verdict]:
    """Claim 4, "approximately quadratic", in two readings, and in either."""
    claim, one = "Bidirectional: rises roughly quadratically with speed", suffix(measure)
    rule = (
        f"rotating force m e w²: {measure} rises at every step of the speed, by at least {LEVEL:.1%}, and by least squares {{law}} "
        f"has p from {NEAREST[0]:g} to {NEAREST[1]:g} and a 95 % interval without 1, the straight line; {BRIDGED}"
    )
    readings = {
        "a": ("in the speed", f"{measure} = a + c w^p", _in_speed),
        "b": ("in the speed above the lowest", "k* − 1 = c w*^p", _above_lowest),
    }
    out, found = [], {}
    for letter, (words, law, fit) in readings.items():
        found[letter], powers = _powers(curves, measure, fit)
        text = f"k*(w* = 1): {by_tilt(found[letter])}{powers}"
        name = in_words(f"{claim}; read as {words}.", measure)
        out.append(judge(f"4{letter}{one}", name, rule.format(law=law), text, found[letter]))
    either = [
        Finding(a.at, None if a.holds is None and not b.holds else bool(a.holds or b.holds), a.value, a.why or b.why)
        for a, b in zip(found["a"], found["b"], strict=True)
    ]
    return [judge(f"4{one}", in_words(f"{claim}.", measure), "4a or 4b", "see 4a and 4b", either), *out]


def _in_speed(curves: Curves, setting: Setting, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    speeds = np.array(curves.design.speeds_of(setting))
    return exponent(speeds / speeds[-1], values / values[0], errors * values / values[0], constant=True)


def _above_lowest(curves: Curves, setting: Setting, values: np.ndarray, errors: np.ndarray) -> Exponent | None:
    w = np.array(curves.design.relative_speeds_of(setting))
    star = values / values[0]
    return exponent(w[1:], star[1:] - 1.0, (errors * star)[1:], constant=False)


def _powers(
    curves: Curves, measure: str, fit: Callable[[Curves, Setting, np.ndarray, np.ndarray], Exponent | None]
) -> tuple[list[Finding], str]:
    """Outcomes at every place, and the exponents where k rises, in words."""
    found: list[Finding] = []
    rising: dict[str, list[Exponent]] = {}
    for model in curves.design.models():
        setting = Setting(**ROTATING, **model)
        for load in curves.design.loads_of(setting):
            values, errors = curves.values(setting, load, measure), curves.errors(setting, load)
            run = course(values, errors, curves.failed(setting, load))
            power = fit(curves, setting, values, errors) if run == "rises" else None
            holds: bool | None = None if run is None else False
            if run == "rises":
                holds = None if power is None else power.roughly_quadratic
            why = "" if holds is not None else curves.why_not(setting, load) or "too few speeds for an exponent's interval"
            ratio = values[-1] / values[0]
            found.append(Finding({**model, "load": load}, holds, float(ratio) if np.isfinite(ratio) else None, why))
            if power is not None:
                rising.setdefault(_place(model), []).append(power)
    told = [
        f"{place} p = {min(p.value for p in powers):.2f} to {max(p.value for p in powers):.2f}, "
        f"intervals from {min(p.low for p in powers):.2f} to {max(p.high for p in powers):.2f}"
        for place, powers in rising.items()
    ]
    return found, f". Where it rises: {'; '.join(told)}" if told else ""


def _place(model: Tables) -> str:
    return f"{FRICTION_WORDS[model['friction']]}, {TILT_WORDS[model['tilt']]}"


def both(curves: Curves, measure: str) -> list[Verdict]:
    """Claim 6: with axial load, with speed, the speed's influence with axial load, and all of it."""
    rises, with_load, grows, whole = [], [], [], []
    for model in curves.design.models():
        setting = Setting(**ROTATING, **model)
        loads, speeds = curves.design.loads_of(setting), curves.design.speeds_of(setting)
        surface, errors, failed = curves.surface(setting, measure)
        why = missing(curves, setting)
        parts: list[bool | None] = []
        rising = rises_with_load(surface, errors, failed)
        for speed, holds, column in zip(speeds, rising, surface.T, strict=True):
            parts.append(holds)
            ratio = column[-1] / column[0]
            with_load.append(Finding({**model, "speed": speed}, holds, float(ratio) if np.isfinite(ratio) else None, why))
        for load, values, error, lost in zip(loads, surface, errors, failed, strict=True):
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
    first, last, one = curves.design.loads[0], curves.design.loads[-1], suffix(measure)
    step = f"rotating force m e w²: {measure} rises at every step of the"
    return [
        judge(f"6a{one}", in_words("The stiffness rises with axial load.", measure),
              f"{step} axial load, at each speed; {BRIDGED}",
              f"{measure} at {last:g} N over {measure} at {first:g} N: {by_tilt(with_load)}", with_load),
        judge(f"6b{one}", in_words("The stiffness rises with speed.", measure),
              f"{step} speed, at each axial load, by at least {LEVEL:.1%}; {BRIDGED}", f"k*(w* = 1): {by_tilt(rises)}", rises),
        judge(f"6c{one}", in_words("The speed's influence grows with axial load.", measure),
              "the size of the change with speed, |k*(1) - 1|, rises at every step of the axial load; a failed run at any speed or "
              "an unstable motion at either end leaves no judgement",
              f"from {first:g} to {last:g} N that size changes by, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}",
              grows),
        judge(f"6{one}", in_words("All of this together.", measure), "6a, 6b and 6c, at all speeds and axial loads",
              "see 6a, 6b and 6c", whole),
    ]  # fmt: skip


def missing(curves: Curves, setting: Setting) -> str:
    """What is missing at any axial load."""
    return "; ".join(filter(None, (curves.why_not(setting, load) for load in curves.design.loads_of(setting))))


#: What the text of the article gives, the zones in w*.
LOW_ZONE, HIGH_ZONE = (0.0, 0.25), (0.75, 1.0)
LOW_EFFECT, HIGH_EFFECT = 0.08, 0.34
_READINGS = {
    "a": ("effect of speed inside each zone", "rise of k at one axial load: k(0.25)/k(0) − 1 and k(1)/k(0.75) − 1"),
    "b": ("effect of speed up to the end of each zone", "rise at one axial load: k*(0.25) − 1 and k*(1) − 1"),
    "c": ("effect of the axial load on k", "largest k over smallest, of all axial loads, where that is largest in the zone"),
    "d": (
        "effect of the axial load on k*",
        "largest k* over smallest, of all axial loads, where that is largest in the zone",
    ),
}


@attrs.frozen
class _Effect:
    """An effect in the low and in the high zone of the speed, a fall with its sign; None where a number is missing."""

    at: Tables
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


def _effects(curves: Curves, measure: str) -> dict[str, list[_Effect]]:
    """The two effects in every reading, wherever it can be taken."""
    found: dict[str, list[_Effect]] = {letter: [] for letter in _READINGS}
    for model in curves.design.models():
        setting = Setting(**ROTATING, **model)
        w = np.array(curves.design.relative_speeds_of(setting))
        surface, _, failed = curves.surface(setting, measure)
        why = missing(curves, setting)
        for load, values, lost in zip(curves.design.loads_of(setting), surface, failed, strict=True):
            at = {**model, "load": load}
            for letter, begin in (("a", HIGH_ZONE[0]), ("b", 0.0)):
                low = change_within(w, values, lost, *LOW_ZONE)
                high = change_within(w, values, lost, begin, HIGH_ZONE[1])
                found[letter].append(_Effect(at, low, high, why))
        for letter, values in (("c", surface), ("d", surface / surface[:, :1])):
            low, high = spread(w, values, failed, *LOW_ZONE), spread(w, values, failed, *HIGH_ZONE)
            found[letter].append(_Effect(model, low, high, why))
    return found


def axial(curves: Curves, measure: str) -> list[Verdict]:
    """Both readings of the two percentages, each in two ways to take a change, and whether the effect grows."""
    effects, one = _effects(curves, measure), suffix(measure)
    asked = f"about {LOW_EFFECT:.0%} and about {HIGH_EFFECT:.0%} (each within {ABOUT:.0%} of the number); {BRIDGED}"
    claim = "Axial load: about 8 % effect for w* from 0 to 0.25, about 34 % from 0.75 to 1"
    out = []
    for letter, (of, words) in _READINGS.items():
        low = [Finding(effect.at, effect.as_claimed, effect.low, effect.why) for effect in effects[letter]]
        high = [Finding(effect.at, effect.as_claimed, effect.high, effect.why) for effect in effects[letter]]
        text = f"low zone: {by_tilt(low, 100.0, ' %', '.1f')}. High zone: {by_tilt(high, 100.0, ' %', '.1f')}"
        name = in_words(f"{claim}; read as {of}.", measure)
        out.append(judge(f"5{letter}{one}", name, f"{words}: {asked}", text, high))
    grows = [
        Finding(effect.at, None if effect.growth is None else effect.growth > 0.0, effect.growth, effect.why)
        for effect in effects["c"]
    ]
    text = f"change of that effect from the low to the high zone, in points of percent: {by_tilt(grows, 100.0, '', '+.1f')}"
    rule = f"the effect of 5c is larger in the high zone than in the low one; {BRIDGED}"
    name = in_words("The influence of the axial load grows with speed.", measure)
    out.append(judge(f"5e{one}", name, rule, text, grows))
    return out


#: What the text of the article gives.
LARGEST_DEVIATION, HEAVIEST_DEVIATION = 0.0242, 0.0033


def verdicts(curves: Curves, static: Sequence[ReadTables]) -> list[Verdict]:
    """Every claim.

    Parameters
    ----------
    static : rows of the static verification, as ``raceway verify`` gives them
    """
    out = [*_static(static), _rig(), *_one_way(curves)]
    for measure in MEASURES:
        out += [*hardening(curves, measure), *axial(curves, measure), *both(curves, measure)]
    # Each claim for K, and at once for |Z|.
    return sorted(out, key=lambda one: one.number[0])


def _static(rows: Sequence[ReadTables]) -> list[Verdict]:
    """The load cases are lost: there is nothing to hold the article's percentages against, only ours to report."""
    pressures = [row for row in rows if not row["quantity"].startswith("mesh independence")]
    heaviest = [row for row in pressures if "inner" in row["quantity"] and "2000 N axial" in row["quantity"]]
    parts = (
        ("1a", f"Static peak pressures are within {LARGEST_DEVIATION:.2%} of exact Hertz in four load cases.", pressures,
         "largest deviation of the peak pressures in four load cases of our own"),
        ("1b", f"In the heaviest case the inner race's is within {HEAVIEST_DEVIATION:.2%}.", heaviest,
         "deviation of the inner race's peak pressure at 2000 N axial, the heaviest of ours"),
    )  # fmt: skip
    out = []
    for number, claim, taken, words in parts:
        known = [row["error"] for row in taken if row["error"] is not None]
        kind = UNTESTED if known or not taken else FAILED
        text = f"{words}: {max(known):.2%}" if known else "no number"
        failed = next((row["note"] for row in taken if row["error"] is None), "")
        rule = "none: the load cases are not in the text that is left of the article, so that no case can be computed again"
        out.append(Verdict(number, claim, rule, text, kind, failed=failed))
    return out


def _rig() -> Verdict:
    return Verdict(
        "2",
        "Stiffness is within 9.12 % of the rig's.",
        "none: the table of measured stiffnesses is not in the text that is left of the article",
        "K at the rig's speeds and loads is reported in a table of its own",
        UNTESTED,
    )


def over_speed(curves: Curves, excitation: ReadTables, measure: str, judged: Callable[..., bool | None]) -> list[Finding]:
    """A rule of (values, errors, failed) for curves over speed, at every way to model and every load; the value is k*(1)."""
    found = []
    for model in curves.design.models():
        setting = Setting(**excitation, **model)
        for load in curves.design.loads_of(setting):
            values, errors = curves.values(setting, load, measure), curves.errors(setting, load)
            ratio = values[-1] / values[0]
            outcome = judged(values, errors, curves.failed(setting, load))
            why = curves.why_not(setting, load) if outcome is None else ""
            found.append(Finding({**model, "load": load}, outcome, float(ratio) if np.isfinite(ratio) else None, why))
    return found


def _one_way(curves: Curves) -> list[Verdict]:
    rule = (
        f"unidirectional force, constant amplitude: falls at every step of the speed, and by at least {LEVEL:.1%} over the range; "
        f"{BRIDGED}"
    )

    def falls(values: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> bool | None:
        found = course(values, errors, failed)
        return None if found is None else found == "falls"

    out = []
    for letter, measure, words in (("a", "K", "K = Re Z + m w²"), ("b", "|Z|", "|Z|, which holds the inertia of the mass")):
        found = over_speed(curves, ONE_WAY, measure, falls)
        text = f"k*(w* = 1): {by_tilt(found)}"
        claim = f"Unidirectional: the radial stiffness falls with speed; k = {words}."
        out.append(judge(f"3{letter}", claim, rule, text, found))
    return out
