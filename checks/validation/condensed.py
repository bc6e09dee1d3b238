"""Condensed bodies: the scene of the reports ``condensed``, ``nodal`` and ``elastic``, its quantities, and the cost of a first use."""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from raceway import build_model, make_plan, scene_from_dict
from raceway.extend import Equilibrium
from raceway.storage import array_cache
from raceway.testing import solve_equilibrium

#: Units of displacements and of stiffness in ``quantities``.
_DISPLACEMENT = {"x": (0, 1e6), "y": (1, 1e6), "tilt_z": (4, 1e3)}
_STIFFNESS = {"kxx": (0, 1e-6), "kyy": (1, 1e-6), "kzz": (2, 1e-6), "k tilt_y": (3, 1e-3), "k tilt_z": (4, 1e-3)}


def tables(tilt: str = "locked", points: int | None = None, **more: Any) -> dict[str, Any]:
    """B7206C under 1000 N axial and 500 N towards ball 0, with contacts at so many points along a semi-axis, or resultants."""
    nodal: dict[str, Any] = {}
    if points is not None:
        nodal["contact"] = {"kind": "unilateral", "discretisation": "nodal"}
        nodal["mesh"] = {"kind": "structured", "nodes_per_semi_axis": points}
    return {
        "title": "condensed", "bearing": {"preset": "B7206C"}, "bodies": {"kind": "condensed"},
        "supports": {"tilt": tilt, **more.pop("supports", {})}, "load": {"axial": 1000.0, "radial": [500.0, 0.0]},
        "kinematics": {"ball_inertia": False}, **nodal, **more,
    }  # fmt: skip


def quantities(equilibrium: Equilibrium) -> dict[str, float]:
    """Displacements [um, mrad] and diagonal stiffness [N/um, N m/mrad]."""
    q, k = equilibrium.displacement, np.diag(equilibrium.stiffness)
    of = {name: float(scale * q[place]) for name, (place, scale) in _DISPLACEMENT.items()}
    return of | {name: float(scale * k[place]) for name, (place, scale) in _STIFFNESS.items()}


def largest(found: dict[str, float], wanted: dict[str, float]) -> float:
    """Largest relative difference of the quantities that are wanted; those that vanish are left out."""
    return max(abs(found[name] / value - 1.0) for name, value in wanted.items() if abs(value) > 1e-9)


def cost(points: int | None) -> dict[str, float]:
    """CPU seconds of a first and a second build and of an equilibrium, and MiB beyond a smaller bearing's, in a process of its own."""
    word = "None" if points is None else str(points)
    done = subprocess.run(
        [sys.executable, "-m", __name__, word], cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, check=True
    )
    content: dict[str, float] = json.loads(done.stdout)
    return content


def _peak() -> float:
    """Largest memory of this program alone [MiB]; ru_maxrss hands on what its parent took."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024.0


def _once(given: dict[str, Any]) -> tuple[float, float]:
    scene = scene_from_dict(given)
    plan = make_plan(scene)
    begin = time.process_time()
    model = build_model(scene, plan)
    middle = time.process_time()
    solve_equilibrium(model)
    return middle - begin, time.process_time() - middle


def main(word: str) -> None:
    points = None if word == "None" else int(word)
    with tempfile.TemporaryDirectory() as folder:
        array_cache.folder = lambda: Path(folder)
        _once(tables(bodies={"kind": "rigid"}) if points is None else tables("free", 2))
        before, given = _peak(), tables("free", points)
        first, _ = _once(given)
        again, solve = _once(given)
    sys.stdout.write(json.dumps({"first": first, "again": again, "solve": solve, "memory": _peak() - before}))


if __name__ == "__main__":
    main(sys.argv[1])
