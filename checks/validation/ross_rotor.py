"""Rotors in ROSS on coefficients and bearings from Raceway, each computed by the interpreters that have ROSS.

``python -m checks.validation.ross_rotor NAME [JSON]`` prints what a function here returns of a JSON list of arguments.

1. Raceway sweeps a B7206C under 1 kN over speed, writes the coefficients, and ROSS reads them.
2. A rigid rotor on two of them: its critical speed against w = sqrt(2 K(w) / M).
3. The stiffness depends on the force, the force on the rotor, the rotor on the stiffness: solved by ``raceway.ross``; its time
   response against that.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import raceway as rw

AXIAL = 1000.0  # N
#: Of the sweep [N]: small, so that the coefficients are those of small motions.
FORCE = 10.0
SPEEDS = "1000:31000:16"  # r/min
#: Of each contact [N s/m].
DAMPING = 100.0
#: The rig: 7.1 g at 90 mm.
UNBALANCE, SPEED_RPM = 6.39e-4, 12000.0
SPAN, SHAFT, DISC_MASS = 0.30, 0.030, 3.0  # m, m, kg
RIGID_MASS = 60.0  # kg: puts the critical speed of the rigid rotor inside the table


def bearing(**changes: Any) -> dict[str, Any]:
    """The scene: one bearing, ring held against tilt, a force that turns with the shaft."""
    parts = {"bearing": {"preset": "B7206C"}, "load": {"axial": AXIAL}, "supports": {"tilt": "locked"}}
    force = {"kind": "bidirectional", "speed_rpm": SPEED_RPM, "amplitude": "constant", "force": FORCE}
    return {"title": "B7206C in a rotor", **parts, "excitation": force, "integrator": {"kind": "periodic"}, **changes}


def swept(generation: int) -> Any:
    """The coefficients over speed, for one generation of ROSS; damped, so that C is more than zeros."""
    scene = bearing(contact={"damping": DAMPING})
    return rw.export_ross(rw.sweep(scene, {"excitation.speed_rpm": SPEEDS}), ross_version=generation)


def grid_at_points() -> float:
    """A table over speed and frequency, which ROSS 3 takes: largest relative difference of kxx at its points."""
    axes = {"kinematics.spin_speed_rpm": "4000:24000:5", "excitation.speed_rpm": "4000:24000:6"}
    found = rw.export_ross(rw.sweep(bearing(), axes), ross_version=3)
    element, table = found.element(), found.coefficients
    assert table.speed is not None and table.frequency is not None
    read = [[element.K(frequency=f, speed=w)[0, 0] for f in table.frequency] for w in table.speed]
    return float(np.max(np.abs(np.array(read) / table.stiffness[..., 0, 0] - 1.0)))


def at_points(element: Any, found: Any) -> dict[str, float]:
    """Largest relative difference of ROSS's coefficients from ours at the points of the table."""
    table = found.coefficients
    assert table.speed is not None
    places = {"x": 0, "y": 1, "z": 2}
    differences = {}
    for ours, theirs in found.names.items():
        matrices = np.array([(element.K if theirs[0] == "k" else element.C)(w) for w in table.speed])
        values, wanted = matrices[:, places[theirs[1]], places[theirs[2]]], table.columns()[ours]
        scale = np.max(np.abs(table.columns()[f"{ours[0]}yy"]))
        differences[ours] = float(np.max(np.abs(values - wanted)) / scale)
    return differences


def rigid_rotor(ross: Any, found: Any) -> tuple[float, float]:
    """Critical speed [rad/s] by ROSS and by the closed form, for a symmetric rotor that does not bend.

    M w^2 = 2 K(w) at the critical speed, K between the points as ROSS takes it.  The shaft is of a material a thousand times
    stiffer than steel: its own bending lowers the speed by some 1e-5.
    """
    stiff = ross.Material(name="stiff", rho=7810.0, E=2.1e14, G_s=8.1e13)
    shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.1, material=stiff) for _ in range(4)]
    mass = RIGID_MASS - sum(float(part.m) for part in shaft)
    # Inertias of a disc that keep the other rigid mode above this one.
    disc = ross.DiskElement(n=2, m=mass, Id=0.02 * mass * 0.1**2, Ip=0.04 * mass * 0.1**2)
    rotor = ross.Rotor(shaft, [disc], [found.element(0), found.element(4)])
    element = found.element()
    closed = brentq(lambda w: RIGID_MASS * w**2 - 2.0 * float(element.K(w)[0, 0]), 100.0, 3200.0, xtol=1e-9)
    total = float(np.asarray(rotor.M(0))[0 :: rotor.number_dof, 0 :: rotor.number_dof].sum())
    assert abs(total / RIGID_MASS - 1.0) < 1e-9, total

    def above(speed: float) -> float:
        """The lateral mode at this speed, which is the one next to the closed form, less the speed."""
        return min(rotor.run_modal(speed, num_modes=12).wn, key=lambda w: abs(w - closed)) - speed

    # ROSS's own run_critical_speed does the same for twelve modes from speed 0 on, and stops at one that has none.
    return float(brentq(above, 0.98 * closed, 1.02 * closed, rtol=1e-8)), float(closed)


def rig_rotor(ross: Any, make: Any) -> Any:
    """Shaft, disc in the middle, two bearings ``make(node)``."""
    steel = ross.Material(name="steel", rho=7810.0, E=2.1e11, G_s=8.1e10)
    shaft = [ross.ShaftElement(L=SPAN / 6, idl=0.0, odl=SHAFT, material=steel) for _ in range(6)]
    return ross.Rotor(shaft, [ross.DiskElement(n=3, m=DISC_MASS, Id=4.1e-3, Ip=8.05e-3)], [make(0), make(6)])


def rolling(ross: Any, axial: float, damping: float = 0.0) -> Any:
    """The rig's rotor on two ``RollingBearing``, with a damper at the disc [N s/m]."""
    from raceway.ross import RollingBearing

    rotor = rig_rotor(ross, lambda node: RollingBearing("B7206C", axial if node == 0 else -axial, n=node))
    if damping == 0.0:
        return rotor
    damper = ross.BearingElement(n=3, kxx=0.0, cxx=damping, tag="damper")
    return ross.Rotor(rotor.shaft_elements, rotor.disk_elements, [*rotor.bearing_elements, damper])


def inside(ross: Any, axial: float) -> float:
    """K [N/m] that ``raceway.ross`` finds at the rotor's own amplitude."""
    from raceway.ross import run_unbalance_response

    found = run_unbalance_response(rolling(ross, axial), 3, UNBALANCE, 0.0, [SPEED_RPM * np.pi / 30.0])
    return float(next(iter(found.stiffness.values()))[0, 0, 0])


def in_time(ross: Any, axial: float = 400.0, steps: int = 128, turns: int = 40) -> dict[str, float]:
    """1x amplitude at the first bearing [m] of the last turn in time, and of the harmonic balance."""
    from raceway.ross import run_time_response, run_unbalance_response

    rotor, w = rolling(ross, axial, 600.0), SPEED_RPM * np.pi / 30.0
    response = run_unbalance_response(rotor, 3, UNBALANCE, 0.0, [w]).response.forced_resp
    linear = rotor.run_unbalance_response(3, UNBALANCE, 0.0, [w]).forced_resp
    t = np.arange(turns * steps + 1) / steps * 2.0 * np.pi / w
    forces, first = np.zeros((len(t), rotor.ndof)), 3 * rotor.number_dof
    forces[:, first], forces[:, first + 1] = UNBALANCE * w**2 * np.cos(w * t), UNBALANCE * w**2 * np.sin(w * t)
    with contextlib.redirect_stdout(io.StringIO()):
        moved = run_time_response(rotor, w, forces, t).yout
    found = 2.0 / steps * np.exp(-1j * w * t[-steps:]) @ moved[-steps:, 0]
    return {
        name: float(abs(value))
        for name, value in (("time", found), ("harmonic", np.asarray(response)[0, 0]), ("linear", np.asarray(linear)[0, 0]))
    }


def table(ross: Any) -> dict[str, Any]:
    """Differences at the points, of our element and of the file read by ROSS alone (3), and the critical speed with its closed form."""
    generation = 3 if int(ross.__version__.partition(".")[0]) >= 3 else 2
    found = swept(generation)
    critical, closed = rigid_rotor(ross, found)
    own = max(at_points(found.element(), found).values())
    if generation < 3:  # its smoothing spline allows 1 N/m or 1 N s/m a point; the exporter says so
        return {"points": [own], "critical": critical / closed - 1.0}
    with tempfile.TemporaryDirectory() as folder:
        alone = ross.BearingElement.load(found.write(Path(folder) / "bearing.toml"))
    return {"points": [own, max(at_points(alone, found).values()), grid_at_points()], "critical": critical / closed - 1.0}


def decrements(ross: Any, ends: list[list[float]]) -> list[float]:
    """Logarithmic decrements of the rig's rotor on bearings of K [N/m] and C [N s/m], backward and forward whirl."""
    rotors = (rig_rotor(ross, lambda node, k=k, c=c: ross.BearingElement(n=node, kxx=k, cxx=c, kzz=1e8)) for k, c in ends)
    return [float(one) for rotor in rotors for one in rotor.run_modal(SPEED_RPM * np.pi / 30.0).log_dec[:2]]


def interpreters() -> list[str]:
    """With ROSS and Raceway: named in RACEWAY_ROSS_PYTHON, this one, or that of the documents beside it."""
    named = os.environ.get("RACEWAY_ROSS_PYTHON", "")
    beside = Path(f"{sys.prefix}-docs") / "bin" / "python"
    own = [sys.executable] if find_spec("ross") else [str(beside)] if beside.exists() else []
    return [os.path.abspath(path) for path in named.split(os.pathsep) if path] or own


def in_ross(name: str, *given: Any) -> list[Any]:
    """What a function here returns, of each interpreter that has ROSS; skips a test where there is none."""
    if not interpreters():
        pytest.skip("no ROSS: make ross installs it, or name an interpreter in RACEWAY_ROSS_PYTHON")
    found, environment = [], {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    for path in interpreters():
        command = [path, "-m", "checks.validation.ross_rotor", name, json.dumps(given)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=1800, check=False)
        assert done.returncode == 0, done.stderr[-2000:]
        found.append(json.loads(done.stdout.strip().splitlines()[-1]))
    return found


if __name__ == "__main__":
    from raceway_rotor.ross_file import ross

    given = json.loads(sys.argv[2]) if len(sys.argv) > 2 else []
    sys.stdout.write("\n" + json.dumps(globals()[sys.argv[1]](ross("this study"), *given)) + "\n")
