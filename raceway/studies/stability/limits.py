"""Steps around the stable limit: of a linear oscillator, of a bearing about its equilibrium, on whole orbits."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.ring.kernels.impact import impact_system
from raceway.core.ring.orbit import at_time, steady_orbit
from raceway.core.ring.start import from_orbit
from raceway.core.ring.surrogate import surrogate
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Schedule
from raceway.errors import ConvergenceError
from raceway.framework.registry import Registry
from raceway.pipeline.settle import settle
from raceway.planning.recording import SAFETY
from raceway.storage.tables import Tables
from raceway.studies.stability.case import Rows
from raceway.studies.stability.systems import UNDAMPED, mass_at, method_of, model_at, still

if TYPE_CHECKING:
    from raceway.core.ring.system import System
    from raceway.core.stepping.record import Motion

#: Parts of the predicted limit.
FACTORS = (0.5, 0.9, 0.98, 1.02, 1.1)
_STEPS, _TURNS = 400, 50
#: Perturbation over the axial approach: small enough to be linear, far above the tolerance of implicit steps (1e-9).
_SMALL = 1e-6
#: Growth of a bounded motion, and of one that grows.
_BOUNDED, _GROWING = 20.0, 1e3
_SWINGS = "at 0.98 of the limit a bounded motion swings to 1 / sqrt(1 - 0.98^2) = 5 times its start, and modes add up"
_GROWS = "1.49 a step at 1.02 of the limit; a nonlinear contact stops the growth where it opens"


def linear(rows: Rows, registry: Registry, tables: Tables, integrator: str) -> None:
    """An undamped oscillator, its contact out of reach."""
    ring = surrogate(model_at(tables, {}, registry).system)
    system = impact_system(2.0, ring.law, ring.law_params[:1], clearance=1.0, stiffness=2e8)
    limit = system.critical_time_step(np.zeros((5, 5)))
    _around_the_limit(rows, registry, integrator, system, mass_at(1e-6, 0.0, -1e2), np.zeros(5), limit)


def small_motions(rows: Rows, registry: Registry, tables: Tables, integrator: str, changes: Tables) -> None:
    """A bearing moved by a millionth of its approach from its equilibrium."""
    at = still(tables, {**UNDAMPED, **changes}, registry)
    start = at.displaced(at.direction(_SMALL))
    _around_the_limit(rows, registry, integrator, at.system, start, at.equilibrium.displacement, at.limit)


def _around_the_limit(
    rows: Rows, registry: Registry, name: str, system: System, start: Motion, rest: np.ndarray, limit: float
) -> None:
    method = method_of(name, registry)
    weight = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
    size = float(np.abs((start.q - rest) * weight).max())

    def growth(factor: float) -> float:
        """Largest displacement over the first; of a motion that was stopped, where it was stopped."""
        try:
            moved = integrate(method, system, start, Schedule(factor * limit, _STEPS, 1)).displacement
        except ConvergenceError as stop:  # grown until the balls find no place, or beyond a metre
            moved = stop.state["q"]
        return float(np.abs((moved - rest) * weight).max() / size)

    words = f"largest over first displacement, {_STEPS} steps"
    for factor in FACTORS:
        if method.implicit or factor < 1.0:
            rows.check(words, growth(factor), _SWINGS, at_most=_BOUNDED, at={"step/limit": factor})
        else:
            rows.check(words, growth(factor), _GROWS, at_least=_GROWING, at={"step/limit": factor})
    if not method.implicit:
        low, high = 0.5, 2.0
        while high - low > 1e-3:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if growth(middle) < _BOUNDED else (low, middle)
        why = "the limit is exact for linear motions; bisected to 1e-3"
        rows.check("stable limit [s]", low * limit, why, near=limit, within=0.02)


def orbit_at_the_safe_limit(rows: Rows, registry: Registry, tables: Tables, integrator: str, changes: Tables) -> None:
    """A large orbit with the steps that a run takes by itself, at most ``SAFETY`` of its limit, is followed for 50 turns."""
    model = model_at(tables, {**UNDAMPED, **changes, "integrator.kind": integrator}, registry)
    scene, system = model.scene, surrogate(model.system)
    if scene.excitation is None or scene.excitation.period_s is None:
        return  # of a user's scene: without a period there is no orbit
    period = scene.excitation.period_s
    orbit = steady_orbit(system, period, settle(model).displacement, samples=129)
    limit = min(system.damped_time_step(k, c) for k, c in zip(orbit.stiffness, orbit.damping, strict=True))
    steps = ceil(period / (SAFETY * limit))
    states = [system.evaluate(q, ball=ball) for q, ball in zip(orbit.displacement, orbit.ball, strict=True)]
    opens = bool((np.array([now.contact_force for now in states]) <= 0.0).any())
    schedule = Schedule(period / steps, steps, _TURNS)
    record = integrate(scene.integrator.method, system, from_orbit(system, orbit, schedule.dt), schedule)
    true = np.array([at_time(orbit.displacement, period, t) for t in record.time[-steps:]])
    size = np.abs(orbit.displacement - orbit.displacement.mean(axis=0)).max(axis=0)[1:3].max()
    away = float(np.abs(record.displacement[-steps:, 1:3] - true[:, 1:3]).max() / size)
    why = "an unstable motion leaves its orbit by many times its size; steps so long cost a stable one percents"
    words = "distance from the orbit in turn 50 over its size"
    rows.check(words, away, why, at_most=0.5, at={"contacts open": opens, "steps a turn": steps})
