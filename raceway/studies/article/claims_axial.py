"""Claim 5: about 8 % at low speeds, about 34 % at high ones, in every reading that the article's words allow."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.storage.tables import Tables
from raceway.studies.article.claims_rotating import in_words, missing, suffix
from raceway.studies.article.curves import ROTATING, Curves
from raceway.studies.article.design import Setting
from raceway.studies.article.regions import Finding, by_tilt
from raceway.studies.article.rules import ABOUT, about, change_within, spread
from raceway.studies.article.verdict import BRIDGED, Verdict, judge

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
