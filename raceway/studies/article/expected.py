"""The quasi-static trends of an independent rigid-ring solver, and the same numbers computed here.

Secant stiffness F0 / y under the rig's force as a radial load towards ball 0, balls fixed, no inertia of the ring: the
article's bearing with rigid bodies, whatever scene the study is given.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.article.design import article_tables

SPEEDS = (10980.0, 12000.0, 13000.0, 14000.0, 15000.0)
#: (tilt, axial load [N], ball inertia): k at 10 980 r/min [N/um], k / that at the other speeds; docs/physics.md says whose.
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
        """Largest difference in units of the last printed digit."""
        if self.computed is None:
            return None
        units = (last_digit(self.expected[0]), *(1e-3 for _ in self.expected[1:]))
        pairs = zip(self.computed, self.expected, units, strict=True)
        return max(abs(found - wanted) / unit for found, wanted, unit in pairs)

    @property
    def holds(self) -> bool:
        """Rounds to the printed digits: within half a unit of the last one."""
        return self.off is not None and self.off <= 0.5

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "off_in_last_digits": self.off, "holds": self.holds}


def last_digit(value: float) -> float:
    """Unit of the last digit of a number that is printed with four digits."""
    return float(10.0 ** (math.floor(math.log10(abs(value))) - 3))


def secants(given: tuple[str, float, bool], registry: Registry) -> list[Tables]:
    """Secant stiffness [N/m] at the five speeds; a task of ``runs.work``.

    Parameters
    ----------
    given : tilt, axial load, ball inertia
    """
    tilt, load, inertia = given
    article = article_tables()
    excitation = article["excitation"]
    moment = excitation["load_share"] * excitation["unbalance"]
    rows = []
    for speed in SPEEDS:
        force = moment * (speed * math.pi / 30.0) ** 2
        tables = {
            "title": "quasi-static secant",
            "bearing": article["bearing"],
            "supports": {"tilt": tilt},
            "load": {"axial": load, "radial": [force, 0.0]},
            "kinematics": {"ball_inertia": inertia, "spin_speed_rpm": speed},
        }
        try:
            result = run(scene_from_dict(tables, registry), registry)
        except RacewayError as error:
            rows.append({"speed_rpm": speed, "status": "failed", "reason": " ".join(str(error).split())})
            continue
        rows.append({"speed_rpm": speed, "status": "completed", "k": force / float(result.equilibrium.displacement[1])})
    return rows


def trend(given: tuple[str, float, bool], rows: Sequence[Tables]) -> Trend:
    """The row of a table from what ``secants`` found."""
    tilt, load, inertia = given
    first, ratios = TRENDS[tilt, load, inertia]
    bad = [row for row in rows if row["status"] != "completed"]
    if bad:
        return Trend(tilt, load, inertia, (first, *ratios), None, bad[0]["reason"])
    k = [row["k"] for row in rows]
    return Trend(tilt, load, inertia, (first, *ratios), (k[0] / 1e6, *(one / k[0] for one in k[1:])))
