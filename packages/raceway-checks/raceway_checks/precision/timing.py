"""Runs of a study with their time: of the processor without what compiles, of the wall, and the peak of memory."""

import time
from typing import NotRequired, TypedDict, cast

from raceway import RacewayError, Scene
from raceway.extend import (
    AXIAL_DISPLACEMENT, P0, PEAK_BALL_LOAD, Content, Item, K, Registry, Store, Tables, Z_IMAG, Z_REAL, local, named,
    row_key, without_mesh, work_through,
)  # fmt: skip
from raceway_checks.clocks import peak_memory, reset_peak

#: No further repeat is begun once a setting has taken this long [s].
PATIENCE_S = 10.0
_COMPARED = named(Z_REAL, Z_IMAG, K, AXIAL_DISPLACEMENT, PEAK_BALL_LOAD, P0)


class Measured(TypedDict):
    """A setting that was run; without quantities and cost where it failed."""

    status: str
    reason: str
    quantities: dict[str, float]
    own_error: float | None
    transient_error: NotRequired[float | None]
    warnings: NotRequired[list[str]]
    cost: Tables | None


def quantities(result: Content) -> dict[str, float]:
    """What a study compares, as far as a result.json has it.

    Re Z, Im Z and K [N/m], mean axial displacement [m], peak ball load [N] and pressure [Pa], of both races.
    """
    return {name: value for name, quantity in _COMPARED.items() if (value := quantity.of(result)) is not None}


def measured_once(scene: Scene, repeats: int, extra: object, registry: Registry, store: Store) -> tuple[Measured, bool]:
    """``measured``, and whether it was stored before; ``extra`` is a part of the row's key.

    In this process, with nothing beside it: times are what is asked for.
    """
    item = Item(row_key(scene, registry, extra), scene.title, (scene, repeats))

    def measurement(task: tuple[Scene, int], registry: Registry) -> Tables:
        return cast(Tables, measured(task[0], registry, task[1]))

    (row,), reused = work_through(measurement, [item], store, local(registry, 0), registry)
    return cast(Measured, row), reused == 1


def measured(scene: Scene, registry: Registry, repeats: int) -> Measured:
    """Run a scene: status, quantities, its own error estimate, cost; a failure with its reason.

    Times are the least of the repeats.  Compiling is apart: a first run that compiled is not among the repeats, because its
    processor time cannot be separated from the compiler's.  ``time_s``, by which settings are compared, is the time of the processor,
    or with several threads the wall time.
    The peak of memory is the process's, counted anew for each setting where the system lets a process do so.
    """
    from raceway.extend import run

    start, compiling = time.perf_counter(), 0.0
    runs: list[dict[str, float]] = []
    own_peak, cold = reset_peak(), True
    while len(runs) < repeats and (not runs or time.perf_counter() - start - compiling < PATIENCE_S):
        cpu = time.process_time()
        try:
            answer = run(scene, registry)
            cpu = time.process_time() - cpu
            result = answer.content
        except RacewayError as error:
            why = str(error).splitlines()[0]
            return {"status": error.status, "reason": why, "quantities": {}, "own_error": None, "cost": None}
        cost = result["cost"]
        compiling += cost["compile_s"]
        if cold and cost["compile_s"] > 0.0:
            own_peak, cold = reset_peak(), False
            continue
        times = {name: cost[name] for name in ("wall_s", "solve_s", "error_s")}
        # A plug-in that compiles in every run: no less than the wall time of the solution can be told.
        runs.append({"cpu_s": cpu if cost["compile_s"] == 0.0 else max(cpu - cost["compile_s"], cost["solve_s"]), **times})
    times = {name: min(timing[name] for timing in runs) for name in runs[0]}
    return {
        "status": "completed",
        "reason": "",
        "quantities": quantities(result),
        "own_error": without_mesh(result["error"]),
        "transient_error": result["error"]["transient"],
        "warnings": result["warnings"],
        "cost": {
            **times,
            # Other programs on the machine stretch the wall time, not the work; threads share the work.
            "time_s": times["cpu_s"] if cost["threads"] == 1 else times["wall_s"],
            "wall_spread_s": max(timing["wall_s"] for timing in runs) - times["wall_s"],
            "compile_s": compiling,
            "steps": cost["steps"],
            "iterations": cost["newton_iterations"],
            **peak_memory("setting", own_peak),
            "repeats": len(runs),
        },
    }
