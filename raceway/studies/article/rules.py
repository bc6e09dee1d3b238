"""Rules of the claims as functions of arrays, regions in which they hold, exponents of power laws, and the verdict that follows.

A rule returns None where numbers are missing.
A number that is missing is nan.  Where ``failed`` is True a run failed or was refused: nothing is judged over such a gap.  The
other numbers that are missing belong to unstable motions: those between two numbers are bridged, those at an end leave no judgement.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs
import numpy as np
from scipy.special import stdtrit

from raceway.points.effects import trend
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.design import FRICTION_WORDS, TILT_WORDS

#: A change below this over the whole range neither rises nor falls.
LEVEL = 0.005
#: "about" a percentage: within this share of it.
ABOUT = 0.25


def course(values: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> str | None:
    """ "rises" or "falls" at every step, "level", "not monotonic"; None with a failed run, without both ends, or with
    fewer than three numbers.

    Parameters
    ----------
    values : (n,);  errors : (n,) relative; a step within its ends' errors is no step;  failed : (n,) bool
    """
    if failed.any():
        return None
    known = np.isfinite(values)
    if not (known[0] and known[-1] and known.sum() >= 3):
        return None
    y = values[known]
    if np.ptp(y) < LEVEL * abs(y[0]):
        return "level"
    found = trend(y, errors[known])
    return found if found == "not monotonic" or abs(y[-1] / y[0] - 1.0) >= LEVEL else "level"


def about(value: float, target: float) -> bool:
    return abs(value - target) <= ABOUT * target


def change_within(
    relative_speed: np.ndarray, values: np.ndarray, failed: np.ndarray, first: float, last: float
) -> float | None:
    """k(last) / k(first) - 1, between neighbours by straight lines; None with a failed run or without numbers around them."""
    if failed.any():
        return None
    known = np.isfinite(values)
    w, k = relative_speed[known], values[known]
    if len(w) < 2 or first < w[0] or last > w[-1]:
        return None
    ends = np.interp([first, last], w, k)
    return float(ends[1] / ends[0] - 1.0)


def spread(relative_speed: np.ndarray, surface: np.ndarray, failed: np.ndarray, first: float, last: float) -> float | None:
    """Largest of max/min - 1 over the loads at the ends of a zone and the speeds in it.

    Between neighbours by straight lines; None with a failed run or without numbers around the zone's ends.

    Parameters
    ----------
    surface : (loads, speeds), positive;  failed : (loads, speeds) bool
    """
    if failed.any():
        return None
    inside = (relative_speed > first) & (relative_speed < last)
    places = np.array([first, *relative_speed[inside], last])
    zone = []
    for values in surface:
        known = np.isfinite(values)
        w = relative_speed[known]
        if len(w) < 2 or first < w[0] or last > w[-1]:
            return None
        zone.append(np.interp(places, w, values[known]))
    return float((np.max(zone, axis=0) / np.min(zone, axis=0) - 1.0).max())


def rises_with_load(surface: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> list[bool | None]:
    """At each speed: whether k rises at every step of the axial load; (loads, speeds) each."""
    found = [course(surface[:, k], errors[:, k], failed[:, k]) for k in range(surface.shape[1])]
    return [None if one is None else one == "rises" for one in found]


def influence(surface: np.ndarray) -> np.ndarray:
    """(loads,) |k*(1) - 1|, the size of the speed's influence."""
    return np.asarray(np.abs(surface[:, -1] / surface[:, 0] - 1.0))


def influence_grows(surface: np.ndarray, failed: np.ndarray) -> bool | None:
    """Whether the size of the speed's influence rises at every step of the axial load; (loads, speeds) each."""
    if failed.any():
        return None
    found = influence(surface)
    if not np.isfinite(found).all():
        return None
    return bool((np.diff(found) > 0.0).all())


_EXPONENTS = np.linspace(0.05, 30.0, 2996)
_CHANCE, _CHI_SQUARED = 0.975, 3.84
#: Nearer to 2 than to 1 or 3 is roughly quadratic; a straight line has 1.
NEAREST, STRAIGHT = (1.5, 2.5), 1.0


@attrs.frozen
class Exponent:
    """Of a power law; ``low`` and ``high`` end its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def roughly_quadratic(self) -> bool:
        """Nearer to 2 than to any other whole number, and no straight line."""
        return NEAREST[0] <= self.value <= NEAREST[1] and not self.low <= STRAIGHT <= self.high

    def __str__(self) -> str:
        return f"{self.value:.2f} ({self.low:.2f} to {self.high:.2f})"


def exponent(x: np.ndarray, y: np.ndarray, errors: np.ndarray, constant: bool) -> Exponent | None:
    """p of y = c x^p, or of y = a + c x^p with a ``constant``; None where the numbers are too few for an interval.

    Parameters
    ----------
    x : (n,) positive;  y : (n,), nan where a number is missing;  errors : (n,) absolute
    """
    known = np.isfinite(y)
    x, y, errors = x[known], y[known], errors[known]
    free = len(y) - 2 - constant
    if free < 1:
        return None
    sums = _rests(x[None, :] ** _EXPONENTS[:, None], y, constant)
    best = int(np.argmin(sums))
    limit = sums[best] * (1.0 + stdtrit(free, _CHANCE) ** 2 / free) + _CHI_SQUARED * float((errors**2).mean())
    inside = _EXPONENTS[sums <= limit]
    # The grid's own step is the least interval that can be told.
    step = _EXPONENTS[1] - _EXPONENTS[0]
    low, high = (
        min(inside.min(initial=np.inf), _EXPONENTS[best] - step),
        max(inside.max(initial=0.0), _EXPONENTS[best] + step),
    )
    return Exponent(float(_EXPONENTS[best]), float(low), float(high))


def _rests(powers: np.ndarray, y: np.ndarray, constant: bool) -> np.ndarray:
    """Sums of squares (k,) that y (n,) leaves beside the best multiple of each power (k, n), about the means with a constant."""
    if constant:
        powers, y = powers - powers.mean(axis=1, keepdims=True), y - y.mean()
    factor = powers @ y / (powers**2).sum(axis=1)
    return np.asarray(((y - factor[:, None] * powers) ** 2).sum(axis=1))


_ORDER = ("case", "friction", "tilt", "inertia", "bodies", "speed", "load")


@attrs.frozen
class Finding:
    """A rule at one place.

    Attributes
    ----------
    at : which friction, tilt, inertia, bodies, load [N], speed [r/min], or which case of a table
    holds : None where it could not be judged, with the reason in ``why``
    value : the number that the rule looks at
    """

    at: ReadTables
    holds: bool | None
    value: float | None = None
    why: str = ""

    def to_dict(self) -> Tables:
        return {"at": dict(self.at), "holds": self.holds, "value": self.value, "why": self.why}


def where(findings: Sequence[Finding], holds: bool | None) -> str:
    """The places with one outcome; "everywhere", "nowhere", or phrases between semicolons."""
    keys = [key for key in _ORDER if any(key in one.at for one in findings)]
    leaves = _leaves([(dict(one.at), one.holds is holds) for one in findings], keys)
    if leaves is None:
        return "nowhere"
    return "; ".join(leaves) if leaves != [""] else "everywhere"


def _leaves(items: list[tuple[Tables, bool]], keys: list[str]) -> list[str] | None:
    """[""] for all of the items, None for none, else a phrase for each part."""
    if all(chosen for _, chosen in items):
        return [""]
    if not any(chosen for _, chosen in items) or not keys:
        return None
    key, rest = keys[0], keys[1:]
    values = list(dict.fromkeys(at.get(key) for at, _ in items))
    below = {value: _leaves([item for item in items if item[0].get(key) == value], rest) for value in values}
    if len({str(one) for one in below.values()}) == 1:
        return below[values[0]]
    found: list[str] = []
    for leaf in dict.fromkeys(str(one) for one in below.values() if one is not None):
        same = [value for value in values if str(below[value]) == leaf]
        name = _named(key, same, values)
        found += [f"{name}, {phrase}" if phrase else name for phrase in below[same[0]] or []]
    return found


def _named(key: str, chosen: Sequence[Any], every: Sequence[Any]) -> str:
    if key == "tilt":
        words = [TILT_WORDS[value].removeprefix("tilt ") for value in chosen]
        return "tilt " + " or ".join(words)
    if key == "friction":
        return " or ".join(FRICTION_WORDS[value] for value in chosen)
    if key == "inertia":
        return "with ball inertia" if chosen[0] else "weightless balls"
    if key == "bodies":
        return f"{' or '.join(chosen)} bodies"
    if key in ("load", "speed"):
        return _ranges(chosen, every, "N" if key == "load" else "r/min")
    return " or ".join(str(value) for value in chosen)


def _ranges(chosen: Sequence[float], every: Sequence[float], unit: str) -> str:
    """Neighbours as one range."""
    runs: list[list[float]] = []
    for value in every:
        if value not in chosen:
            runs.append([])
        elif not runs or not runs[-1]:
            runs.append([value])
        else:
            runs[-1].append(value)
    words = [f"{run[0]:g}" if len(run) == 1 else f"{run[0]:g} to {run[-1]:g}" for run in runs if run]
    return f"{' and '.join(words)} {unit}"


def by_tilt(findings: Sequence[Finding], scale: float = 1.0, unit: str = "", form: str = ".3f") -> str:
    """The range of the values at each tilt boundary, for each kind of friction."""
    kinds = list(dict.fromkeys(one.at.get("friction") for one in findings))
    told = [_by_tilt([one for one in findings if one.at.get("friction") == kind], scale, unit, form) for kind in kinds]
    if len(kinds) < 2:
        return "".join(told)
    return ". ".join(f"{FRICTION_WORDS[str(kind)].capitalize()}: {text}" for kind, text in zip(kinds, told, strict=True))


def _by_tilt(findings: Sequence[Finding], scale: float, unit: str, form: str) -> str:
    parts = []
    for tilt in dict.fromkeys(one.at["tilt"] for one in findings):
        values = [scale * one.value for one in findings if one.at["tilt"] == tilt and one.value is not None]
        if not values:
            parts.append(f"{TILT_WORDS[tilt]}: no number")
            continue
        low, high = (f"{value:{form}}" for value in (min(values), max(values)))
        parts.append(f"{TILT_WORDS[tilt]}: {low if low == high else f'{low} to {high}'}{unit}")
    return "; ".join(parts)


HOLDS, PARTLY, NOT, FAILED, UNTESTED = "holds", "holds only for", "does not hold", "failed", "cannot be tested"
#: What every rule does with numbers that are missing; the rules do it, here it is said.
BRIDGED = "unstable motions between the ends are left out, a failed run leaves no judgement"


@attrs.frozen
class Verdict:
    """A claim, or one reading of it.

    Attributes
    ----------
    number : of the claim, with a letter where it has several parts or readings, and "|Z|" where that is taken for the stiffness
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

    def to_dict(self) -> Tables:
        plain = attrs.asdict(self, filter=lambda field, _: field.name != "findings")
        return {**plain, "verdict": self.words, "findings": [one.to_dict() for one in self.findings]}


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
