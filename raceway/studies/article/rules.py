"""Rules of the claims, as plain functions of arrays; None where numbers are missing.

A number that is missing is nan.  Where ``failed`` is True a run failed or was refused: nothing is judged over such a gap.  The
other numbers that are missing belong to unstable motions: those between two numbers are bridged, those at an end leave no judgement.
"""

from __future__ import annotations

import numpy as np

from raceway.studies.compare.effects import trend

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
