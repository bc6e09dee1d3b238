"""One run of the article's own model as a row of numbers, and its differences from that with other bodies."""

from __future__ import annotations

import gc
import math
from pathlib import Path
from typing import TYPE_CHECKING

from raceway_checks.clocks import Clocks

from raceway import RacewayError, Scene
from raceway.extend import C, K, OnProgress, ReadTables, Registry, Tables, Z, run, write_whole
from raceway_article.design import RACES
from raceway_article.rows import failure

if TYPE_CHECKING:
    from raceway import Result

#: Balls above this part of the largest load count as loaded.
_LOADED = 0.05
#: A displacement below this part of the axial one has no relative difference.
_NEGLIGIBLE = 1e-3
#: What a row has of the tables of result.json.
_BALL = (
    "azimuth_deg", "load_inner_n", "load_outer_n", "peak_pressure_inner_pa", "peak_pressure_outer_pa",
    "peak_pressure_nodal_inner_pa", "peak_pressure_nodal_outer_pa",
)  # fmt: skip
_IDENTIFIED = (
    "speed_rpm", "force_amplitude_n", K.name, C.name, "phase_lag_deg", "dynamic_stiffness",
    "residual", "spread",
)  # fmt: skip
_STABILITY = (
    "energy_drift", "friction_energy_j", "hourglass_energy_ratio", "critical_time_step_s", "max_penetration_m", "status",
)  # fmt: skip
_ERROR = ("total", "time_step", "transient", "mesh", "contact")


def row_of(scene: Scene, registry: Registry, on_progress: OnProgress | None = None, folder: Path | None = None) -> Tables:
    """Run a scene.

    on_progress : called as ``on_progress(what, done, total)`` between steps; an exception that is no fault of the run passes through
    folder : where the section through the most loaded contact is drawn; None: nowhere
    Returns row : ``status`` "completed", "failed" (numbers) or "refused" (the scene, or this machine), ``reason``, ``cost``; of a completed
        run ``balls``, ``displacement``, ``kyy_n_per_m``, ``subsurface``, ``mesh``, ``identification``, ``stability``, ``error``,
        ``warnings`` as in result.json, and ``pictures``, names of files in ``folder``
    """
    clocks, row = Clocks(), {"status": "completed", "reason": ""}
    try:
        result = run(scene, registry, on_progress)
        numbers, cost = _result_numbers(result.to_dict()), _cost(clocks, result)
        if folder is not None:
            from raceway_view.stress import contact_stress_files

            numbers["pictures"] = []
            try:
                files = contact_stress_files(result)
                numbers["pictures"] += [write_whole(content, folder / name).name for name, content in files.items()]
            except RacewayError as why:
                numbers["no_picture"] = failure(why)["reason"]
        del result
    except RacewayError as why:
        row = failure(why)
    except MemoryError:
        reason = "the memory of this machine does not suffice: use larger elements, mesh.element_size"
        row = {"status": "refused", "reason": reason}
    except Exception as why:  # a fault of the program costs its run, not the study
        row = {"status": "failed", "reason": f"unexpected {type(why).__name__}: {why or 'no message'}"}
    if row["status"] != "completed":
        numbers, cost = {}, _cost(clocks, None)
    gc.collect()  # bodies of gigabytes hold each other
    return {**row, **numbers, "cost": cost}


def _cost(clocks: Clocks, result: Result | None) -> Tables:
    """What a run took until now; compiling is apart from its processor time.  None: it came to no end."""
    (cpu, wall, peak), cost = clocks.read(), dict[str, float]() if result is None else result.cost
    mesh = None if result is None else (result.bodies or {}).get("mesh")
    return {
        "cpu_s": cpu,
        "wall_s": wall,
        "compile_s": cost.get("compile_s", 0.0),
        **peak,
        "elements": (mesh or {}).get("cells"),
        "steps": cost.get("steps"),
        "newton_iterations": cost.get("newton_iterations"),
        "predicted_s": None if result is None else result.model.plan.predicted_wall_s,
    }


def _result_numbers(result: ReadTables) -> Tables:
    static, identification, model = result["equilibrium"], result["identification"], result["model"] or {}
    return {
        "balls": [{key: ball[key] for key in _BALL if key in ball} for ball in static["balls"]],
        "displacement": static["displacement"],
        "kyy_n_per_m": static["stiffness"][1][1],
        "subsurface": model.get("subsurface") or [],
        "mesh": model.get("mesh"),
        "mass_scaling": model.get("mass_scaling"),
        "identification": None if identification is None else {key: identification[key] for key in _IDENTIFIED},
        "stability": {key: result["stability"][key] for key in _STABILITY},
        "error": {key: result["error"][key] for key in _ERROR},
        "warnings": result["warnings"],
    }


def pressures_of(balls: list[ReadTables], race: str) -> Tables | None:
    """Nodal peak pressures of a race over Hertz's at the same ball load, less 1; None of rigid bodies, which have no points.

    ``ball``, ``load_n`` and ``peak_pressure_pa`` are of the most loaded ball, with ``most_loaded``, its deviation; ``largest`` is the
    deviation of largest size over all loaded balls.
    """
    nodal, hertz, load = f"peak_pressure_nodal_{race}_pa", f"peak_pressure_{race}_pa", f"load_{race}_n"
    most = max(balls, key=lambda ball: ball[load])
    loaded_balls = [ball for ball in balls if ball[load] > _LOADED * most[load] and ball.get(nodal) is not None]
    if not loaded_balls:
        return None
    deviations = [ball[nodal] / ball[hertz] - 1.0 for ball in loaded_balls]
    return {
        "ball": balls.index(most),
        "load_n": most[load],
        "peak_pressure_pa": most[nodal],
        "hertz_peak_pressure_pa": most[hertz],
        "most_loaded": deviations[loaded_balls.index(most)],
        "largest": max(deviations, key=abs),
        "loaded_balls": len(loaded_balls),
    }


def difference_at_rest(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of two rows at rest: x, y, kyy, and the largest of a ball's load over the largest load.

    y is None where the load is axial.
    """
    displacement, reference_values = row["displacement"], reference["displacement"]
    sideways = abs(reference_values["y"]) > _NEGLIGIBLE * abs(reference_values["x"])
    return {
        "ball_loads": max(_loads(row["balls"], reference["balls"], f"load_{race}_n") for race in RACES),
        "x": over(displacement["x"], reference_values["x"]),
        "y": over(displacement["y"], reference_values["y"]) if sideways else None,
        "kyy": over(row["kyy_n_per_m"], reference["kyy_n_per_m"]),
    }


def difference_in_motion(row: ReadTables, reference: ReadTables) -> Tables:
    """Relative differences of K, C and |Z| of two motions, and of the complex Z, its size.

    ``wc`` : difference of w C over the reference's |Z|, where C is next to nothing
    """
    z, reference_values = stiffness_numbers(row), stiffness_numbers(reference)
    speed = reference["identification"]["speed_rpm"] * math.pi / 30.0
    differences: Tables = {name: over(z[name], reference_values[name]) for name in z}
    wc = speed * (z["c"] - reference_values["c"]) / reference_values["abs_z"]
    return differences | {"wc": wc, "z": math.hypot((z["k"] - reference_values["k"]) / reference_values["abs_z"], wc)}


def stiffness_numbers(row: ReadTables) -> dict[str, float]:
    """K [N/m], C [N s/m] and |Z| [N/m] of a motion."""
    return {"k": K.of(row), "c": C.of(row), "abs_z": Z.of(row)}


def _loads(balls: list[ReadTables], references: list[ReadTables], load: str) -> float:
    pairs = zip(balls, references, strict=True)
    return max(abs(a[load] - b[load]) for a, b in pairs) / max(b[load] for b in references)


def over(value: float, reference: float) -> float | None:
    return value / reference - 1.0 if reference else None
