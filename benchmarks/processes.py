"""What whole processes cost: start, caches, imports."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

#: What the light commands must not load.
HEAVY = ("numba", "scipy", "meshio", "gmsh", "pyvista", "matplotlib")
_COUNT = """
import json, sys
from raceway import load_scene
from raceway.pipeline.run import run
from raceway.core.jit import clock
compile_s = run(load_scene(sys.argv[1])).cost["compile_s"]
print(json.dumps({**clock, "compile_s": compile_s}))
"""
_MODULES = """
import json, runpy, sys
sys.argv = ["raceway", *sys.argv[1:]]
try:
    runpy.run_module("raceway", run_name="__main__")
except SystemExit as end:
    code = end.code or 0
print("\\nloaded:" + json.dumps([code, sorted({name.split(".")[0] for name in sys.modules})]))
"""


def _python(*words: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, check=True, env={**os.environ, **environment}
    )
    return done.stdout


def whole_runs(scene: Path, repeats: int = 5) -> dict[str, float]:
    """Wall time [s] of ``raceway run SCENE`` as a process, after one that fills the caches."""
    with tempfile.TemporaryDirectory() as folder:
        command = ("-m", "raceway", "run", str(scene), "--out", folder)
        _python(*command)
        times = [_timed(*command) for _ in range(repeats)]
    return {"minimum_s": min(times), "median_s": statistics.median(times), "repeats": repeats}


def _timed(*words: str) -> float:
    begin = time.perf_counter()
    _python(*words)
    return time.perf_counter() - begin


def second_process(scene: Path) -> dict[str, Any]:
    """What a first process with an empty kernel cache and a second one compile, read and write."""
    with tempfile.TemporaryDirectory() as folder:
        found = []
        for _ in range(2):
            clock = json.loads(_python("-c", _COUNT, str(scene), RACEWAY_CACHE_DIR=folder))
            files = {str(p): p.stat().st_mtime_ns for p in Path(folder).rglob("*") if p.is_file()}
            found.append((clock, files))
    (first, before), (second, after) = found
    return {
        "first_compiled": int(first["compiled"]),
        "first_compile_s": first["compile_s"],
        "compiled": int(second["compiled"]),
        "loaded": int(second["loaded"]),
        "load_s": second["load_s"],
        "files": len(before),
        "new_files": len(set(after) - set(before)),
        "rewritten_files": sum(after[name] != before[name] for name in before if name in after),
    }


def light_commands(scene: Path, repeats: int = 3) -> dict[str, dict[str, Any]]:
    """Wall time [s] of commands that compute nothing, and which heavy packages they load."""
    commands = {"--help": ("--help",), "plugins": ("plugins",), "check": ("check", str(scene))}
    found: dict[str, dict[str, Any]] = {}
    for name, words in commands.items():
        code, modules = json.loads(_python("-c", _MODULES, *words).rpartition("loaded:")[2])
        if code:
            raise RuntimeError(f"raceway {name} ended with code {code}")
        times = [_timed("-m", "raceway", *words) for _ in range(repeats)]
        found[name] = {"minimum_s": min(times), "heavy": [package for package in HEAVY if package in modules]}
    return found
