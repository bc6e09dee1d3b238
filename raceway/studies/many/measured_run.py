"""One setting, run a few times: its numbers and what they cost."""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables
from raceway.studies.many.engine import Item, local, work_through
from raceway.studies.many.row_store import RowStore, row_key

#: No further repeat is begun once a setting has taken this long [s].
PATIENCE_S = 10.0
_PROCESS = Path("/proc/self")


def quantities(result: Tables) -> dict[str, float]:
    """What a study compares, as far as a result.json has it.

    Returns
    -------
    quantities : Re Z, Im Z and K [N/m], mean axial displacement [m], peak ball load [N] and pressure [Pa], of both races
    """
    found: dict[str, float] = {}
    known, motion = result["identification"], result["motion"]
    if known is not None:
        z = known["dynamic_stiffness"]
        found |= {"z_real": z["real"], "z_imag": z["imag"], "equivalent_stiffness": known["equivalent_stiffness"]}
    if motion is not None:
        found |= {"axial_displacement": motion["axial_displacement_m"], "peak_ball_load": motion["peak_ball_load_n"]}
        return found | {"p0": motion["peak_pressure_pa"]}
    still = result["equilibrium"]
    found |= {"axial_displacement": still["displacement"]["x"], "peak_ball_load": still["largest_ball_load_n"]}
    return found | {"p0": still["largest_pressure_pa"]}


def measured_once(scene: Scene, repeats: int, extra: object, registry: Registry, store: RowStore) -> tuple[Tables, bool]:
    """``measured``, and whether it was kept from before; ``extra`` is a part of the row's key.

    In this process, with nothing beside it: times are what is asked for.
    """
    item = Item(row_key(scene, registry, extra), scene.title, (scene, repeats))
    (row,), reused = work_through(_measured, [item], store, local(registry, 0), registry)
    return row, reused == 1


def _measured(given: tuple[Scene, int], registry: Registry) -> Tables:
    scene, repeats = given
    return measured(scene, registry, repeats)


def measured(scene: Scene, registry: Registry, repeats: int) -> Tables:
    """Run a scene: status, quantities, its own error estimate, cost; a failure with its reason.

    Notes
    -----
    Times are the least of the repeats.  Compiling is apart: a first run that compiled is not among the repeats, because its
    processor time cannot be told from the compiler's.  ``time_s``, by which settings are compared, is the time of the processor,
    or with several threads the wall time.
    The peak of memory is the process's, counted anew for each setting where the system lets a process do so.
    """
    from raceway.pipeline.run import run

    begun, compiling = time.perf_counter(), 0.0
    runs: list[dict[str, float]] = []
    own_peak, cold = reset_peak(), True
    while len(runs) < repeats and (not runs or time.perf_counter() - begun - compiling < PATIENCE_S):
        cpu = time.process_time()
        try:
            found = run(scene, registry)
            cpu = time.process_time() - cpu
            result = found.to_dict()
        except RacewayError as error:
            return {
                "status": error.status,
                "reason": str(error).splitlines()[0],
                "quantities": {},
                "own_error": None,
                "cost": None,
            }
        cost = result["cost"]
        compiling += cost["compile_s"]
        if cold and cost["compile_s"] > 0.0:
            own_peak, cold = reset_peak(), False
            continue
        times = {name: cost[name] for name in ("wall_s", "solve_s", "error_s")}
        # A plug-in that compiles in every run: no less than the wall time of the solution can be told.
        runs.append({"cpu_s": cpu if cost["compile_s"] == 0.0 else max(cpu - cost["compile_s"], cost["solve_s"]), **times})
    scale = 1 if sys.platform == "darwin" else 1024
    times = {name: min(one[name] for one in runs) for name in runs[0]}
    return {
        "status": "completed",
        "reason": "",
        "quantities": quantities(result),
        "own_error": _without_mesh(result["error"]),
        "transient_error": result["error"]["transient"],
        "warnings": result["warnings"],
        "cost": {
            **times,
            # Other programs on the machine stretch the wall time, not the work; threads share the work.
            "time_s": times["cpu_s"] if cost["threads"] == 1 else times["wall_s"],
            "wall_spread_s": max(one["wall_s"] for one in runs) - times["wall_s"],
            "compile_s": compiling,
            "steps": cost["steps"],
            "iterations": cost["newton_iterations"],
            "peak_memory_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale,
            "peak_memory_of": "setting" if own_peak else "process so far",
            "repeats": len(runs),
        },
    }


def _without_mesh(error: Tables) -> float | None:
    """The run's own estimate, less its bodies': rows on one mesh are held against a reference on the same."""
    return None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0)


def reset_peak() -> bool:
    """Let the system count the peak of memory of this process anew (Linux); whether it does."""
    try:
        (_PROCESS / "clear_refs").write_bytes(b"5")
    except OSError:
        return False
    return True
