"""Exported FMUs: the map against runs, the force against the rings' kernels, a rotor's orbit, time of a step."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import raceway as rw
from checks.robustness import Row, below
from checks.validation.fmu import (
    FORCES,
    MAP,
    RANGES,
    Instance,
    exported,
    force_difference,
    jeffcott,
    map_difference,
    step_time,
)

TITLE = "FMUs for simulators: map, force, rotor's orbit, time of a step"
COMMAND = "python -m checks fmu"
TEST = "python -m pytest packages/raceway-fmu/tests/test_fmu.py"
_RUNS = 20
_TURNING = MAP | {"contact": {}, "excitation": MAP["excitation"] | {"force": 400.0}}
#: Samples of a turn of the orbit whose steps are timed.
_SAMPLES = 720


def rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        maps = exported(Path(folder) / "map", MAP, ranges=RANGES)
        force = exported(Path(folder) / "force", _TURNING, kind="force")
        return [*_map(maps), *_force(Path(folder)), *_rotor(force), *_times(maps[2], force[2]), *_flags(maps, force)]


def _map(paths: dict[int, Path]) -> list[Row]:
    instance, rng = Instance(paths[2]), np.random.default_rng(7)
    stated = max(instance.value(f"relative_error.{name}") for name in instance.outputs)
    worst = 0.0
    for point in zip(*(rng.uniform(*ends, size=_RUNS) for ends in RANGES.values()), strict=True):
        result = rw.run(rw.evolve(MAP, *(f"{key}={value!r}" for key, value in zip(RANGES, map(float, point), strict=True))))
        worst = max(worst, *np.abs(instance(*point) / np.array([result.K, result.C]) - 1.0))
    return [
        below("map of K, C over axial load, force, speed: stated relative error", stated, 1e-4, COMMAND),
        below(
            "1000 random points (Fa, F, n), FMI 2.0: difference from the function over the stated error",
            map_difference(instance),
            1.0,
            COMMAND,
        ),
        below("the same, FMI 3.0", map_difference(Instance(paths[3])), 1.0, COMMAND),
        below(f"{_RUNS} random points: difference from `rw.run` over the stated error", worst / stated, 1.0, COMMAND),
    ]


def _force(folder: Path) -> list[Row]:
    found = []
    for name, scene in FORCES.items():
        paths = exported(folder / name.replace(" ", "_"), scene, kind="force")
        differences = [force_difference(Instance(path), scene) for path in paths.values()]
        worst = max(max(each["force"], each["load"]) for each in differences)
        found.append(
            below(
                f"force and ball loads, {name}: 180 random displacements, relative to the largest load", worst, 1e-9, COMMAND
            )
        )
    return found


def _rotor(paths: dict[int, Path]) -> list[Row]:
    words = "Jeffcott rotor on the FMU's force, two turns: distance from the orbit of `rw.run` over its amplitude"
    return [
        below(f"{words}, FMI {v}.0", jeffcott(Instance(path), _TURNING, turns=2), 1e-4, COMMAND) for v, path in paths.items()
    ]


def _times(maps: Path, force: Path) -> list[Row]:
    rng, angle = np.random.default_rng(1), 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    points, orbit = np.column_stack([rng.uniform(*ends, size=1000) for ends in RANGES.values()]), np.zeros((_SAMPLES, 7))
    orbit[:, 0], orbit[:, 1], orbit[:, 2], orbit[:, 5] = 30e-6, 2e-6 * np.cos(angle), 2e-6 * np.sin(angle), 1256.6
    jumps = orbit[rng.permutation(_SAMPLES)] * rng.uniform(0.5, 1.5, size=(_SAMPLES, 1))
    note = "fmi2SetReal, fmi2DoStep, fmi2GetReal in a loop in C; processor time"
    return [
        below("step of the map, random points [us]", round(1e6 * step_time(maps, points), 2), 2.0, COMMAND, note),
        below(
            f"step of the force of 12 balls, {_SAMPLES} a turn [us]",
            round(1e6 * step_time(force, orbit), 2),
            2.0,
            COMMAND,
            note,
        ),
        Row("the same at random displacements [us]", round(1e6 * step_time(force, jumps), 2), "stated", True, COMMAND, note),
    ]


def _flags(maps: dict[int, Path], force: dict[int, Path]) -> list[Row]:
    flagged, discarded = 0, 0
    for path, good, far in (
        *((path, (700.0, 100.0, 9000.0), (100.0, 100.0, 9000.0)) for path in maps.values()),
        *((path, (3e-5, *[0.0] * 6), (3e-5, *[0.0] * 4, 1e5, 0.0)) for path in force.values()),
    ):
        instance = Instance(path)
        instance(*good)
        inside = instance.in_range
        instance(*far)
        flagged += inside and not instance.in_range and len(instance.messages) == 1
        try:
            instance(np.nan, *good[1:])
        except Exception as why:
            discarded += "discard" in str(why).lower() and bool(np.isfinite(instance.get(instance._out)).all())
    return [
        Row("inputs out of range that are flagged, of 4 FMUs", flagged, "4", flagged == 4, COMMAND),
        Row("NaN that is discarded, outputs stay numbers, of 4 FMUs", discarded, "4", discarded == 4, COMMAND),
    ]
