"""Compiled kernels for a wheel: ``python -m checks.kernels [FOLDER]`` compiles what common scenes need, for x86-64-v3, into FOLDER.

``make wheel`` puts them into the wheel; ``raceway.core.wheel_kernels`` reads them.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Beside the examples named: what a first week of use meets.
EXAMPLES = ("minimal", "b7206", "b7206_condensed")
_TURNING = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}
_FORCED = {"kind": "unidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}
_BEARING, _LOAD = {"preset": "B7206C"}, {"axial": 500.0}
SCENES: tuple[dict[str, object], ...] = (
    {"bearing": _BEARING},
    {"bearing": {"preset": "6205"}, "load": {"axial": 100.0, "radial": [500.0, 0.0]}},
    {"bearing": {**_BEARING, "arrangement": "DB", "row_distance": 0.016}},
    {"bearing": _BEARING, "excitation": _TURNING, "supports": {"tilt": "free"}},
    {"bearing": _BEARING, "excitation": _FORCED},
    {"bearing": _BEARING, "excitation": _FORCED, "supports": {"tilt": "free"}},
    {"bearing": _BEARING, "excitation": _TURNING, "integrator": {"kind": "newmark", "turns": 2}},
    {"bearing": _BEARING, "excitation": _TURNING, "kinematics": {"ball_inertia": False, "gyroscopic": "none"}},
    {"bearing": _BEARING, "excitation": _TURNING, "contact": {"damping": 100.0}},
)


def compile_all(folder: Path) -> None:
    """Run the scenes in this process, whose kernels are compiled for ``LEVEL``, and write what they compiled."""
    import numpy as np

    import raceway
    from raceway.core import wheel_kernels

    wheel_kernels.writing.append(folder)
    loaded = (raceway.scene_from_dict({"load": _LOAD, **scene}) for scene in SCENES)
    for scene in (*(ROOT / "examples" / f"{name}.toml" for name in EXAMPLES), *loaded):
        raceway.run(scene)
    speeds = np.linspace(6000.0, 12000.0, 3)
    for kind in (_TURNING, _FORCED):
        scene = raceway.scene_from_dict({"bearing": _BEARING, "load": _LOAD, "excitation": kind})
        raceway.sweep(scene, {"excitation.speed_rpm": speeds})
        raceway.function(scene, ["load.axial"], ["K"])(np.linspace(300.0, 900.0, 3)[:, None])
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    print(f"{sum(1 for path in folder.rglob('*') if path.is_file())} kernels, {size / 2**20:.2f} MiB in {folder}")


def main() -> int:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "kernels").resolve()
    if sys.argv[2:]:  # the process below
        compile_all(folder)
        return 0
    with tempfile.TemporaryDirectory() as cache:
        own = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": "", "RACEWAY_CACHE_DIR": cache, "RACEWAY_PLUGINS": ""}
        words = [sys.executable, "-m", "checks.kernels", str(folder), "here"]
        return subprocess.run(words, cwd=ROOT, env={**os.environ, **own}).returncode


if __name__ == "__main__":
    sys.exit(main())
