"""From the rows of a map to its curves over speed: change, sign, exponent, saturation, loss of contact, groove's edge."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from raceway.storage.tables import Tables
from raceway.studies.map.design import ANGLE, AXIAL, SPEED, TILT

if TYPE_CHECKING:
    from collections.abc import Callable

#: Local exponents n = d ln k / d ln w closer to 0 than this count as level.
LEVEL = 0.02
#: Hardening has saturated where n, past its largest value, has fallen below this share of it.
SATURATED = 0.75


def curves(rows: Sequence[Tables]) -> list[Tables]:
    """A curve for each axial load, tilt and contact angle; adds ``change`` and ``exponent`` to its rows.

    Notes
    -----
    ``change`` of a row: k(w) / k(w0) - 1, with w0 the curve's lowest speed; None where that point failed.
    ``exponent`` of a row: n between it and the next lower speed of the curve; None where either failed.
    """
    groups: dict[tuple[object, ...], list[Tables]] = {}
    for row in rows:
        groups.setdefault((row["point"][ANGLE], str(row["point"][TILT]), row["point"][AXIAL]), []).append(row)
    return [_curve(sorted(group, key=lambda row: row["point"][SPEED])) for group in groups.values()]


def _curve(rows: list[Tables]) -> Tables:
    first = rows[0].get("stiffness")
    for row, before in zip(rows, [None, *rows[:-1]], strict=True):
        row["change"] = _ratio(row.get("stiffness"), first)
        row["exponent"] = None
        step = None if before is None else _ratio(row.get("stiffness"), before.get("stiffness"))
        if before is not None and step is not None:
            row["exponent"] = math.log1p(step) / math.log(row["point"][SPEED] / before["point"][SPEED])
    steps = [row for row in rows if row["exponent"] is not None]
    steepest = max(steps, key=lambda row: row["exponent"], default=None)
    hardens = steepest is not None and steepest["exponent"] > LEVEL
    saturated = None
    if steepest is not None and hardens:
        later = [row for row in steps if row["point"][SPEED] > steepest["point"][SPEED]]
        saturated = next((row for row in later if row["exponent"] < SATURATED * steepest["exponent"]), None)
    done = [row for row in rows if row["status"] == "completed"]
    return {
        "contact_angle_deg": rows[0]["point"][ANGLE],
        "tilt": rows[0]["point"][TILT],
        "axial": rows[0]["point"][AXIAL],
        "first_speed_rpm": rows[0]["point"][SPEED],
        "first_stiffness": first,
        "last_change": rows[-1]["change"],
        "least_change": min((row["change"] for row in rows if row["change"] is not None), default=None),
        "largest_change": max((row["change"] for row in rows if row["change"] is not None), default=None),
        "small_signal_change": _ratio(rows[-1].get("small_signal"), rows[0].get("small_signal")),
        "trend": trend([row["exponent"] for row in steps]),
        "steepest_exponent": None if steepest is None else steepest["exponent"],
        "steepest_at_rpm": None if steepest is None or not hardens else steepest["point"][SPEED],
        "saturates_at_rpm": None if saturated is None else saturated["point"][SPEED],
        "last_exponent": rows[-1]["exponent"],
        "contact_lost_from_rpm": _from(done, lambda row: row["lost"] > 0),
        "unseats_from_rpm": _from(done, lambda row: row["unseats"]),
        "edge_from_rpm": _from(done, lambda row: max(row["reach_inner"], row["reach_outer"]) > 1.0),
        "failed": len(rows) - len(done),
    }


def trend(exponents: Sequence[float]) -> str:
    """The signs of a curve in its order: "hardens", "softens, then hardens", "level"."""
    words: list[str] = []
    for n in exponents:
        word = "hardens" if n > LEVEL else "softens" if n < -LEVEL else "level"
        if word != "level" and (not words or words[-1] != word):
            words.append(word)
    if not words:
        return "level" if exponents else "no numbers"
    return ", then ".join(words) if len(words) < 4 else f"{words[0]}, then changes its sign {len(words) - 1} times"


def _from(rows: Sequence[Tables], holds: Callable[[Tables], bool]) -> float | None:
    """The lowest speed at which something holds."""
    return next((row["point"][SPEED] for row in rows if holds(row)), None)


def _ratio(a: float | None, b: float | None) -> float | None:
    """a / b - 1; None for what failed, and for a secant below zero, as there is beyond a resonance."""
    return a / b - 1.0 if a is not None and b is not None and a > 0.0 and b > 0.0 else None


def words(found: Sequence[Tables], rows: Sequence[Tables]) -> list[str]:
    """What the map says, a sentence or two for each angle and tilt."""
    out = []
    groups: dict[tuple[object, str], list[Tables]] = {}
    for curve in found:
        groups.setdefault((curve["contact_angle_deg"], str(curve["tilt"])), []).append(curve)
    for (angle, tilt), members in groups.items():
        name = f"{angle:g} deg, tilt {tilt if tilt in ('locked', 'free') else tilt + ' N m/rad'}"
        kinds: dict[str, list[float]] = {}
        loads = sorted({curve["axial"] for curve in members})
        for curve in members:
            kinds.setdefault(curve["trend"], []).append(curve["axial"])
        said = "; ".join(f"{kind} at {_spans(some, loads)}" for kind, some in kinds.items())
        ends = [curve["last_change"] for curve in members if curve["last_change"] is not None]
        tail = f". k at the highest speed is {_times(min(ends), max(ends))} that at the lowest" if ends else ""
        out.append(f"{name}: {said}{tail}.")
    failed = [row for row in rows if row["status"] != "completed"]
    if failed:
        out.append(f"{len(failed)} of {len(rows)} points gave no number; they are listed with their reasons.")
    return out


def _spans(chosen: Sequence[float], every: Sequence[float]) -> str:
    """Loads in words; only neighbours among every load of the map become a range."""
    runs: list[list[float]] = [[]]
    for load in every:
        if load in chosen:
            runs[-1].append(load)
        elif runs[-1]:
            runs.append([])
    return " and ".join(f"{run[0]:g} N" if len(run) == 1 else f"{run[0]:g} to {run[-1]:g} N" for run in runs if run)


def _times(least: float, most: float) -> str:
    low, high = f"{1.0 + least:.3g} times", f"{1.0 + most:.3g} times"
    return low if low == high else f"{low} to {high}"
