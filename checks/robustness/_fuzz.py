"""Tries scenes in a process of its own, which the operating system ends where one hangs: ``python -m checks._fuzz``.

A line of JSON is written before each scene and after it; a line without its second one names the scene that ended the process.
"""

import json
import math
import os
import re
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

import raceway as rw
from checks.robustness._doors import called
from checks.robustness._scenes import fill, scene
from raceway import ConvergenceError, RacewayError, Result, Scene, ScenePlan, load_scene, make_plan, scene_from_dict
from raceway.extend import START_S, resolve, run
from raceway.planning.resolve import record_bytes

#: Processor time [s] in which a scene is checked and planned, and run; and wall time that nothing may sleep through.
CHECK_S, RUN_S, ASLEEP_S = 10.0, 60.0, 300.0
#: One call of a Python front for so many scenes.
CALLS = 5
#: Runs that are tried: at most so many steps, predicted seconds beyond start-up (rigid, deforming), and for steady orbits natural
#: frequencies over the force's.
_STEPS, _SECONDS, _DEFORMING_S, _ORDER = 3000, 0.5, 6.0, 200.0
_LEAVING = (
    "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.forkpty", "os.startfile", "pty.spawn", "os.mkdir",
    "os.rename", "os.remove", "os.link", "os.symlink", "os.truncate", "shutil.move", "sqlite3.connect", "socket.connect",
    "tempfile.mkstemp", "tempfile.mkdtemp",
)  # fmt: skip


class Watch:
    """Processes that Python starts and files that it writes, while ``on``."""

    def __init__(self) -> None:
        self.on, self.seen = False, list[str]()
        sys.addaudithook(self._event)

    def _event(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        writes = event == "open" and isinstance(arguments[2], int) and arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if event in _LEAVING or (writes and arguments[0] != os.devnull):
            self.seen.append(f"{event} {arguments}"[:200])


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """The process ends by SIGPROF or SIGALRM, compiled code or not, where a scene takes longer."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, ASLEEP_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)


class Memory:
    """Peak of this process's memory [bytes] since the beginning of a scene."""

    def __init__(self) -> None:
        Path("/proc/self/clear_refs").write_text("5")
        self.before = _status("VmRSS")

    @property
    def peak(self) -> int:
        return _status("VmHWM")


def _status(word: str) -> int:
    return next(
        1024 * int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(word)
    )


def check(tables: dict[str, Any]) -> tuple[Scene | None, ScenePlan | None, str]:
    """What ``raceway check`` and ``raceway plan`` do, and how it ended."""
    try:
        scene = scene_from_dict(tables)
        plan = make_plan(scene)
        json.dumps(plan.to_dict(), allow_nan=False)
        mistakes = rw.check(scene).mistakes
    except RacewayError as error:
        assert error.exit_code in (1, 2), error.exit_code
        assert str(error).strip(), "no message"
        return None, None, "refused"
    return scene, plan, "foreseen" if mistakes else "planned"


def planned_bytes(scene: Scene, plan: ScenePlan, before: int) -> float:
    """Memory [bytes] that a run is to take: what was there, its record, its meshes."""
    record = 0
    if scene.excitation is not None and plan.time_step_s is not None:
        count = scene.bearing.ball_count * len(scene.bearing.rows)
        record = record_bytes(plan.turns, resolve(scene).steps_per_turn, count, resolve(scene).integrator.method.inertial)
    return before + record + (plan.mesh or {}).get("bytes", 0)


def cheap(scene: Scene, plan: ScenePlan) -> bool:
    """Whether a scene is run."""
    if plan.predicted_work_s - START_S > (_SECONDS if scene.bodies.name == "rigid" else _DEFORMING_S):
        return False
    if scene.bodies.name != "elastic" and plan.predicted_steps > _STEPS:
        return False
    problem = resolve(scene)
    if problem.integrator.method.steady and scene.excitation is not None:
        return problem.highest_frequency / (2.0 * math.pi * scene.excitation.frequency_hz) <= _ORDER
    return True


def tried(seed: int, folder: Path, watch: Watch, runs: bool) -> dict[str, Any]:
    """What becomes of a scene."""
    tables = scene(seed, folder)
    found: dict[str, Any] = {"seed": seed, "faults": []}
    memory, watch.on, watch.seen = Memory(), True, []
    with limited(CHECK_S):
        try:
            good, plan, found["check"] = check(tables)
        except Exception:
            found["faults"].append(["traceback", "check", traceback.format_exc()[-900:]])
            return found
        finally:
            watch.on = False
    found["faults"] += [["left", "check", event] for event in watch.seen]
    if memory.peak > 2 * memory.before:
        found["faults"].append(["memory", "check", f"{memory.peak} of {memory.before} bytes"])
    if not runs or good is None or plan is None or not cheap(good, plan):
        return found
    memory, begun = Memory(), time.process_time()
    with limited(RUN_S):
        found["run"], fault = ran(good)
    found |= {"s": time.process_time() - begun, "planned_s": plan.predicted_wall_s, "bodies": good.bodies.name}
    found["faults"] += fault
    allowed = planned_bytes(good, plan, memory.before)
    if memory.peak > 2 * allowed:
        found["faults"].append(["memory", "run", f"{memory.peak} of {allowed:.0f} bytes"])
    return found


def ran(scene: Scene) -> tuple[str, list[list[str]]]:
    """How a run ended, and what is wrong with that."""
    try:
        result = run(scene)
    except RacewayError as error:
        if not str(error).strip():
            return "failed", [["traceback", "run", f"no message: {error!r}"]]
        words = str(error).replace(",", " ").split()
        bad = isinstance(error, ConvergenceError) and bool({"nan", "inf"} & set(words))
        return "failed", [["nan", "run", str(error)]] if bad else []
    except Exception:
        return "broken", [["traceback", "run", traceback.format_exc()[-900:]]]
    try:
        refuse_nan(result)
    except (AssertionError, ValueError) as why:
        return "finished", [["nan", "run", str(why)]]
    return "finished", [["untold", "run", why] for why in untold(result)]


def untold(result: Result) -> list[str]:
    """Errors of Z that are unknown, with their parts, and larger than Z, of which no warning says so."""
    if result.identification is None:
        return []
    error, told = result.error, " ".join(result.warnings)
    parts = ("time_step", "transient", "identification", "mesh", "contact")
    found = [f"{part}: null without reason" for part in parts if error[part] is None and not error["how"].get(part)]
    if error["total"] is None and not re.search("rror (of Z )?is not estimated[:,] .{30}", told):
        found.append("total: null without warning")
    if max(error[part] or 0.0 for part in ("total", *parts)) >= 1.0 and "Z is not resolved" not in told:
        found.append("an error larger than Z without warning")
    return found


def refuse_nan(result: Result) -> None:
    """Raise ``AssertionError`` for a number that is none, in arrays too: result.json has null where arrays have NaN."""
    json.dumps(result.to_dict(), allow_nan=False)
    still = result.equilibrium
    arrays = {"equilibrium": still.displacement, "tangent": still.stiffness, "ball loads": still.contact_force}
    if result.identification is not None:
        z = result.identification.dynamic_stiffness
        arrays["dynamic stiffness"] = np.array([z.real, z.imag])
    if result.simulation is not None:
        whole = result.simulation.whole
        arrays |= {"displacement": whole.displacement, "velocity": whole.velocity, "contact force": whole.contact_force}
    bad = [name for name, array in arrays.items() if not np.isfinite(array).all()]
    assert not bad, f"not finite: {', '.join(bad)}"


def main(first: int, last: int, quota: int, out: Path) -> None:
    """Try the scenes from ``first`` to ``last``; run at most ``quota`` of them."""
    warnings.simplefilter("ignore")
    for change in ("integrator.kind=periodic", "contact.friction=0.1", "supports.tilt=free", "contact.kind=penalty"):
        run(load_scene(Path("examples/minimal.toml"), [change]))
    run(load_scene(Path("examples/minimal.toml")))
    watch = Watch()
    with tempfile.TemporaryDirectory() as folder, out.open("a") as file:
        fill(Path(folder))
        for seed in range(first, last):
            file.write(json.dumps({"begun": seed}) + "\n")
            file.flush()
            found = tried(seed, Path(folder), watch, quota > 0)
            quota -= "run" in found
            if seed % CALLS == 0:
                with limited(RUN_S):
                    found["front"], found["called"], fault = called(seed // CALLS, Path(folder))
                found["faults"] += fault
            if (Path(folder) / "PWNED").exists():
                found["faults"].append(["left", "check", "a program that a scene names was executed"])
                (Path(folder) / "PWNED").unlink()
            file.write(json.dumps(found) + "\n")
            file.flush()


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:4]), Path(sys.argv[4]))
