"""Exported FMUs under fmpy: a call of the instance, the force of a bearing in a rotor's motion, time of a step."""

import ctypes
import subprocess
import tempfile
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

import raceway as rw
from raceway import build_model
from raceway.extend import as_scene

#: A map's scene with load, force and speed for inputs, and ranges over which no ball lifts off.
MAP: dict[str, Any] = {
    "bearing": {"preset": "B7206C"}, "rotor": {"mass": 2.0}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 200.0},
    "contact": {"damping": 300.0},
}  # fmt: skip
RANGES = {"load.axial": (400.0, 2000.0), "excitation.force": (50.0, 300.0), "excitation.speed_rpm": (3000.0, 15000.0)}
_STATIC: dict[str, Any] = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
    "kinematics": {"spin_speed_rpm": 12000.0, "gyroscopic": "none", "ring_growth": False},
}  # fmt: skip
_SPIN = _STATIC["kinematics"]
#: Scenes of the force: weightless balls, centrifugal force, gyroscopic moments by all hypotheses, growth, another law, a pair.
FORCES: dict[str, dict[str, Any]] = {
    "weightless": _STATIC | {"kinematics": _SPIN | {"ball_inertia": False}}, "centrifugal": _STATIC,
    "outer race": _STATIC | {"kinematics": _SPIN | {"gyroscopic": "outer_race"}},
    "shared": _STATIC | {"kinematics": _SPIN | {"gyroscopic": "shared"}},
    "traction": _STATIC | {"kinematics": _SPIN | {"gyroscopic": "traction", "ring_growth": "with_shaft"}},
    "growth": _STATIC | {"kinematics": _SPIN | {"ring_growth": True}},
    "penalty": _STATIC | {"contact": {"kind": "penalty"}},
    "DB": _STATIC | {"bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0, "row_distance": 0.016}},
}  # fmt: skip


class Instance:
    """An FMU under fmpy; ``messages`` : what it has logged.

    path : of the FMU;  exchange : for model exchange instead of co-simulation
    """

    def __init__(self, path: Path, exchange: bool = False) -> None:
        description = read_model_description(path)
        self.description, self.messages = description, list[str]()
        about = {"guid": description.guid, "unzipDirectory": extract(path), "instanceName": "bearing"}
        about["modelIdentifier"] = description.coSimulation.modelIdentifier
        second = description.fmiVersion == "2.0"
        kind = (FMU2Model if exchange else FMU2Slave) if second else (FMU3Model if exchange else FMU3Slave)
        self.fmu = kind(**about)
        if second:
            from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda _e, _n, _s, _c, text, *_: self.messages.append(text.decode()))
            self._callbacks = callbacks
            self.fmu.instantiate(callbacks=callbacks)
            self.fmu.setupExperiment()
        else:
            self.fmu.instantiate(logMessage=lambda _e, _s, _c, message: self.messages.append(message.decode()))
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.get, self.set = (self.fmu.getReal, self.fmu.setReal) if second else (self.fmu.getFloat64, self.fmu.setFloat64)
        variables = description.modelVariables
        self.references = {variable.name: variable.valueReference for variable in variables}
        self.inputs = [variable.name for variable in variables if variable.causality == "input"]
        self.outputs = [v.name for v in variables if v.causality == "output" and v.name != "in_range"]
        self._in, self._out = ([self.references[name] for name in names] for names in (self.inputs, self.outputs))

    def __call__(self, *values: float) -> np.ndarray:
        """Outputs at values of all inputs."""
        self.set(self._in, list(values))
        return np.array(self.get(self._out))

    def value(self, name: str) -> float:
        """Of one real variable."""
        return float(self.get([self.references[name]])[0])

    @property
    def in_range(self) -> bool:
        return bool(self.fmu.getBoolean([self.references["in_range"]])[0])


def exported(folder: Path, scene: object, **options: Any) -> dict[int, Path]:
    """FMI version -> file."""
    paths = rw.export_fmu(scene, **options).save(folder)
    return {version: next(path for path in paths if path.name.endswith(f"_fmi{version}.fmu")) for version in (2, 3)}


def map_difference(instance: Instance, count: int = 1000, ranges: dict[str, tuple[float, float]] = RANGES) -> float:
    """Largest difference of random points from ``raceway.function`` over the error that the FMU states."""
    rng = np.random.default_rng(3)
    columns = [rng.uniform(*ends, size=count) for ends in ranges.values()]
    answer = rw.function(MAP, ranges, ["K", "C"])(*columns)
    values = np.array([instance(*point) for point in zip(*columns, strict=True)])
    shares = []
    for k, name in enumerate(instance.outputs):
        relative = np.abs(values[:, k] / answer[name] - 1.0)
        shares.append(relative.max() / instance.value(f"relative_error.{name}"))
    return float(max(shares))


def force_difference(instance: Instance, scene: dict[str, Any], count: int = 60) -> dict[str, float]:
    """Largest differences from the rings' kernels at random displacements, relative to the largest of their kind."""
    rng, balls = np.random.default_rng(5), sum(name.startswith("ball_load_inner") for name in instance.outputs)
    worst = dict.fromkeys(("force", "load", "stiffness"), 0.0)
    for rpm in (500.0, 6000.0, 18000.0):
        ring = build_model(as_scene(scene | {"kinematics": scene["kinematics"] | {"spin_speed_rpm": rpm}})).system
        lengths = np.array([1.0, 1.0, 1.0, 1.0 / ring.arm, 1.0 / ring.arm])
        areas = np.outer(lengths, lengths)
        for _ in range(count):
            x = rng.uniform(0.0, 60e-6) if balls == 12 else rng.normal() * 1e-5
            q = np.array([x, *rng.normal(size=2) * 8e-6, *rng.normal(size=2) * 3e-4])
            out, core = instance(*q, rpm * np.pi / 30.0, 0.0), ring.evaluate(q)
            parts = {
                "force": (-out[:5] * lengths, core.force * lengths), "load": (out[7 : 7 + 2 * balls], core.contact_force),
                "stiffness": (out[7 + 2 * balls :].reshape(5, 5) * areas, core.stiffness * areas),
            }  # fmt: skip
            size = core.contact_force.max()
            for kind, (ours, theirs) in parts.items():
                scale = size if kind != "stiffness" else np.abs(theirs).max()
                worst[kind] = max(worst[kind], float(np.abs(ours - theirs).max() / scale))
    return worst


def jeffcott(instance: Instance, scene: dict[str, Any], turns: int = 1, steps: int = 1440) -> float:
    """Largest distance of a rotor's motion on the FMU's force from the orbit of ``raceway.run``, over its amplitude.  The
    classical method of Runge and Kutta from a point of the orbit and its velocity; tilts are locked."""
    result = rw.run(scene)
    orbit = result.to_xarray()
    motion, mass, speed = orbit["motion"].values, result.identification.mass_used, result.speed_rpm * np.pi / 30.0
    amplitude, load = result.identification.force_amplitude, result.model.system.load[:3]
    first, n = float(orbit["time"].values[-1]), len(motion)
    waves = np.fft.rfft(motion, axis=0)
    velocity = np.fft.irfft(1j * speed * np.arange(len(waves))[:, np.newaxis] * waves, n, axis=0)

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        turning = amplitude * np.array([0.0, np.cos(speed * t), np.sin(speed * t)])
        force = instance(*state[:3], 0.0, 0.0, speed, 0.0)[:3]
        return np.concatenate([state[3:], (load + turning + force) / mass])

    state, dt, worst = np.concatenate([motion[-1, :3], velocity[-1, :3]]), 2.0 * np.pi / speed / steps, 0.0
    for k in range(turns * steps):
        t = first + k * dt
        a = rates(t, state)
        b = rates(t + 0.5 * dt, state + 0.5 * dt * a)
        c = rates(t + 0.5 * dt, state + 0.5 * dt * b)
        state = state + dt / 6.0 * (a + 2.0 * b + 2.0 * c + rates(t + dt, state + dt * c))
        if (k + 1) % (steps // n) == 0:
            expected = motion[((k + 1) // (steps // n) - 1) % n, :3]
            worst = max(worst, float(np.linalg.norm(state[:3] - expected)))
    return worst / float(np.abs(motion[:, 1]).max())


_LOOP = """#include "fmi2.c"
double loop(int count, int rows, const double *inputs, double *last)
{
    Component *c = create("bearing", TOKEN, NULL, NULL);
    unsigned in[INPUTS], out[OUTPUTS];
    double value[OUTPUTS], total = 0.0;
    for (int k = 0; k < INPUTS; k++) in[k] = k;
    for (int k = 0; k < OUTPUTS; k++) out[k] = FIRST_OUTPUT + k;
    for (int k = 0; k < count; k++) {
        NAME(SetReal)(c, in, INPUTS, inputs + (k % rows) * INPUTS);
        NAME(DoStep)(c, 1e-6 * k, 1e-6, 0);
        NAME(GetReal)(c, out, OUTPUTS < 5 ? OUTPUTS : 5, value);
        total += value[0];
    }
    *last = c->time;
    destroy(c);
    return total;
}
"""


def step_time(fmu: Path, inputs: np.ndarray, count: int = 20_000) -> float:
    """Least time [s] of setting all inputs, fmi2DoStep and getting five outputs, in a loop in C over rows of inputs (n, k)."""
    with tempfile.TemporaryDirectory() as folder:
        zipfile.ZipFile(fmu).extractall(folder)
        source = Path(folder) / "sources" / "loop.c"
        source.write_text(_LOOP)
        command = ["cc", "-std=c99", "-O3", "-fPIC", "-shared", source.name, "-o", "loop.so", "-lm"]
        subprocess.run(command, cwd=source.parent, check=True)
        loop = ctypes.CDLL(str(source.parent / "loop.so")).loop
        loop.restype = ctypes.c_double
        rows, last, least = np.ascontiguousarray(inputs), ctypes.c_double(), np.inf
        pointer = rows.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        for _ in range(20):
            start = time.process_time()
            loop(count, len(rows), pointer, ctypes.byref(last))
            least = min(least, (time.process_time() - start) / count)
    return least
