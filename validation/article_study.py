"""A study of the article with invented numbers, which costs no run."""

from __future__ import annotations

from typing import Any

from raceway.studies.article import causes, expected
from raceway.studies.article.curves import Curves
from raceway.studies.article.design import article_tables, design
from raceway.studies.article.study import RIG_LOADS, RIG_SPEEDS, Article

SPEEDS, LOADS = "10980:15000:5", "400,1000,2000"


def row(speed: float, load: float, k: float | None, status: str = "completed", reason: str = "") -> dict[str, Any]:
    """As ``runs.curve`` makes it; k None for a run that failed."""
    found = {"speed_rpm": speed, "axial_n": load, "status": status, "reason": reason}
    numbers = {"k": k, "abs_z": None if k is None else 0.9 * k, "force_n": 400.0, "error": 1e-9, "mesh_error": None}
    return found if k is None else {**found, **numbers}


def curves(k: Any, bodies: tuple[str, ...] = ("rigid",), friction: float | None = None) -> Curves:
    """Curves of ``k(setting, load, w*)`` [N/m]; None fails the run, a tuple (k,) makes its motion unstable."""
    made = design(article_tables(), SPEEDS, LOADS, None, bodies, friction)
    rows: dict[Any, list[dict[str, Any]]] = {}
    for setting, load in made.tasks():
        rows[setting, load] = []
        for speed, w in zip(made.speeds_of(setting), made.relative_speeds_of(setting), strict=True):
            value = k(setting, load, w)
            if value is None:
                one = row(speed, load, None, "failed", "no motion was found")
            elif isinstance(value, tuple):
                one = row(speed, load, value[0], "unstable", "the steady motion is unstable")
            else:
                one = row(speed, load, value)
            rows[setting, load].append(one)
    return Curves(made, rows)


def static(deviation: float | None) -> list[dict[str, Any]]:
    """Rows of the static verification, all with the same deviation; None for a solver that failed."""
    names = [
        f"peak pressure, {race} race, {where} [MPa]"
        for where in ("400 N axial", "2000 N axial")
        for race in ("inner", "outer")
    ]
    computed = None if deviation is None else 1000.0 * (1.0 + deviation)
    note = "no equilibrium" if deviation is None else ""
    return [
        {"case": "seed-static-pressures", "quantity": name, "reference": 1000.0, "computed": computed, "error": deviation,
         "tolerance": 0.0242, "ok": deviation is not None and deviation <= 0.0242, "source": "", "note": note}
        for name in names
    ]  # fmt: skip


def study(found: Curves) -> Article:
    """A whole study around invented curves."""
    trends = tuple(
        expected.Trend(*given, (first, *ratios), (first, *ratios)) for given, (first, ratios) in expected.TRENDS.items()
    )
    scan = {
        load: [row(speed, load, 1e8 * (1.0 + (0.1 - 0.02 * n) * (speed > 12000.0))) for n in range(len(causes.STIFFNESSES))
               for speed in (10980.0, 15000.0)]
        for load in causes.scan_loads(found.design)
    }  # fmt: skip
    rig = tuple(
        {"tilt": tilt, "bodies": "rigid", **row(speed, load, 2e8)}
        for tilt in ("locked", "shaft", "free") for load in RIG_LOADS for speed in RIG_SPEEDS
    )  # fmt: skip
    return Article("invented", found, rig, tuple(static(0.01)), trends, scan, 1.0, 1.0, 0.5, 10, 0)
