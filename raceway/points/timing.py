"""Runs of a study with their time: of the processor without what compiles, of the wall, and the peak of memory."""

import resource
import sys
import time
from pathlib import Path
from typing import NotRequired, TypedDict, cast

from raceway.answers.quantities import AXIAL_DISPLACEMENT, P0, PEAK_BALL_LOAD, Z_IMAG, Z_REAL, K, named
from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.content import Content, ErrorTable
from raceway.points.engine import Item, local, work_through
from raceway.points.store import Store, row_key
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


def processor_time() -> float:
    """Of this process and of those that it has ended [s]."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


#: No further repeat is begun once a setting has taken this long [s].
PATIENCE_S = 10.0
_PROCESS = Path("/proc/self")
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
    from raceway.pipeline.run import run

    start, compiling = time.perf_counter(), 0.0
    runs: list[dict[str, float]] = []
    own_peak, cold = _reset_peak(), True
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
            own_peak, cold = _reset_peak(), False
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
            **_peak_memory("setting", own_peak),
            "repeats": len(runs),
        },
    }


def without_mesh(error: ErrorTable) -> float | None:
    """The run's own estimate, less its bodies': rows on one mesh are compared with a reference on the same."""
    return None if error["total"] is None else max(error["total"] - (error["bodies"] or 0.0), 0.0)


class Clocks:
    """Readings of the clocks as a run starts, and the peak of memory counted anew where the system does so."""

    def __init__(self) -> None:
        from raceway.core.jit import working_process_time

        self._counted_anew, self._clock = _reset_peak(), working_process_time
        self._cpu, self._wall = self._clock(), time.perf_counter()

    def read(self) -> tuple[float, float, Tables]:
        """Processor time without what kernels took to compile, and wall time since then [s]; ``_peak_memory`` of the run."""
        return self._clock() - self._cpu, time.perf_counter() - self._wall, _peak_memory("run", self._counted_anew)


def _peak_memory(counted: str, anew: bool) -> Tables:
    """Peak of memory of this process [bytes], and whose it is: of what is ``counted`` where the count began ``anew`` with it."""
    scale = 1 if sys.platform == "darwin" else 1024
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale
    return {"peak_memory_bytes": peak, "peak_memory_of": counted if anew else "process so far"}


def _reset_peak() -> bool:
    """Let the system count the peak of memory of this process anew (Linux); whether it does."""
    try:
        (_PROCESS / "clear_refs").write_bytes(b"5")
    except OSError:
        return False
    return True
