"""Quasi-static trends of K with speed, compared with those of an independent rigid-ring solver.

Secant stiffness F0 / y under the rig's force as a radial load towards ball 0, balls fixed, no inertia of the ring; the article's bearing
with rigid bodies, whatever scene the study is run for.
"""

import math
from collections.abc import Sequence

import attrs
import numpy as np

from raceway import function, scene_from_dict
from raceway.extend import Registry, Tables, without_nan
from raceway_article.design import SOLVER_SPEEDS, article_tables

#: (tilt, axial load [N], ball inertia): k at 10 980 r/min [N/um], k / that at the other speeds; docs/physics.md names the solver.
TRENDS: dict[tuple[str, float, bool], tuple[float, tuple[float, ...]]] = {
    ("locked", 400.0, False): (180.1, (0.991, 0.979, 0.960, 0.926)),
    ("locked", 400.0, True): (163.0, (0.932, 0.848, 0.756, 0.668)),
    ("locked", 1000.0, False): (237.5, (0.999, 0.997, 0.995, 0.992)),
    ("locked", 1000.0, True): (235.3, (0.994, 0.987, 0.976, 0.962)),
    ("locked", 2000.0, False): (286.4, (1.000, 0.999, 0.999, 0.998)),
    ("locked", 2000.0, True): (285.8, (0.999, 0.997, 0.995, 0.993)),
    ("free", 400.0, False): (24.47, (1.084, 1.172, 1.266, 1.365)),
    ("free", 400.0, True): (24.32, (1.081, 1.167, 1.259, 1.356)),
    ("free", 1000.0, False): (34.34, (1.035, 1.075, 1.120, 1.169)),
    ("free", 1000.0, True): (34.30, (1.034, 1.074, 1.118, 1.167)),
    ("free", 2000.0, False): (48.39, (1.012, 1.026, 1.044, 1.064)),
    ("free", 2000.0, True): (48.37, (1.012, 1.026, 1.043, 1.063)),
}


@attrs.frozen
class Trend:
    """One row: expected and computed k at the first speed [N/um] and the ratios at the others; None where a run failed."""

    tilt: str
    load: float
    inertia: bool
    expected: tuple[float, ...]
    computed: tuple[float, ...] | None
    why: str = ""

    @property
    def off(self) -> float | None:
        """Largest difference in units of the last printed digit: k has four of them, ratios have three decimals."""
        if self.computed is None:
            return None
        first = float(10.0 ** (math.floor(math.log10(abs(self.expected[0]))) - 3))
        units = (first, *(1e-3 for _ in self.expected[1:]))
        return max(abs(k - reference) / unit for k, reference, unit in zip(self.computed, self.expected, units, strict=True))

    @property
    def holds(self) -> bool:
        """Rounds to the printed digits: within half a unit of the last one."""
        return self.off is not None and self.off <= 0.5

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "off_in_last_digits": self.off, "holds": self.holds}

    def row(self) -> Tables:
        """As a row of a flat table."""
        table, parts = self.to_dict(), ("expected", "computed")
        numbers = {f"{name}_{k}": value for name in parts for k, value in enumerate(table.pop(name) or ())}
        return {name: table.pop(name) for name in ("tilt", "load", "inertia", "why")} | numbers | table


def secants(case: tuple[str, float, bool], registry: Registry) -> list[Tables]:
    """Secant stiffness [N/m] at the five speeds of a case: tilt, axial load, ball inertia."""
    tilt, load, inertia = case
    article, speeds = article_tables(), np.array(SOLVER_SPEEDS)
    force = article["excitation"]["load_share"] * article["excitation"]["unbalance"] * (speeds * math.pi / 30.0) ** 2
    tables = {
        "title": "quasi-static secant",
        "bearing": article["bearing"],
        "supports": {"tilt": tilt},
        "load": {"axial": load, "radial": [0.0, 0.0]},
        "kinematics": {**article["kinematics"], "ball_inertia": inertia, "spin_speed_rpm": speeds[0]},
    }
    keys = ("load.radial[0]", "kinematics.spin_speed_rpm")
    answer = function(scene_from_dict(tables, registry), keys, ["displacement"], threads=1)(force, speeds)
    stiffness = (force / answer["displacement"][:, 1]).tolist()
    rows = zip(stiffness, answer["reason"], strict=True)
    return [without_nan({"k": k, "reason": " ".join(str(reason).split())}) for k, reason in rows]


def trend(case: tuple[str, float, bool], rows: Sequence[Tables]) -> Trend:
    """The printed numbers of a case beside the rows of ``secants``."""
    first, ratios = TRENDS[case]
    missing = [row["reason"] for row in rows if row["k"] is None]
    k = [row["k"] for row in rows]
    computed = None if missing else (k[0] / 1e6, *(value / k[0] for value in k[1:]))
    return Trend(*case, (first, *ratios), computed, missing[0] if missing else "")
