"""Rules of the claims as functions of arrays, exponents of power laws, regions in which a rule holds, and the verdict that follows.

A rule returns None where numbers are missing.  A number that is missing is nan.  Where ``failed`` is True a run failed or was
refused: nothing is judged over such a gap.  The other numbers that are missing belong to unstable motions: those between two
numbers are bridged, those at an end leave no judgement.

Notes
-----
For each exponent p a power law is linear in its other numbers.  The interval of p holds every exponent whose sum of squared
residuals stays below S (1 + t^2 / (n - m)) + 3.84 e^2: S is the least sum, e the root mean square of the runs' errors, n numbers,
m parameters, t Student's and 3.84 chi squared at 95 %.

References
----------
Seber, Wild, Nonlinear Regression (1989), section 5.4 (intervals from the sum of squares).
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
    finite = np.isfinite(values)
    if failed.any() or not (finite[0] and finite[-1] and finite.sum() >= 3):
        return None
    y = values[finite]
    if np.ptp(y) < LEVEL * abs(y[0]):
        return "level"
    steps = trend(y, errors[finite])
    return steps if steps == "not monotonic" or abs(y[-1] / y[0] - 1.0) >= LEVEL else "level"


def about(value: float, target: float) -> bool:
    return abs(value - target) <= ABOUT * target


def change_within(w: np.ndarray, values: np.ndarray, failed: np.ndarray, first: float, last: float) -> float | None:
    """k(last) / k(first) - 1 over the relative speed w (n,); None with a failed run or without numbers around both ends."""
    ends = None if failed.any() else _between(w, values, np.array([first, last]))
    return None if ends is None else float(ends[1] / ends[0] - 1.0)


def spread(w: np.ndarray, surface: np.ndarray, failed: np.ndarray, first: float, last: float) -> float | None:
    """Largest of max/min - 1 over the loads at the ends of a zone and the speeds in it; None as in ``change_within``.

    Parameters
    ----------
    surface : (loads, speeds), positive;  failed : (loads, speeds) bool
    """
    zone = np.array([first, *w[(w > first) & (w < last)], last])
    rows = [None if failed.any() else _between(w, values, zone) for values in surface]
    complete = [row for row in rows if row is not None]
    if len(complete) < len(rows):
        return None
    return float((np.max(complete, axis=0) / np.min(complete, axis=0) - 1.0).max())


def _between(w: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray | None:
    """Values at ascending points, between neighbours by straight lines; None where they do not reach both ends."""
    finite = np.isfinite(values)
    w, values = w[finite], values[finite]
    return None if len(w) < 2 or at[0] < w[0] or at[-1] > w[-1] else np.interp(at, w, values)


def rises_with_load(surface: np.ndarray, errors: np.ndarray, failed: np.ndarray) -> list[bool | None]:
    """At each speed: whether k rises at every step of the axial load; (loads, speeds) each."""
    courses = [course(*column) for column in zip(surface.T, errors.T, failed.T, strict=True)]
    return [None if outcome is None else outcome == "rises" for outcome in courses]


def influence(surface: np.ndarray) -> np.ndarray:
    """(loads,) |k*(1) - 1|, the size of the speed's influence."""
    return np.asarray(np.abs(surface[:, -1] / surface[:, 0] - 1.0))


def influence_grows(surface: np.ndarray, failed: np.ndarray) -> bool | None:
    """Whether the size of the speed's influence rises at every step of the axial load; (loads, speeds) each."""
    size = influence(surface)
    if failed.any() or not np.isfinite(size).all():
        return None
    return bool((np.diff(size) > 0.0).all())


_EXPONENTS = np.linspace(0.05, 30.0, 2996)
_CHANCE, _CHI_SQUARED = 0.975, 3.84
#: Nearer to 2 than to 1 or 3 is roughly quadratic; a straight line has 1.
NEAREST, _STRAIGHT = (1.5, 2.5), 1.0


@attrs.frozen
class Exponent:
    """Of a power law; ``low`` and ``high`` end its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def roughly_quadratic(self) -> bool:
        """Nearer to 2 than to any other whole number, and no straight line."""
        return NEAREST[0] <= self.value <= NEAREST[1] and not self.low <= _STRAIGHT <= self.high


def exponent(x: np.ndarray, y: np.ndarray, errors: np.ndarray, constant: bool) -> Exponent | None:
    """p of y = c x^p, or of y = a + c x^p with a ``constant``; None where the numbers are too few for an interval.

    Parameters
    ----------
    x : (n,) positive;  y : (n,), nan where a number is missing;  errors : (n,) absolute
    """
    finite = np.isfinite(y)
    x, y, errors = x[finite], y[finite], errors[finite]
    free = len(y) - 2 - constant
    if free < 1:
        return None
    sums = _residuals(x[None, :] ** _EXPONENTS[:, None], y, constant)
    best = int(np.argmin(sums))
    limit = sums[best] * (1.0 + stdtrit(free, _CHANCE) ** 2 / free) + _CHI_SQUARED * float((errors**2).mean())
    inside = _EXPONENTS[sums <= limit]
    # No interval is narrower than the step of the grid.
    value, step = _EXPONENTS[best], _EXPONENTS[1] - _EXPONENTS[0]
    low, high = min(inside.min(initial=np.inf), value - step), max(inside.max(initial=0.0), value + step)
    return Exponent(float(value), float(low), float(high))


def _residuals(powers: np.ndarray, y: np.ndarray, constant: bool) -> np.ndarray:
    """Sums of squares (k,) that y (n,) leaves beside the best multiple of each power (k, n), about the means with a constant."""
    if constant:
        powers, y = powers - powers.mean(axis=1, keepdims=True), y - y.mean()
    factor = powers @ y / (powers**2).sum(axis=1)
    return np.asarray(((y - factor[:, None] * powers) ** 2).sum(axis=1))


_ORDER = ("friction", "tilt", "inertia", "bodies", "speed", "load")


@attrs.frozen
class Finding:
    """Outcome of a rule for one model, load or speed.

    Attributes
    ----------
    at : which friction, tilt, inertia, bodies, load [N] and speed [r/min]
    holds : None where it could not be judged, with the reason in ``why``
    value : the number that the rule looks at
    """

    at: ReadTables
    holds: bool | None
    value: float | None = None
    why: str = ""


def _where(findings: Sequence[Finding], holds: bool | None) -> str:
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
    values = list(dict.fromkeys(at.get(key) for at, _ in items))
    below = {value: _phrases([item for item in items if item[0].get(key) == value], remaining) for value in values}
    if len({str(part) for part in below.values()}) == 1:
        return below[values[0]]
    phrases: list[str] = []
    for text in dict.fromkeys(str(part) for part in below.values() if part is not None):
        same = [value for value in values if str(below[value]) == text]
        name = _named(key, same, values)
        phrases += [f"{name}, {phrase}" if phrase else name for phrase in below[same[0]] or []]
    return phrases


def _named(key: str, values: Sequence[Any], every: Sequence[Any]) -> str:
    """Some of all values of a key, in words."""
    if key == "tilt":
        return "tilt " + " or ".join(TILT_WORDS[value].removeprefix("tilt ") for value in values)
    if key == "friction":
        return " or ".join(FRICTION_WORDS[value] for value in values)
    if key == "inertia":
        return "with ball inertia" if values[0] else "weightless balls"
    if key == "bodies":
        return f"{' or '.join(values)} bodies"
    return _ranges(values, every, "N" if key == "load" else "r/min")


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


def by_tilt(findings: Sequence[Finding], scale: float = 1.0, unit: str = "", form: str = ".3f") -> str:
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


HOLDS, PARTLY, NOT, FAILED, UNTESTED = "holds", "holds only for", "does not hold", "failed", "cannot be tested"
#: Kind of a verdict -> tone of its cell on a page, and words after a count.
KINDS = {
    HOLDS: ("good", "hold"),
    PARTLY: ("partly", "hold only in a region"),
    NOT: ("bad", "do not hold"),
    FAILED: ("failed", "failed"),
    UNTESTED: ("partly", "cannot be tested"),
}
#: How every rule treats numbers that are missing; the rules do it, this tells the reader.
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

    def row(self) -> Tables:
        """As a row of a flat table."""
        words = f"{self.kind} {self.region}" if self.region else self.kind
        return {**attrs.asdict(self, filter=lambda field, _: field.name != "findings"), "verdict": words}

    def to_dict(self) -> Tables:
        return {**self.row(), "findings": [attrs.asdict(finding) for finding in self.findings]}


def judge(number: str, claim: str, rule: str, computed: str, findings: Sequence[Finding]) -> Verdict:
    """The verdict that follows from the outcomes of a rule.

    Notes
    -----
    Failed places never count as holding: with one of them a claim that holds everywhere else holds only for the remaining ones.
    """
    judged = [finding.holds for finding in findings if finding.holds is not None]
    failed = region = ""
    if len(judged) < len(findings):
        reason = next(finding.why for finding in findings if finding.holds is None)
        failed = f"{_where(findings, None)} (the first reason: {reason or 'a run is missing'})"
    if not judged:
        kind = FAILED
    elif not any(judged):
        kind = NOT
    elif all(finding.holds for finding in findings):
        kind = HOLDS
    else:
        kind, region = PARTLY, _where(findings, True)
    return Verdict(number, claim, rule, computed, kind, region, failed, tuple(findings))
