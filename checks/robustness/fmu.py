"""Exported FMUs: the map against runs, time of a step."""

import tempfile
from pathlib import Path

import numpy as np

import raceway as rw
from checks.robustness import Row, below
from checks.validation.fmu import MAP, RANGES, Instance, exported, step_time

_RUNS = 20
_TURNING = MAP | {"contact": {}, "excitation": MAP["excitation"] | {"force": 400.0}}
#: Samples of a turn of the orbit whose steps are timed.
_SAMPLES = 720


def rows() -> list[Row]:
    with tempfile.TemporaryDirectory() as folder:
        maps = exported(Path(folder) / "map", MAP, ranges=RANGES)
        force = exported(Path(folder) / "force", _TURNING, kind="force")
        return [*_map(maps[2]), *_times(maps[2], force[2])]


def _map(path: Path) -> list[Row]:
    """The rows that take runs; the tests hold the map against the function, and the force against the kernels."""
    instance, rng = Instance(path), np.random.default_rng(7)
    stated = max(instance.value(f"relative_error.{name}") for name in instance.outputs)
    worst = 0.0
    for point in zip(*(rng.uniform(*ends, size=_RUNS) for ends in RANGES.values()), strict=True):
        result = rw.run(rw.evolve(MAP, *(f"{key}={value!r}" for key, value in zip(RANGES, map(float, point), strict=True))))
        worst = max(worst, *np.abs(instance(*point) / np.array([result.K, result.C]) - 1.0))
    return [
        below("map of K, C over axial load, force, speed: stated relative error", stated, 1e-4),
        below(f"{_RUNS} random points: difference from `rw.run` over the stated error", worst / stated, 1.0),
    ]


def _times(maps: Path, force: Path) -> list[Row]:
    rng, angle = np.random.default_rng(1), 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    points, orbit = np.column_stack([rng.uniform(*ends, size=1000) for ends in RANGES.values()]), np.zeros((_SAMPLES, 7))
    orbit[:, 0], orbit[:, 1], orbit[:, 2], orbit[:, 5] = 30e-6, 2e-6 * np.cos(angle), 2e-6 * np.sin(angle), 1256.6
    jumps = orbit[rng.permutation(_SAMPLES)] * rng.uniform(0.5, 1.5, size=(_SAMPLES, 1))
    note = "fmi2SetReal, fmi2DoStep, fmi2GetReal in a loop in C; processor time"
    return [
        below("step of the map, random points [us]", round(1e6 * step_time(maps, points), 2), 2.0, note),
        below(f"step of the force of 12 balls, {_SAMPLES} a turn [us]", round(1e6 * step_time(force, orbit), 2), 2.0, note),
        Row("the same at random displacements [us]", round(1e6 * step_time(force, jumps), 2), "stated", True, note),
    ]
