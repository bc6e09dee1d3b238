"""Claims 4 and 6: what the rotating force m e w^2 does over speed and axial load."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raceway.storage.tables import Tables
from raceway.studies.article.curves import ROTATING, Curves
from raceway.studies.article.design import FRICTION_WORDS, TILT_WORDS, Setting
from raceway.studies.article.power_law import NEAREST, Exponent, exponent
from raceway.studies.article.regions import Finding, by_tilt
from raceway.studies.article.rules import LEVEL, course, influence, influence_grows, rises_with_load
from raceway.studies.article.verdict import BRIDGED, Verdict, judge


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
