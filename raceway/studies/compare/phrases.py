"""Numbers, lists and names as words, for studies that explain what they found."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from raceway.storage.tables import Tables
from raceway.studies.many.axes import Axis, shown

#: A change of less than half a percent "hardly matters".
HARDLY = math.log(1.005)
LABELS = {"equivalent_stiffness": "K(w)", "dynamic_stiffness": "|Z|"}
_NAMES = {
    "excitation.kind": "the direction of the force",
    "excitation.amplitude": "the amplitude law",
    "excitation.speed_rpm": "the speed",
    "supports.tilt": "the tilt boundary",
    "kinematics.ball_inertia": "the centrifugal force of the balls",
    "load.axial": "the axial load",
    "rotor.mass": "the carried mass",
}


def percent(log_change: float) -> str:
    """A change of ln(quantity) in percent, signed."""
    value = 100.0 * math.expm1(log_change)
    return f"{value:+.1f} %" if abs(value) >= 1.0 else f"{value:+.2f} %"


def span(log_changes: Iterable[float]) -> str:
    found = list(log_changes)
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def listed(parts: Sequence[str]) -> str:
    """``a, b and c``."""
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def named(key: str) -> str:
    return f"{_NAMES[key]} ({key})" if key in _NAMES else key


def step(axis: Axis) -> str:
    return f"{axis.key} from {shown(axis.ends[0])} to {shown(axis.ends[1])}"


def settings(point: Tables) -> str:
    """``a = 1 and b = 2``."""
    return listed([f"{key} = {shown(value)}" for key, value in point.items()])
