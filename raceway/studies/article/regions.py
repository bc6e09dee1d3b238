"""Regions in which a rule holds, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import attrs

from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.design import FRICTION_WORDS, TILT_WORDS

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
