"""The trend of K with speed: what it depends on, one choice swapped at a time, and the numbers of an independent solver.

The independent rigid-ring solver gives the quasi-static secant stiffness F0 / y under the rig's force as a radial load towards ball
0, balls fixed, no inertia of the ring: the article's bearing with rigid bodies, whatever scene the study is run for.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.scene.changes import with_value
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.article.design import (
    AMPLITUDES,
    DIRECTIONS,
    ROTATING,
    TILTS,
    Curve,
    Curves,
    Design,
    Setting,
    article_tables,
)

#: Swaps of one choice against the article's bidirectional model with ball inertia; the first changes nothing.
SWAPS: dict[str, Tables] = {
    "rotating force m e w², ball inertia": {},
    "direction swapped: unidirectional force m e w²": {"direction": DIRECTIONS[0]},
    "amplitude law swapped: rotating force, constant": {"amplitude": AMPLITUDES[0]},
    "both swapped: unidirectional force, constant": {"direction": DIRECTIONS[0], "amplitude": AMPLITUDES[0]},
    "weightless balls": {"inertia": False},
    "condensed bodies": {"bodies": "condensed"},
    "friction, balls that stand": {"friction": "standing"},
    "friction, balls that orbit": {"friction": "orbiting"},
}
#: Tilt stiffness of the shaft [N m/rad], from next to free to next to locked.
STIFFNESSES = tuple(float(f"{10.0 ** (2.0 + 0.25 * k):.4g}") for k in range(17))


def base(tilt: str, bodies: Sequence[str]) -> Setting:
    """The article's model: rigid bodies where they are run."""
    return Setting(**ROTATING, tilt=tilt, inertia=True, bodies="rigid" if "rigid" in bodies else bodies[0])


def one_at_a_time(curves: Curves, load: float) -> list[tuple[str, dict[str, float | str]]]:
    """Of each swap that is run at a load the ``change`` of K at each tilt boundary."""
    rows = []
    for name, swap in SWAPS.items():
        settings = {tilt: attrs.evolve(base(tilt, curves.design.bodies), **swap) for tilt in TILTS}
        if (settings[TILTS[0]], load) in curves.rows:  # with friction every other axial load is run
            rows.append((name, {tilt: change(curves.curve(setting, load)) for tilt, setting in settings.items()}))
    return rows


def change(curve: Curve) -> float | str:
    """k*(1) - 1, or why there is no number: "unstable", "failed", "refused"."""
    value = curve.normalised()[-1] - 1.0
    ends = [curve.rows[end]["status"] for end in (0, -1)]
    return float(value) if np.isfinite(value) else str(next(status for status in ends if status != "completed"))


def friction_trends(curves: Curves) -> list[Tables]:
    """k*(1) - 1 under the rotating force m e w^2 for each kind of friction: ``tilt``, ``axial_n``, ``none`` and so on."""
    design, rows = curves.design, []
    for tilt in TILTS if len(design.frictions) > 1 else ():
        settings = {friction: attrs.evolve(base(tilt, ("rigid",)), friction=friction) for friction in design.frictions}
        for load in design.loads_of(settings[design.frictions[-1]]):
            changes = {friction: change(curves.curve(setting, load)) for friction, setting in settings.items()}
            rows.append({"tilt": tilt, "axial_n": load, **changes})
    return rows


def scan_loads(design: Design) -> list[float]:
    """The lightest, the middle and the heaviest axial load."""
    return [design.loads[0], design.loads[len(design.loads) // 2], design.loads[-1]]


def scan_points(design: Design, load: float, registry: Registry) -> list[Tables]:
    """Scenes at the lowest and highest speed over the shaft's tilt stiffness."""
    ends = [
        design.point(base("shaft", design.bodies), load, speed, registry) for speed in (design.speeds[0], design.speeds[-1])
    ]
    return [with_value(tables, "supports.tilt", stiffness) for stiffness in STIFFNESSES for tables in ends]


def hardening(rows: list[Tables]) -> np.ndarray:
    """k*(1) over the stiffnesses (n,); nan where a run failed."""
    k = np.array([row["k"] if row["status"] == "completed" else np.nan for row in rows]).reshape(-1, 2)
    return np.asarray(k[:, 1] / k[:, 0])


def turning_point(ratio: np.ndarray) -> float | None:
    """Tilt stiffness above which k falls with speed instead of rising [N m/rad]; None where it does not turn.

    Notes
    -----
    Straight lines over the logarithm of the stiffness; the first crossing.
    """
    x = np.log(np.array(STIFFNESSES))
    for k in range(len(ratio) - 1):
        first, second = ratio[k] - 1.0, ratio[k + 1] - 1.0
        if first > 0.0 >= second:
            return float(np.exp(x[k] + (x[k + 1] - x[k]) * first / (first - second)))
    return None


SOLVER_SPEEDS = (10980.0, 12000.0, 13000.0, 14000.0, 15000.0)
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
        return max(abs(k - printed) / unit for k, printed, unit in zip(self.computed, self.expected, units, strict=True))

    @property
    def holds(self) -> bool:
        """Rounds to the printed digits: within half a unit of the last one."""
        return self.off is not None and self.off <= 0.5

    def to_dict(self) -> Tables:
        return {**attrs.asdict(self), "off_in_last_digits": self.off, "holds": self.holds}

    def row(self) -> Tables:
        """As a row of a flat table."""
        table = self.to_dict()
        off, holds = table.pop("off_in_last_digits"), table.pop("holds")
        for name in ("expected", "computed"):
            table |= {f"{name}_{k}": value for k, value in enumerate(table.pop(name) or ())}
        return {**table, "off_in_last_digits": off, "holds": holds}


def secants(case: tuple[str, float, bool], registry: Registry) -> list[Tables]:
    """Secant stiffness [N/m] at the five speeds of a case: tilt, axial load, ball inertia."""
    tilt, load, inertia = case
    article = article_tables()
    moment = article["excitation"]["load_share"] * article["excitation"]["unbalance"]
    rows = []
    for speed in SOLVER_SPEEDS:
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


def trend(case: tuple[str, float, bool], rows: Sequence[Tables]) -> Trend:
    """The printed numbers of a case beside the rows of ``secants``."""
    first, ratios = TRENDS[case]
    reason = next((row["reason"] for row in rows if row["status"] != "completed"), "")
    k = [] if reason else [row["k"] for row in rows]
    computed = (k[0] / 1e6, *(value / k[0] for value in k[1:])) if k else None
    return Trend(*case, (first, *ratios), computed, reason)
