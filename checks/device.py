"""Explicit steps on a CUDA device: ``python -m checks.device [--turn] [--out FILE]`` checks, times, and writes a table.

Without a device the kernels run as Python against the processor's, some minutes, and the rows of the device say "not measured".
With one the same tests run on it; then the article's mesh of a million elements, with penalty contact and friction 0.03: its step, two
runs, and with ``--turn`` a whole turn at 15 000 r/min with ``integrator.least_step`` = 3 ns and its K against implicit steps.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
#: Rows of the table: what is measured, and what is asked of it.
ROWS = {
    "kernels against the processor, a ball between two sectors, 20 steps": "1e-12 of their size",
    "step of 1.06 M elements with contact and friction": "200 us", "a turn at the natural step": "900 s",
    "a turn at 3 ns": "300 s", "two runs": "equal bits", "energy drift over a turn at 3 ns": "1e-3",
    "K against implicit steps": "0.5 %", "memory of the device": "4 GB",
}  # fmt: skip
#: Steps that are timed after those that compile, of the length [s] that changes the state a little.
_TIMED, _WARM, _STEP = 2000, 20, 1e-10
_TURN_S, _NATURAL = 4e-3, 0.971e-9
_EXCITED = ("excitation.kind=bidirectional", "excitation.speed_rpm=15000", "excitation.unbalance=3e-5", "rotor.mass=0.5")


def tests(simulated: bool) -> bool:
    """Whether the tests of the kernels pass, on the device or as Python."""
    words = [sys.executable, "-m", "pytest", "-q", "-m", "not release", "tests/core/stepping/test_device.py"]
    return subprocess.run(words, cwd=ROOT, env={**os.environ, "NUMBA_ENABLE_CUDASIM": str(int(simulated))}).returncode == 0


def steps(count: int) -> tuple[float, Any, float]:
    """Time of a step [s], the last motion, and bytes of the device, of steps of the pressed bearing on the article's mesh."""
    from checks.explicit_step import ARTICLE, bearing, pressed
    from raceway import load_scene
    from raceway.core.fem.elastic import device
    from raceway.extend import Recorder, Schedule

    built, before, least = bearing(load_scene(ARTICLE)), device.free_bytes(), []
    system, together = built.system, device.together

    def watched(*arguments: Any) -> Any:
        """The kernel, all of whose arrays are there."""
        least.append(device.free_bytes())
        return together(*arguments)

    device.together = watched
    recorder = Recorder(system, pressed(built), Schedule(_STEP, 3 * count, 1, 6 * count), None)
    ahead, seconds = system.explicit(_STEP, "gpu"), []
    assert ahead is not None
    # The first steps compile; the last take as many steps more as are timed, and the same copies.
    for number in (_WARM, count, 2 * count - _WARM):
        start = perf_counter()
        recorder.accept_steps(number, *ahead.take(recorder, number))
        seconds.append(perf_counter() - start)
    device.together = together
    return (seconds[2] - seconds[1]) / (count - _WARM), system.motion(recorder.state), before - min(least)


def scene(*changes: str) -> Any:
    """The article's scene with friction and excitation."""
    from raceway import load_scene

    tables: dict[str, dict[str, Any]] = {}
    for change in (*_EXCITED, *("bodies.formulation=one_point", "contact.friction=0.03"), *changes):
        key, value = change.split("=")
        table, name = key.split(".")
        tables.setdefault(table, {})[name] = json.loads(value) if value[0].isdigit() else value
    return load_scene(ROOT / "examples/b7206_article_mesh.toml").with_(**tables)


def turn() -> dict[str, str]:
    """A turn at 3 ns on the device, and K against 80 implicit steps a turn."""
    from raceway import run

    start = perf_counter()
    steps = ("integrator.kind=central_difference", "integrator.turns=1", "integrator.least_step=3e-9")
    explicit = run(scene(*steps, "integrator.device=gpu"))
    seconds = perf_counter() - start
    implicit = run(scene("integrator.kind=newmark", "integrator.turns=2", "integrator.steps_per_turn=80"))
    k, wanted = explicit.equivalent_stiffness, implicit.equivalent_stiffness
    return {
        "a turn at 3 ns": f"{seconds:.0f} s",
        "energy drift over a turn at 3 ns": f"{explicit.to_dict()['stability']['energy_drift']:.1e}",
        "K against implicit steps": f"{100.0 * abs(k / wanted - 1.0):.2g} %",
    }


def measure(whole: bool) -> dict[str, str]:
    """Rows of the table that a device fills."""
    (step, first, size), (_, second, _) = steps(_TIMED), steps(_TIMED)
    same = all((values == second.full_state[name]).all() for name, values in first.full_state.items())
    return {
        "step of 1.06 M elements with contact and friction": f"{1e6 * step:.0f} us",
        "a turn at the natural step": f"{step * _TURN_S / _NATURAL:.0f} s by its step",
        "two runs": "equal bits" if same else "different",
        "memory of the device": f"{size / 1e9:.2g} GB",
        **(turn() if whole else {}),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition(":")[0])
    parser.add_argument("--turn", action="store_true", help="a whole turn too, some minutes")
    parser.add_argument("--out", type=Path, default=ROOT / "raceway-out" / "device.json")
    arguments = parser.parse_args()
    os.environ["NUMBA_ENABLE_CUDASIM"] = "0"
    from raceway.core.fem.elastic import device

    reason = device.absent()
    passed = tests(simulated=bool(reason))
    found = {"device": reason or device.title(), next(iter(ROWS)): "within it" if passed else "beyond it"}
    found |= {} if reason else measure(arguments.turn)
    table = {"device": found.pop("device")} | {name: found.get(name, "not measured") for name in ROWS}
    for name, value in table.items():
        print(f"{name:70} {value:20} {'asked: ' + ROWS[name] if name in ROWS else ''}")
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(json.dumps(table, indent=1) + "\n")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
