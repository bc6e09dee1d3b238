"""Steps around the stable limit: of a linear oscillator, of a bearing about its equilibrium, on whole orbits."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from raceway.bodies.model import build_model
from raceway.core.ring.kernels.impact import impact_system
from raceway.core.ring.orbit import Orbit, at_time, steady_orbit
from raceway.core.ring.start import from_orbit
from raceway.core.ring.surrogate import surrogate
from raceway.core.ring.system import System
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Motion, Schedule
from raceway.errors import ConvergenceError
from raceway.framework.registry import Registry
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.planning.recording import SAFETY
from raceway.studies.stability.case import AtLeast, AtMost, Case, Expectation, Measured, Near, Row, judged
from raceway.studies.stability.systems import UNDAMPED, scene_at, still

if TYPE_CHECKING:
    from raceway.framework.contracts import Integrator

#: Parts of the predicted limit.
FACTORS = (0.5, 0.9, 0.98, 1.02, 1.1)
_STEPS = 400
#: Perturbation over the axial approach: small enough to be linear, far above the tolerance of implicit steps (1e-9).
_SMALL = 1e-6
_BOUNDED = AtMost(
    20.0, "at 0.98 of the limit a bounded motion swings to 1 / sqrt(1 - 0.98^2) = 5 times its start, and modes add up"
)
_GROWING = AtLeast(1e3, "1.49 a step at 1.02 of the limit; a nonlinear contact stops the growth where it opens")
_TURNS = 50


def linear(case: Case, registry: Registry) -> list[Row]:
    """An undamped oscillator, its contact out of reach."""
    model = build_model(base := scene_at(case.arguments["tables"], {}, registry), make_plan(base))
    system = impact_system(
        2.0, surrogate(model.system).law, surrogate(model.system).law_params[:1], clearance=1.0, stiffness=2e8
    )
    start = np.array([1e-6, 0.0, 0.0, 0.0, 0.0])
    balls = np.zeros((1, 2))
    first = Motion(start, np.zeros(5), -start * 1e8, balls, balls.copy())
    return _around_the_limit(case, registry, system, first, np.zeros(5), system.critical_time_step(np.zeros((5, 5))))


def small_motions(case: Case, registry: Registry) -> list[Row]:
    """A bearing moved by a millionth of its approach from its equilibrium."""
    scene = scene_at(case.arguments["tables"], {**UNDAMPED, **case.arguments["changes"]}, registry)
    found = still(scene)
    start = found.displaced(found.direction(_SMALL))
    return _around_the_limit(case, registry, found.system, start, found.equilibrium.displacement, found.limit)


def _around_the_limit(
    case: Case, registry: Registry, system: System, start: Motion, rest: np.ndarray, limit: float
) -> list[Row]:
    name = case.arguments["integrator"]
    method: Integrator = registry.find("integrator", name).plugin()
    weight = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
    size = float(np.abs((start.q - rest) * weight).max())

    def growth(factor: float) -> float:
        """Largest displacement over the first; of a motion that was stopped, where it was stopped."""
        try:
            record = integrate(method, system, start, Schedule(factor * limit, _STEPS, 1))
        except ConvergenceError as stop:  # grown until the balls find no place, or beyond a metre
            return float(np.abs((stop.state["q"] - rest) * weight).max() / size)
        return float(np.abs((record.displacement - rest) * weight).max() / size)

    setting = {"integrator": name, **case.arguments.get("shown", {})}
    rows = []
    for factor in FACTORS:
        expected: Expectation = _BOUNDED if method.implicit or factor < 1.0 else _GROWING
        rows.append(
            judged(
                case.name, {**setting, "step/limit": factor}, f"largest over first displacement, {_STEPS} steps", expected,
                None, lambda f=factor: (growth(f), None),  # type: ignore[misc]
            )
        )  # fmt: skip
    if not method.implicit:
        close = Near(0.02, "the limit is exact for linear motions; bisected to 1e-3")
        rows.append(judged(case.name, setting, "stable limit [s]", close, limit, lambda: (_limit(growth) * limit, None)))
    return rows


def _limit(growth: Callable[[float], float]) -> float:
    """Observed limit over the predicted one, by bisection between a half and twice."""
    low, high = 0.5, 2.0
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if growth(middle) < _BOUNDED.bound else (low, middle)
    return low


def orbit_at_the_safe_limit(case: Case, registry: Registry) -> list[Row]:
    """A large orbit with the steps that a run takes by itself, at most ``SAFETY`` of its limit, is followed for 50 turns."""
    a = case.arguments
    scene = scene_at(a["tables"], {**UNDAMPED, **a["changes"], "integrator.kind": a["integrator"]}, registry)
    if scene.excitation is None or scene.excitation.period_s is None:
        return []  # of a user's scene: without a period there is no orbit
    model = build_model(scene, make_plan(scene))
    method = scene.integrator.method
    period = scene.excitation.period_s
    rest = settle(model)
    orbit = steady_orbit(surrogate(model.system), period, rest.displacement, samples=129)
    limit = min(surrogate(model.system).damped_time_step(k, c) for k, c in zip(orbit.stiffness, orbit.damping, strict=True))
    steps = ceil(period / (SAFETY * limit))
    opens = bool((_open_share(surrogate(model.system), orbit)) > 0.0)

    def follow() -> Measured:
        schedule = Schedule(period / steps, steps, _TURNS)
        record = integrate(
            method, surrogate(model.system), from_orbit(surrogate(model.system), orbit, schedule.dt), schedule
        )
        true = np.array([at_time(orbit.displacement, period, t) for t in record.time[-steps:]])
        size = np.abs(orbit.displacement - orbit.displacement.mean(axis=0)).max(axis=0)[1:3].max()
        return float(np.abs(record.displacement[-steps:, 1:3] - true[:, 1:3]).max() / size), None

    setting = {"integrator": a["integrator"], **a["shown"], "contacts open": opens, "steps a turn": steps}
    bound = AtMost(
        0.5, "an unstable motion leaves its orbit by many times its size; steps so long cost a stable one percents"
    )
    return [judged(case.name, setting, "distance from the orbit in turn 50 over its size", bound, None, follow)]


def _open_share(system: System, orbit: Orbit) -> float:
    """Share of ball contacts that are open along the orbit."""
    force = np.array([
        system.evaluate(q, ball=ball).contact_force for q, ball in zip(orbit.displacement, orbit.ball, strict=True)
    ])  # fmt: skip
    return float((force <= 0.0).mean())
