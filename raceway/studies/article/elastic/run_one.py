"""One run and its row: numbers, cost, or why there are none."""

from __future__ import annotations

import gc
import resource
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from raceway.core.jit import working_process_time
from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.measured_run import reset_peak

if TYPE_CHECKING:
    from raceway.pipeline.result import Result
    from raceway.studies.article.elastic.told import OnProgress

#: What a row keeps of the tables of result.json.
_BALL = (
    "azimuth_deg", "load_inner_n", "load_outer_n", "peak_pressure_inner_pa", "peak_pressure_outer_pa",
    "peak_pressure_nodal_inner_pa", "peak_pressure_nodal_outer_pa",
)  # fmt: skip
_IDENTIFIED = (
    "speed_rpm", "force_amplitude_n", "equivalent_stiffness", "equivalent_damping", "phase_lag_deg", "dynamic_stiffness",
    "residual", "spread",
)  # fmt: skip
_STABILITY = (
    "energy_drift", "friction_energy_j", "hourglass_energy_ratio", "critical_time_step_s", "max_penetration_m", "status",
)  # fmt: skip


def row_of(scene: Scene, registry: Registry, tell: OnProgress | None = None, folder: Path | None = None) -> Tables:
    """Run a scene.

    Parameters
    ----------
    tell : called as ``tell(what, done, total)`` between steps; an exception that is no fault of the run passes through
    folder : where the section through the most loaded contact is drawn; None: nowhere

    Returns
    -------
    row : ``status`` "completed", "failed" (numbers) or "refused" (the scene, or this machine), ``reason``, ``cost``; of a completed
        run ``balls``, ``displacement``, ``kyy_n_per_m``, ``subsurface``, ``mesh``, ``identification``, ``stability``, ``error``,
        ``warnings`` as in result.json, and ``pictures``, names of files in ``folder``
    """
    begun, status, reason = _Begun(), "completed", ""
    found: Tables = {}
    try:
        result = run(scene, registry, tell)
        found, cost = _numbers(result.to_dict()), begun.cost(result)
        if folder is not None:
            found |= _section(result, folder)
        del result
    except RacewayError as why:
        status, reason = "failed" if why.exit_code == 1 else "refused", " ".join(str(why).split())
    except MemoryError:
        status, reason = "refused", "the memory of this machine does not suffice: take larger elements, mesh.element_size"
    except Exception as why:  # a fault of the program costs its run, not the study
        status, reason = "failed", f"unexpected {type(why).__name__}: {why or 'no message'}"
    if status != "completed":
        found, cost = {}, begun.cost(None)
    gc.collect()  # bodies of gigabytes hold each other
    return {"status": status, "reason": reason, **found, "cost": cost}


class _Begun:
    """Readings of the clocks as a run starts, and the peak of memory counted anew where the system does so."""

    def __init__(self) -> None:
        self.own = reset_peak()
        self.cpu, self.wall = working_process_time(), time.perf_counter()

    def cost(self, result: Result | None) -> Tables:
        """What the run took until now; compiling is apart from its processor time.  None: it came to no end."""
        cpu, wall = working_process_time() - self.cpu, time.perf_counter() - self.wall
        told: Tables = {} if result is None else result.cost
        compiling, mesh = told.get("compile_s", 0.0), (result.bodies or {}).get("mesh") if result is not None else None
        return {
            "cpu_s": cpu,
            "wall_s": wall,
            "compile_s": compiling,
            "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            * (1 if sys.platform == "darwin" else 1024),
            "peak_memory_of": "run" if self.own else "process so far",
            "elements": (mesh or {}).get("cells"),
            "steps": told.get("steps"),
            "newton_iterations": told.get("newton_iterations"),
            "predicted_s": None if result is None else result.model.plan.predicted_wall_s,
        }


def _numbers(result: ReadTables) -> Tables:
    rest, known, model = result["equilibrium"], result["identification"], result["model"] or {}
    return {
        "balls": [{key: ball[key] for key in _BALL if key in ball} for ball in rest["balls"]],
        "displacement": rest["displacement"],
        "kyy_n_per_m": rest["stiffness"][1][1],
        "subsurface": model.get("subsurface") or [],
        "mesh": model.get("mesh"),
        "identification": None if known is None else {key: known[key] for key in _IDENTIFIED},
        "stability": {key: result["stability"][key] for key in _STABILITY},
        "error": {key: result["error"][key] for key in ("total", "time_step", "transient", "mesh", "contact")},
        "warnings": result["warnings"],
    }


def _section(result: Result, folder: Path) -> Tables:
    """The section below the most loaded contact of each race, where a picture can be made; why not, elsewhere."""
    from raceway.studies.view.contact_stress import write_contact_stress

    try:
        return {"pictures": [file.name for file in write_contact_stress(result, folder)]}
    except RacewayError as why:
        return {"pictures": [], "no_picture": " ".join(str(why).split())}
