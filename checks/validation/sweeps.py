"""Sweeps as a user runs them: how long, how much memory, what they survive."""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from checks.validation.scenes import built_in
from checks.validation.sessions import left
from raceway import RacewayError, load_scene, scene_from_dict
from raceway.extend import default_registry, open_store, read_toml, run, tables_at, with_value
from raceway.points.axes import grid
from raceway.points.sweep import fill_store as study
from raceway.points.sweep import prepare

Serial = built_in("executor", "serial")

SCENE = Path(__file__).parents[2] / "examples" / "b7206.toml"
#: A machine whose processors are busier than this with other programs is not quiet.
_BUSY = 0.1


def words(count: int, store: Path, *more: str, bodies: str = "rigid") -> list[str]:
    """The command line of a sweep of ``count`` points: speeds times 20 loads."""
    axes = [f"excitation.speed_rpm=10980:15000:{count // 20}", "load.axial=400:2000:20"]
    settings = ["integrator.kind=quasi_static", f"bodies.kind={bodies}"]
    return [
        *("sweep", str(SCENE)),
        *(word for setting in settings for word in ("--set", setting)),
        *(word for axis in axes for word in ("--grid", axis)), *("--out", str(store), *more),
    ]  # fmt: skip


def timed(count: int, *more: str, bodies: str = "rigid") -> dict[str, float]:
    """Wall time, processor time of all processes, and peak memory of the main one, of a whole sweep as a process."""
    with tempfile.TemporaryDirectory() as folder:
        store = Path(folder) / "s"
        begin = time.perf_counter()
        process = subprocess.Popen(_python(*words(count, store, *more, bodies=bodies)), stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        with open_store(store) as there:
            states = there.status()
            points = sum(cost["cpu_s"] for kind in (int, str) for cost in there.costs(kind))
    if process.returncode or states["done"] != count:
        raise RuntimeError(f"a sweep of {count} points ended with code {process.returncode}, {states}")
    return {
        "wall_s": wall, "cpu_s": used.ru_utime + used.ru_stime, "points_cpu_s": points,
        "peak_bytes": used.ru_maxrss * 1024.0,
    }  # fmt: skip


def overhead(count: int = 400) -> dict[str, float]:
    """Time a point [s] of the sweep beyond that of the same runs, each begun from its neighbour, in this process."""
    registry, tables = default_registry(), with_value(read_toml(SCENE), "integrator.kind", "quasi_static")
    design = grid([f"excitation.speed_rpm=10980:15000:{count // 4}", "load.axial=400,800,1200,2000"])
    with tempfile.TemporaryDirectory() as folder:
        prepared = prepare(tables, design, Path(folder) / "s")
        run(scene_from_dict(tables_at(tables, design.point(0), registry), registry), registry)
        cpu = time.process_time()
        for chain in design.chains(prepared.length):
            before = None
            for number in chain:
                scene = scene_from_dict(tables_at(tables, design.point(number), registry), registry)
                before = run(scene, registry, near=before)
        bare = time.process_time() - cpu
        cpu = time.process_time()
        study(prepared, Serial()).close()
        swept = time.process_time() - cpu
    return {"bare_s": bare / count, "swept_s": swept / count, "overhead_s": (swept - bare) / count}


def quiet(patience: float = 2.0) -> bool:
    """Whether nobody else works on this machine: its processors idle while this process sleeps.  The load average would
    still count this program's own last minutes."""
    (idle, total), _ = _processor_time(), time.sleep(patience)
    idle_then, total_then = _processor_time()
    return idle_then - idle > (1.0 - _BUSY) * (total_then - total)


def _processor_time() -> tuple[int, int]:
    """Idle and all time of the processors since the start [ticks]."""
    ticks = [int(word) for word in Path("/proc/stat").read_text(encoding="ascii").partition("\n")[0].split()[1:9]]
    return ticks[3] + ticks[4], sum(ticks)


def rows_of(store: Path) -> list[Any]:
    """Everything but costs."""
    with open_store(store) as there:
        return [(row["point"], row["status"], row["reason"], row["values"]) for row in there.rows()]


def killed(times: int = 20, count: int = 120, seed: int = 8) -> dict[str, int]:
    """Sweeps that are killed (SIGKILL) at random moments and then gone on with: how many equal the undisturbed one.  The
    moment is drawn between the first finished chain and about the last; every fourth sweep uses two processes."""
    draw = random.Random(seed)
    found = {"killed": 0, "equal": 0, "unreadable": 0, "lost": 0, "orphans": 0}
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        _finish(words(count, whole))
        wanted = rows_of(whole)
        for number in range(times):
            store = Path(folder) / f"s{number}"
            more = ("--executor", "processes") if number % 4 == 3 else ()
            with _running(words(count, store, *more)) as process:
                seen = _until(store, process, draw.randint(1, count - 1))
                process.kill()
            found["killed"] += process.returncode == -signal.SIGKILL
            found["orphans"] += len(left(process.pid))
            try:
                with open_store(store) as there:
                    found["lost"] += there.status()["done"] < seen
            except RacewayError:
                found["unreadable"] += 1
            _finish([*words(count, store), "--resume"])
            found["equal"] += rows_of(store) == wanted
    return found


def continuation(count: int = 100) -> dict[str, dict[str, float]]:
    """Largest relative change of Z by starting from a neighbour, and the evaluations that it takes, cold and warm."""
    found = {}
    cases = {
        "the article's speeds": ((10980.0, 15000.0), ()),
        "through the ring's resonance, constant force of 20 N": (
            (60000.0, 120000.0),
            ("kinematics.ball_inertia=false", "excitation.amplitude=constant", "excitation.force=20.0"),
        ),
    }
    for name, ((first, last), changes) in cases.items():
        largest, work, before = 0.0, [0, 0], None
        for k in range(count):
            speed = first + (last - first) * k / (count - 1)
            scene = load_scene(SCENE, ["integrator.kind=periodic", *changes, f"excitation.speed_rpm={speed!r}"])
            cold, warm = run(scene), run(scene, near=before)
            z, other = cold.identification.dynamic_stiffness, warm.identification.dynamic_stiffness
            largest = max(largest, abs(other / z - 1.0))
            work = [work[0] + cold.cost["newton_iterations"], work[1] + warm.cost["newton_iterations"]]
            before = warm
        found[name] = {"change": largest, "cold": work[0] / count, "warm": work[1] / count}
    return found


def _python(*given: str) -> list[str]:
    return [sys.executable, "-m", "raceway", *given]


def _finish(given: list[str]) -> None:
    """A command in this process, to its end."""
    from click.testing import CliRunner

    from raceway.cli.main import main as command

    done = CliRunner().invoke(command, given)
    if done.exit_code:
        raise RuntimeError(done.output)


@contextmanager
def _running(given: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        _python(*given),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        # What a shell starts in the background ignores Ctrl-C, and its children with it.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def _until(store: Path, process: subprocess.Popen[bytes], wanted: int) -> int:
    """Wait until so many points are done, or the process ends; how many were seen."""
    done = 0
    while done < wanted and process.poll() is None:
        time.sleep(0.005)
        if (store / "points.sqlite").is_file():
            try:
                with open_store(store) as there:
                    done = there.status()["done"]
            except RacewayError:
                continue  # it is being made
    return done
