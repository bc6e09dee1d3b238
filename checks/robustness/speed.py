"""Processor time of what is done most, against the times that were asked for: least of repeats, kernels compiled unless a row says so."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import raceway as rw
from checks import explicit_step
from checks.kernel import least
from checks.robustness import Row, below
from checks.robustness.points import PAIR, STATIC, seconds, turning
from raceway.extend import resolve
from raceway.planning.parts import timed
from raceway.plugins.bodies.elastic import elastic_cost

_LOADS = {"load.axial": (300.0, 2000.0), "load.radial[0]": (0.0, 200.0), "kinematics.spin_speed_rpm": (1000.0, 24_000.0)}
_MOTIONS = {"load.axial": (600.0, 2000.0), "excitation.speed_rpm": (3000.0, 15_000.0)}
_LOAD = {"load": {"axial": 1000.0}}
_MOMENTS = STATIC | {"kinematics": {"spin_speed_rpm": 12000.0, "gyroscopic": "traction"}}
_ELASTIC = Path(__file__).parents[1] / "b7206_elastic_60k.toml"
_SCENE = Path(__file__).parents[2] / "examples" / "minimal.toml"


def _least(call: Callable[[], object], repeats: int = 7) -> float:
    """Least processor time of a call [ms], of all threads."""
    return 1e3 * least(call, repeats, time.process_time)


def _of_child(*command: str, **environment: str) -> tuple[float, float]:
    """Wall time and processor time [s] of a command."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    compiled = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=compiled | environment)
    wall, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _newmark_step() -> float:
    """Processor time of a step of 12 balls with inertia [us]: what more turns cost, start and identification apart."""
    scene = turning("bidirectional") | _LOAD | {"integrator": {"kind": "newmark", "turns": 10}}
    few, many = (_least(lambda n=n: rw.run(rw.evolve(scene, f"integrator.turns={n}")), 3) for n in (10, 60))
    return 1e3 * (many - few) / (50 * 360)


def _gradients(scene: dict[str, Any]) -> float:
    """Processor time of all derivatives over that of the run, both without building the scene."""
    rw.sensitivities(scene)
    complete = _least(lambda: rw.run(scene), 3)
    return 1e3 * min(rw.sensitivities(scene).gradients_s for _ in range(3)) / complete


def _explicit_steps() -> list[tuple[str, float, float]]:
    """An explicit step of 63 120 one-point elements with contact at points and friction 0.03, one thread."""
    scene = rw.evolve(
        rw.load_scene(_ELASTIC), "bodies.formulation=one_point", "integrator.kind=central_difference",
        "excitation.kind=bidirectional", "excitation.speed_rpm=12000", "excitation.unbalance=1e-4",
    )  # fmt: skip
    built, cost = explicit_step.bearing(scene), elastic_cost(resolve(scene))
    assert cost is not None
    step, force, planned = explicit_step.steps(built, 1)[0], explicit_step.forces_s(built), cost.step_s * timed()
    return [
        ("an explicit step of elastic bodies [ns an element]", 1e9 * step / built.cells, 65.0),
        ("it over the forces of its elements alone", step / force, 1.5),
        ("it beside the plan's, the larger over the smaller", max(step / planned, planned / step), 1.3),
    ]


def rows() -> list[Row]:
    f, hundred = rw.function(STATIC, ["load.axial"], ["kyy"], threads=1), np.linspace(300.0, 2000.0, 100)
    static, orbit, one_way = (scene | _LOAD for scene in (STATIC, turning("bidirectional"), turning("unidirectional")))
    run = [sys.executable, "-m", "raceway", "run", str(_SCENE), "--out"]
    with tempfile.TemporaryDirectory() as folder:
        first, _ = _of_child(*run, f"{folder}/out", RACEWAY_CACHE_DIR=f"{folder}/cache")
        warm = min(_of_child(*run, f"{folder}/out", RACEWAY_CACHE_DIR=f"{folder}/cache")[1] for _ in range(5))
        measured: list[tuple[str, float, float]] = [
            ("1e6 equilibria with 5 x 5 [CPU-s]", seconds(STATIC, ["displacement", "stiffness"], _LOADS, 10**6), 4.0),
            ("memory of it [GB]", 1e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, 0.6),
            ("an equilibrium with gyroscopic moments [us]", 5.0 * seconds(_MOMENTS, ["stiffness"], _LOADS, 2 * 10**5), 8.0),
            ("one of a DB pair over load and speed [us]", 10.0 * seconds(STATIC | {"bearing": PAIR}, ["stiffness"], _LOADS, 10**5), 8.0),
            ("1e5 steady orbits, rotating force [CPU-s]", seconds(orbit, ["K", "C"], _MOTIONS, 10**5), 2.5),
            ("one with dashpots [us]", 50.0 * seconds(turning("bidirectional", 1e-3), ["K", "C"], _MOTIONS, 2 * 10**4), 60.0),
            ("one under a one-directional force, tilt free [us]", 100.0 * seconds(one_way, ["K"], _MOTIONS, 10**4), 60.0),
            ("a Newmark step of 12 balls with inertia [us]", _newmark_step(), 8.0),
            ("rw.function of one point [ms]", _least(lambda: f(1000.0)), 0.3),
            ("rw.function of 100 points [ms]", _least(lambda: f(hundred)), 1.0),
            ("rw.run, static [ms]", _least(lambda: rw.run(static)), 2.0),
            ("rw.run, steady orbit [ms]", _least(lambda: rw.run(orbit)), 5.0),
            ("all derivatives over the run, static", _gradients(static), 1.0),
            ("all derivatives over the run, rotating force", _gradients(orbit), 1.0),
            ("all derivatives over the run, one direction", _gradients(one_way), 1.0),
            ("first raceway run examples/minimal.toml, empty cache [s wall]", first, 7.0),
            ("a warm one [CPU-s]", warm, 0.6),
            *_explicit_steps(),
        ]  # fmt: skip
    return [below(quantity, float(f"{value:.3g}"), target) for quantity, value, target in measured]
