"""First sentences of comparisons against their own tables, by a judge that knows rows and numbers alone."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

import raceway as rw

#: How far a percentage in a sentence may be off: it has two digits after the point or one.
_DIGIT = 0.06
_AXES: dict[str, tuple[Any, ...]] = {
    "excitation.speed_rpm": (8000, 14000, 20000), "contact.kind": ("hertz", "penalty"), "supports.tilt": ("locked", "free"),
    "load.axial": (900, 400, 1500), "kinematics.ball_inertia": (False, True), "excitation.kind": ("unidirectional", "bidirectional"),
    "kinematics.gyroscopic": ("none", "outer_race"), "bearing.ball_count": (10, 12),
}  # fmt: skip
_FORCE = {"kind": "bidirectional", "speed_rpm": 12000, "amplitude": "constant", "force": 50.0}


def contradictions(count: int) -> list[str]:
    """What the first sentences of so many comparisons say that their tables do not."""
    rng, found = np.random.default_rng(5), []
    for number in range(count):
        names = [str(name) for name in rng.choice(list(_AXES), 2 + number % 2, replace=False)]
        moving: dict[str, Any] = {"excitation": _FORCE, "integrator": {"kind": "quasi_static"}}
        if number % 5 == 0:
            names = [name for name in names if not name.startswith("excitation")] or ["load.axial"]
            moving = {"kinematics": {"spin_speed_rpm": 12000.0}}
        scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": float(rng.choice([500.0, 1200.0]))}, **moving}
        study = rw.compare(scene, {name: list(_AXES[name]) for name in names})
        wrong = contradiction(study.short_words[0], [(row.point, value(row.result)) for row in study.rows], names)
        found += [f"{number}: {wrong}"] if wrong else []
    return found


def value(result: Any) -> float | None:
    """What a table shows first: K, or kxx of a static scene [N/m]."""
    motion, rest = result.get("identification"), result.get("equilibrium")
    return motion["equivalent_stiffness"] if motion else rest["stiffness"][0][0] if rest else None


def contradiction(sentence: str, table: list[tuple[Any, float | None]], names: list[str]) -> str:
    """What a sentence says that the table does not; empty where nothing.

    Notes
    -----
    The range is that of the whole table.  The mean change of an axis is that of the logarithm between its first and last value over the
    table's corners; an axis that the sentence passes over must change nothing by half a per cent, and those that it names stand in the
    order of their sizes.
    """
    if any(number is None or number <= 0.0 for _, number in table):
        return ""  # the sentence may hold some axes then: the words say which
    bounds = [1e-6 * pick(number for _, number in table if number is not None) for pick in (min, max)]
    if "lies between {:.2f} and {:.2f} ".format(*bounds) not in sentence:
        return f"{sentence[:60]} for {bounds[0]:.2f} to {bounds[1]:.2f}"
    changes = {}
    for name in names:
        ends = _AXES[name][0], _AXES[name][-1]
        corners = [(point, number) for point, number in table if all(point[k] in (_AXES[k][0], _AXES[k][-1]) for k in names)]
        means = [np.mean([math.log(number) for point, number in corners if number and point[name] == end]) for end in ends]
        changes[name] = 100.0 * math.expm1(float(means[1] - means[0]))
    said = {
        name: float(found[1])
        for name in names
        if (found := re.search(rf"{re.escape(name)} from [^;]*? by ([+-][0-9.]+) %", sentence))
    }
    for name, number in said.items():
        if abs(number - changes[name]) > _DIGIT:
            return f"{name} {number} for {changes[name]:.2f} %"
    for name in names:
        if name not in said and abs(changes[name]) > 0.5:
            return f"{name} is passed over, {changes[name]:.2f} %"
    if "; to " in sentence:
        return ""  # an axis may stand for what it does between its ends
    sizes = [abs(math.log1p(changes[name] / 100.0)) for name in sorted(said, key=sentence.index)]
    return "" if sizes == sorted(sizes, reverse=True) else "not in the order of size"
