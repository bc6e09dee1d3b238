"""A study of the article with invented numbers, which costs no run."""

from collections.abc import Sequence
from typing import Any

from raceway_article import elastic_design
from raceway_article import study as driver
from raceway_article.design import Curves, article_tables, design
from raceway_article.elastic import ElasticArticle
from raceway_article.elastic_design import ElasticRun
from raceway_article.study import RIG_LOADS, RIG_SPEEDS, Article
from raceway_checks.verify.reference import Verified

from raceway.extend import Tables, read_toml

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
    for setting, load in (at for group in made.curves() for at in group):
        rows[setting, load] = []
        for speed, w in zip(made.speeds_of(setting), made.relative(made.speeds_of(setting)), strict=True):
            value = k(setting, load, w)
            if value is None:
                one = row(speed, load, None, "failed", "no motion was found")
            elif isinstance(value, tuple):
                one = row(speed, load, value[0], "unstable", "the steady motion is unstable")
            else:
                one = row(speed, load, value)
            rows[setting, load].append(one)
    return Curves(made, rows)


def static(deviation: float | None) -> list[Verified]:
    """Rows of the static verification, all with the same deviation; None for a solver that failed."""
    names = [
        f"peak pressure, {race} race, {where} [MPa]"
        for where in ("400 N axial", "2000 N axial")
        for race in ("inner", "outer")
    ]
    computed = None if deviation is None else 1000.0 * (1.0 + deviation)
    note = "no equilibrium" if deviation is None else ""
    ok = deviation is not None and deviation <= 0.0242
    numbers = 1000.0, computed, deviation, 0.0242, ok
    return [Verified("seed-static-pressures", name, *numbers, "", "own", note) for name in names]


def study(found: Curves) -> Article:
    """A whole study around invented curves."""
    compared = tuple(
        driver.Trend(*given, (first, *ratios), (first, *ratios)) for given, (first, ratios) in driver.TRENDS.items()
    )
    scan = {
        load: [row(speed, load, 1e8 * (1.0 + (0.1 - 0.02 * n) * (speed > 12000.0))) for n in range(len(driver.STIFFNESSES))
               for speed in (10980.0, 15000.0)]
        for load in driver._scan_loads(found.design)
    }  # fmt: skip
    rig = tuple(
        {"tilt": tilt, "bodies": "rigid", **row(speed, load, 2e8)}
        for tilt in ("locked", "shaft", "free") for load in RIG_LOADS for speed in RIG_SPEEDS
    )  # fmt: skip
    return Article("invented", found, rig, tuple(static(0.01)), compared, scan, 1.0, 1.0, 0.5, 10, 0)


def elastic_rows() -> dict[ElasticRun, Tables]:
    """Invented rows of ``raceway study article --bodies elastic``: elastic bodies are a little off condensed ones, these off Hertz."""
    return {run: _elastic_row(run) for run in elastic_design.design(read_toml(elastic_design.SCENE)).runs()}


def elastic_study(failed: Sequence[ElasticRun] = ()) -> ElasticArticle:
    """The study around them; of ``failed`` runs there is a reason."""
    made = elastic_design.design(read_toml(elastic_design.SCENE))
    rows = elastic_rows() | {
        run: {"status": "failed", "reason": "no equilibrium", "cost": {**_cost(run), "elements": None}} for run in failed
    }
    return ElasticArticle("invented", made, [rows[run] for run in made.runs()], 60.0, 60.0, 0)


def _elastic_row(run: ElasticRun) -> Tables:
    off = float(run.bodies == "elastic")
    loads = [200.0, 100.0, 50.0, 0.0]
    balls = [_ball(place, load, 1.0 + 0.005 * off * (place == 0), run.bodies != "rigid", 0.02 + 0.01 * (place == 2))
             for place, load in enumerate(loads)]  # fmt: skip
    stress = {"race": "inner", "body": "ball", "ball": 0, "load_n": 200.0, "largest_shear_pa": 4.1e8, "hertz_largest_shear_pa": 4e8,
              "depth_m": 6.1e-5, "hertz_depth_m": 6e-5, "cells_to_hertz_depth": 5.0, "resolved": True}  # fmt: skip
    k, c = 2e8 * (1.0 + 0.01 * off), 100.0 * (1.0 + 0.5 * off)
    z = complex(k - 2.0 * 1256.6**2, 1256.6 * c)
    known = {"speed_rpm": 12000.0, "equivalent_stiffness": k, "equivalent_damping": c,
             "dynamic_stiffness": {"real": z.real, "imag": z.imag, "abs": abs(z)}}  # fmt: skip
    return {
        "status": "completed", "reason": "", "balls": balls,
        "displacement": {"x": 1e-5 * (1.0 - 0.01 * off), "y": 2e-6 if run.radial else 1e-20},
        "kyy_n_per_m": 2.5e8 * (1.0 + 0.004 * off), "subsurface": [stress] if off else [],
        "identification": None if run.excitation is None else known,
        "stability": {"energy_drift": 1e-4 if off else None, "status": "completed"}, "error": {"transient": 1e-3, "total": 1e-3},
        "warnings": ["one node"] if off else [], "cost": _cost(run),
    }  # fmt: skip


def _ball(place: int, load: float, factor: float, points: bool, off: float) -> Tables:
    ball: Tables = {"azimuth_deg": 90.0 * place}
    for race in ("inner", "outer"):
        hertz = 1e8 * load ** (1.0 / 3.0)
        ball |= {f"load_{race}_n": load * factor, f"peak_pressure_{race}_pa": hertz}
        ball |= {f"peak_pressure_nodal_{race}_pa": (1.0 + off) * hertz} if points else {}
    return ball


def _cost(run: ElasticRun) -> Tables:
    return {"cpu_s": 3.0, "wall_s": 3.0, "compile_s": 0.0, "peak_memory_bytes": 2**30, "peak_memory_of": "run",
            "elements": 1_060_152 if run.bodies == "elastic" else None, "steps": 80, "newton_iterations": 200, "predicted_s": 3.0}  # fmt: skip
