"""Sudden and ramped starts: the error that a result states against its true error.

The true value is Z of the steady motion by ``integrator.kind = "periodic"``, and every tenth of those is computed again by Fourier
collocation in time, which shares neither equations nor search with it.  Where several motions exist it may find another one of
those that the result lists.  Starts without a steady motion are drawn anew: nothing is true of them.
"""

from typing import Any

import attrs
import numpy as np

from checks.validation.error_estimate import SMALL
from checks.validation.scenes import rotating
from raceway import ConvergenceError, RacewayError, scene_from_dict
from raceway.extend import steady_orbit, stiffness
from raceway.testing import model_of, run, solve_equilibrium

_SEED = 1
#: Largest difference of both ways to a steady motion, over the true error.
_CONFIRMED = 1e-3


@attrs.frozen
class Start:
    """A sudden or ramped start: its scene, and its speed over the natural frequency along the force."""

    tables: dict[str, Any]
    ratio: float


@attrs.frozen
class Judged:
    """A start, the stated and the true error of its Z and of its K; whether Fourier collocation confirms the steady motion, if asked."""

    start: Start
    estimate: float
    true: float
    estimate_of_k: float
    true_of_k: float
    confirmed: bool | None


def draw(rng: np.random.Generator) -> Start:
    """Speeds at 0.1 to 1.1 of the natural frequency along the force, half of them within a tenth of it; half undamped."""
    axial, rpm = float(10.0 ** rng.uniform(np.log10(150.0), np.log10(2000.0))), float(rng.uniform(6000.0, 15000.0))
    tables = rotating(axial, ("locked", "free")[rng.integers(2)], rpm, bool(rng.integers(2)), "newmark")
    kind, force = ("bidirectional", "unidirectional")[rng.integers(2)], float(axial * 10.0 ** rng.uniform(-2.0, -0.3))
    tables["excitation"] = {"kind": kind, "speed_rpm": rpm, "amplitude": "constant", "force": force}
    start, turns = ("static", "ramp")[rng.integers(2)], int((3, 4, 6, 12, 24)[rng.integers(5)])
    tables["integrator"] = {"kind": "newmark", "start": start, "turns": turns, "steps_per_turn": 180}
    ratio = float(rng.uniform(0.9, 1.1) if rng.integers(2) else rng.uniform(0.1, 0.9))
    model = model_of(tables)
    free = np.flatnonzero(model.system.free > 0.0)
    tangent = model.system.reduced(solve_equilibrium(model).stiffness + model.system.stiffness)
    along = 1.0 / np.linalg.inv(tangent)[list(free).index(1), list(free).index(1)]
    mass = max(float(ratio**2 * along / (rpm * np.pi / 30.0) ** 2), 0.05)
    damping = float(10.0 ** rng.uniform(-3.0, -1.0)) if rng.integers(2) else 0.0
    tables["rotor"] = {"mass": mass, "damping": 2.0 * damping * float(np.sqrt(along * mass))}
    return Start(tables, ratio)


def _fourier_value(tables: dict[str, Any]) -> complex | None:
    """Z of the steady orbit by Fourier collocation; None where that finds none."""
    model = model_of(tables)
    try:
        orbit = steady_orbit(model.system, model.excitation.period_s, solve_equilibrium(model).displacement, 65)
    except ConvergenceError:
        return None
    return stiffness(*(np.fft.fft(part, axis=0)[1] for part in (orbit.force, orbit.displacement)))


def judged_starts(count: int) -> list[Judged]:
    """The same starts each time."""
    rng = np.random.default_rng(_SEED)
    judged: list[Judged] = []
    while len(judged) < count:
        one = draw(rng)
        try:
            steady = run(scene_from_dict({**one.tables, "integrator": {"kind": "periodic"}}))
        except RacewayError:
            continue
        result, confirmed = run(scene_from_dict(one.tables)), None
        found, wanted = result.identification, steady.identification
        size = abs(wanted.dynamic_stiffness)
        true = abs(found.dynamic_stiffness - wanted.dynamic_stiffness) / size
        if len(judged) % 10 == 9:
            other = _fourier_value(one.tables)
            if other is not None:
                listed = [orbit["dynamic_stiffness"] for orbit in steady.to_dict()["motion"]["orbits"]]
                close = (_CONFIRMED * min(true, 1.0) + SMALL) * size
                confirmed = any(abs(other - complex(one["real"], one["imag"])) < close for one in listed)
        estimate, of_k = result.error["total"], result.to_dict()["identification"]["equivalent_stiffness_error"]
        estimate, of_k = (np.nan if value is None else value for value in (estimate, of_k))
        true_of_k = abs(found.equivalent_stiffness - wanted.equivalent_stiffness)
        judged.append(Judged(one, estimate, true, of_k, true_of_k, confirmed))
    return judged
